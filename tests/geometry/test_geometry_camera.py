# SPDX-License-Identifier: GPL-3.0-or-later
"""Projection, lines of sight, and agreement with Blender's own camera."""

import math

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.geometry import camera as cam
from hypothesis import given, settings
from hypothesis import strategies as st


@st.composite
def cameras(draw: st.DrawFn) -> CameraModel:
    size = (draw(st.integers(200, 2000)), draw(st.integers(200, 2000)))
    kind = draw(st.sampled_from(["perspective", "orthographic"]))
    rotation = cam.tilt_rotation(draw(st.floats(-20, 20)), draw(st.floats(-20, 20)), draw(st.floats(-30, 30)))
    position = (draw(st.floats(-2, 2)), draw(st.floats(-2, 2)), draw(st.floats(4, 15)))
    scale = draw(st.floats(500, 2500)) if kind == "perspective" else draw(st.floats(40, 200))
    principal = (draw(st.floats(350, 650)), draw(st.floats(350, 650)))
    return cam.camera_from(kind, position, rotation, scale, size, principal)


points = st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=1, max_size=6)


@given(cameras(), points, st.floats(0, 2.5))
def test_a_point_comes_back_from_the_picture(camera: CameraModel, flat: list, z: float) -> None:
    world = np.array([(x, y, z) for x, y in flat])
    assert cam.to_plane(camera, cam.project(camera, world), z) == pytest.approx(world, abs=1e-6)


@given(cameras(), points, st.floats(0, 2.5))
def test_a_point_lies_on_its_line_of_sight(camera: CameraModel, flat: list, z: float) -> None:
    world = np.array([(x, y, z) for x, y in flat])
    origins, directions = cam.ray(camera, cam.project(camera, world))
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1)
    assert np.cross(world - origins, directions) == pytest.approx(np.zeros_like(world), abs=1e-6)


def test_straight_down_has_east_right_and_north_up() -> None:
    for kind in ("perspective", "orthographic"):
        camera = cam.camera_straight_down(kind, 5, 4, (1200, 900))
        (middle, east, north) = cam.project(camera, [(0, 0, 0), (1, 0, 0), (0, 1, 0)])
        assert middle == pytest.approx((500, 500))
        assert east[0] > 500 and east[1] == pytest.approx(500)
        assert north[1] < 500 and north[0] == pytest.approx(500)


def test_tilt_names_say_where_the_camera_looks() -> None:
    assert -cam.tilt_rotation(10, 0)[:, 2] == pytest.approx(
        (0, math.sin(math.radians(10)), -math.cos(math.radians(10)))
    )
    assert -cam.tilt_rotation(0, 10)[:, 2] == pytest.approx(
        (math.sin(math.radians(10)), 0, -math.cos(math.radians(10)))
    )


def test_behind_the_camera_is_nan_and_the_sky_meets_no_floor() -> None:
    camera = cam.camera_looking_at("perspective", (0, -3, 1.5), (0, 0, 1.5), 50, (800, 600))
    assert np.isnan(cam.project(camera, [(0, -5, 1)])).all()
    assert np.isnan(cam.to_plane(camera, [(500, 100)], 0)).all()
    assert np.isfinite(cam.to_plane(camera, [(500, 900)], 0)).all()


@pytest.mark.parametrize("change", [{"matrix": (1.0,) * 9}, {"fov_y": 0.0}, {"fov_y": 4.0}])
def test_numbers_that_are_no_camera_give_a_plain_error(change: dict) -> None:
    camera = cam.camera_straight_down("perspective", 5, 4, (1200, 900)).model_copy(update=change)
    with pytest.raises(cam.GeometryError):
        cam.project(camera, [(0, 0, 0)])


@settings(
    max_examples=20,
)
@given(camera=cameras())
def test_blender_sees_the_same_picture(camera: CameraModel) -> None:
    bpy = pytest.importorskip("bpy")
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Matrix, Vector

    data = bpy.data.cameras.new("check")
    holder = bpy.data.objects.new("check", data)
    scene = bpy.context.scene
    try:
        scene.render.resolution_x, scene.render.resolution_y = camera.image_size
        holder.matrix_world = Matrix([camera.matrix[i : i + 4] for i in range(0, 16, 4)])
        width, height = camera.image_size
        if camera.kind == "perspective":
            data.sensor_fit = "VERTICAL"
            data.angle = camera.fov_y
        else:
            data.type, data.sensor_fit = "ORTHO", "VERTICAL"
            data.ortho_scale = camera.ortho_height
        # Blender counts the shift in units of the side that the sensor is fitted to; ours counts the longer one.
        shift_x, shift_y = cam.blender_shift(camera)
        data.shift_x, data.shift_y = (s * max(width, height) / height for s in (shift_x, shift_y))
        for point in ((0.0, 0.0, 0.0), (1.0, 0.5, 0.3), (-2.0, 1.0, 2.0)):
            view = world_to_camera_view(scene, holder, Vector(point))
            [seen] = cam.project(camera, [point])
            assert (view.x * 1000, 1000 - view.y * 1000) == pytest.approx(tuple(seen), abs=0.05)
    finally:
        bpy.data.objects.remove(holder)
        bpy.data.cameras.remove(data)
