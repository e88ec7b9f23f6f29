# SPDX-License-Identifier: GPL-3.0-or-later
"""Skirting boards: what covers the joint of walls and floor in nearly every real room, so that walls do not just end."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .enclosure import solid_spans
from .holes import wall_holes
from .pieces import Hole, ShellPiece, WallRun
from .record import Record
from .shape import Shape
from .walls import wall_runs

SKIRTING = "skirting"
_HEIGHT, _DEPTH = 0.07, 0.012  # metres
_CHAMFER = 0.006  # metres off its upper edge, which catches the light
_LEAST = 0.03  # metres; shorter pieces are left out
_CASING = 0.012  # metres that it ends before a door's frame


def skirting_pieces(record: Record) -> list[ShellPiece]:
    """All skirting boards of a room as one piece in the room's frame, metres; none without walls.

    Low walls have none. Boards run along every face that looks into the room, and stop at doors and openings.
    """
    runs = wall_runs(record.walls, list((record.room or {}).get("floor", [])))
    holes = wall_holes(record, runs, [])
    points: list[tuple[float, float, float]] = []
    for run in runs:
        if run.height < 4 * _HEIGHT:
            continue
        for low, high in _spans(run, holes[run.id]):
            for side in (0, 1) if run.partition else (0,):
                points += _board(run, low, high, side)
    if not points:
        return []
    faces = tuple(face for first in range(0, len(points), 10) for face in _faces(first))
    return [ShellPiece(SKIRTING, SKIRTING, [Shape(np.array(points, dtype=float), faces, SKIRTING, "frame")])]


def _spans(run: WallRun, holes: Iterable[Hole]) -> list[tuple[float, float]]:
    """Where a board may be, metres along the wall."""
    spans = []
    for low, high in solid_spans(run, list(holes), _HEIGHT / 2):
        low = low + _CASING if low > 0 else low
        high = high - _CASING if high < run.length else high
        if high - low > _LEAST:
            spans.append((low, high))
    return spans


def _board(run: WallRun, low: float, high: float, side: int) -> list[tuple[float, float, float]]:
    """Five corners of its profile at either end: from the foot of the wall outwards and up."""
    dx, dy = run.direction
    face, out = (run.left, 1.0) if side == 0 else (run.right, -1.0)
    profile = [(0.0, 0.0), (_DEPTH, 0.0), (_DEPTH, _HEIGHT - _CHAMFER), (_DEPTH - _CHAMFER, _HEIGHT), (0.0, _HEIGHT)]
    found = []
    # Seen along the board from its right end, the profile goes round counter-clockwise on the left face.
    for along in (low, high) if side == 0 else (high, low):
        for away, z in profile:
            across = face + out * away
            found.append((run.start[0] + dx * along - dy * across, run.start[1] + dy * along + dx * across, z))
    return found


def _faces(first: int) -> list[tuple[int, ...]]:
    """The board's two ends and its long sides but the one on the wall, outwards."""
    near, far = range(first, first + 5), range(first + 5, first + 10)
    sides = [(near[i], near[i + 1], far[i + 1], far[i]) for i in range(4)]
    return [tuple(reversed(near)), tuple(far), *sides]
