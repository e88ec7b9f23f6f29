# SPDX-License-Identifier: GPL-3.0-or-later
"""Profiles led along paths do not twist: a moulding's upper side stays its upper side round every corner."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_as_room.pipeline.program.prelude import profiles
from hypothesis import given, settings
from hypothesis import strategies as st

BAR = [(-0.03, -0.01), (0.03, -0.01), (0.03, 0.01), (-0.03, 0.01)]
UPRIGHT = [(0, 0, 0), (1, 0, 0), (1, 0, 1.4), (0, 0, 1.4)]

PATHS = {
    "upright rectangle along x": (UPRIGHT, True),
    "upright rectangle along y": ([(y, x, z) for x, y, z in UPRIGHT], True),
    "upright rectangle from a post": (UPRIGHT[1:] + UPRIGHT[:1], True),
    "lying rectangle": ([(x, z, 0) for x, _, z in UPRIGHT], True),
    "U that stands": ([(0, 0, 1), (0, 0, 0), (1, 0, 0), (1, 0, 1)], False),
    "U on its head": ([(0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0)], False),
    "hairpin": ([(0, 0, 0), (0, 0, 1), (0.2, 0, 1), (0.2, 0, 0)], False),
    "staircase": ([(0, 0, 0), (1, 0, 0), (1, 0, 1), (1, 1, 1), (2, 1, 1), (2, 1, 2)], False),
}


@pytest.mark.parametrize("name", PATHS)
def test_straight_pieces_between_corners_are_straight(name: str) -> None:
    points, closed = PATHS[name]
    rings = profiles.sweep(BAR, points, closed=closed).vertices.reshape(-1, len(BAR), 3)
    following = np.roll(rings, -1, axis=0)
    for one, other in list(zip(rings, following, strict=True))[: len(points) - (not closed)]:
        ways = other - one
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        assert (ways @ ways[0]).min() > 0.9999, name


def test_a_round_loop_closes_without_a_seam() -> None:
    circle = [(math.cos(t), 0.0, math.sin(t)) for t in np.linspace(0, math.tau, 49)[:-1].tolist()]
    rings = profiles.sweep(BAR, circle, closed=True).vertices.reshape(-1, len(BAR), 3)
    steps = np.linalg.norm(np.roll(rings, -1, axis=0) - rings, axis=2)
    assert steps.std(axis=0).max() < 1e-6


number = st.floats(-2, 2)


@settings(max_examples=60)
@given(st.lists(st.tuples(number, number, number), min_size=3, max_size=8), st.booleans())
def test_no_path_turns_the_profile_more_than_its_corner(points: list[tuple[float, ...]], closed: bool) -> None:
    try:
        shape = profiles.sweep(BAR, points, closed=closed)
    except ValueError:
        return
    assert np.isfinite(shape.vertices).all()
    path = [points[0]] + [b for a, b in zip(points, points[1:], strict=False) if math.dist(a, b) > 1e-9]
    assert shape.vertex_count in (len(path) * 4, (len(path) - 1) * 4)
