# SPDX-License-Identifier: GPL-3.0-or-later
"""Skirting boards follow the walls that look into the room, and leave doors free."""

from __future__ import annotations

import numpy as np
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.prelude.skirting import skirting_pieces

ROOM = """\
room(size=(4, 3, 2.5), floor=[(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)])
wall("wall_1", start=(-2, -1.5), end=(2, -1.5), height=2.5)
wall("wall_2", start=(2, -1.5), end=(2, 1.5), height=2.5)
wall("wall_3", start=(2, 1.5), end=(-2, 1.5), height=2.5)
wall("wall_4", start=(-2, 1.5), end=(-2, -1.5), height=2.5)
door("door_1", "wall_1", start=(0.5, -1.5), end=(1.4, -1.5), height=2.0)
window("window_1", "wall_3", start=(-0.5, 1.5), end=(0.5, 1.5), height=1.2, sill=0.9)
build()
"""


def test_boards_stand_in_the_room_and_end_before_the_door() -> None:
    [piece] = skirting_pieces(evaluate(ROOM))
    [shape] = piece.shapes
    low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
    assert np.allclose(low, (-2, -1.5, 0)) and np.allclose(high[:2], (2, 1.5)) and 0.04 < high[2] < 0.15
    boards = shape.vertices.reshape(-1, 10, 3)
    south = [b for b in boards if np.ptp(b[:, 1]) < 0.05 and b[:, 1].max() < -1.4]
    spans = sorted((float(b[:, 0].min()), float(b[:, 0].max())) for b in south)
    assert len(spans) == 2 and spans[0][1] < 0.5 and spans[1][0] > 1.4
    # Under the window it goes on.
    north = [b for b in boards if np.ptp(b[:, 1]) < 0.05 and b[:, 1].min() > 1.4]
    assert len(north) == 1 and np.isclose(np.ptp(north[0][:, 0]), 4)


def test_boards_look_outwards() -> None:
    [piece] = skirting_pieces(evaluate(ROOM))
    [shape] = piece.shapes
    for board, faces in zip(shape.vertices.reshape(-1, 10, 3), np.arange(len(shape.faces)).reshape(-1, 6), strict=True):
        middle = board.mean(axis=0)
        for number in faces:
            points = shape.vertices[list(shape.faces[number])]
            normal = np.cross(points[1] - points[0], points[2] - points[1])
            assert normal @ (points.mean(axis=0) - middle) > 0


def test_low_walls_and_no_walls_have_none() -> None:
    assert skirting_pieces(evaluate(ROOM.replace("height=2.5)", "height=0.2)"))) == []
    assert skirting_pieces(evaluate(ROOM.splitlines()[0] + "\nbuild()\n")) == []
