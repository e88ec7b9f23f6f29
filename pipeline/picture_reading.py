# SPDX-License-Identifier: GPL-3.0-or-later
"""Decodes any picture file into upright 8-bit sRGB, or says in plain words why it cannot."""

from __future__ import annotations

import io
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageCms, ImageOps, UnidentifiedImageError

from .errors import PictureError

MOST_PIXELS = 120_000_000
"""Largest picture that is decoded; a decoded pixel takes up to eight bytes on the way."""
_FORMATS = ("PNG", "JPEG", "MPO", "WEBP", "BMP", "DIB", "GIF", "TIFF", "AVIF", "JPEG2000", "PPM", "TGA", "ICO")
"""Raster formats only: Pillow's vector and document readers start other programs."""
_EXIF_ORIENTATION = 0x0112
_FIX = "Save it again as PNG or JPEG and choose that."


def decode_picture(data: bytes, name: str) -> tuple[Image.Image, tuple[str, ...]]:
    """Decode a picture file's bytes.

    Returns:
        The upright image in mode RGB, and sentences on what was changed (transparency, profile, rotation, ...).

    Raises:
        PictureError: it is not a picture, is of a kind that is not read, is damaged, or is absurdly large.
    """
    notes: list[str] = []
    with warnings.catch_warnings():
        # Pillow warns about large pictures; our own limit decides.
        warnings.simplefilter("ignore")
        try:
            image = _opened(data, name)
            if getattr(image, "n_frames", 1) > 1 and image.format not in ("MPO", "ICO"):
                notes.append("The picture is animated or has several pages; the first was taken.")
            image.load()
            image = _upright(image, notes)
            plain = _rgb(image, notes)
            # A new image from the bare pixels: Pillow would write profiles, comments and positions on again.
            return Image.frombytes("RGB", plain.size, plain.tobytes()), tuple(notes)
        except PictureError:
            raise
        except Image.DecompressionBombError:
            raise _too_large(name) from None
        except MemoryError:
            raise PictureError(f"There is not enough memory to read {name!r}.", "Choose a smaller picture.") from None
        except Exception:
            # Decoders raise almost anything on damaged bytes; to the artist it is one and the same.
            raise PictureError(f"{name!r} is damaged or incomplete and cannot be read.", _FIX) from None


def _opened(data: bytes, name: str) -> Image.Image:
    if not data:
        raise PictureError(f"{name!r} is empty.", "Choose another picture.")
    available = [kind for kind in _FORMATS if kind in Image.OPEN or Image.init() and kind in Image.OPEN]
    try:
        image = Image.open(io.BytesIO(data), formats=available)
    except UnidentifiedImageError:
        raise PictureError(_what_it_is(data, name), _FIX) from None
    if image.width * image.height > MOST_PIXELS:
        raise _too_large(name)
    return image


def _too_large(name: str) -> PictureError:
    return PictureError(f"{name!r} has too many pixels to be read.", "Choose a picture of at most 100 megapixels.")


def _what_it_is(data: bytes, name: str) -> str:
    """One sentence on a file that is not a picture we read."""
    head = data[:512].lstrip()
    if data[4:12] in (b"ftypheic", b"ftypheix", b"ftypmif1", b"ftyphevc"):
        return f"{name!r} is a HEIC picture, which cannot be read here."
    if head.startswith(b"%PDF"):
        return f"{name!r} is a PDF, not a picture."
    if b"<svg" in head.lower():
        return f"{name!r} is a vector drawing (SVG), not a picture of pixels."
    return f"{name!r} is not a picture that can be read."


def _upright(image: Image.Image, notes: list[str]) -> Image.Image:
    """The image turned as its EXIF orientation says."""
    try:
        turned = image.getexif().get(_EXIF_ORIENTATION, 1) in range(2, 9)
    except Exception:
        # Damaged EXIF data says nothing about the pixels.
        return image
    if not turned:
        return image
    notes.append("The picture was turned upright as its EXIF data says.")
    return ImageOps.exif_transpose(image)


def _rgb(image: Image.Image, notes: list[str]) -> Image.Image:
    """The image as 8-bit sRGB without transparency."""
    if image.mode.startswith("I") or image.mode == "F":
        notes.append("The picture was brought from 16 or 32 bits to 8 bits a channel.")
        grey = _eight_bit(np.asarray(image), image.mode)
        return Image.fromarray(grey).convert("RGB")
    if image.mode in ("RGBA", "LA", "PA", "La", "RGBa") or "transparency" in image.info:
        return _over_white(image, notes)
    return _to_srgb(image, image.info.get("icc_profile"), notes)


def _over_white(image: Image.Image, notes: list[str]) -> Image.Image:
    profile = image.info.get("icc_profile")
    with_alpha = image.convert("RGBA")
    alpha = with_alpha.getchannel("A")
    colour = _to_srgb(with_alpha.convert("RGB"), profile, notes)
    if alpha.getextrema() == (255, 255):
        return colour
    notes.append("The picture's transparent parts were put on white.")
    white = Image.new("RGB", colour.size, (255, 255, 255))
    white.paste(colour, mask=alpha)
    return white


def _to_srgb(image: Image.Image, profile: bytes | None, notes: list[str]) -> Image.Image:
    """RGB by the embedded colour profile where there is a usable one, else by Pillow's plain conversion."""
    if profile and image.mode in ("RGB", "CMYK", "L", "LAB"):
        try:
            source = ImageCms.ImageCmsProfile(io.BytesIO(profile))
            converted: Any = ImageCms.profileToProfile(image, source, ImageCms.createProfile("sRGB"), outputMode="RGB")
        except (ImageCms.PyCMSError, OSError, ValueError, TypeError):
            notes.append("The picture's colour profile could not be used.")
        else:
            return converted if isinstance(converted, Image.Image) else image.convert("RGB")
    if image.mode == "CMYK":
        notes.append("The picture was converted from CMYK without a profile; its colours are approximate.")
    return image.convert("RGB")


def _eight_bit(values: NDArray[Any], mode: str) -> NDArray[np.uint8]:
    """Grey values of more than 8 bits scaled to 0-255: 16-bit range for integers, 0-1 or the maximum for floats."""
    numbers = np.nan_to_num(values.astype(np.float32), nan=0.0, posinf=0.0, neginf=0.0)
    largest = float(numbers.max(initial=0.0))
    if mode == "F":
        top = 1.0 if largest <= 1.0 else 255.0 if largest <= 255.0 else largest
    else:
        top = 255.0 if mode == "I" and largest <= 255.0 else 65535.0 if largest <= 65535.0 else largest
    return np.clip(numbers * (255.0 / top) + 0.5, 0, 255).astype(np.uint8)
