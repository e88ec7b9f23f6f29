# SPDX-License-Identifier: GPL-3.0-or-later
"""Eye-level and top cameras: in the room, outside of furniture, with a free view of most of it."""

from __future__ import annotations

import math

import numpy as np
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImagePoint
from code_as_room.pipeline.artifacts.layout import CameraLine, DoorLine, Layout, RoomLine, WallLine
from code_as_room.pipeline.geometry.camera import project
from code_as_room.pipeline.light.panorama import open_leaves, viewing_space
from code_as_room.pipeline.light.space import FLOOR, WALLS, inside, space_of
from code_as_room.pipeline.light.views import LEAST_FREE, cut_height, eye_cameras, top_camera
from hypothesis import given, settings
from hypothesis import strategies as st

from .rooms_to_light import rectangle, thing

spot = st.floats(-0.8, 0.8)
kinds = st.sampled_from([("wardrobe", (1.6, 0.6, 2.1)), ("bed", (1.7, 2.0, 0.6)), ("sofa", (1.9, 0.9, 0.8)),
                         ("bookshelf", (0.9, 0.3, 1.9)), ("desk", (1.4, 0.7, 0.75))])  # fmt: skip


def model_of(line: CameraLine) -> CameraModel:
    return CameraModel(
        kind=line.kind, matrix=line.matrix, fov_y=line.fov_y, ortho_height=line.ortho_height, image_size=line.image_size,
        principal=ImagePoint(x=line.principal[0], y=line.principal[1]),
    )  # fmt: skip


@settings(max_examples=15, deadline=None)
@given(st.floats(3.2, 8.0), st.floats(3.2, 7.0), st.lists(st.tuples(kinds, spot, spot, st.floats(0, 360)), max_size=6))
def test_eyes_stand_free_and_see_the_room(width: float, depth: float, things: list) -> None:
    layout = rectangle(width, depth, windows=(1,))
    for n, ((category, size), x, y, yaw) in enumerate(things):
        layout.proxies.append(thing(f"thing_{n}", category, (x * width / 2, y * depth / 2), size, yaw=yaw))
    space = space_of(layout)
    lines, seen = eye_cameras(space)
    assert len({line.id for line in lines}) == len(lines) <= 2
    for line in lines:
        matrix = np.array(line.matrix).reshape(4, 4)
        at, way = matrix[:3, 3], -matrix[:3, 2]
        assert inside(space.floor, at[None, :2]).all() and 1.0 < at[2] < space.height
        assert abs(way[2]) < 1e-9  # level, so that walls stay upright
        for p in layout.proxies:
            c, s = math.cos(math.radians(p.yaw)), math.sin(math.radians(p.yaw))
            dx, dy = at[0] - p.centre[0], at[1] - p.centre[1]
            within = abs(c * dx + s * dy) < p.size[0] / 2 and abs(c * dy - s * dx) < p.size[1] / 2
            assert not (within and p.size[2] > 0.5), p.id
        distance, _, _ = space.hit(at[None], way[None])
        assert distance[0] > LEAST_FREE


def test_two_eyes_of_a_furnished_bedroom_see_all_of_it() -> None:
    layout = rectangle(4.6, 3.9, windows=(2,))
    layout.proxies += [
        thing("bed_1", "bed", (0, 0.9), (1.7, 2.0, 0.6)),
        thing("wardrobe_1", "wardrobe", (-1.9, -1.5), (0.7, 0.8, 2.1)),
        thing("desk_1", "desk", (1.6, -1.5), (1.2, 0.6, 0.75)),
        thing("chair_1", "chair", (1.6, -0.9), (0.5, 0.5, 0.9)),
    ]
    lines, seen = eye_cameras(space_of(layout))
    assert len(lines) == 2 and max(seen.values()) >= 0.75
    first, second = (np.array(line.matrix).reshape(4, 4)[:3, 3] for line in lines)
    assert np.linalg.norm(first - second) > 1.0


def test_the_top_view_shows_the_whole_room_cut_below_the_lintels() -> None:
    layout = rectangle(6.0, 3.0, height=2.7)
    space = space_of(layout)
    cut = cut_height(space)
    line = top_camera(space, cut)
    assert 1.9 < cut < 2.1
    z = np.array(line.matrix).reshape(4, 4)[2, 3]
    assert abs(z - line.near - cut) < 1e-3
    corners = project(model_of(line), [(x, y, 0.0) for x in (-3.12, 3.12) for y in (-1.62, 1.62)])
    assert corners.min() > 0 and corners.max() < 1000
    layout.proxies.append(thing("wardrobe_1", "wardrobe", (0, 0), (1, 0.6, 2.3)))
    assert cut_height(space_of(layout)) > 2.3  # furniture is not cut open
    layout.proxies.append(thing("pillar_1", "pillar", (1, 0), (0.3, 0.3, 2.69)))
    assert cut_height(space_of(layout)) == 0.0


def picture(layout: Layout, line: CameraLine, wide: int = 60) -> tuple[np.ndarray, list[str | None]]:
    """Distances (H, W) and what is met (id, "floor", or None) by the lines of sight of an eye's picture."""
    view = viewing_space(space_of(layout))
    matrix = np.array(line.matrix).reshape(4, 4)
    half = math.tan(line.fov_y / 2)
    x, y = np.meshgrid((np.arange(wide) + 0.5) / wide * 2 - 1, 1 - (np.arange(wide * 2 // 3) + 0.5) / (wide // 3))
    y = y - (1 - line.principal[1] / 500)
    ways = np.stack([x * half * 1.5, y * half, -np.ones_like(x)], axis=-1).reshape(-1, 3) @ matrix[:3, :3].T
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    distance, surface, _ = view.hit(np.broadcast_to(matrix[:3, 3], ways.shape), ways)
    return distance.reshape(x.shape), [
        "floor" if s == FLOOR else view.owner(int(s)) if s >= WALLS else None for s in surface
    ]


def looks(lines: list[CameraLine]) -> list[float]:
    return [math.degrees(math.atan2(-line.matrix[6], -line.matrix[2])) for line in lines]


def parts() -> Layout:
    """Three parts side by side, with partitions between them that are passed at their ends."""
    layout = rectangle(8.0, 4.4, windows=(3,))
    for n, (a, b) in enumerate((((-0.8, 2.2), (-0.8, -0.6)), ((1.8, -2.2), (1.8, 0.8)))):
        layout.walls.append(WallLine(id=f"partition_{n}", start=a, end=b, height=2.6, partition=True))
    layout.proxies += [
        thing("bed_1", "bed", (-2.6, 1.0), (1.8, 2.1, 0.6)),
        thing("wardrobe_1", "wardrobe", (-3.6, -1.7), (1.0, 0.7, 2.2), yaw=90),
        thing("desk_1", "desk", (0.5, 1.8), (1.4, 0.6, 0.75)),
        thing("sofa_1", "sofa", (0.5, -1.7), (1.8, 0.9, 0.8), yaw=180),
        thing("bookshelf_1", "bookshelf", (3.75, 0.0), (1.6, 0.35, 2.0), yaw=-90),
    ]
    return layout


def test_eyes_in_parts_of_a_room_look_past_the_ends_of_partitions() -> None:
    layout = parts()
    lines, _ = eye_cameras(space_of(layout))
    shown: set[str] = set()
    for line in lines:
        distance, met = picture(layout, line)
        middle = distance[10:30, 15:45]
        assert (middle < 1.0).mean() < 0.02 and (distance < 0.5).mean() < 0.03
        ends = [m for m in met if m is not None and m.startswith("partition")]
        assert len(ends) < 0.04 * len(met)
        shown |= {i for i in set(met) if i and met.count(i) > 0.015 * len(met)}
    assert len(shown & {p.id for p in layout.proxies}) >= 3
    turn = abs((looks(lines)[0] - looks(lines)[1] + 180) % 360 - 180)
    assert turn >= 60


def test_eyes_look_along_a_corridor() -> None:
    layout = rectangle(1.3, 7.0)
    layout.proxies.append(thing("cabinet_1", "cabinet", (-0.47, -1.0), (0.9, 0.3, 1.0), yaw=90))
    lines, _ = eye_cameras(space_of(layout))
    assert all(abs(math.sin(math.radians(look))) > 0.9 for look in looks(lines))
    assert looks(lines)[0] * looks(lines)[1] < 0  # one each way


def test_eyes_find_their_place_in_a_tiny_bathroom() -> None:
    layout = rectangle(1.8, 2.2, windows=(2,))
    layout.proxies += [
        thing("bathtub_1", "bathtub", (0, 0.72), (1.75, 0.72, 0.55)),
        thing("toilet_1", "toilet", (0.55, -0.2), (0.4, 0.65, 0.8), yaw=-90),
        thing("sink_1", "sink", (-0.65, -0.05), (0.5, 0.6, 0.85), yaw=90),
    ]
    lines, seen = eye_cameras(space_of(layout))
    assert len(lines) == 2 and max(seen.values()) > 0.6
    assert all("floor" in picture(layout, line)[1] or min(seen.values()) > 0.6 for line in lines)


def test_nothing_tall_fills_an_edge_where_there_is_another_place() -> None:
    layout = rectangle(4.6, 3.9, windows=(2,))
    layout.proxies += [
        thing("bed_1", "bed", (-1.2, 0.2), (2.0, 2.1, 0.6), yaw=90),
        thing("wardrobe_1", "wardrobe", (-0.6, -1.6), (1.7, 0.6, 2.1), yaw=180),
        thing("desk_1", "desk", (1.9, 0.0), (1.3, 0.6, 0.75), yaw=-90),
        thing("curtain_1", "curtain", (-0.9, 1.9), (0.5, 0.1, 2.3), salience="minor"),
    ]
    for line in eye_cameras(space_of(layout))[0]:
        distance, met = picture(layout, line)
        close = (distance < 1.2).reshape(distance.shape) & np.array([m not in (None, "floor") for m in met]).reshape(
            distance.shape
        )
        assert close[:, :8].mean() < 0.3 and close[:, -8:].mean() < 0.3


def test_an_open_leaf_is_in_the_way_of_the_eyes() -> None:
    layout = Layout(
        room=RoomLine(size=(3, 4, 2.6), floor=[(-1.5, -2), (1.5, -2), (1.5, 2), (-1.5, 2)]),
        walls=rectangle(3, 4).walls,
        doors=[DoorLine(id="door_1", wall="wall_0", start=(0.2, -2.0), end=(1.1, -2.0), open=90)],
        proxies=[thing("bed_1", "bed", (0.5, 0.9), (1.6, 2.0, 0.6))],
    )
    for line in eye_cameras(space_of(layout))[0]:
        distance, met = picture(layout, line)
        leaf = np.array([m == "door_1" for m in met]).reshape(distance.shape)
        assert not (leaf & (distance < 1.0))[:, 15:45].any() and leaf.mean() < 0.25


def test_nobody_stands_in_an_open_leaf() -> None:
    layout = rectangle(4.4, 3.9)
    layout.doors.append(DoorLine(id="door_1", wall="wall_1", start=(2.2, -1.82), end=(2.2, -1.0), height=2.0, open=70))
    layout.proxies.append(thing("bed_1", "bed", (-1.6, 0.9), (1.0, 2.0, 1.6)))
    space = space_of(layout)
    lines, _ = eye_cameras(space)
    assert lines
    _, centre, half, yaw, _ = open_leaves(layout)[0]
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    for line in lines:
        at = np.array(line.matrix).reshape(4, 4)[:3, 3]
        dx, dy = at[0] - centre[0], at[1] - centre[1]
        within = abs(c * dx + s * dy) < half[0] + 0.02 and abs(c * dy - s * dx) < half[1] + 0.02
        assert not within, line.id
