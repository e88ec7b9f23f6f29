# SPDX-License-Identifier: GPL-3.0-or-later
"""What is built of the shell for its pictures alone: a ceiling that hides nothing, the walls' upper faces in a colour of
their own, and where walls are cut, their section.

Ceiling and section follow from the `view` line, upper faces from a finish of "wall_tops". The section lies inside the
walls, so that it is seen only by a camera that cuts them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .holes import wall_holes
from .pieces import Hole, ShellPiece, WallRun
from .record import Record
from .shape import Shape
from .walls import wall_runs

CEILING, SECTION, TOPS = "ceiling", "section", "wall_tops"
_BELOW = 0.002  # metres that a section lies under its cut, so that the cutting camera has it before it
_INSIDE = 0.001  # metres that it keeps from the walls' faces
_ABOVE = 0.001  # metres that upper faces lie above the walls
_CEILING_BELOW = 0.002  # metres that the ceiling lies under its height: partitions that end there stay in the light


def enclosure_pieces(record: Record) -> list[ShellPiece]:
    """The upper faces of finished wall tops, and the ceiling and section that a view line asks for; room's frame, metres."""
    if record.room is None:
        return []
    pieces = _tops(record) if TOPS in record.finishes else []
    if not record.views:
        return pieces
    line = record.views[0]
    if line["ceiling"] > 0.0:
        pieces.append(_ceiling(list(record.room["floor"]), float(line["ceiling"])))
    if line["cut"] > 0.0:
        pieces += _section(record, float(line["cut"]))
    return pieces


def _ceiling(floor: list[tuple[float, float]], height: float) -> ShellPiece:
    """One face that looks down."""
    points = np.array([(x, y, height - _CEILING_BELOW) for x, y in reversed(floor)], dtype=float)
    return ShellPiece(CEILING, CEILING, [Shape(points, (tuple(range(len(points))),), CEILING, CEILING)])


def _section(record: Record, height: float) -> list[ShellPiece]:
    """The walls' solid at a height: strips along each wall between its holes."""
    return _strips(record, SECTION, SECTION, lambda run: (height, height - _BELOW) if height < run.height else None)


def _tops(record: Record) -> list[ShellPiece]:
    """The walls' upper faces, where no hole goes up to them."""
    return _strips(record, TOPS, "wall", lambda run: (run.height - _BELOW, run.height + _ABOVE))


def _strips(
    record: Record, kind: str, role: str, levels: Callable[[WallRun], tuple[float, float] | None]
) -> list[ShellPiece]:
    """Strips along each wall between the holes that it has at the first level, lying at the second."""
    runs = wall_runs(record.walls, list((record.room or {}).get("floor", [])))
    holes = wall_holes(record, runs, [])
    points: list[tuple[float, float, float]] = []
    for run in runs:
        level = levels(run)
        if level is not None:
            for low, high in solid_spans(run, holes[run.id], level[0]):
                points += _strip(run, low, high, level[1])
    if not points:
        return []
    faces = tuple((i, i + 1, i + 2, i + 3) for i in range(0, len(points), 4))
    return [ShellPiece(kind, kind, [Shape(np.array(points, dtype=float), faces, kind, role)])]


def solid_spans(run: WallRun, holes: list[Hole], height: float) -> list[tuple[float, float]]:
    """Where a wall is solid at a height: metres along it from and to."""
    cut = sorted((h.x[0], h.x[1]) for h in holes if h.z[0] < height < h.z[1])
    spans, at = [], 0.0
    for low, high in cut:
        if low > at:
            spans.append((at, low))
        at = max(at, high)
    if at < run.length:
        spans.append((at, run.length))
    return spans


def _strip(run: WallRun, low: float, high: float, z: float) -> list[tuple[float, float, float]]:
    """Four corners, counter-clockwise from above; the ends of the wall keep their mitres."""
    dx, dy = run.direction

    def corner(along: float, side: int) -> tuple[float, float, float]:
        at_end = along >= run.length
        if along <= 0.0 or at_end:
            along = run.ends[1 if at_end else 0][side]
        across = run.left - _INSIDE if side == 0 else run.right + _INSIDE
        return (run.start[0] + dx * along - dy * across, run.start[1] + dy * along + dx * across, z)

    return [corner(low, 1), corner(high, 1), corner(high, 0), corner(low, 0)]
