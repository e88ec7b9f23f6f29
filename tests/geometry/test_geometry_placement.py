# SPDX-License-Identifier: GPL-3.0-or-later
"""Footprints snapped to walls, pushed inside and taken off each other."""

import math
from itertools import combinations

import numpy as np
import pytest
from code_as_room.pipeline.geometry import placement as pl
from code_as_room.pipeline.geometry.polygon import intersection_area, line_distance, outside_fraction
from hypothesis import given, settings
from hypothesis import strategies as st

L_SHAPE = [(-3.0, -2.0), (3.0, -2.0), (3.0, 0.0), (0.5, 0.0), (0.5, 2.0), (-3.0, 2.0)]
yaws = st.sampled_from([0.0, 90.0, 180.0, 30.0]) | st.floats(-180, 180)


@st.composite
def rects(draw: st.DrawFn, reach: float = 4.0, largest: float = 1.8) -> pl.Rect:
    at, size = st.floats(-reach, reach), st.floats(0.2, largest)
    return pl.Rect(draw(at), draw(at), draw(size), draw(size), draw(yaws))


@given(rects(), rects())
def test_pushing_apart_by_the_penetration_just_ends_the_overlap(a: pl.Rect, b: pl.Rect) -> None:
    found = pl.penetration(a, b)
    if found is None:
        assert intersection_area(a.corners(), b.corners()) < 1e-4
        return
    depth, (nx, ny) = found
    assert pl.penetration(a.moved(nx * (depth + 1e-5), ny * (depth + 1e-5)), b) is None
    assert pl.penetration(a.moved(nx * (depth - 1e-3), ny * (depth - 1e-3)), b) is not None or depth < 1.1e-3


@given(rects(), st.integers(0, 1000))
def test_push_inside_is_inside_and_no_shorter_move_is(rect: pl.Rect, seed: int) -> None:
    pushed = pl.push_inside(rect, L_SHAPE)
    assert pushed.outside == 0
    assert outside_fraction(pushed.rect.corners(), L_SHAPE) < 1e-4
    length = math.hypot(*pushed.shift)
    rng = np.random.default_rng(seed)
    for _ in range(30):
        angle, share = rng.uniform(0, 2 * math.pi), rng.uniform(0, 0.999)
        assert not (
            length > 1e-3
            and pl.is_inside(rect.moved(length * share * math.cos(angle), length * share * math.sin(angle)), L_SHAPE)
        )


def test_what_fits_nowhere_is_put_where_least_is_outside() -> None:
    pushed = pl.push_inside((5, 0.3, 9, 1, 0), [(-3, -2), (3, -2), (3, 2), (-3, 2)])
    assert pushed.outside == pytest.approx(1 - 6 / 9, abs=1e-3)


WALL = ((3.0, 2.0), (-3.0, 2.0))  # the north wall, room to its left


@given(st.floats(-2, 2), st.floats(-0.15, 0.15), st.floats(-10, 10), st.sampled_from([0, 90, 180, 270]))
def test_snapping_makes_flush_and_parallel(x: float, gap: float, turn: float, yaw: int) -> None:
    rect = pl.Rect(x, 2 - 0.5 - gap, 1.0, 1.0, yaw + turn)
    snapped = pl.snap_to_wall(rect, WALL, 0.4)
    assert snapped is not None and snapped.yaw % 90 == 0 and abs(snapped.yaw - rect.yaw) == pytest.approx(abs(turn))
    assert snapped.x == pytest.approx(x)
    assert min(line_distance(c, *WALL) for c in snapped.corners()) == pytest.approx(0, abs=1e-9)


def test_snapping_leaves_alone_what_is_far_or_beside_the_wall() -> None:
    assert pl.snap_to_wall((0, 0, 1, 1, 0), WALL, 0.4) is None
    assert pl.snap_to_wall((3.3, 1.5, 1, 1, 0), WALL, 0.4) is None
    slanted = pl.snap_to_wall((0, 1.2, 1, 1, 30), WALL, 0.4)
    assert slanted is not None and slanted.yaw == 30
    assert min(line_distance(c, *WALL) for c in slanted.corners()) == pytest.approx(0, abs=1e-9)


def overlaps(rects: list[pl.Rect]) -> float:
    return sum((pl.penetration(a, b) or (0.0,))[0] for a, b in combinations(rects, 2))


@settings(
    max_examples=40,
)
@given(st.lists(rects(reach=1.8, largest=0.8), min_size=2, max_size=6), st.data())
def test_separate_never_makes_it_worse_and_keeps_its_bounds(boxes: list[pl.Rect], data: st.DataObject) -> None:
    fixed = data.draw(st.sets(st.integers(0, len(boxes) - 1), max_size=2))
    moves = pl.separate(boxes, fixed=fixed, floor=L_SHAPE, max_move=0.8)
    after = [box.moved(*move) for box, move in zip(boxes, moves, strict=True)]
    assert all(math.hypot(*move) <= 0.8 + 1e-9 for move in moves)
    assert all(moves[i] == (0, 0) for i in fixed)
    assert moves == pl.separate(boxes, fixed=fixed, floor=L_SHAPE, max_move=0.8), "deterministic"
    outside = [
        [outside_fraction(r.corners(), L_SHAPE) * max(r.width, r.depth) for r in group] for group in (boxes, after)
    ]
    assert overlaps(after) + sum(outside[1]) <= overlaps(boxes) + sum(outside[0]) + 1e-6


@settings(
    max_examples=40,
)
@given(rects(reach=1.4, largest=1.0), st.floats(0, 2 * math.pi), st.floats(0.05, 0.4))
def test_two_that_overlap_in_a_roomy_floor_end_apart(a: pl.Rect, towards: float, distance: float) -> None:
    b = a.moved(distance * math.cos(towards), distance * math.sin(towards))
    floor = [(-4, -4), (4, -4), (4, 4), (-4, 4)]
    moves = pl.separate([a, b], floor=floor)
    assert pl.penetration(a.moved(*moves[0]), b.moved(*moves[1])) is None


def test_heavy_things_stay_and_allowed_pairs_may_overlap() -> None:
    bed, table, chair = pl.Rect(0, 0, 1.6, 2), pl.Rect(0.9, 0, 0.5, 0.5), pl.Rect(1.0, 0.2, 0.45, 0.45)
    moves = pl.separate([bed, table, chair], weights=[20, 1, 1], allowed_pairs=[(2, 1)])
    assert math.hypot(*moves[0]) < 0.02 and moves[1][0] > 0.1
    assert pl.penetration(table.moved(*moves[1]), chair.moved(*moves[2])) is not None


def test_a_thing_between_two_fixed_ones_finds_the_nearest_free_place() -> None:
    left, right, middle = pl.Rect(-0.5, 0, 1, 1), pl.Rect(0.7, 0, 1, 1), pl.Rect(0.1, 0.2, 0.6, 0.4)
    moves = pl.separate([left, right, middle], fixed=[0, 1], max_move=1.5)
    after = middle.moved(*moves[2])
    assert overlaps([left, right, after]) == 0
    assert math.hypot(*moves[2]) < 0.8


def test_gap_between_counts_overlap_below_zero() -> None:
    assert pl.gap_between(pl.Rect(0, 0, 1, 1), pl.Rect(2, 0, 1, 1)) == pytest.approx(1)
    assert pl.gap_between(pl.Rect(0, 0, 1, 1), pl.Rect(0.9, 0, 1, 1)) == pytest.approx(-0.1)
