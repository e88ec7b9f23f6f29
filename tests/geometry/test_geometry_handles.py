# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies under the pointer, and what dragging it does."""

from __future__ import annotations

import math

import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.geometry import handles as hd
from code_as_room.pipeline.geometry.camera import project
from code_as_room.pipeline.geometry.measuring import along_walls, fit_quality, floor_distance, parse_length
from hypothesis import assume, given
from hypothesis import strategies as st

picture = st.floats(0, 1000)
shift = st.floats(-3000, 3000)
position = st.tuples(picture, picture)
SQUARE = [(100.0, 100.0), (900.0, 100.0), (900.0, 900.0), (100.0, 900.0)]


@st.composite
def boxes(draw: st.DrawFn) -> ImageBox:
    (x0, x1), (y0, y1) = sorted(draw(position)), sorted(draw(position))
    assume(x1 - x0 >= hd.LEAST_SIDE and y1 - y0 >= hd.LEAST_SIDE)
    return ImageBox(x_min=x0, y_min=y0, x_max=x1, y_max=y1)


grips = st.builds(hd.Grip, st.booleans(), st.booleans(), st.booleans(), st.booleans()).filter(
    lambda g: g.whole or (any(g) and not (g.left and g.right) and not (g.top and g.bottom))
)


def sides(box: ImageBox) -> tuple[float, ...]:
    return box.x_min, box.y_min, box.x_max, box.y_max


@given(boxes(), grips, st.tuples(shift, shift))
def test_a_dragged_box_stays_in_the_picture_and_right_side_out(
    box: ImageBox, grip: hd.Grip, by: tuple[float, float]
) -> None:
    after = hd.drag_box(box, grip, by)
    assert all(-1e-9 <= value <= 1000 + 1e-9 for value in sides(after))
    assert after.x_max - after.x_min >= hd.LEAST_SIDE - 1e-9 and after.y_max - after.y_min >= hd.LEAST_SIDE - 1e-9


@given(boxes(), grips, st.tuples(shift, shift))
def test_only_the_held_sides_move(box: ImageBox, grip: hd.Grip, by: tuple[float, float]) -> None:
    after = hd.drag_box(box, grip, by)
    for held, old, new in zip(grip, sides(box), sides(after), strict=True):
        assert held or old == new
    if grip.whole:
        assert after.x_max - after.x_min == pytest.approx(box.x_max - box.x_min)
        assert after.y_max - after.y_min == pytest.approx(box.y_max - box.y_min)


@given(boxes(), grips)
def test_a_drag_by_nothing_changes_nothing(box: ImageBox, grip: hd.Grip) -> None:
    assert hd.drag_box(box, grip, (0, 0)) == box


@given(boxes(), grips, st.tuples(st.floats(-3, 3), st.floats(-3, 3)))
def test_a_small_drag_with_room_goes_all_the_way(box: ImageBox, grip: hd.Grip, by: tuple[float, float]) -> None:
    assume(min(sides(box)) > 5 and max(sides(box)) < 995)
    assume(box.x_max - box.x_min > 10 and box.y_max - box.y_min > 10)
    after = hd.drag_box(box, grip, by)
    for held, old, new, step in zip(grip, sides(box), sides(after), (*by, *by), strict=True):
        assert new == pytest.approx(old + step if held else old)


def test_a_box_that_was_outside_the_picture_is_not_cut_by_dragging_its_other_side() -> None:
    box = ImageBox(x_min=-20, y_min=10, x_max=200, y_max=100)
    assert hd.drag_box(box, hd.Grip(right=True), (50, 0)).x_min == -20
    assert hd.drag_box(box, hd.Grip(left=True), (-50, 0)).x_min == -20


def test_a_corner_holds_two_sides_an_edge_one_and_the_middle_none() -> None:
    box = (100.0, 100.0, 300.0, 200.0)
    assert hd.grip_at(box, (102, 98), 6) == hd.Grip(left=True, top=True)
    assert hd.grip_at(box, (303, 150), 6) == hd.Grip(right=True)
    assert hd.grip_at(box, (200, 196), 6) == hd.Grip(bottom=True)
    assert hd.grip_at(box, (200, 150), 6) is None
    assert hd.grip_at(box, (200, 260), 6) is None, "an edge's line beyond the box is not the box"


@given(st.floats(0.5, 5), st.floats(0.5, 5), st.floats(-4, 9), st.floats(-4, 9))
def test_a_box_smaller_than_the_reach_never_holds_two_opposite_sides(
    width: float, height: float, x: float, y: float
) -> None:
    grip = hd.grip_at((0.0, 0.0, width, height), (x, y), 4)
    assert grip is None or not (grip.left and grip.right) and not (grip.top and grip.bottom)


@given(st.lists(position, min_size=1, max_size=8), position, st.floats(1, 300))
def test_the_nearest_point_is_the_nearest_within_reach(
    points: list[tuple[float, float]], at: tuple[float, float], reach: float
) -> None:
    found = hd.nearest_point(points, at, reach)
    nearest = min(math.dist(p, at) for p in points)
    assert (found is None) == (nearest > reach)
    assert found is None or math.dist(points[found], at) == nearest


def test_a_point_that_is_nowhere_is_never_the_nearest() -> None:
    assert hd.nearest_point([(math.nan, math.nan), (5.0, 5.0)], (4, 4), 10) == 1
    assert hd.nearest_point([(math.nan, 3.0)], (4, 4), 10) is None


def test_the_edge_under_the_pointer_is_found_with_its_point() -> None:
    hit = hd.nearest_edge(SQUARE, (500, 108), 10)
    assert hit is not None and hit.edge == 0 and hit.point == pytest.approx((500, 100))
    last = hd.nearest_edge(SQUARE, (95, 400), 10)
    assert last is not None and last.edge == 3
    assert hd.nearest_edge(SQUARE, (500, 500), 10) is None


@given(st.integers(0, 3), position)
def test_a_corner_that_is_added_and_taken_away_again_leaves_the_outline_as_it_was(
    edge: int, point: tuple[float, float]
) -> None:
    more = hd.with_corner(SQUARE, edge, point)
    assert len(more) == 5 and more[edge + 1] == point
    assert hd.without_corner(more, edge + 1) == SQUARE
    assert hd.moved_corner(SQUARE, edge, point)[edge] == point


def test_an_outline_no_floor_can_have_is_refused_with_its_reason() -> None:
    assert hd.outline_fault(SQUARE) == ""
    assert "cross" in hd.outline_fault(hd.moved_corner(SQUARE, 0, (950.0, 500.0)))
    assert "corners" in hd.outline_fault(SQUARE[:3])
    assert "small" in hd.outline_fault([(1.0, 1.0), (20.0, 1.0), (20.0, 20.0), (1.0, 20.0)])


@given(position, position)
def test_a_drawn_box_does_not_depend_on_the_corner_it_was_begun_at(
    a: tuple[float, float], b: tuple[float, float]
) -> None:
    assert hd.box_between(a, b) == hd.box_between(b, a)
    assert hd.box_between((-50, -50), (2000, 500)) == ImageBox(x_min=0, y_min=0, x_max=1000, y_max=500)


@given(st.lists(st.tuples(position, st.tuples(st.floats(5, 80), st.floats(5, 20))), max_size=20))
def test_labels_never_cover_each_other(given_boxes: list) -> None:
    placed = [
        r
        for r in hd.spread_labels([(x, y, x + 60, y + 40) for (x, y), _ in given_boxes], [s for _, s in given_boxes])
        if r is not None
    ]
    assert len(placed) >= min(1, len(given_boxes)), "the most important label always has its place"
    for i, a in enumerate(placed):
        assert not any(hd._overlap(a, b) for b in placed[i + 1 :])


def test_a_length_on_the_floor_is_measured_in_metres(camera: CameraModel) -> None:
    a, b = project(camera, [(-1.5, 0.5, 0.0), (1.5, -0.5, 0.0)])
    assert floor_distance(camera, a, b) == pytest.approx(math.sqrt(10), abs=1e-9)


def test_snapping_along_a_wall_follows_the_nearer_axis_of_the_floor(camera: CameraModel) -> None:
    start, near_x = project(camera, [(-1.0, -1.0, 0.0), (1.2, -0.8, 0.0)])
    assert along_walls(camera, start, near_x) == pytest.approx(project(camera, [(1.2, -1.0, 0.0)])[0])
    near_y = project(camera, [(-0.9, 0.7, 0.0)])[0]
    assert along_walls(camera, start, near_y) == pytest.approx(project(camera, [(-1.0, 0.7, 0.0)])[0])


@pytest.mark.parametrize(
    ("text", "metres"),
    [("4.2", 4.2), ("4,2", 4.2), (" 420 cm", 4.2), (".5", 0.5), ("13ft", 3.9624), ("6' 3\"", 1.905), ("5 ft 2 in", 1.5748)],
)  # fmt: skip
def test_lengths_are_read_as_people_type_them(text: str, metres: float) -> None:
    assert parse_length(text) == pytest.approx(metres)


@pytest.mark.parametrize("text", ["", " ", "m", "4.2.1", "4 2", "0", "-3", "1e9", "nan", "9999", "__import__('os')"])
def test_what_is_no_length_is_none(text: str) -> None:
    assert parse_length(text) is None


def test_in_a_scene_of_feet_a_bare_number_is_feet() -> None:
    assert parse_length("10", feet=True) == pytest.approx(3.048)
    assert parse_length("10m", feet=True) == pytest.approx(10)


def test_the_fit_is_judged_by_the_size_of_the_picture() -> None:
    assert fit_quality(3.0, (1200, 800)) == "good"
    assert fit_quality(3.0, (400, 300)) == "fair"
    assert fit_quality(3.0, (200, 100)) == "poor"
