# SPDX-License-Identifier: GPL-3.0-or-later
"""A question's pictures as files that an artist can hand to any chat: one by one, and all in one with captions."""

from __future__ import annotations

import contextlib
import io
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from ..errors import OutputError

TOGETHER = "all_pictures.jpg"
_LONGEST_SIDE = 2400
"""Of the composite, pixels: chats shrink what is much larger."""
_CAPTION, _GAP = 34, 12
_FONT = 24
_TRIED = 24
"""Page widths that are tried."""
_PAPER, _INK = (255, 255, 255), (0, 0, 0)


@dataclass(frozen=True)
class SavedPictures:
    """Where a question's pictures lie.

    Attributes:
        folder: holds nothing else; files: in the prompt's order, the composite of several last.
    """

    folder: Path
    files: tuple[Path, ...] = ()

    @property
    def together(self) -> Path | None:
        """The composite; None for fewer than two pictures."""
        return self.files[-1] if self.files and self.files[-1].name == TOGETHER else None


def save_pictures(base: Path, key: str, images: Sequence[bytes]) -> SavedPictures:
    """Write a question's pictures into a folder of its own.

    Raises:
        OutputError: the folder cannot be written.
    """
    folder = base / (re.sub(r"[^A-Za-z0-9_-]+", "_", key).strip("_") or "question")
    files: list[Path] = []
    if not images:
        return SavedPictures(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for number, image in enumerate(images, 1):
            ending = "png" if image.startswith(b"\x89PNG") else "jpg"
            files.append(folder / f"picture_{number}.{ending}")
            files[-1].write_bytes(image)
        if len(images) > 1:
            files.append(folder / TOGETHER)
            files[-1].write_bytes(composite(images))
    except OSError as error:
        remove_pictures(SavedPictures(folder, tuple(files)))
        reason = error.strerror or "unknown reason"
        raise OutputError(
            f"The question's pictures cannot be saved in {str(base)!r}: {reason}.",
            "Choose another folder in the preferences.",
        ) from None
    return SavedPictures(folder, tuple(files))


def remove_pictures(saved: SavedPictures) -> None:
    """Take away what `save_pictures` wrote, and the folder where it holds nothing else. Never raises."""
    for file in saved.files:
        with contextlib.suppress(OSError):
            file.unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        saved.folder.rmdir()


def composite(images: Sequence[bytes]) -> bytes:
    """All pictures on one white page, JPEG bytes; each has its caption "Picture 1" and so on above it."""
    pictures = [_opened(image) for image in images]
    rows, scale = _arrangement([picture.size for picture in pictures])
    font = ImageFont.load_default(_FONT)
    placed: list[tuple[int, int, Image.Image]] = []
    width = y = _GAP
    for row in rows:
        x = _GAP
        small = [_scaled(pictures[number], scale) for number in row]
        for picture in small:
            placed.append((x, y, picture))
            x += picture.width + _GAP
        width = max(width, x)
        y += _CAPTION + max(picture.height for picture in small) + _GAP
    page = Image.new("RGB", (width, y), _PAPER)
    draw = ImageDraw.Draw(page)
    for number, (left, top, picture) in enumerate(placed, 1):
        draw.text((left, top), f"Picture {number}", fill=_INK, font=font)
        page.paste(picture, (left, top + _CAPTION))
    data = io.BytesIO()
    page.save(data, "JPEG", quality=90)
    return data.getvalue()


def _arrangement(sizes: Sequence[tuple[int, int]]) -> tuple[list[list[int]], float]:
    """Which pictures stand side by side, in their order, and their common scale: the one that shows them largest, at most 1."""
    widths = [width for width, _ in sizes]
    found: list[tuple[float, int, list[list[int]]]] = []
    for step in range(_TRIED + 1):
        page = max(widths) + (sum(widths) - max(widths)) * step / _TRIED
        rows: list[list[int]] = [[]]
        for number, width in enumerate(widths):
            if rows[-1] and sum(widths[n] for n in rows[-1]) + width > page:
                rows.append([])
            rows[-1].append(number)
        across = max(sum(widths[n] for n in row) for row in rows)
        down = sum(max(sizes[n][1] for n in row) for row in rows)
        most = max(map(len, rows))
        scale = min(
            1.0,
            (_LONGEST_SIDE - _GAP * (most + 1)) / across,
            (_LONGEST_SIDE - (_GAP + _CAPTION) * len(rows) - _GAP) / down,
        )
        found.append((max(scale, 0.05), -across * down, rows))
    scale, _, rows = max(found)
    return rows, scale


def _scaled(picture: Image.Image, scale: float) -> Image.Image:
    if scale >= 1.0:
        return picture
    size = max(1, math.floor(picture.width * scale)), max(1, math.floor(picture.height * scale))
    return picture.resize(size, Image.Resampling.LANCZOS)


def _opened(image: bytes) -> Image.Image:
    with Image.open(io.BytesIO(image)) as opened:
        return opened.convert("RGB")
