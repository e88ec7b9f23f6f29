# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows and doors that go up to the walls' upper ends: pictures from above are often of rooms that are cut through them.

Over such a hole the picture shows something else than the walls' upper faces. A window is then made as high as its wall; a
door keeps its leaf, and the wall over it is left open.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ..artifacts.camera import CameraModel
from ..artifacts.layout import Layout, OpeningLine, WindowLine
from ..geometry.camera import Projector
from ..geometry.polygon import Floats
from ..program.prelude.holes import wall_holes
from ..program.prelude.pieces import Hole, WallRun
from ..program.prelude.record import Record
from ..program.prelude.walls import wall_runs

OVER = "_top"
"""What the id of the opening over a door ends with."""
_STEP = 0.05  # metres between places
_FROM_ENDS = 0.1  # metres of walls and holes that are left out: mitres, frames
_FEWEST = 6  # places
_ALIKE, _OTHER = 0.08, 0.1  # of the cube root of linear light, which is about as the eye sees it
_CERTAIN = 0.6  # of a wall's places that are of one colour


def with_open_tops(layout: Layout, camera: CameraModel, pixels: Floats) -> Layout:
    """The layout with windows and doors as high as the picture shows them.

    Args:
        pixels: the picture as linear light (height, width, 3).
    """
    floor = [(float(x), float(y)) for x, y in layout.room.floor]
    record = Record(room=layout.room.model_dump())
    for name in ("walls", "doors", "windows", "openings"):
        setattr(record, name, [line.model_dump() for line in getattr(layout, name)])
    runs = [run for run in wall_runs(record.walls, floor) if not run.partition]
    holes = wall_holes(record, wall_runs(record.walls, floor), [])
    high = {
        hole.line["id"]: run.height
        for run in runs
        for hole in holes[run.id]
        if _is_open(run, hole, holes[run.id], camera, pixels)
    }
    taken = {line.id for name in ("walls", "doors", "windows", "openings") for line in getattr(layout, name)}
    over = [
        OpeningLine(id=_free(f"{d.id}{OVER}", taken), wall=d.wall, start=d.start, end=d.end, sill=d.height,
                    height=round(high[d.id] - d.height, 4))
        for d in layout.doors
        if d.id in high and high[d.id] - d.height > _FROM_ENDS
    ]  # fmt: skip
    windows = [_up_to(window, high[window.id]) if window.id in high else window for window in layout.windows]
    return layout.model_copy(update={"windows": windows, "openings": [*layout.openings, *over]})


def _up_to(window: WindowLine, top: float) -> WindowLine:
    return window.model_copy(update={"height": round(top - window.sill, 4)})


def _free(name: str, taken: Collection[str]) -> str:
    return name if name not in taken else f"{name}_2"


def _is_open(run: WallRun, hole: Hole, holes: list[Hole], camera: CameraModel, pixels: Floats) -> bool:
    """Whether the picture shows something else over a hole than over the wall beside it."""
    if hole.kind == "opening":
        return False
    places = np.arange(_FROM_ENDS, run.length - _FROM_ENDS, _STEP)
    beside = np.ones(len(places), dtype=bool)
    for other in holes:
        beside &= (places < other.x[0] - _FROM_ENDS) | (places > other.x[1] + _FROM_ENDS)
    wall = _seen(run, places[beside], camera, pixels)
    over = _seen(run, np.arange(hole.x[0] + _FROM_ENDS, hole.x[1] - _FROM_ENDS, _STEP), camera, pixels)
    if min(len(wall), len(over)) < _FEWEST:
        return False
    usual = np.median(wall, axis=0)
    if (np.abs(wall - usual).max(axis=1) < _ALIKE).mean() < _CERTAIN:
        return False
    return bool((np.abs(over - usual).max(axis=1) > _OTHER).mean() > _CERTAIN)


def _seen(run: WallRun, along: Floats, camera: CameraModel, pixels: Floats) -> Floats:
    """Cube roots of the light at places in the middle of a wall's upper face, those in the picture, (N, 3)."""
    lens = Projector.of(camera)
    if lens.perspective and run.height > lens.position[2] - 0.1:
        return np.zeros((0, 3))
    dx, dy = run.direction
    across = (run.left + run.right) / 2
    x, y = run.start[0] + dx * along - dy * across, run.start[1] + dy * along + dx * across
    points = np.stack([x, y, np.full(len(along), run.height)], axis=1)
    high, wide = pixels.shape[:2]
    at = lens.pixels(points) * np.array((wide, high)) / lens.size if len(points) else np.zeros((0, 2))
    spots = np.nan_to_num(at, nan=-1.0).astype(int)
    inside = (spots[:, 0] >= 0) & (spots[:, 0] < wide) & (spots[:, 1] >= 0) & (spots[:, 1] < high)
    found: Floats = np.cbrt(pixels[spots[inside, 1], spots[inside, 0]])
    return found
