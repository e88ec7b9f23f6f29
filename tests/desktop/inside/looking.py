# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures drawn in the artist's 3D view, and looking at the room through the picture's camera."""

from __future__ import annotations

import io
import time
from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np
from PIL import Image
from window import PAUSE, call, check, part, results, shoot, view

LONG_SIDE = 1024


def capture_in_the_view() -> Iterator[float]:
    """What the 3D view draws off screen lies under the camera, is what a render gives, and leaves the view alone."""
    box = _red_box()
    for name, camera in _cameras().items():
        picture = _capture(camera)
        check(f"the {name} picture is drawn in the view", picture.method == "viewport")
        check(f"the {name} picture lies under its camera within a pixel", _offset(picture.png, camera, box) <= 1.0)
        check(f"the {name} picture is what a render gives", _difference(picture.png, _rendered(camera).png) < 1.5)
        yield 0.05
    _measure()
    yield from _whatever_the_artist_does(_cameras()["fitted"])
    mesh, red = box.data, box.data.materials[0]
    bpy.data.objects.remove(box)
    bpy.data.meshes.remove(mesh)
    bpy.data.materials.remove(red)


def _measure() -> None:
    camera = _cameras()["fitted"]
    for name, draw in (("view", _capture), ("render", _rendered)):
        draw(camera)
        began, cpu = time.perf_counter(), time.process_time()
        for _ in range(3):
            draw(camera)
        took, busy = (time.perf_counter() - began) / 3, (time.process_time() - cpu) / 3
        results["numbers"][f"a {LONG_SIDE} px picture by {name}, s (and of the processors)"] = [
            round(took, 3),
            round(busy, 3),
        ]


def _whatever_the_artist_does(camera: Any) -> Iterator[float]:
    """The same picture whatever the view shows, and the view as it was."""
    window, area, _ = view()
    space, scene = area.spaces.active, bpy.context.scene
    data = space.region_3d
    plain = _capture(camera).png
    for kind in ("WIREFRAME", "MATERIAL", "RENDERED", "SOLID"):
        space.shading.type = kind
        data.use_clip_planes = kind == "WIREFRAME"
        space.show_object_viewport_mesh = kind != "MATERIAL"
        before = _view_state(space)
        picture = _capture(camera)
        check(f"drawn in a {kind.lower()} view", picture.method == "viewport")
        check(f"the picture is the same in a {kind.lower()} view", _difference(picture.png, plain) < 0.2)
        check(f"the {kind.lower()} view is as it was", _view_state(space) == before)
        yield 0.05
    layer = bpy.context.view_layer
    hidden = next(c for c in layer.layer_collection.children if c.collection.get("code_as_room_role") == "room")
    hidden.hide_viewport = True
    check("a collection that is hidden in the view is drawn", _difference(_capture(camera).png, plain) < 0.2)
    hidden.hide_viewport = False
    other = bpy.data.scenes.new("other")
    window.scene = other
    picture = part("pipeline.scene.capture").capture(scene, camera, LONG_SIDE)
    check("a scene that is not shown is drawn", _difference(picture.png, plain) < 0.2)
    check("the shown scene stays", window.scene == other)
    window.scene = scene
    bpy.data.scenes.remove(other)
    yield PAUSE
    region = next(r for r in area.regions if r.type == "WINDOW")
    scene.objects[0].select_set(True)
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.localview()
        picture = _capture(camera)
        check("in local view it is rendered", picture.method == "workbench")
        check("and is the same", _difference(picture.png, plain) < 1.5)
        check("local view stays", space.local_view is not None)
        bpy.ops.view3d.localview()
    yield 1.0


def look_through() -> Iterator[float]:
    """Through the fitted camera and back: the layout lies on the picture, and the view comes back."""
    fitted = part("operators.fitted_view")
    _, area, _ = view()
    space = area.spaces.active
    before = _view_state(space)
    call(bpy.ops.code_as_room.look_through)
    yield 1.0
    with _in_view():
        check("the view looks through the camera", fitted.is_looking_through(bpy.context))
        wanted = np.array([(0.0, 0.0), (1000, 0), (1000, 1000), (0, 1000), (333, 777)])
        spots = fitted.picture_to_region(bpy.context, wanted)
        back = fitted.region_to_picture(bpy.context, spots)
        check("picture and view map onto each other", float(np.abs(back - wanted).max()) < 1e-6)
        check("the mapping is the camera's frame", _frame_apart(spots[:4]) < 0.1)
        space.region_3d.view_camera_zoom += 9
        space.region_3d.view_camera_offset = (0.07, -0.04)
        space.region_3d.update()
        check("also zoomed and panned", _frame_apart(fitted.picture_to_region(bpy.context, wanted[:4])) < 0.1)
    call(bpy.ops.code_as_room.look_through)
    yield PAUSE
    call(bpy.ops.code_as_room.look_through)
    yield 1.0
    shoot("looking_through")
    call(bpy.ops.code_as_room.look_through)
    yield PAUSE
    check("the view comes back", _view_state(space) == before)


def _in_view() -> Any:
    window, area, _ = view()
    region = next(r for r in area.regions if r.type == "WINDOW")
    return bpy.context.temp_override(window=window, area=area, region=region)


def _frame_apart(spots: Any) -> float:
    """Pixels between the mapped corners and those of Blender's own camera frame."""
    from bpy_extras.view3d_utils import location_3d_to_region_2d

    camera, data = bpy.context.scene.camera, bpy.context.region_data
    corners = [camera.matrix_world @ c for c in camera.data.view_frame(scene=bpy.context.scene)]
    frame = np.array([location_3d_to_region_2d(bpy.context.region, data, c) for c in corners])
    return float(np.linalg.norm(frame[:, None] - spots[None], axis=2).min(axis=1).max())


def _view_state(space: Any) -> Any:
    data = space.region_3d
    numbers = [tuple(data.view_location), tuple(data.view_rotation), data.view_distance, tuple(data.view_camera_offset)]
    return (
        [tuple(round(v, 5) for v in n) if isinstance(n, tuple) else round(n, 5) for n in numbers],
        [
            data.view_perspective,
            data.view_camera_zoom,
            data.use_clip_planes,
            space.shading.type,
            space.use_local_camera,
        ],
        [space.overlay.show_overlays, space.show_object_viewport_mesh, space.lock_camera, space.shading.use_compositor],
        [obj.name for obj in bpy.context.selected_objects],
        bpy.context.view_layer.objects.active,
    )


def _cameras() -> dict[str, Any]:
    """The fitted camera; one with a shifted lens; a tilted orthographic one."""
    camera = part("pipeline.geometry.camera")
    memory = part("operators.room_memory").memory_of(bpy.context.scene)
    fitted = memory.latest(part("pipeline.artifacts.analysis").Calibration).camera
    tilted, size = camera.tilt_rotation(4, -3, 8), (1000, 800)
    return {
        "fitted": fitted,
        "shifted": camera.camera_from("perspective", (0.4, -1.5, 9.0), tilted, 1100, size, (420, 590)),
        "orthographic": camera.camera_from("orthographic", (0.4, -1.5, 9.0), tilted, 110, size, (540, 460)),
    }


def _capture(camera: Any) -> Any:
    return part("pipeline.scene.capture").capture(bpy.context.scene, camera, LONG_SIDE)


def _rendered(camera: Any) -> Any:
    """The picture as it would be without a 3D view."""
    capture = part("pipeline.scene.capture")
    kept, capture.open_view = capture.open_view, lambda: None
    try:
        return _capture(camera)
    finally:
        capture.open_view = kept


def _red_box() -> Any:
    """A box high above the room, which nothing covers, in a colour that nothing else has."""
    corners = [(0.6 * x + 0.5, 0.4 * y - 0.3, 0.3 * z + 3.0) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new("test box")
    mesh.from_pydata(corners, [], faces)
    red = bpy.data.materials.new("test box")
    red.diffuse_color = (1.0, 0.0, 0.0, 1.0)
    mesh.materials.append(red)
    box = bpy.data.objects.new("test box", mesh)
    room = part("pipeline.scene.tags").find_room_collection(bpy.context.scene)
    room.objects.link(box)
    bpy.context.view_layer.update()
    return box


def _pixels(png: bytes) -> Any:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=float)


def _difference(first: bytes, second: bytes) -> float:
    """The mean difference of two pictures, 0..255; infinite where their sizes differ."""
    a, b = _pixels(first), _pixels(second)
    return float(np.abs(a - b).mean()) if a.shape == b.shape else float("inf")


def _offset(png: bytes, camera: Any, obj: Any) -> float:
    """Pixels by which the red box's outline is off from where the camera model puts its corners."""
    image = _pixels(png)
    found = (image[..., 0] > 110) & (image[..., 1] < 70) & (image[..., 2] < 70)
    rows, columns = np.nonzero(found)
    corners = [tuple(obj.matrix_world @ v.co) for v in obj.data.vertices]
    height, width = image.shape[:2]
    spots = part("pipeline.geometry.camera").project(camera, corners) / 1000 * (width, height)
    low, high = spots.min(axis=0), spots.max(axis=0)
    if not len(rows):
        return float("inf")
    edges = (columns.min() - low[0], columns.max() + 1 - high[0], rows.min() - low[1], rows.max() + 1 - high[1])
    return float(np.abs(edges).max())
