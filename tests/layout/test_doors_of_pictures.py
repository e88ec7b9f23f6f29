# SPDX-License-Identifier: GPL-3.0-or-later
"""Doors stand as the analysis' words and boxes show them."""

from __future__ import annotations

import math

import pytest
from code_as_room.pipeline.analysis.door_leaves import without_leaves
from code_as_room.pipeline.artifacts.analysis import ArchitectureItem, Calibration, DetectedObject, SceneAnalysis
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.artifacts.layout import DoorLine, Layout, RoomLine, WallLine
from code_as_room.pipeline.geometry.camera import camera_straight_down, project
from code_as_room.pipeline.layout.doors import opens_in, read_swing
from code_as_room.pipeline.layout.keep_clear import door_areas
from code_as_room.pipeline.layout.walls import shell

FLOOR = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]
HEIGHT = 2.05


@pytest.mark.parametrize(
    ("words", "side", "hinge", "degrees", "usual"),
    [
        ("into the room, hinge at the right end, slightly open", 1, (1, 0), None, 25),
        ("hinged at the lower end, opens inwards, standing about 80 degrees open", 1, (0, 1), 80, None),
        ("into the room, hinge at the left end", 1, (-1, 0), None, None),
        ("outwards, left-hinged, ajar", -1, (-1, 0), None, 25),
        ("in", 1, None, None, None),
        ("out", -1, None, None, None),
        ("swings open into the room", 1, None, None, None),
        ("hinged on the upper side, half open", 0, (0, -1), None, 45),
        ("closed, hinge left", 0, (-1, 0), 0, None),
        ("sliding, standing open", 0, None, 0, None),
        ("wide open", 0, None, None, 90),
        ("", 0, None, None, None),
    ],
)
def test_words_on_doors_are_read(words: str, side: int, hinge: object, degrees: object, usual: object) -> None:
    said = read_swing(words)
    assert (said.side, said.hinge, said.degrees) == (side, hinge, degrees)
    assert (said.between[2] if said.between else None) == usual
    assert opens_in(words) == (side > 0)


def seen(
    degrees: float, hinge: str, kind: str, words: str, calibration: Calibration, wall: str = "bottom"
) -> tuple[ArchitectureItem, Calibration]:
    """A door in a wall of a 4 m room as a picture from above shows it, standing open into the room."""
    cam = camera_straight_down(kind, 4.3, 4.3, (1000, 1000), top=2.6)  # type: ignore[arg-type]
    start, end, inward = {
        "bottom": ((0.6, -2.0), (1.5, -2.0), (0.0, 1.0)),
        "left": ((-2.0, 1.5), (-2.0, 0.6), (1.0, 0.0)),
        "top": ((1.5, 2.0), (0.6, 2.0), (0.0, -1.0)),
    }[wall]
    pivot, edge = (start, end) if hinge == "start" else (end, start)
    way = (edge[0] - pivot[0], edge[1] - pivot[1])
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    tip = tuple(pivot[i] + c * way[i] + s * 0.9 * inward[i] for i in (0, 1))
    points = [(*p, z) for p in (start, end, tip) for z in (0.0, HEIGHT)]
    points += [(p[0] - 0.12 * inward[0], p[1] - 0.12 * inward[1], z) for p in (start, end) for z in (0.0, HEIGHT)]
    shown = project(cam, points)
    box = ImageBox(
        x_min=float(shown[:, 0].min()), y_min=float(shown[:, 1].min()),
        x_max=float(shown[:, 0].max()), y_max=float(shown[:, 1].max()),
    )  # fmt: skip
    item = ArchitectureItem(
        id="door_1", kind="door", start=start, end=end, height=HEIGHT, wall=wall, box=box, swing=words
    )
    return item, calibration.model_copy(update={"camera": cam, "floor": FLOOR, "height": 2.6})


def door_of(item: ArchitectureItem, calibration: Calibration, analysis: SceneAnalysis, *more: object) -> DoorLine:
    found = analysis.model_copy(update={"architecture": [item, *more]})
    return shell(found, calibration)[2][0]


@pytest.mark.parametrize("kind", ["orthographic", "perspective"])
@pytest.mark.parametrize("wall", ["bottom", "left", "top"])
@pytest.mark.parametrize(("degrees", "word"), [(25, "slightly open"), (50, "open"), (85, "wide open")])
def test_what_words_leave_open_is_measured(
    kind: str, wall: str, degrees: float, word: str, analysis: SceneAnalysis, calibration: Calibration
) -> None:
    end = {"bottom": "right", "left": "lower", "top": "left"}[wall]  # the end of each wall's line
    item, fitted = seen(degrees, "end", kind, f"into the room, hinge at the {end} end, {word}", calibration, wall)
    line = door_of(item, fitted, analysis)
    assert line.open == pytest.approx(degrees, abs=10)
    assert line.start == pytest.approx(item.end) and line.end == pytest.approx(item.start)


def test_degrees_that_are_said_are_taken(analysis: SceneAnalysis, calibration: Calibration) -> None:
    item, fitted = seen(40, "start", "perspective", "hinged left, opens inwards, 65 degrees open", calibration)
    line = door_of(item, fitted, analysis)
    assert line.open == 65.0 and line.start == pytest.approx(item.start)


@pytest.mark.parametrize("kind", ["orthographic", "perspective"])
@pytest.mark.parametrize("words", ["", "closed", "into the room, hinge at the left end"])
def test_a_closed_door_stays_closed(kind: str, words: str, analysis: SceneAnalysis, calibration: Calibration) -> None:
    item, fitted = seen(0, "start", kind, words, calibration)
    assert door_of(item, fitted, analysis).open == 0.0


def test_a_box_alone_opens_a_door_and_no_box_does_not(analysis: SceneAnalysis, calibration: Calibration) -> None:
    item, fitted = seen(80, "start", "perspective", "", calibration)
    assert door_of(item, fitted, analysis).open == pytest.approx(80, abs=12)
    blind = item.model_copy(update={"box": None})
    assert door_of(blind, fitted, analysis).open == 0.0
    told = blind.model_copy(update={"swing": "into the room, hinge at the right end, half open"})
    assert door_of(told, fitted, analysis).open == 45.0


def test_a_door_that_opens_outwards_turns_the_other_way(analysis: SceneAnalysis, calibration: Calibration) -> None:
    item, fitted = seen(0, "start", "perspective", "out of the room, 70 degrees open", calibration)
    assert door_of(item, fitted, analysis).open == -70.0


def test_a_leaf_among_the_objects_becomes_its_door_s(analysis: SceneAnalysis, calibration: Calibration) -> None:
    item, fitted = seen(80, "start", "orthographic", "", calibration)
    shut, _ = seen(0, "start", "orthographic", "", calibration)
    assert item.box is not None
    leaf = DetectedObject(
        id="door_leaf", category="door", box=item.box, centre=(0.68, -1.55, 1.0), size=(0.9, 0.04, 2.0), yaw=80
    )
    mat = DetectedObject(id="mat", category="doormat", box=None, centre=(1.0, -1.7, 0.01), size=(0.6, 0.4, 0.02))
    notes: list = []
    kept, [door] = without_leaves([leaf, mat], [shut], notes)
    assert [o.id for o in kept] == ["mat"] and notes[0].about == "door_leaf"
    assert door_of(door, fitted, analysis).open == pytest.approx(80, abs=12)


def areas(degrees: float, words: str = "", partition: bool = False) -> list[tuple[float, float, float]]:
    """(x, y, depth) of what is kept clear before a door in the bottom wall, hinge at its left end."""
    wall = WallLine(id="wall_s", start=(-2, -2), end=(2, -2), height=2.6, partition=partition)
    door = DoorLine(id="door_1", wall="wall_s", start=(0.0, -2.0), end=(0.9, -2.0), open=degrees)
    room = Layout(room=RoomLine(size=(4, 4, 2.6), floor=FLOOR), walls=[wall], doors=[door])
    found = door_areas(room, {"door_1": words})
    return [(round(a.rect.x, 2), round(a.rect.y, 2), round(a.rect.depth, 2)) for a in found]


def test_floor_is_kept_free_for_a_leaf_where_it_stands() -> None:
    assert areas(0.0) == [(0.45, -1.82, 0.35)]
    assert areas(0.0, "into the room, hinge at the left end") == areas(80.0, "") == [(0.45, -1.55, 0.9)]
    assert areas(-80.0, "in") == [(0.45, -1.82, 0.35)]  # it stands outside, whatever was said
    before, beside = areas(150.0)
    assert before == (0.45, -1.55, 0.9) and beside[0] < -0.3 and beside[1] > -1.9 and beside[2] == 0.1
    left, right = areas(60.0, partition=True)
    assert left[2] == 0.9 and right[2] == 0.35
