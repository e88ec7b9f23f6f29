# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference image: read from whatever the artist has, normalised once, and cut to what a model is sent.

Whatever comes in (alpha, CMYK, palette, 16 bit, EXIF rotation, colour profiles, animation) leaves as upright 8-bit
sRGB without metadata, so that every later step and every model sees the same picture.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from .artifacts.common import ImageBox
from .errors import PictureError
from .picture_boxes import draw_boxes, draw_grid
from .picture_reading import decode_picture

KEEP_LONG_SIDE = 4096
"""Longest side that is kept, pixels."""
MODEL_LONG_SIDE = 1568
"""Longest side that every vendor sees without scaling it down again, pixels."""
SMALLEST_SIDE = 64
_MOST_BYTES = 600_000_000
_LOSSLESS_PIXELS = 2_500_000
_LOSSLESS_BYTES = 1_500_000
_SAMPLE = 96
_FLAT_COLOURS = 1500
_OTHER_FORMAT = "Choose a PNG, JPEG or WebP picture of the room seen from above."


@dataclass(frozen=True)
class ReferencePicture:
    """The normalised reference image.

    Attributes:
        name: the file's name, without its folder.
        width, height: pixels of the kept picture, upright.
        data: the kept picture, PNG or JPEG, sRGB, no metadata; the same input gives the same bytes.
        sha256: of `data`, hexadecimal; what memory knows the picture by.
        notes: sentences on what was changed on the way in.
    """

    name: str
    width: int
    height: int
    data: bytes
    sha256: str
    notes: tuple[str, ...] = ()

    @cached_property
    def _image(self) -> Image.Image:
        image = Image.open(io.BytesIO(self.data))
        image.load()
        return image.convert("RGB")

    @cached_property
    def _model_image(self) -> Image.Image:
        return _shrunk(self._image, MODEL_LONG_SIDE)

    @cached_property
    def _model_data(self) -> bytes:
        return encode_for_model(self._model_image)

    def pixels(self) -> NDArray[np.uint8]:
        """A copy of the picture's pixels, shape (height, width, 3), sRGB 0-255, first row at the top."""
        return np.array(self._image, dtype=np.uint8)

    def for_model(self, long_side: int = MODEL_LONG_SIDE) -> bytes:
        """The picture as a model is sent it: at most `long_side` pixels, never enlarged, PNG or JPEG bytes."""
        if long_side == MODEL_LONG_SIDE:
            return self._model_data
        return encode_for_model(_shrunk(self._image, long_side))

    def crop(self, box: ImageBox, margin: float = 0.05, long_side: int = MODEL_LONG_SIDE) -> bytes:
        """A part of the picture, widened on every side by `margin` of the box's longer side, never enlarged.

        Args:
            box: in 0-1000 of the picture's width and height; what lies outside the picture is cut off.

        Raises:
            PictureError: nothing of the box lies inside the picture.
        """
        left, right = sorted((box.x_min * self.width / 1000, box.x_max * self.width / 1000))
        top, bottom = sorted((box.y_min * self.height / 1000, box.y_max * self.height / 1000))
        extra = margin * max(right - left, bottom - top)
        corners = (
            max(0, int(np.floor(left - extra))),
            max(0, int(np.floor(top - extra))),
            min(self.width, int(np.ceil(right + extra))),
            min(self.height, int(np.ceil(bottom + extra))),
        )
        if corners[2] <= corners[0] or corners[3] <= corners[1]:
            raise PictureError("The part of the picture that was asked for lies outside it.")
        return encode_for_model(_shrunk(self._image.crop(corners), long_side))

    def with_boxes_drawn(self, boxes: Sequence[tuple[str, ImageBox]], long_side: int = MODEL_LONG_SIDE) -> bytes:
        """The picture with thin boxes, each with its label (a number or a short id), drawn at the size sent.

        Args:
            boxes: (label, box) pairs; boxes in 0-1000 of the picture's width and height.
        """
        model_size = long_side == MODEL_LONG_SIDE
        image = (self._model_image if model_size else _shrunk(self._image, long_side)).copy()
        draw_boxes(image, boxes)
        return encode_for_model(image)

    def with_grid(self) -> bytes:
        """The picture as a model is sent it, with numbered lines every 100 of its 0-1000 coordinates."""
        image = self._model_image.copy()
        draw_grid(image)
        return encode_for_model(image)


def load_picture(path: str | Path) -> ReferencePicture:
    """Read the reference image from a file.

    Raises:
        PictureError: there is no such file, it is no picture, it is damaged, too small or absurdly large.
    """
    path = Path(path)
    try:
        if path.is_dir():
            raise PictureError(f"{path.name or path} is a folder, not a picture.", _OTHER_FORMAT)
        if not path.exists():
            raise PictureError(f"There is no file {path.name!r} in that place.", "Check the path.")
        if not path.is_file():
            raise PictureError(f"{path.name!r} is not a file.", _OTHER_FORMAT)
        if path.stat().st_size > _MOST_BYTES:
            raise PictureError(f"{path.name!r} is too large a file.", _OTHER_FORMAT)
        data = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "its path is not valid"
        raise PictureError(f"{path.name!r} cannot be read: {reason}.", "Check the path and its permissions.") from None
    # A file's name may hold bytes that are no text; memory and report hold text.
    return read_picture(data, path.name.encode("utf-8", "replace").decode("utf-8"))


def read_picture(data: bytes, name: str) -> ReferencePicture:
    """Normalise an encoded picture (any format that Pillow reads safely).

    Raises:
        PictureError: as `load_picture`.
    """
    image, notes = decode_picture(data, name)
    _refuse_tiny(image, name)
    if max(image.size) > KEEP_LONG_SIDE:
        before = f"{image.width} x {image.height}"
        image = _shrunk(image, KEEP_LONG_SIDE)
        _refuse_tiny(image, name)
        notes = (*notes, f"The picture was scaled from {before} to {image.width} x {image.height} pixels.")
    lossless = image.width * image.height <= _LOSSLESS_PIXELS
    kept = _encoded(image, "PNG" if lossless else "JPEG", quality=95)
    return ReferencePicture(name, image.width, image.height, kept, hashlib.sha256(kept).hexdigest(), notes)


def encode_for_model(image: Image.Image) -> bytes:
    """PNG for drawings and flat renders, JPEG of high quality for the rest; the same pixels give the same bytes.

    A photograph is five times smaller as JPEG, and twenty times faster to make.
    """
    sample = image.resize((_SAMPLE, _SAMPLE), Image.Resampling.NEAREST)
    flat = sample.getcolors(_FLAT_COLOURS) is not None
    if flat and not _surely_large(image):
        lossless = _encoded(image, "PNG")
        if len(lossless) <= _LOSSLESS_BYTES:
            return lossless
    return _encoded(image, "JPEG", quality=92)


def _surely_large(image: Image.Image) -> bool:
    """Whether a few bands of the image tell that its PNG is far over the limit, so that it need not be made."""
    height = image.height // 64
    if height < 4:
        return False
    bands = [image.crop((0, top, image.width, top + height)) for top in range(4 * height, 61 * height, 8 * height)]
    part = sum(len(_encoded(band, "PNG")) for band in bands)
    return part * image.height / (len(bands) * height) > 2 * _LOSSLESS_BYTES


def _refuse_tiny(image: Image.Image, name: str) -> None:
    if min(image.size) < SMALLEST_SIDE:
        raise PictureError(
            f"{name!r} is only {image.width} x {image.height} pixels; nothing can be recognised in it.",
            "Choose a picture of at least 512 pixels on its shorter side.",
        )


def _shrunk(image: Image.Image, long_side: int) -> Image.Image:
    """The image at most `long_side` pixels long, never enlarged."""
    longest = max(image.size)
    if longest <= long_side:
        return image
    size = (max(1, round(image.width * long_side / longest)), max(1, round(image.height * long_side / longest)))
    return image.resize(size, Image.Resampling.LANCZOS)


def _encoded(image: Image.Image, kind: str, quality: int = 95) -> bytes:
    buffer = io.BytesIO()
    if kind == "JPEG":
        # No chroma subsampling: thin coloured lines and small objects keep their colour.
        image.save(buffer, "JPEG", quality=quality, subsampling=0)
    else:
        image.save(buffer, "PNG", compress_level=3)
    return buffer.getvalue()
