# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures: the colour of a thing is where the camera model puts it, and the artist's scene is as it was."""

from __future__ import annotations

import io
import math
from typing import Any

import bpy
import code_as_room.pipeline.scene.capture
import numpy as np
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImagePoint
from code_as_room.pipeline.errors import SceneError
from code_as_room.pipeline.geometry.camera import project
from code_as_room.pipeline.scene.capture import capture, eye_view
from code_as_room.pipeline.scene.realise import realise_record
from code_as_room.pipeline.scene.tags import ID
from PIL import Image


def tilted(degrees: float, height: float, at: tuple[float, float] = (0.0, 0.0), **lens: Any) -> CameraModel:
    """A camera above `at` that leans over to look north by some degrees."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    matrix = (1, 0, 0, at[0], 0, c, -s, at[1], 0, s, c, height, 0, 0, 0, 1)
    lens.setdefault("image_size", (320, 240))
    if "ortho_height" in lens:
        return CameraModel(kind="orthographic", matrix=matrix, **lens)
    return CameraModel(kind="perspective", matrix=matrix, fov_y=0.9, **lens)


CAMERAS = {
    "down": tilted(0, 9),
    "tilted": tilted(15, 9, (0, -2.0)),
    "shifted": tilted(5, 9, (0.4, -0.5), principal=ImagePoint(x=430, y=590)),
    "portrait": tilted(-8, 11, image_size=(180, 240), principal=ImagePoint(x=560, y=450)),
    "ortho": tilted(0, 9, (0.2, 0.1), ortho_height=5.5),
    "ortho_shifted": tilted(12, 9, (0, -1.8), ortho_height=5.5, principal=ImagePoint(x=550, y=480)),
}


def pixels(png: bytes) -> Any:
    """(height, width, 3) floats 0..255."""
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=float)


def paint(identifier: str, colour: tuple[float, float, float]) -> Any:
    """Give one object a colour of its own on all its faces."""
    [obj] = [o for o in bpy.data.objects if o.get(ID) == identifier]
    material = bpy.data.materials.new("mark")
    material.diffuse_color = (*colour, 1.0)
    for index in range(len(obj.data.materials)):
        obj.data.materials[index] = material
    return obj


def red(image: Any) -> Any:
    """Where the picture is as red as nothing in the room is."""
    return (image[..., 0] > 120) & (image[..., 1] < 60) & (image[..., 2] < 60)


@pytest.mark.parametrize("name", CAMERAS)
def test_the_picture_lies_under_the_camera_model(record: Any, name: str) -> None:
    realise_record(record)
    obj = paint("armchair_1", (1.0, 0.0, 0.0))
    camera = CAMERAS[name]
    width, height = camera.image_size
    image = pixels(capture(bpy.context.scene, camera, max(width, height)).png)
    assert image.shape[:2] == (height, width)
    corners = [obj.matrix_world @ v.co for v in obj.data.vertices]
    spots = np.asarray(project(camera, [tuple(c) for c in corners])) / 1000 * (width, height)
    rows, columns = np.nonzero(red(image))
    found = (columns.min(), columns.max() + 1, rows.min(), rows.max() + 1)
    wanted = (spots[:, 0].min(), spots[:, 0].max(), spots[:, 1].min(), spots[:, 1].max())
    assert np.abs(np.subtract(found, wanted)).max() < 2.0
    x, y = spots.mean(axis=0)
    assert red(image)[round(y), round(x)]


def test_upper_faces_have_the_palettes_colour(record: Any) -> None:
    realise_record(record)
    image = pixels(capture(bpy.context.scene, CAMERAS["down"], 320).png)
    x, y = np.asarray(project(CAMERAS["down"], [(-0.6, 0.3, 0.6)]))[0] / 1000 * (320, 240)
    assert np.abs(image[round(y), round(x)] - (0x7C, 0x93, 0xB9)).max() < 20  # a wall may shade it a little


def test_only_the_room_is_in_the_picture(record: Any) -> None:
    realise_record(record)
    before = pixels(capture(bpy.context.scene, CAMERAS["down"], 160).png)
    mesh = bpy.data.meshes.new("sheet")
    mesh.from_pydata([(-9, -9, 4), (9, -9, 4), (9, 9, 4), (-9, 9, 4)], [], [(0, 1, 2, 3)])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("sheet", mesh))
    bpy.context.scene.view_settings.exposure = 3
    assert np.abs(pixels(capture(bpy.context.scene, CAMERAS["down"], 160).png) - before).max() < 3


def test_nothing_is_left_behind(record: Any) -> None:
    realise_record(record)
    scene = bpy.context.scene
    groups = ("scenes", "objects", "meshes", "cameras", "worlds", "materials", "collections")
    counts = [len(getattr(bpy.data, group)) for group in groups]
    settings = scene.render.engine, scene.render.resolution_x, scene.render.filepath, scene.camera, scene.world
    capture(scene, CAMERAS["tilted"], 64, labels=True)
    eye_view(scene, 64)
    assert [len(getattr(bpy.data, group)) for group in groups] == counts
    after = scene.render.engine, scene.render.resolution_x, scene.render.filepath, scene.camera, scene.world
    assert after == settings
    assert bpy.context.scene == scene


def test_a_wall_before_the_camera_does_not_hide_the_floor(record: Any) -> None:
    realise_record(record)
    camera = tilted(35, 7, (-0.5, -6.0))
    [wall] = [o for o in bpy.data.objects if o.get(ID) == "wall_s"]
    paint("wall_s", (1.0, 0.0, 0.0))
    rows = np.nonzero(red(pixels(capture(bpy.context.scene, camera, 320).png)))[0]
    high = np.asarray(project(camera, [tuple(wall.matrix_world.translation), (-0.5, -2.0, 2.6)]))[:, 1] * 0.24
    assert rows.min() > high[1] + 20  # the wall ends far below where its top would be


def test_labels_are_written_at_the_objects(record: Any) -> None:
    realise_record(record)
    plain = pixels(capture(bpy.context.scene, CAMERAS["down"], 640).png)
    named = pixels(capture(bpy.context.scene, CAMERAS["down"], 640, labels=True).png)
    changed = np.abs(plain - named).max(axis=2) > 40
    for line in record.proxies:
        x, y, z = line["centre"]
        spot = np.asarray(project(CAMERAS["down"], [(x, y, z + line["size"][2] / 2)]))[0] / 1000 * (640, 480)
        column, row = round(spot[0]), round(spot[1])
        assert changed[row - 25 : row + 26, column - 25 : column + 26].any(), line["id"]


def test_the_view_from_the_corner_shows_all_of_the_room(record: Any) -> None:
    realise_record(record)
    image = pixels(eye_view(bpy.context.scene, 320).png)
    backdrop = image[0, 0]
    border = np.concatenate([image[0], image[-1], image[:, 0], image[:, -1]])
    assert np.abs(border - backdrop).max() < 6
    assert (np.abs(image - backdrop).max(axis=2) > 12).mean() > 0.3


def test_without_a_graphics_driver_cycles_draws_the_same_picture(record: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    realise_record(record)
    drawn = capture(bpy.context.scene, CAMERAS["down"], 160)
    monkeypatch.setattr(code_as_room.pipeline.scene.capture, "can_draw", lambda: False)
    counts = len(bpy.data.materials), len(bpy.data.worlds), len(bpy.data.meshes)
    fallback = capture(bpy.context.scene, CAMERAS["down"], 160)
    assert (drawn.method, fallback.method) == ("workbench", "cycles")
    assert np.abs(pixels(drawn.png) - pixels(fallback.png)).mean() < 6
    assert (len(bpy.data.materials), len(bpy.data.worlds), len(bpy.data.meshes)) == counts


def test_without_a_room_the_artist_is_told() -> None:
    with pytest.raises(SceneError, match="no room"):
        capture(bpy.context.scene, CAMERAS["down"], 64)
