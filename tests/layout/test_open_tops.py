"""Windows and doors go up to their walls' ends where the picture shows something else than the walls over them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import DoorLine, Layout, RoomLine, WallLine, WindowLine
from code_as_room.pipeline.layout.open_tops import with_open_tops

HEIGHT, SIDE = 2.6, 400
WALL, BESIDE = 0.15, 0.7
FLOOR = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]


def room() -> Layout:
    """Four by four metres, a window at the top and a door at the bottom, both of usual height."""
    names = ("wall_s", "wall_e", "wall_n", "wall_w")
    walls = [
        WallLine(id=name, start=a, end=b, height=HEIGHT, thickness=0.2)
        for name, a, b in zip(names, FLOOR, FLOOR[1:] + FLOOR[:1], strict=True)
    ]
    window = WindowLine(id="window_1", wall="wall_n", start=(1.0, 2.0), end=(-0.5, 2.0), sill=0.9, height=1.3)
    door = DoorLine(id="door_1", wall="wall_s", start=(-1.0, -2.0), end=(-0.1, -2.0), height=2.05)
    return Layout(room=RoomLine(size=(4.0, 4.0, HEIGHT), floor=FLOOR), walls=walls, windows=[window], doors=[door])


def camera() -> CameraModel:
    """Straight from above, six metres of picture."""
    matrix = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 10, 0, 0, 0, 1)
    return CameraModel(
        kind="orthographic",
        matrix=tuple(float(v) for v in matrix),
        ortho_height=6.0,
        image_size=(SIDE, SIDE),
        principal={"x": 500.0, "y": 500.0},
    )


def picture(*open_at: tuple[tuple[float, float], tuple[float, float]], noise: float = 0.0) -> np.ndarray:
    """Walls' upper faces in one tone, other light within the given rectangles (x from, to), (y from, to)."""
    centre = (np.arange(SIDE) + 0.5) / SIDE * 6.0 - 3.0
    x, y = np.meshgrid(centre, -centre)
    tone = np.where((np.abs(x) < 2.2) & (np.abs(y) < 2.2), WALL, BESIDE)
    for (x0, x1), (y0, y1) in open_at:
        tone = np.where((x > x0) & (x < x1) & (y > y0) & (y < y1), BESIDE, tone)
    tone = tone + noise * np.random.default_rng(3).random(tone.shape)
    return np.repeat(tone[..., None], 3, axis=2)


WINDOW = ((-0.5, 1.0), (2.0, 2.3))
DOOR = ((-1.0, -0.1), (-2.3, -2.0))


def test_walls_that_go_on_over_their_holes_leave_all_as_it_was() -> None:
    assert with_open_tops(room(), camera(), picture()) == room()


def test_a_window_through_the_walls_upper_end_is_as_high_as_the_wall() -> None:
    found = with_open_tops(room(), camera(), picture(WINDOW))
    (window,) = found.windows
    assert math.isclose(window.sill + window.height, HEIGHT, abs_tol=1e-3)
    assert window.sill == 0.9
    assert found.doors == room().doors and found.openings == []


def test_over_a_door_the_wall_is_open_and_its_leaf_stays_as_high_as_it_is() -> None:
    found = with_open_tops(room(), camera(), picture(DOOR))
    (over,) = found.openings
    assert found.doors == room().doors and found.windows == room().windows
    assert (over.wall, over.start, over.end, over.sill) == ("wall_s", (-1.0, -2.0), (-0.1, -2.0), 2.05)
    assert math.isclose(over.sill + over.height, HEIGHT, abs_tol=1e-3)


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_both_are_found_in_a_picture_that_is_not_clean(noise: float) -> None:
    found = with_open_tops(room(), camera(), picture(WINDOW, DOOR, noise=noise))
    assert len(found.openings) == 1 and found.windows[0].height > 1.6


def test_a_speck_over_a_window_is_no_hole() -> None:
    assert with_open_tops(room(), camera(), picture(((0.0, 0.2), (2.0, 2.3)))) == room()


def test_walls_of_all_sorts_of_tones_say_nothing() -> None:
    mixed = np.random.default_rng(5).random((SIDE, SIDE, 3))
    assert with_open_tops(room(), camera(), mixed) == room()
