# SPDX-License-Identifier: GPL-3.0-or-later
"""Eye-level and top cameras: in the room, outside of furniture, with a free view of most of it."""

from __future__ import annotations

import math

import numpy as np
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImagePoint
from code_as_room.pipeline.artifacts.layout import CameraLine
from code_as_room.pipeline.geometry.camera import project
from code_as_room.pipeline.light.space import inside, space_of
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
