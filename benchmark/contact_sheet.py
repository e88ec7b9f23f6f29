# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact sheets of the furniture library: every piece from two sides, in its typical size.

python -m benchmark.contact_sheet [--out DIR] [--group NAME] [--piece NAME ...]
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np
from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.program.prelude.palette import category_family
from code_as_room.pipeline.program.prelude.shape import Shape
from PIL import Image, ImageDraw

from .photographs import Photographs

CELL = (340, 300)
COLUMNS = 4
VIEWS = ((-0.55, -1.0, 0.55), (0.9, 0.75, 1.1))


def shapes_of(piece: catalogue.Piece) -> list[Shape]:
    """The piece in its typical size."""
    text = catalogue.source([piece.name]) + f"\n\ndef made():\n    return {piece.name}({piece.typical!r})\n"
    return evaluate_object(text, "made")


def sheet(pieces: list[catalogue.Piece], out: Path, studio: Photographs) -> None:
    """One picture of these pieces, with their vertices counted."""
    wide, high = 2 * CELL[0], CELL[1] + 18
    rows = math.ceil(len(pieces) / COLUMNS)
    page = Image.new("RGB", (min(COLUMNS, len(pieces)) * wide, rows * high), "white")
    pen = ImageDraw.Draw(page)
    for number, piece in enumerate(pieces):
        x, y = number % COLUMNS * wide, number // COLUMNS * high
        try:
            shapes = shapes_of(piece)
            for k, picture in enumerate(studio.take(shapes, category_family(piece.words[0]), VIEWS)):
                page.paste(picture, (x + k * CELL[0], y))
            spans = " x ".join(f"{v:g}" for v in piece.typical)
            count = int(np.sum([shape.vertex_count for shape in shapes]))
            pen.text((x + 6, y + CELL[1] + 2), f"{piece.name}  {spans} m, {count} vertices", fill="black")
        except Exception as error:
            pen.text((x + 6, y + 20), f"{piece.name}: {error}", fill="red")
    page.thumbnail((2000, 10_000))
    page.save(out)
    print(out)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("out/library"))
    parser.add_argument("--group")
    parser.add_argument("--piece", action="append")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    groups: dict[str, list[catalogue.Piece]] = {}
    for piece in catalogue.pieces().values():
        if (not options.group or piece.group == options.group) and (not options.piece or piece.name in options.piece):
            groups.setdefault(piece.group, []).append(piece)
    studio = Photographs(CELL)
    for group, found in groups.items():
        for start in range(0, len(found), 16):
            sheet(found[start : start + 16], options.out / f"{group}-{start // 16 + 1}.png", studio)


if __name__ == "__main__":
    main()
