# SPDX-License-Identifier: GPL-3.0-or-later
"""The room's shell as solid pieces: floor, mitred walls with real openings, doors and windows.

Every piece has a frame of its own (origin and yaw), so that in Blender its object has a sensible origin. Numbers that
do not fit are clamped and reported in plain sentences; nothing here raises because of where an opening is.
"""

from __future__ import annotations

import math

import numpy as np

from .fittings import fitting_pieces
from .holes import wall_holes
from .pieces import ShellPiece
from .record import Record
from .shape import Shape
from .walls import FLOOR_THICKNESS, wall_piece, wall_runs


def shell_pieces(record: Record) -> tuple[list[ShellPiece], list[str]]:
    """Everything of the shell: the floor, then the walls, then what is in them.

    Returns:
        The pieces, and one sentence for each number that had to be changed to make the shell possible.
    """
    notes: list[str] = []
    floor = _floor_outline(record)
    pieces = [_floor_piece(floor)] if len(floor) >= 3 else []
    if not pieces:
        notes.append("The room has no floor outline with three corners, so no floor was built.")
    runs = wall_runs(record.walls, floor, notes)
    holes = wall_holes(record, runs, notes)
    for run in runs:
        pieces.append(wall_piece(run, holes[run.id]))
    for run in runs:
        for hole in holes[run.id]:
            pieces.extend(fitting_pieces(run, hole, holes[run.id]))
    return pieces, notes


def _floor_outline(record: Record) -> list[tuple[float, float]]:
    """The floor's corners counter-clockwise, without repeated ones."""
    raw = [(float(p[0]), float(p[1])) for p in (record.room or {}).get("floor", [])]
    points = [p for i, p in enumerate(raw) if math.dist(p, raw[i - 1]) > 1e-6 or len(raw) == 1]
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, points[1:] + points[:1], strict=True))
    return points if area >= 0 else points[::-1]


def _floor_piece(outline: list[tuple[float, float]]) -> ShellPiece:
    """The floor as a slab: its upper face is the outline at z = 0."""
    count = len(outline)
    vertices = [(x, y, 0.0) for x, y in outline] + [(x, y, -FLOOR_THICKNESS) for x, y in outline]
    sides = [(i, count + i, count + (i + 1) % count, (i + 1) % count) for i in range(count)]
    faces = (tuple(range(count)), tuple(range(2 * count - 1, count - 1, -1)), *sides)
    return ShellPiece("floor", "floor", [Shape(np.array(vertices, dtype=float), faces, "floor", "floor")])
