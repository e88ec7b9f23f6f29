# SPDX-License-Identifier: GPL-3.0-or-later
"""The constructors in docs/geometry.md: a sheet of small pictures for each group, and their text from the docstrings.

python -m benchmark.constructor_sheets [--out docs/pictures/geometry] [--sheet NAME]
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from code_as_room.pipeline.program.evaluate import evaluate_object
from PIL import Image, ImageDraw

from .constructor_examples import MARKS, SHEETS, documentation, program
from .photographs import Photographs

CELL = (240, 200)
COLUMNS = 4
VIEW = (-0.5, -1.0, 0.62)
FAMILIES = {"foliage": "plant", "soft": "textile"}


def sheet(name: str, studio: Photographs) -> Image.Image:
    """One sheet, every picture with its title below."""
    examples = SHEETS[name]
    high = CELL[1] + 18
    page = Image.new("RGB", (COLUMNS * CELL[0], math.ceil(len(examples) / COLUMNS) * high), "white")
    pen = ImageDraw.Draw(page)
    for number, (title, expression) in enumerate(examples.items()):
        x, y = number % COLUMNS * CELL[0], number // COLUMNS * high
        shapes = evaluate_object(program(expression), "made")
        page.paste(studio.take(shapes, FAMILIES.get(name, "table"), (VIEW,))[0], (x, y))
        pen.text((x + 6, y + CELL[1] + 3), title, fill="black")
    return page


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("docs/pictures/geometry"))
    parser.add_argument("--sheet", choices=tuple(SHEETS), action="append")
    options = parser.parse_args()
    page = Path("docs/geometry.md")
    before, rest = page.read_text(encoding="utf-8").split(MARKS[0])
    page.write_text(before + MARKS[0] + "\n" + documentation() + MARKS[1] + rest.split(MARKS[1])[1], encoding="utf-8")
    options.out.mkdir(parents=True, exist_ok=True)
    studio = Photographs(CELL)
    for name in options.sheet or SHEETS:
        path = options.out / f"{name}.png"
        sheet(name, studio).quantize(128).save(path, optimize=True)
        print(path, f"{path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
