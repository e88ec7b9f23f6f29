# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference camera: there as soon as a picture is, taken over by the program, and in nobody's way."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import numpy as np
import pytest
from code_as_room.operators import fitted_view
from code_as_room.operators.scene_backend import ResolvedScene
from code_as_room.pipeline.geometry.camera import to_plane
from code_as_room.pipeline.scene import reference_camera
from code_as_room.pipeline.scene.reference_camera import (
    find_reference_camera,
    frame_corners,
    is_stand_in,
    picture_size,
    show_picture,
)
from PIL import Image, ImageDraw

SIZE = (480, 400)


@pytest.fixture(autouse=True)
def enabled() -> Iterator[None]:
    """The add-on enabled in an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    yield
    code_as_room.unregister()


@pytest.fixture
def picture(tmp_path: Path) -> str:
    """A drawing of a room with a bed."""
    image = Image.new("RGB", SIZE, "white")
    pen = ImageDraw.Draw(image)
    pen.rectangle((30, 30, 450, 370), fill=(120, 120, 125))
    pen.rectangle((45, 45, 435, 355), fill=(205, 170, 130))
    pen.rectangle((170, 50, 310, 220), fill=(90, 120, 180))
    path = tmp_path / "flat.png"
    image.save(path)
    return str(path)


def load(path: str, **options: Any) -> Any:
    bpy.ops.code_as_room.load_picture(filepath=path, **options)
    return find_reference_camera(bpy.context.scene)


def test_a_loaded_picture_has_a_camera_that_looks_straight_down_on_five_metres(picture: str) -> None:
    camera = load(picture)
    bpy.context.view_layer.update()
    corners = frame_corners(camera, SIZE[0] / SIZE[1])
    depth = 5.0 * SIZE[1] / SIZE[0]
    wanted = np.array([(-2.5, depth / 2), (2.5, depth / 2), (2.5, -depth / 2), (-2.5, -depth / 2)])
    assert corners[:, :2] == pytest.approx(wanted, abs=1e-5)
    assert bpy.context.scene.camera == camera
    [background] = camera.data.background_images
    assert background.image == bpy.context.scene.code_as_room.picture
    assert background.alpha == pytest.approx(0.5)


def test_opacity_and_depth_are_those_of_the_panel(picture: str) -> None:
    camera = load(picture)
    settings = bpy.context.scene.code_as_room
    settings.reference_opacity, settings.reference_in_front = 0.8, False
    [background] = camera.data.background_images
    assert (round(background.alpha, 3), background.display_depth) == (0.8, "BACK")
    settings.reference_in_front = True
    assert background.display_depth == "FRONT"


def test_another_picture_takes_the_background_and_leaves_no_image_behind(picture: str, tmp_path: Path) -> None:
    load(picture)
    other = str(tmp_path / "other.png")
    Image.new("RGB", (300, 240), "green").save(other)
    camera = load(other)
    [background] = camera.data.background_images
    assert background.image == bpy.context.scene.code_as_room.picture
    assert picture_size(camera) == (300, 240)
    assert len(bpy.data.images) == 1 and len(bpy.data.cameras) == 1


def test_a_background_of_the_artist_stays(picture: str) -> None:
    camera = load(picture)
    plan = bpy.data.images.new("plan", 8, 8)
    mine = camera.data.background_images.new()
    mine.image = plan
    bpy.context.scene.code_as_room.reference_opacity = 0.3
    assert [b.image.name for b in camera.data.background_images if not b.image.get("code_as_room_reference")] == [
        "plan"
    ]
    show_picture(camera, None, 0.0, False)
    assert [b.image for b in camera.data.background_images] == [plan]


def test_the_stand_in_is_no_edit_by_hand_and_the_program_takes_it_over(picture: str) -> None:
    stand_in = load(picture)
    name = stand_in.name
    settings = bpy.context.scene.code_as_room
    settings.iterations = 1
    backend = ResolvedScene(bpy.context.scene)
    assert backend.read_back() == []
    bpy.ops.code_as_room.run_stage(stage="s01_analysis")
    camera = find_reference_camera(bpy.context.scene)
    assert is_stand_in(camera) and camera.name == name
    assert len(camera.data.background_images) == 1
    fitted = np.array(camera.matrix_basis)
    assert not np.allclose(fitted[:3, 3], (0, 0, 10), atol=1e-3), "the stage's fit moved the camera"
    assert ResolvedScene(bpy.context.scene).read_back() == []

    bpy.ops.code_as_room.run_all()
    camera = find_reference_camera(bpy.context.scene)
    assert not is_stand_in(camera) and camera.name == name
    assert np.array(camera.matrix_basis) == pytest.approx(fitted, abs=1e-6)
    views = {"top", "eye_1", "eye_2"}
    assert {c.name for c in bpy.data.cameras} == {camera.data.name} | views, "the build made no second reference"
    assert len(camera.data.background_images) == 1
    assert ResolvedScene(bpy.context.scene).read_back() == []


def test_the_frame_is_that_of_the_camera_model_with_shift_and_tilt(picture: str) -> None:
    from code_as_room.pipeline.artifacts.camera import CameraModel
    from code_as_room.pipeline.artifacts.common import ImagePoint
    from code_as_room.pipeline.geometry.camera import camera_from, tilt_rotation
    from code_as_room.pipeline.scene.reference_camera import ensure_reference_camera

    load(picture)
    scene = bpy.context.scene
    model: CameraModel = camera_from("perspective", (0.3, -0.4, 6.5), tilt_rotation(6, -3, 4), 500, SIZE, (430, 560))
    assert model.principal == ImagePoint(x=430, y=560)
    camera = ensure_reference_camera(scene, "Code-as-Room", model)
    bpy.context.view_layer.update()
    corners = frame_corners(camera, SIZE[0] / SIZE[1])
    eye = np.array(camera.matrix_world)[:3, 3]
    on_floor = eye + (corners - eye) * (-eye[2] / (corners - eye)[:, 2])[:, None]
    wanted = to_plane(model, [(0, 0), (1000, 0), (1000, 1000), (0, 1000)], 0.0)
    assert on_floor == pytest.approx(wanted, abs=1e-4)
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    drawn = np.array([tuple(corner / -corner.z) for corner in camera.data.view_frame(scene=scene)])
    local = (corners - eye) @ np.array(camera.matrix_world)[:3, :3]
    apart = np.linalg.norm(drawn[:, None] - local[None], axis=2)
    assert apart.min(axis=0).max() < 1e-4 and apart.min(axis=1).max() < 1e-4


def test_the_written_blend_holds_one_reference_camera_and_one_picture(picture: str, tmp_path: Path) -> None:
    load(picture)
    bpy.context.scene.code_as_room.iterations = 1
    bpy.ops.code_as_room.run_all()
    bpy.ops.code_as_room.write_outputs(directory=str(tmp_path / "out"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "out" / "room.blend"))
    assert sorted(camera.name for camera in bpy.data.cameras) == ["eye_1", "eye_2", "reference", "top"]
    assert all(image.packed_file for image in bpy.data.images if image.type == "IMAGE")
    assert len([image for image in bpy.data.images if image.name.startswith("Reference")]) == 1
    assert bpy.context.scene.camera == find_reference_camera(bpy.context.scene)


def test_without_a_window_looking_through_is_refused_in_a_sentence(picture: str) -> None:
    load(picture)
    assert not bpy.ops.code_as_room.look_through.poll()
    with pytest.raises(RuntimeError, match="no window"):
        bpy.ops.code_as_room.look_through()
    assert not fitted_view.is_looking_through(bpy.context)
    assert fitted_view.picture_to_region(bpy.context, [(0, 0)]) is None


def test_a_new_room_keeps_the_picture_and_its_camera(picture: str) -> None:
    load(picture)
    bpy.context.scene.code_as_room.iterations = 1
    bpy.ops.code_as_room.run_all()
    bpy.ops.code_as_room.new_room()
    camera = find_reference_camera(bpy.context.scene)
    assert is_stand_in(camera)
    assert [obj.name for obj in bpy.context.scene.objects] == ["reference"]


def test_a_corrected_fit_moves_the_camera_at_once(picture: str) -> None:
    from code_as_room.operators import correcting
    from code_as_room.pipeline.artifacts.corrections import KnownLength

    load(picture)
    bpy.ops.code_as_room.run_stage(stage="s01_analysis")
    camera = find_reference_camera(bpy.context.scene)
    before = camera.matrix_basis.translation.z
    wide = KnownLength(start={"x": 200, "y": 500}, end={"x": 800, "y": 500}, metres=20.0)
    correcting.apply(bpy.context.scene, lambda c: c.model_copy(update={"known_length": wide}))
    assert camera.matrix_basis.translation.z > 2 * before or camera.data.ortho_scale > 10


def test_a_room_that_is_linked_from_another_file_is_left_alone(picture: str, tmp_path: Path) -> None:
    load(picture)
    source = str(tmp_path / "source.blend")
    bpy.ops.wm.save_as_mainfile(filepath=source)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(source, link=True) as (_, wanted):
        wanted.scenes = ["Scene"]
    [linked] = [scene for scene in bpy.data.scenes if scene.library is not None]
    count = len(bpy.data.cameras)
    fitted_view.follow(linked)
    fitted_view.show_background(linked)
    assert len(bpy.data.cameras) == count


def test_a_room_whose_picture_was_taken_away_has_no_frame_and_no_error(picture: str) -> None:
    camera = load(picture)
    del camera[reference_camera._SIZE]
    bpy.context.scene.code_as_room.picture = None
    assert picture_size(camera) is None
    assert fitted_view._corners(None, bpy.context.scene, camera) is None  # type: ignore[arg-type]
