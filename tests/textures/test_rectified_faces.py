# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces come back from the picture at the right scale, in the right direction and place, without what hides them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.geometry.camera import Projector
from code_as_room.pipeline.picture import ReferencePicture
from code_as_room.pipeline.textures.occluders import hidden_pixels, solids_of
from code_as_room.pipeline.textures.pixels import Pixels, to_linear
from code_as_room.pipeline.textures.planes import Face, Rectified, floor_face, front_face, rectify, top_face
from hypothesis import given, settings
from hypothesis import strategies as st

from .drawn_rooms import FLOOR, SIZE, box, camera, layout, seen_through, waves

NOTHING = np.zeros((SIZE[1], SIZE[0]), dtype=bool)


def expected(face: Face, found: Rectified) -> Pixels:
    rows, columns = found.seen.shape
    across, along = np.meshgrid((np.arange(columns) + 0.5) / found.scale, (rows - np.arange(rows) - 0.5) / found.scale)
    points = face.points(across.ravel(), along.ravel())
    return waves(points[:, 0], points[:, 1]).reshape(rows, columns, 3).astype(np.float32)


def linear(picture: ReferencePicture) -> Pixels:
    return to_linear(picture.pixels())


@settings(max_examples=14, deadline=None)
@given(
    tilt_x=st.floats(-32, 32),
    tilt_y=st.floats(-32, 32),
    roll=st.floats(-20, 20),
    perspective=st.booleans(),
    turn=st.sampled_from((0.0, 30.0, -45.0)),
)
def test_a_floor_comes_back_where_it_is(
    tilt_x: float, tilt_y: float, roll: float, perspective: bool, turn: float
) -> None:
    lens = camera(tilt_x, tilt_y, perspective, roll)
    face = floor_face([(-1.2, -1.0), (1.2, -1.0), (1.2, 1.0), (-1.2, 1.0)], turn)
    found = rectify(linear(seen_through(lens, waves)), lens, face, NOTHING)
    assert found is not None
    points = face.points(np.array((0.0, face.size[0])), np.array((0.0, face.size[1])))
    inside = (np.abs(points[:, 0]) < 2.1).all() and (np.abs(points[:, 1]) < 1.8).all()
    gap = np.abs(found.pixels - expected(face, found))[found.seen]
    if inside:
        assert gap.mean() < 0.012
    # The size of the image is that of the face: a pixel more or less.
    assert abs(found.seen.shape[1] / found.scale - face.size[0]) <= 1.0 / found.scale
    assert np.median(gap) < 0.012


@pytest.mark.parametrize("perspective", (True, False))
def test_nothing_is_sharper_than_the_picture(perspective: bool) -> None:
    lens = camera(25, 10, perspective)
    found = rectify(linear(seen_through(lens, waves)), lens, floor_face(FLOOR), NOTHING, scale=2000.0)
    assert found is not None
    middle = Projector.of(lens).pixels(np.array(((0.0, 0, 0), (0.01, 0, 0), (0, 0.01, 0))))
    per_metre = max(math.dist(middle[0], middle[1]), math.dist(middle[0], middle[2])) * 100
    assert found.scale <= per_metre * 1.05


def test_a_top_is_found_at_its_height() -> None:
    # What is drawn at floor level lies elsewhere on a plane half a metre up.
    lens = camera(22, -12)
    table = box("table", (0.4, 0.3), (1.2, 0.8, 0.5), yaw=30)
    face = top_face(table, (-0.6, -0.4), (0.6, 0.4), 0.5)
    corners = Projector.of(lens).pixels(face.points(np.array((0, 1.2, 1.2, 0)), np.array((0, 0, 0.8, 0.8))))
    picture = linear(seen_through(lens, waves, [table]))
    found = rectify(picture, lens, face, NOTHING)
    assert found is not None and np.isfinite(corners).all()
    pink = found.pixels[5:-5, 5:-5]
    assert (pink[..., 1] < 0.02).mean() > 0.99


def test_a_wall_seen_from_behind_or_edge_on_is_not_seen() -> None:
    picture = box("picture", (0, 1.85), (0.8, 0.04, 0.6), placement="wall")
    face = front_face(picture, (-0.4, 0.0), (0.4, 0.6), -0.02)
    seen = linear(seen_through(camera(25), waves))
    assert rectify(seen, camera(25), face, NOTHING) is not None
    assert rectify(seen, camera(-25), face, NOTHING) is None
    assert rectify(seen, camera(0, 0, perspective=False), face, NOTHING) is None


@settings(max_examples=12, deadline=None)
@given(
    tilt_x=st.floats(-35, 35),
    tilt_y=st.floats(-35, 35),
    x=st.floats(-1.2, 1.2),
    y=st.floats(-1.0, 1.0),
    yaw=st.floats(-180, 180),
    height=st.floats(0.02, 1.8),
)
def test_what_stands_on_a_floor_leaves_no_trace(
    tilt_x: float, tilt_y: float, x: float, y: float, yaw: float, height: float
) -> None:
    lens: CameraModel = camera(tilt_x, tilt_y)
    thing = box("thing", (x, y), (0.7, 0.45, height), yaw)
    face = floor_face(FLOOR)
    hidden = hidden_pixels(lens, SIZE, face, solids_of(layout(thing)))
    found = rectify(linear(seen_through(lens, waves, [thing])), lens, face, hidden)
    assert found is not None
    pink = (found.pixels[..., 1] < 0.03) & found.seen
    assert not pink.any()
    assert found.share > 0.25


def test_what_lies_below_a_plane_does_not_hide_it() -> None:
    table, stool = box("table", (0, 0), (1.4, 0.9, 0.7)), box("stool", (0.2, 0.1), (0.4, 0.4, 0.4))
    face = top_face(table, (-0.7, -0.45), (0.7, 0.45), 0.7)
    lens = camera(20)
    assert not hidden_pixels(lens, SIZE, face, solids_of(layout(stool)), ("table",)).any()
    assert hidden_pixels(lens, SIZE, floor_face(FLOOR), solids_of(layout(stool))).any()
