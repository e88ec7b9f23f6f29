"""Stage 4's placements: on walls that run askew, and under the ceiling."""

from __future__ import annotations

import math

import pytest
from code_as_room.pipeline.artifacts.analysis import Calibration, DetectedObject
from code_as_room.pipeline.artifacts.layout import ProxyLine
from code_as_room.pipeline.layout.auxiliary import on_surface, on_wall, top_of
from code_as_room.pipeline.layout.initial import proxy_of
from code_as_room.pipeline.layout.walls import along, outer_walls


def test_a_picture_lies_flat_on_a_wall_that_runs_askew(calibration: Calibration) -> None:
    wall = next(
        w for w in outer_walls([(-2.3, -1.95), (2.3, -1.95), (2.3, 1.65), (-2.3, 1.95)], 2.6) if w.id == "wall_n"
    )
    art = DetectedObject(
        id="art", category="painting", placement="wall", parent="wall_n", box=None, centre=(0.0, 1.8, 1.5),
        size=(1.2, 0.03, 0.6),
    )  # fmt: skip
    placed = on_wall(art, [wall], calibration)
    assert placed is not None
    proxy = placed[0]
    angle = math.radians(proxy.yaw)
    for side in (-0.6, 0.6):
        back = (
            proxy.centre[0] + side * math.cos(angle) - 0.015 * math.sin(angle),
            proxy.centre[1] + side * math.sin(angle) + 0.015 * math.cos(angle),
        )
        assert along(wall, back)[1] == pytest.approx(0.002, abs=1e-3)


def test_what_stands_on_a_cupboard_as_high_as_the_room_stays_below_the_ceiling(calibration: Calibration) -> None:
    cupboard = ProxyLine(id="cupboard", category="wardrobe", centre=(2.0, -0.6, 1.3), size=(1.4, 0.6, 2.6))
    box = DetectedObject(
        id="b", category="box", placement="surface", parent="cupboard", box=None, centre=(2.0, -0.6, 2.8),
        size=(0.4, 0.4, 0.4),
    )  # fmt: skip
    placed = on_surface(box, {"cupboard": cupboard}, calibration)
    assert placed is not None
    assert top_of(placed[0]) <= calibration.height + 1e-9 and placed[0].size[2] == pytest.approx(0.4)


def thing(identifier: str, base: float, size: tuple[float, float, float], at: tuple[float, float]) -> DetectedObject:
    return DetectedObject(
        id=identifier, category=identifier, placement="surface", parent="desk", box=None,
        centre=(*at, base + size[2] / 2), size=size,
    )  # fmt: skip


def test_what_stands_on_a_desk_follows_its_top_and_what_is_said_to_be_lower_does_not(calibration: Calibration) -> None:
    desk = ProxyLine(id="desk", category="desk", centre=(0.0, 0.0, 0.42), size=(1.4, 0.7, 0.84))
    lamp, drawer = thing("lamp", 0.74, (0.2, 0.2, 0.4), (0, 0)), thing("book", 0.3, (0.2, 0.2, 0.05), (0, 0))
    bases = []
    for item in (lamp, drawer):
        placed = on_surface(item, {"desk": desk}, calibration, {"desk": 0.74})
        assert placed is not None
        bases.append(placed[0].centre[2] - placed[0].size[2] / 2)
    assert bases == pytest.approx([0.84, 0.3])


def test_a_screen_over_two_desks_stays_where_it_is_seen(calibration: Calibration) -> None:
    desk = ProxyLine(id="desk", category="desk", centre=(0.0, 0.0, 0.37), size=(1.4, 0.7, 0.74))
    screen = thing("screen", 0.74, (2.8, 0.04, 0.4), (0.7, 0.33))
    placed = on_surface(screen, {"desk": desk}, calibration)
    assert placed is not None
    assert placed[0].centre[:2] == pytest.approx((0.7, 0.33))
    away = on_surface(thing("cup", 0.74, (0.1, 0.1, 0.1), (1.5, 0.0)), {"desk": desk}, calibration)
    assert away is not None and away[0].centre[0] < 0.7


def test_a_wardrobe_that_ends_just_under_the_ceiling_reaches_it(calibration: Calibration) -> None:
    for height, reached in ((calibration.height - 0.05, True), (calibration.height - 0.2, False), (1.0, False)):
        wardrobe = DetectedObject(
            id="w",
            category="wardrobe",
            placement="floor",
            box=None,
            centre=(1.0, 1.0, height / 2),
            size=(1.2, 0.6, height),
        )
        proxy, _ = proxy_of(wardrobe, calibration, 0.0)
        assert proxy.size[2] == pytest.approx(calibration.height if reached else height)
        assert proxy.centre[2] == pytest.approx(proxy.size[2] / 2)
