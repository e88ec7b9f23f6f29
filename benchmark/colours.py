# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of finished rooms against their pictures:
`python -m benchmark.colours RUN_DIR... [--pictures DIR]... [--json FILE]`.

RUN_DIR is what `code-as-room --out` wrote (room.blend, scene.json, memory.json). Its picture is found below the --pictures
folders by name and content; a truth beside it (truth.json, or NAME.truth.json) gives true boxes.

Definition. A room is rendered through its reference camera (Cycles, at most 64 samples, denoised, 512 px), and the picture
is brought to that size, so that both have the same pixels. For each object that is seen, two figures, both CIEDE2000:

- `base`: the mean base colour of its visible pixels (patterns and images included, light not), against the colour that the
  picture has at its place, times the gains that take the light's colour and strength out of this picture (stage 5's).
- `shown`: the colour in the render against the colour in the picture over the same pixels, both as they are displayed.

The picture's place of an object is its true box without its rim, less the boxes of smaller things before it, where there is
a truth and the object was matched with a true one; else the pixels that show it in the render, without the outermost two.
The colour of a place is the mean light of its pixels without the darkest and the brightest tenth. Things with less than 30
pixels are left out. Floor and walls are measured by their own pixels. A room's figure is the mean over its objects.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from code_as_room.pipeline.artifacts.objects import RoomStyle
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.memory import Memory, load_memory
from code_as_room.pipeline.picture import ReferencePicture, load_picture
from numpy.typing import NDArray
from PIL import Image

from .ciede import Floats, ciede2000, encoded, lab, linear
from .shown_colours import Seen, see
from .true_boxes import Boxes, true_boxes

LONG_SIDE = 512
TARGETS = {"objects": 12.0, "floor": 8.0}
_RIM, _FEWEST, _TAIL = 2, 30, 0.1
_PICTURES = (Path("samples"), Path("benchmark/pictures"))
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Row:
    """One thing: both differences, the colours they are between (six sRGB digits), its pixels, and whose place it is."""

    id: str
    base: float
    shown: float
    finished: str
    picture: str
    pixels: int
    place: str


@dataclass(frozen=True)
class Sheet:
    """The figures of one room; rows of objects, largest difference first."""

    name: str
    picture: str
    objects: list[Row]
    floor: Row | None
    walls: list[Row]

    def mean(self, which: str = "base") -> float:
        """Of all objects."""
        return float(np.mean([getattr(row, which) for row in self.objects])) if self.objects else 0.0


def measure(run: Path, pictures: Sequence[Path] = _PICTURES, samples: int = 64) -> Sheet:
    """All figures of a run's folder.

    Raises:
        ValueError: there is no room in it, or its picture is not found.
    """
    memory = load_memory((run / "memory.json").read_text(encoding="utf-8"))
    path, picture = _picture(memory, [run, *pictures])
    style = memory.latest(RoomStyle)
    gains = np.array(style.gains if style is not None else (1.0, 1.0, 1.0))
    seen = see(run / "room.blend", LONG_SIDE, samples)
    boxes = true_boxes(path, run / "scene.json", memory)
    return sheet_of(run.name, path.name, seen, _resized(picture, seen.numbers.shape), gains, boxes)


def sheet_of(name: str, picture: str, seen: Seen, light: Floats, gains: Floats, boxes: Mapping[str, Boxes]) -> Sheet:
    """The figures of a room that was rendered.

    Args:
        light: the picture as linear light (height, width, 3), as large as the render. boxes: true boxes by object's id.
    """
    rows, floors, walls = [], [], []
    for identifier, kind in dict(zip(seen.ids, seen.kinds, strict=True)).items():
        mask = seen.mask(identifier)
        inner = _without_rim(mask)
        place, whose = (inner, "own") if inner.sum() >= _FEWEST else (mask, "own")
        if identifier in boxes:
            true = boxes[identifier].place(seen.numbers.shape)
            if true.sum() >= _FEWEST:
                place, whose = true, "true"
        if min(mask.sum(), place.sum()) < _FEWEST:
            continue
        row = _row(identifier, seen, light, gains, mask, place, whose)
        {"proxy": rows, "floor": floors, "wall": walls, "partition": walls}.get(kind, []).append(row)
    rows.sort(key=lambda row: -row.base)
    return Sheet(name, picture, rows, floors[0] if floors else None, walls)


def _row(
    identifier: str, seen: Seen, light: Floats, gains: Floats, mask: Mask, place: Mask, whose: str
) -> Row:  # fmt: skip
    finished, pictured = seen.base[mask].mean(axis=0), _colour(light[place])
    base = ciede2000(lab(finished), lab(pictured * gains))
    shown = ciede2000(lab(_colour(seen.shown[place])), lab(pictured))
    codes = [_code(finished), _code(pictured * gains)]
    return Row(identifier, round(float(base), 2), round(float(shown), 2), *codes, int(place.sum()), whose)


def _colour(pixels: Floats) -> Floats:
    """The mean light of pixels (N, 3) without the darkest and brightest: shadows in corners, gloss, neighbours' edges."""
    order = pixels.mean(axis=1).argsort()
    cut = int(len(order) * _TAIL)
    found: Floats = pixels[order[cut : len(order) - cut]].mean(axis=0)
    return found


def _without_rim(mask: Mask) -> Mask:
    for _ in range(_RIM):
        padded = np.pad(mask, 1)
        mask = mask & padded[2:, 1:-1] & padded[:-2, 1:-1] & padded[1:-1, 2:] & padded[1:-1, :-2]
    return mask


def _code(light: Floats) -> str:
    return "".join(f"{round(255 * float(v)):02X}" for v in encoded(light))


def _resized(picture: ReferencePicture, shape: Sequence[int]) -> Floats:
    image = Image.fromarray(picture.pixels()).resize((shape[1], shape[0]), Image.Resampling.LANCZOS)
    return linear(np.asarray(image, dtype=float) / 255)


def _picture(memory: Memory, folders: Sequence[Path]) -> tuple[Path, ReferencePicture]:
    """The picture that a memory is about: of its name, and with its content."""
    for folder in folders:
        for path in sorted(folder.rglob(memory.picture_name)) if memory.picture_name else ():
            try:
                picture = load_picture(path)
            except RoomError:
                continue
            if picture.sha256 == memory.picture_hash:
                return path, picture
    raise ValueError(f"its picture {memory.picture_name or '(none)'} is not below {', '.join(map(str, folders))}")


def text(sheet: Sheet) -> str:
    """The table for a terminal."""
    objects, floor = sheet.mean(), sheet.floor
    lines = [
        f"{sheet.name} ({sheet.picture}), {len(sheet.objects)} objects; CIEDE2000 of base colours, and as displayed"
    ]
    worst = [("worst", row) for row in sheet.objects[:5]]
    for title, row in [*worst, *([("floor", floor)] if floor else []), *(("wall", row) for row in sheet.walls)]:
        lines.append(f"  {title:<6}{row.id:<28}{row.base:>7.1f}{row.shown:>7.1f}   room #{row.finished}, "
                     f"picture #{row.picture}, {row.place} place of {row.pixels} px")  # fmt: skip
    lines.append(_figure("objects", objects, sheet.mean("shown")))
    if floor is not None:
        lines.append(_figure("floor", floor.base, floor.shown))
    return "\n".join(lines)


def _figure(name: str, base: float, shown: float) -> str:
    reached = "reached" if base <= TARGETS[name] else "NOT REACHED"
    return f"  mean of {name}: {base:.1f} (target {TARGETS[name]:.0f}, {reached}); as displayed {shown:.1f}"


def summary(sheets: Sequence[Sheet]) -> str:
    """Means over rooms."""
    floors = [s.floor for s in sheets if s.floor is not None]
    lines = [f"{len(sheets)} rooms"]
    lines.append(_figure("objects", *(float(np.mean([s.mean(w) for s in sheets])) for w in ("base", "shown"))))
    if floors:
        lines.append(_figure("floor", *(float(np.mean([getattr(f, w) for f in floors])) for w in ("base", "shown"))))
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables; 1 when a folder cannot be measured."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("runs", type=Path, nargs="+")
    parser.add_argument("--pictures", type=Path, action="append", default=[], help="folder to look for pictures in")
    parser.add_argument("--samples", type=int, default=64, help="of the render, at most")
    parser.add_argument("--json", type=Path, help="write all figures there")
    options = parser.parse_args(arguments)
    sheets: list[Sheet] = []
    for run in options.runs:
        try:
            sheets.append(measure(run, [*options.pictures, *_PICTURES], options.samples))
        except (ValueError, OSError, RuntimeError, RoomError) as error:
            print(f"{run}: {error}", file=sys.stderr)
            return 1
        print(text(sheets[-1]), end="\n\n", flush=True)
    if len(sheets) > 1:
        print(summary(sheets))
    if options.json:
        options.json.write_text(json.dumps([asdict(s) for s in sheets], indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
