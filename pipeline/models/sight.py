# SPDX-License-Identifier: GPL-3.0-or-later
"""What a vendor's models see of a picture one to one, and pictures made to fit it before they are sent.

A larger picture would only be shrunk at the other end, after it was sent and often after it was paid for. Coordinates are
asked for in 0-1000 of the picture, so its size does not matter for them.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from PIL import Image

_JPEG_QUALITY = 92
_WORTH = 0.97
"""A picture that would shrink by less stays as it is: encoding it anew would cost more than it saves."""


@dataclass(frozen=True)
class Sight:
    """Limits of pictures.

    Attributes:
        long_side, short_side: most pixels of the longer and of the shorter side; pixels: in all; 0 for no limit.
        picture_bytes, request_bytes: of one encoded picture, and of all of a request.
    """

    long_side: int = 1568
    short_side: int = 0
    pixels: int = 0
    picture_bytes: int = 7_000_000
    request_bytes: int = 20_000_000

    def scale(self, width: int, height: int) -> float:
        """By how much a picture has to shrink, 1 when it fits."""
        limits = [1.0]
        if self.long_side:
            limits.append(self.long_side / max(width, height))
        if self.short_side:
            limits.append(self.short_side / min(width, height))
        if self.pixels:
            limits.append(math.sqrt(self.pixels / (width * height)))
        return min(limits)


_VERSION = re.compile(r"(?<!\d)\d{1,2}(?!\d)")
_TILED = re.compile(r"(?:4o|4o-mini|4\.1|5|o1|o3)(?:-(?:chat-)?latest|-\d{4}-\d{2}-\d{2})?")


def sight_of_claude(model: str) -> Sight:
    """Claude up to 4.6 sees 1568 pixels of the long side and about 1.15 megapixels in all; later ones see more."""
    version = [int(number) for number in _VERSION.findall(model)[:2]]
    earlier = bool(version) and version < [4, 7]
    # A picture may have 5 MB, in base64.
    return Sight(pixels=1_150_000 if earlier else 0, picture_bytes=3_700_000, request_bytes=22_000_000)


def sight_of_openai(model: str) -> Sight:
    """Models that look at tiles see 768 pixels of the short side; those that look at patches see more."""
    name = model.strip().lower().removeprefix("chatgpt-").removeprefix("gpt-")
    return Sight(long_side=2048, short_side=768) if _TILED.fullmatch(name) else Sight()


def fitted(images: Sequence[bytes], sight: Sight) -> tuple[bytes, ...]:
    """The pictures, shrunk and encoded anew where they are larger than the limits; what cannot be read stays as it is."""
    made = tuple(_fitted(image, sight) for image in images)
    share = 1.0
    while sum(map(len, made)) > sight.request_bytes and share > 0.2:
        # First as JPEG, then smaller and smaller: all must go into one request.
        made = tuple(_encoded(image, share, jpeg=True) for image in images)
        share *= 0.75
    return made


@lru_cache(maxsize=24)
def _fitted(image: bytes, sight: Sight) -> bytes:
    size = _size(image)
    if size is None:
        return image
    scale = sight.scale(*size)
    if scale < _WORTH:
        image = _encoded(image, scale)
    return image if len(image) <= sight.picture_bytes else _encoded(image, 1.0, jpeg=True)


def _size(image: bytes) -> tuple[int, int] | None:
    try:
        with Image.open(io.BytesIO(image)) as opened:
            return opened.size
    except Exception:  # whatever Pillow raises on bytes that are no picture
        return None


def _encoded(image: bytes, scale: float, jpeg: bool = False) -> bytes:
    """The picture at another size; in its own format unless JPEG is asked for."""
    try:
        with Image.open(io.BytesIO(image)) as opened:
            opened.load()
            as_jpeg = jpeg or opened.format == "JPEG"
            picture = opened.convert("RGB")
    except Exception:  # as above
        return image
    size = max(1, round(picture.width * scale)), max(1, round(picture.height * scale))
    if size != picture.size:
        picture = picture.resize(size, Image.Resampling.LANCZOS)
    data = io.BytesIO()
    picture.save(data, "JPEG" if as_jpeg else "PNG", **({"quality": _JPEG_QUALITY} if as_jpeg else {}))
    return data.getvalue()


def sizes_seen(images: Sequence[bytes], model: str) -> list[tuple[int, int]]:
    """Sizes in pixels that a model may mean when it speaks of pixels: of the pictures as it sees them, then as they are."""
    name = model.strip().lower().rpartition("/")[2]
    sight = sight_of_claude(name) if "claude" in name else sight_of_openai(name)
    whole = [size for image in images if (size := _size(image)) is not None]
    seen = [(round(w * sight.scale(w, h)), round(h * sight.scale(w, h))) for w, h in whole]
    return list(dict.fromkeys([*seen, *whole]))
