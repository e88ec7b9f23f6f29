# SPDX-License-Identifier: GPL-3.0-or-later
"""The photo studio: a scene for the length of one picture, so that nothing of the artist's scene has to be changed.

The studio holds painted copies of what is to be seen, a camera, a world and Workbench settings of its own; all of it is
gone when the `with` block ends, whatever happens inside it. Walls that stand between the camera and the room
are cut down to a low kerb, so that they never hide the floor.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from typing import Any

import bpy
import numpy as np

from ..artifacts.camera import CameraModel
from ..program.prelude.enclosure import CEILING, SECTION
from .compat import ensure_node_tree, set_png
from .lenses import write_camera
from .paint import glowing_material, painted_copy
from .tags import FIELD, ID, KIND, PART, world_matrix

BACKGROUND = (0.90, 0.905, 0.91)  # sRGB; a calm light grey
_CYCLES_SAMPLES = 4
_ON_WALL = 0.3  # metres between a wall and the middle of what hangs on it
KERB = 0.12  # metres that stay of a wall that is cut down


@contextlib.contextmanager
def studio(objects: Iterable[Any], camera: CameraModel, long_side: int, fine: bool = False) -> Iterator[Any]:
    """A temporary scene that shows these objects through this camera; yields it.

    The picture is at most `long_side` pixels long, in the aspect of the camera's `image_size`. A fine
    picture takes about three times as long: it is for people, the quick one for the critic.
    """
    scene = bpy.data.scenes.new("Code-as-Room Capture")
    made: list[Any] = []
    try:
        _look(scene, fine, made)
        _resolution(scene, camera, long_side)
        scene.camera = _camera_object(camera, made)
        scene.collection.objects.link(scene.camera)
        shown = list(objects)
        walls = [obj for obj in shown if obj.get(KIND) == "wall"]
        for obj in shown:
            in_front = stands_before(obj, camera, walls)
            if not in_front or obj.get(KIND) in ("wall", "door"):
                scene.collection.objects.link(painted_copy(obj, made, KERB if in_front else None))
        yield scene
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.batch_remove(made)


def _look(scene: Any, fine: bool, made: list[Any]) -> None:
    """Workbench, flat, with cavity and outlines; the colours come painted on the objects."""
    world = bpy.data.worlds.new("Code-as-Room Capture")
    made.append(world)
    world.color = tuple(((v + 0.055) / 1.055) ** 2.4 for v in BACKGROUND)
    scene.world = world
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.use_compositing = False
    scene.render.use_sequencer = False
    scene.render.film_transparent = False
    scene.view_settings.view_transform = "Standard"
    set_png(scene.render.image_settings)
    scene.display.render_aa = "5" if fine else "FXAA"
    shading = scene.display.shading
    shading.light = "FLAT"
    shading.color_type = "VERTEX"
    shading.show_shadows = False  # high walls would put the whole floor in shadow, with a hard edge across it
    shading.show_object_outline = True
    shading.object_outline_color = (0.10, 0.10, 0.11)
    shading.show_cavity = True
    shading.cavity_type = "BOTH" if fine else "SCREEN"  # ambient occlusion is grainy without many samples
    scene.display.matcap_ssao_distance = 0.25
    shading.cavity_ridge_factor = 0.3
    shading.cavity_valley_factor = 1.0
    shading.curvature_ridge_factor = 0.3
    shading.curvature_valley_factor = 0.6


@contextlib.contextmanager
def cycles(scene: Any) -> Iterator[None]:
    """Draw the stage on the processor inside the `with` block: the painted colours as they are, without light."""
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = _CYCLES_SAMPLES
    scene.cycles.use_denoising = False
    background = next((n for n in ensure_node_tree(scene.world).nodes if n.type == "BACKGROUND"), None)
    if background is not None:
        background.inputs["Color"].default_value = (*scene.world.color, 1.0)
    material = glowing_material(obj for obj in scene.collection.objects if obj.type == "MESH")
    try:
        yield
    finally:
        bpy.data.materials.remove(material)


def _resolution(scene: Any, camera: CameraModel, long_side: int) -> None:
    """The picture's pixels: the camera's aspect, square pixels, no border."""
    width, height = camera.image_size
    scale = max(1, int(long_side)) / max(width, height)
    render = scene.render
    render.resolution_x = max(4, round(width * scale))
    render.resolution_y = max(4, round(height * scale))
    render.resolution_percentage = 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1.0
    render.use_border = False


def _camera_object(camera: CameraModel, made: list[Any]) -> Any:
    """A camera object for the camera model."""
    data = bpy.data.cameras.new("Code-as-Room Capture")
    line = camera.model_dump()
    line["principal"] = (camera.principal.x, camera.principal.y)
    write_camera(data, line)
    obj = bpy.data.objects.new("Code-as-Room Capture", data)
    made.extend([obj, data])
    matrix = np.array(camera.matrix, dtype=float).reshape(4, 4)
    obj.matrix_basis = matrix.T.tolist()
    return obj


def wall_inward(wall: Any) -> tuple[Any, Any] | None:
    """A point on an outer wall's inner face and its normal into the room, as the wall stands; None for others."""
    if wall is None or wall.get(KIND) != "wall":
        return None
    matrix = np.array(world_matrix(wall), dtype=float)
    normal = matrix[:3, 1]
    return matrix[:3, 3], normal / max(float(np.linalg.norm(normal)), 1e-9)


def stands_before(obj: Any, camera: CameraModel, walls: list[Any]) -> bool:
    """Whether an outer wall, or the wall that a fitting or a wall object belongs to, turns its back to the camera."""
    face = wall_inward(_wall_of(obj, walls))
    if face is None:
        return False
    point, normal = face
    matrix = np.array(camera.matrix, dtype=float).reshape(4, 4)
    towards = matrix[:3, 3] - point if camera.kind == "perspective" else matrix[:3, 2]
    return bool(towards @ normal < -1e-3)


def _wall_of(obj: Any, walls: list[Any]) -> Any | None:
    """The wall object that this is, or that this is in or hangs on; None for what stands free."""
    is_proxy = obj.get(KIND) == "proxy"
    if is_proxy and obj.get(FIELD + "placement") != "wall":
        return None
    above = obj
    while above is not None:
        if above.get(KIND) in ("wall", "partition"):
            return above
        above = above.parent
    return _nearest_wall(obj, walls) if is_proxy else None


def _nearest_wall(obj: Any, walls: list[Any]) -> Any | None:
    """The outer wall whose inner face is nearest to an object that hangs on a wall which it does not name."""
    middle = np.array(world_matrix(obj), dtype=float)[:3, 3]

    def distance(wall: Any) -> float:
        face = wall_inward(wall)
        return float("inf") if face is None else abs(float((middle - face[0]) @ face[1]))

    near = min(walls, key=distance, default=None)
    return near if near is not None and distance(near) < _ON_WALL else None


def visible_objects(room: Any) -> list[Any]:
    """What a picture of the room shows: every mesh of the collection that is not hidden from renders."""
    return [
        obj
        for obj in room.all_objects
        if obj.type == "MESH" and not obj.hide_render and obj.get(KIND) not in (CEILING, SECTION)
    ]


def proxies_of(room: Any) -> list[Any]:
    """The proxies among a collection's objects, copies included."""
    return [obj for obj in room.all_objects if obj.get(KIND) == "proxy" and ID in obj and PART not in obj]
