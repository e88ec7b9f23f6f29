# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects to image boxes and back."""

import math

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.geometry import camera as cam
from code_as_room.pipeline.geometry import footprint as fp
from hypothesis import given
from hypothesis import strategies as st

ROOM = cam.camera_straight_down("perspective", 6, 5, (1200, 1000), margin=0.15)
FLAT = cam.camera_straight_down("orthographic", 6, 5, (1200, 1000), margin=0.15)


@st.composite
def cameras(draw: st.DrawFn, kinds: tuple[str, ...] = ("perspective", "orthographic")) -> CameraModel:
    kind = draw(st.sampled_from(kinds))
    rotation = cam.tilt_rotation(draw(st.floats(-14, 14)), draw(st.floats(-14, 14)), draw(st.floats(-5, 5)))
    scale = draw(st.floats(500, 2000)) if kind == "perspective" else draw(st.floats(50, 150))
    position = (draw(st.floats(-2, 2)), draw(st.floats(-2, 2)), draw(st.floats(4.5, 12)))
    return cam.camera_from(kind, position, rotation, scale, (1200, 900), (draw(st.floats(400, 600)), 500))


place = st.tuples(st.floats(-3, 3), st.floats(-3, 3))
extent = st.tuples(st.floats(0.15, 2.5), st.floats(0.15, 2.5))
square_yaw = st.sampled_from([0.0, 90.0, 180.0, 270.0, -90.0])
shapes = st.sampled_from(["box", "round"])


@given(cameras(), place, extent, st.floats(0.01, 2.2), st.sampled_from([0.0, 0.7]), square_yaw, shapes)
def test_lift_undoes_projection_at_right_angles(
    camera: CameraModel, at: tuple, size: tuple, height: float, base: float, yaw: float, shape: str
) -> None:
    box = fp.image_box_of(camera, (*at, base + height / 2), (*size, height), yaw, shape)
    lifted = fp.lift_box(camera, box, base, height, yaw, shape=shape)
    assert lifted.iou > 0.995 and lifted.residual < 0.01
    assert lifted.centre == pytest.approx((*at, base + height / 2), abs=2e-3)
    assert lifted.size == pytest.approx((*size, height), abs=4e-3)


@given(cameras(), place, extent, st.floats(0.1, 2), st.floats(-180, 180), st.floats(0.9, 1.1))
def test_lift_of_turned_objects_leans_on_the_hinted_ratio(
    camera: CameraModel, at: tuple, size: tuple, height: float, yaw: float, error: float
) -> None:
    box = fp.image_box_of(camera, (*at, height / 2), (*size, height), yaw)
    lifted = fp.lift_box(camera, box, 0, height, yaw, size_hint=(size[0] * error, size[1]))
    assert lifted.iou > 0.93
    assert lifted.centre[:2] == pytest.approx(at, abs=0.1)
    # Each extent within the hint's own error and a little, never a swap of width and depth.
    assert lifted.size[0] / lifted.size[1] == pytest.approx(size[0] / size[1], rel=0.15)


@given(cameras(), place, extent, st.floats(0.05, 2), st.floats(-180, 180), shapes)
def test_image_box_is_the_hull_of_the_surface(
    camera: CameraModel, at: tuple, size: tuple, height: float, yaw: float, shape: str
) -> None:
    box = fp.image_box_of(camera, (*at, height / 2), (*size, height), yaw, shape)
    turn = np.linspace(0, 2 * math.pi, 721)
    if shape == "round":
        rim = np.stack([size[0] / 2 * np.cos(turn), size[1] / 2 * np.sin(turn)], axis=1)
    else:
        rim = np.array([(x * size[0] / 2, y * size[1] / 2) for x in (-1, 1) for y in (-1, 1)])
    a = math.radians(yaw)
    flat = rim @ np.array(((math.cos(a), math.sin(a)), (-math.sin(a), math.cos(a)))) + at
    surface = np.concatenate([np.column_stack([flat, np.full(len(flat), z)]) for z in (0, height)])
    seen = cam.project(camera, surface)
    expected = (*seen.min(axis=0), *seen.max(axis=0))
    assert (box.x_min, box.y_min, box.x_max, box.y_max) == pytest.approx(expected, abs=0.05)


def test_tall_objects_far_out_are_moved_back_in() -> None:
    """The naive reading of the image box as floor area puts a wardrobe in the corner through the wall."""
    box = fp.image_box_of(ROOM, (2.6, 2.0, 1.1), (0.6, 1.0, 2.2), 0)
    naive = cam.to_plane(ROOM, [box.centre], 0)[0]
    lifted = fp.lift_box(ROOM, box, 0, 2.2, 0)
    assert naive[0] - 2.6 > 0.25
    assert lifted.centre == pytest.approx((2.6, 2.0, 1.1), abs=1e-3)


def test_a_box_smaller_than_its_parallax_comes_back_small_with_a_residual() -> None:
    box = fp.image_box_of(ROOM, (2.6, 2.0, 0.05), (0.3, 0.3, 0.1), 0)
    lifted = fp.lift_box(ROOM, box, 0, 2.5, 0)
    assert lifted.residual > 5 and all(math.isfinite(v) for v in (*lifted.centre, *lifted.size))
    assert max(lifted.size[:2]) < 0.3


@pytest.mark.parametrize("edges", [(300, 300, 200, 400), (300, 300, 300, 400), (300, math.nan, 400, 400)])
def test_boxes_without_area_give_a_plain_error(edges: tuple) -> None:
    names = ("x_min", "y_min", "x_max", "y_max")
    box = ImageBox.model_construct(**dict(zip(names, edges, strict=True)))
    with pytest.raises(cam.GeometryError, match="no area"):
        fp.lift_box(ROOM, box, 0, 1, 0)


def test_an_object_behind_the_camera_is_refused_and_a_half_visible_one_is_cut() -> None:
    eye = cam.camera_looking_at("perspective", (0, -3, 1.5), (0, 0, 1.5), 50, (800, 600))
    with pytest.raises(cam.GeometryError):
        fp.image_box_of(eye, (0, -6, 1), (1, 1, 1), 0)
    cut = fp.image_box_of(eye, (0, -3, 0.5), (1, 4, 1), 0)
    assert cut.y_max > 1000 and math.isfinite(cut.area)


WALLS = [((-3, -2.5), (3, -2.5)), ((3, -2.5), (3, 2.5)), ((3, 2.5), (-3, 2.5)), ((-3, 2.5), (-3, -2.5))]


def on_wall(wall: tuple, along: float, z: float, depth: float) -> tuple[float, float, float]:
    (ax, ay), (bx, by) = wall
    length = math.dist(*wall)
    ux, uy = (bx - ax) / length, (by - ay) / length
    return ax + along * ux - uy * depth / 2, ay + along * uy + ux * depth / 2, z


@given(
    st.sampled_from(WALLS), st.floats(0.2, 0.8), st.floats(0.3, 1.5), st.floats(0.8, 1.8), st.floats(0.3, 1.0),
    st.floats(-0.3, 0.3), st.booleans(),
)  # fmt: skip
def test_wall_objects_are_found_where_they_hang(
    wall: tuple, share: float, width: float, z: float, tall: float, wrong: float, perspective: bool
) -> None:
    camera = ROOM if perspective else FLAT
    along = share * math.dist(*wall)
    yaw = fp.wall_yaw(*wall)
    box = fp.image_box_of(camera, on_wall(wall, along, z, 0.05), (width, 0.05, tall), yaw)
    guess = (z - tall / 2 + wrong, z + tall / 2 + wrong)
    found = fp.lift_on_wall(camera, box, *wall, z_hint=guess)
    assert found.along == pytest.approx(along, abs=0.02)
    assert found.width == pytest.approx(width, abs=0.03)
    assert found.yaw == yaw
    if perspective:
        assert (found.z_min, found.z_max) == pytest.approx((z - tall / 2, z + tall / 2), abs=0.05)
        assert found.z_known > 0.9
    else:
        assert (found.z_min, found.z_max) == pytest.approx(guess, abs=1e-6) and found.z_known == 0


def test_wall_objects_face_the_room() -> None:
    assert [fp.wall_yaw(*wall) for wall in WALLS] == pytest.approx([180, -90, 0, 90])
