# SPDX-License-Identifier: GPL-3.0-or-later
"""Overlap, distance and shape of floor polygons."""

import math

import numpy as np
import pytest
from code_as_room.pipeline.geometry import polygon as pg
from hypothesis import given, settings
from hypothesis import strategies as st

coordinate = st.floats(-5, 5)
length = st.floats(0.1, 4)
angle = st.sampled_from([0.0, 90.0, 180.0, -90.0, 45.0]) | st.floats(-360, 360)
L_SHAPE = [(-3.0, -2.0), (3.0, -2.0), (3.0, 0.0), (0.5, 0.0), (0.5, 2.0), (-3.0, 2.0)]
U_SHAPE = [(-3, -2), (3, -2), (3, 2), (1, 2), (1, -1), (-1, -1), (-1, 2), (-3, 2)]


@st.composite
def rectangles(draw: st.DrawFn) -> np.ndarray:
    return pg.rectangle_corners((draw(coordinate), draw(coordinate)), (draw(length), draw(length)), draw(angle))


@st.composite
def star_polygons(draw: st.DrawFn) -> list[tuple[float, float]]:
    """Simple outlines, mostly concave: corners at growing angles around a centre."""
    radii = draw(st.lists(st.floats(0.5, 3), min_size=4, max_size=9))
    x, y, step = draw(coordinate), draw(coordinate), 2 * math.pi / len(radii)
    return [(x + r * math.cos(i * step), y + r * math.sin(i * step)) for i, r in enumerate(radii)]


def sampled_area(a: object, b: object, low: np.ndarray, high: np.ndarray, side: int = 80) -> float:
    xs = low[0] + (np.arange(side) + 0.5) / side * (high[0] - low[0])
    ys = low[1] + (np.arange(side) + 0.5) / side * (high[1] - low[1])
    hits = sum(pg.point_in_polygon((x, y), a) and pg.point_in_polygon((x, y), b) for x in xs for y in ys)
    return hits / side**2 * float((high - low).prod())


@given(rectangles(), rectangles())
def test_overlap_does_not_depend_on_order_and_stays_within_both(a: np.ndarray, b: np.ndarray) -> None:
    shared = pg.intersection_area(a, b)
    assert shared == pytest.approx(pg.intersection_area(b, a), abs=1e-9)
    assert -1e-9 <= shared <= min(pg.area(a), pg.area(b)) + 1e-9
    assert 0 <= pg.footprint_iou(a, b) <= pg.overlap_fraction(a, b) <= 1


@given(rectangles())
def test_a_footprint_covers_itself(a: np.ndarray) -> None:
    assert pg.footprint_iou(a, a) == pytest.approx(1)
    assert pg.footprint_iou(a, a[::-1]) == pytest.approx(1), "clockwise corners mean the same footprint"
    assert pg.outside_fraction(a, a) == pytest.approx(0, abs=1e-9)
    assert pg.is_convex(a) and pg.orientation(a) == 1


@settings(max_examples=25)
@given(star_polygons(), star_polygons())
def test_overlap_of_concave_outlines_agrees_with_counting_points(a: list, b: list) -> None:
    low, high = np.min(a, axis=0), np.max(a, axis=0)
    counted = sampled_area(a, b, low, high)
    # Counting is off by at most about one row of cells along the outlines.
    assert pg.intersection_area(a, b) == pytest.approx(counted, abs=0.06 * float((high - low).max()) ** 2)


@given(rectangles(), st.sampled_from([L_SHAPE, U_SHAPE]))
def test_inside_and_outside_parts_make_the_whole(rect: np.ndarray, floor: list) -> None:
    inside = pg.intersection_area(rect, floor)
    assert inside == pytest.approx(pg.area(rect) * (1 - pg.outside_fraction(rect, floor)), abs=1e-9)
    notch_counts = pg.intersection_area(floor, rect)
    assert inside == pytest.approx(notch_counts, abs=1e-9)


def test_a_rectangle_in_the_notch_of_an_l_is_outside() -> None:
    assert pg.outside_fraction(pg.rectangle_corners((2, 1), (1, 1), 0), L_SHAPE) == pytest.approx(1)
    assert pg.outside_fraction(pg.rectangle_corners((0.5, 1), (1, 1), 0), L_SHAPE) == pytest.approx(0.5)


@given(coordinate, coordinate, length, length, angle)
def test_rectangle_corners_keep_centre_size_and_front(x: float, y: float, w: float, d: float, yaw: float) -> None:
    corners = pg.rectangle_corners((x, y), (w, d), yaw)
    assert pg.signed_area(corners) == pytest.approx(w * d)
    assert pg.centroid(corners) == pytest.approx((x, y), abs=1e-9)
    front = corners[:2].mean(axis=0) - (x, y)
    turned = math.radians(yaw)
    assert front == pytest.approx((d / 2 * math.sin(turned), -d / 2 * math.cos(turned)), abs=1e-9)


@given(coordinate, coordinate)
def test_nearest_wall_is_no_further_than_any_point_of_the_walls(x: float, y: float) -> None:
    hit = pg.nearest_wall((x, y), L_SHAPE)
    start, end = pg.edges(L_SHAPE)[hit.edge]
    assert math.dist((x, y), hit.point) == pytest.approx(hit.distance)
    t = hit.along / math.dist(start, end)
    assert hit.point == pytest.approx((start[0] + t * (end[0] - start[0]), start[1] + t * (end[1] - start[1])))
    for a, b in pg.edges(L_SHAPE):
        for s in np.linspace(0, 1, 11):
            assert hit.distance <= math.dist((x, y), (a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]))) + 1e-9


def test_wall_and_side_of_a_bed_against_the_north_wall() -> None:
    bed = pg.rectangle_corners((-1, 0.9), (1.6, 2.0), 0)
    hit = pg.nearest_wall_of_rectangle(bed, L_SHAPE)
    assert hit.edge == 4 and hit.distance == pytest.approx(0.1)
    assert pg.side_distance(bed, 2, *pg.edges(L_SHAPE)[4]) == pytest.approx(0.1)
    assert pg.side_distance(bed, 0, *pg.edges(L_SHAPE)[4]) == pytest.approx(2.1)


def test_a_bow_tie_crosses_itself_and_an_l_does_not() -> None:
    assert pg.self_crossing([(0, 0), (1, 1), (1, 0), (0, 1)]) == (0, 2)
    assert pg.self_crossing(L_SHAPE) is None


@given(st.floats(0, 1), st.integers(0, 5))
def test_simplify_drops_corners_on_a_straight_wall_only(t: float, edge: int) -> None:
    a, b = pg.edges(L_SHAPE)[edge]
    middle = (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]))
    simple = pg.simplify_polygon([*L_SHAPE[: edge + 1], middle, *L_SHAPE[edge + 1 :]], 0.01)
    assert len(simple) == 6 and pg.footprint_iou(simple, L_SHAPE) > 0.99


@given(star_polygons())
def test_ensure_ccw_keeps_the_first_corner(outline: list) -> None:
    for way in (outline, outline[::-1]):
        turned = pg.ensure_ccw(way)
        assert pg.signed_area(turned) > 0 and turned[0] == pytest.approx(way[0])
        assert pg.area(turned) == pytest.approx(pg.area(outline))
