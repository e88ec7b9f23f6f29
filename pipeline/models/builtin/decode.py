# SPDX-License-Identifier: GPL-3.0-or-later
"""From encoded picture bytes to a small array of Lab colours that the analysis works on."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFilter, ImageOps

from ...errors import PictureError

Floats = NDArray[np.float32]

LONG_SIDE = 400
"""Long side of the working picture in pixels: one pixel is 0.25 % of the picture, and a second is enough for it."""


@dataclass(frozen=True)
class WorkPicture:
    """The picture at working size.

    Attributes:
        rgb: (h, w, 3) float32, sRGB 0..255, lightly denoised.
        lab: (h, w, 3) float32, CIE L*a*b* (D65).
        ink: (h, w) lightness L* of the darkest spot under each pixel, so that thin lines survive.
        size: (width, height) of the original in pixels.
    """

    rgb: Floats
    lab: Floats
    ink: Floats
    size: tuple[int, int]


def rgb_to_lab(rgb: Floats) -> Floats:
    """Convert sRGB 0..255 to CIE L*a*b* under D65 (IEC 61966-2-1 and CIE 15). Any leading shape, last axis 3."""
    unit = np.clip(rgb / 255.0, 0.0, 1.0)
    linear = np.where(unit <= 0.04045, unit / 12.92, ((unit + 0.055) / 1.055) ** 2.4)
    to_xyz = np.array(
        [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
    )
    xyz = linear @ to_xyz.T / np.array([0.95047, 1.0, 1.08883])
    f = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    lab = np.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], axis=-1)
    result: Floats = lab.astype(np.float32)
    return result


def _flatten(image: Image.Image) -> Image.Image:
    """Upright 8-bit RGB; transparency is laid over white; 16-bit grey is scaled by its own range."""
    upright = ImageOps.exif_transpose(image)
    if upright.mode in ("I", "F") or upright.mode.startswith("I;16"):
        values = np.asarray(upright, dtype=np.float64)
        values = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
        top = 65535.0 if values.max(initial=0.0) > 255 else 255.0
        return Image.fromarray(np.clip(values / top * 255, 0, 255).astype(np.uint8)).convert("RGB")
    if upright.mode in ("RGBA", "LA", "PA") or "transparency" in upright.info:
        clear = upright.convert("RGBA")
        white = Image.new("RGBA", clear.size, (255, 255, 255, 255))
        return Image.alpha_composite(white, clear).convert("RGB")
    return upright.convert("RGB")


def decode(data: bytes, long_side: int = LONG_SIDE) -> WorkPicture:
    """Decode PNG, JPEG or another format that Pillow reads, and bring it to working size.

    Raises:
        PictureError: the bytes are not a picture that can be read.
    """
    try:
        with Image.open(io.BytesIO(data)) as image:
            image.draft("RGB", (long_side * 2, long_side * 2))
            size = image.size
            image.load()
            flat = _flatten(image)
            if image.getexif().get(0x0112) in (5, 6, 7, 8):
                size = (size[1], size[0])
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise PictureError("The picture cannot be read.", "Save it as PNG or JPEG and load it again.") from error
    scale = long_side / max(flat.size)
    dark = flat.convert("L")
    if scale < 1:
        small = (max(1, round(flat.width * scale)), max(1, round(flat.height * scale)))
        flat = flat.resize(small, Image.Resampling.BOX if scale < 0.5 else Image.Resampling.LANCZOS)
        block = min(2 * round(0.5 / scale) + 1, 9)
        dark = dark.filter(ImageFilter.MinFilter(block)).resize(small, Image.Resampling.NEAREST)
    if min(flat.size) >= 5:
        flat = flat.filter(ImageFilter.MedianFilter(3))
    rgb = np.asarray(flat, dtype=np.float32)
    ink = rgb_to_lab(np.repeat(np.asarray(dark, dtype=np.float32)[..., None], 3, axis=2))[..., 0]
    return WorkPicture(rgb, rgb_to_lab(rgb), ink, size)
