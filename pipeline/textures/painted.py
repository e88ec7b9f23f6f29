# SPDX-License-Identifier: GPL-3.0-or-later
"""What an image model painted, made fit for use: checked, made to repeat, brought to the room's own colour."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from ..artifacts.textures import TextureQuality
from .pixels import Pixels, perceived, resized, to_linear
from .quality import seam_error, sharpness
from .quilting import quilted
from .shading import flattened, typical_colour
from .shown import LIGHTEST, Flat, NotUsable

SIDE = 768
_LEAST_SIDE = 200
_PLAIN = 0.004
_WORST_SEAM = 1.6
_MOST_TINT = 1.8


def painted_tile(data: bytes, size: tuple[float, float], colour: Pixels | None = None) -> Flat:
    """A painted surface as a tile.

    Args:
        size: metres that the image shows; colour: linear colour that it is to have on the whole, None as it is.

    Raises:
        NotUsable: nothing is on it, or it cannot be made to repeat.
    """
    pixels = _read(data, size)
    whole = np.ones(pixels.shape[:2], dtype=bool)
    scale = pixels.shape[1] / size[0]
    even = flattened(pixels, whole, 0.35 * min(whole.shape))
    # A border is lost to the seams.
    covers = 0.75 * size[0], 0.75 * size[1]
    tile = quilted(even, whole, np.zeros(whole.shape, dtype=np.float32), scale, covers)
    if tile is None:
        raise NotUsable("What the image model painted cannot be made to repeat.")
    seam = seam_error(tile.pixels, tile.owners)
    if seam > _WORST_SEAM:
        raise NotUsable("What the image model painted shows seams where it repeats.")
    quality = TextureQuality(
        detail=round(scale, 1), sharpness=round(sharpness(tile.pixels, even, whole), 3), seam=round(seam, 3)
    )
    made = tile.pixels.shape[1] / scale, tile.pixels.shape[0] / scale
    return Flat(_tinted(tile.pixels, colour), made, 0.0, quality)


def painted_face(data: bytes, size: tuple[float, float], colour: Pixels | None = None) -> Flat:
    """A painted rug, cover or picture, which fills its face once.

    Raises:
        NotUsable: nothing is on it.
    """
    pixels = _read(data, size)
    return Flat(_tinted(pixels, colour), size, 0.0, TextureQuality(detail=round(pixels.shape[1] / size[0], 1)))


def _read(data: bytes, size: tuple[float, float]) -> Pixels:
    """The image's middle in the proportions of the surface."""
    with Image.open(io.BytesIO(data)) as image:
        found = image.convert("RGB")
    ratio = size[0] / size[1]
    width = min(found.width, round(found.height * ratio))
    height = min(found.height, round(width / ratio))
    left, top = (found.width - width) // 2, (found.height - height) // 2
    pixels = to_linear(np.array(found.crop((left, top, left + width, top + height)), dtype=np.uint8))
    if max(width, height) < _LEAST_SIDE:
        raise NotUsable("What the image model painted is too small.")
    longest = max(width, height)
    if longest > SIDE:
        pixels = resized(pixels, (max(8, round(width * SIDE / longest)), max(8, round(height * SIDE / longest))))
    lab = perceived(pixels.reshape(-1, 3)[::17])
    if float(lab.std(axis=0).sum()) < _PLAIN:
        raise NotUsable("The image model painted an empty surface.")
    return pixels


def _tinted(pixels: Pixels, colour: Pixels | None) -> Pixels:
    """The image brought to a colour, within reason: a painted pattern keeps its own contrasts."""
    if colour is None:
        return np.clip(pixels, 0.0, LIGHTEST).astype(np.float32)
    own = typical_colour(pixels, np.ones(pixels.shape[:2], dtype=bool))
    gain = np.clip(colour / np.maximum(own, 1e-3), 1 / _MOST_TINT, _MOST_TINT)
    found: Pixels = np.clip(pixels * gain, 0.0, LIGHTEST).astype(np.float32)
    return found
