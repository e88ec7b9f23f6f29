# SPDX-License-Identifier: GPL-3.0-or-later
"""Finished pictures of a room: a scene of its own for their length, so that nothing of the artist's scene is changed.

The scene holds what the artist's scene shows, its world and colour management, a camera's resolution, and settings for the
device at hand. Walls that stand between a camera outside and the room are replaced by copies which only the camera does not
see: they still hold back and throw light. What is in such a wall, or hangs on it, goes with it.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

import bmesh
import bpy
import numpy as np
from mathutils import Vector

from ..artifacts.camera import CameraModel
from ..artifacts.common import ImagePoint
from ..artifacts.layout import CameraLine
from ..errors import SceneError
from ..program.prelude.enclosure import SECTION
from .compat import eevee_id, quiet, set_png
from .outside import brighten_outside
from .read_lines import built_layout
from .studio import stands_before
from .tags import FIELD, ID, KIND, find_room_collection

Engine = Literal["CYCLES", "EEVEE"]
STAGE = FIELD + "render"  # on the scene that pictures are taken in, so that one left by a crash is found
PREVIEW, FINE = 768, 1536
"""Longest sides, pixels: of a picture that comes within a minute on a processor of two cores, and of one to keep."""
_INNER = 1e-3  # metres from a wall's inner face
CUT = FIELD + "cut"  # on what `cut_for` took out of a camera's sight
_SAMPLES = ((PREVIEW, 16), (1024, 48), (10_000, 192))
"""Up to how many pixels how many samples: a denoiser does the rest."""
_PATIENCE = 40.0
"""Seconds after which a preview takes what it has, whatever the machine."""
_SCREEN_GAMUT_CLAMP = 8.0  # of indirect light: a few samples of a bright bulb would become white dots


def camera_lines(scene: Any) -> list[CameraLine]:
    """The room's cameras as they were built, the reference first; [] without a room."""
    room = find_room_collection(scene)
    built = built_layout(room) if room is not None else None
    return list(built[0].cameras) if built is not None else []


@contextlib.contextmanager
def shooting(scene: Any, camera: str, long_side: int, engine: Engine) -> Iterator[Any]:
    """A scene to render the room through one of its cameras with; it is gone when the `with` block ends.

    Raises:
        SceneError: there is no room, or no such camera in it.
    """
    stage = set_stage(scene, camera, long_side, engine)
    try:
        yield stage
    finally:
        strike_stage(stage)


def set_stage(scene: Any, camera: str, long_side: int, engine: Engine) -> Any:
    """As `shooting`, for a render that goes on after the call: `strike_stage` takes the scene away."""
    room = find_room_collection(scene)
    if room is None:
        raise SceneError("There is no room in this scene yet.", "Run the stages first.")
    found = next((o for o in room.all_objects if o.type == "CAMERA" and o.get(ID) == camera), None)
    if found is None:
        raise SceneError(f"The room has no camera {camera!r}.", "Run the stage Light and views, or choose another one.")
    clear_stages()
    stage = bpy.data.scenes.new("Code-as-Room Render")
    stage[STAGE] = True
    try:
        _furnish(stage, scene, room, found)
        _settings(stage, scene, _aspect(scene, found), long_side, engine)
        view: Any = stage.view_settings
        view.exposure += _stops(scene, found)
        if _is_inside(scene, found):
            world = brighten_outside(stage, scene.view_settings.exposure)
            if world is not None:
                world[STAGE] = True
    except Exception:
        strike_stage(stage)
        raise
    return stage


def strike_stage(stage: Any) -> None:
    """Take away a scene that `set_stage` made, with the copies in it."""
    copies = [obj for obj in stage.collection.objects if obj.get(STAGE)]
    world = stage.world
    bpy.data.scenes.remove(stage)
    if world is not None and world.get(STAGE):
        bpy.data.worlds.remove(world)
    for obj in copies:
        mesh = obj.data
        bpy.data.objects.remove(obj)
        if mesh.users == 0:
            bpy.data.meshes.remove(mesh)


def clear_stages() -> None:
    """Take away what a render that was broken off left."""
    for stage in [s for s in bpy.data.scenes if s.get(STAGE)]:
        strike_stage(stage)


def shoot(scene: Any, camera: str, path: Path, long_side: int = 1024, engine: Engine = "CYCLES") -> None:
    """Render one view to a PNG file; waits for it.

    Raises:
        SceneError: there is no such camera, or Blender could not render.
    """
    with shooting(scene, camera, long_side, engine) as stage:
        stage.render.filepath = str(path)
        try:
            with quiet():
                bpy.ops.render.render(write_still=True, scene=stage.name)
        except RuntimeError as error:
            raise SceneError(
                f"Blender could not render the view {camera}: {error}.", "Try the other engine."
            ) from error
    if not path.is_file():
        raise SceneError(f"The picture of the view {camera} could not be written.", "Look whether the disk is full.")


def _furnish(stage: Any, scene: Any, room: Any, camera: Any) -> None:
    """Link everything that the artist's scene renders; what the camera is not to see, as copies."""
    model = _camera_model(scene, camera)
    shown = [obj for obj in scene.objects if not obj.hide_render and _is_rendered(scene, obj)]
    walls = [obj for obj in shown if obj.get(KIND) == "wall"]
    inside = set(room.all_objects)
    for obj in shown:
        if obj in inside and obj.get(KIND) == SECTION and not _cuts(camera):
            continue
        if obj.type in ("MESH", "CURVE", "SURFACE", "FONT") and obj in inside and stands_before(obj, model, walls):
            obj = _unseen(obj)
        stage.collection.objects.link(obj)
    if camera.name not in stage.collection.objects:
        stage.collection.objects.link(camera)
    stage.camera = camera


def _cuts(camera: Any) -> bool:
    """Whether a camera's near clip cuts the walls; for others there is no section to be seen."""
    return float(camera.data.clip_start) > 0.05


def _is_inside(scene: Any, camera: Any) -> bool:
    """Whether a camera is in the room: below its walls' upper edges."""
    room = find_room_collection(scene)
    walls = [obj for obj in room.all_objects if obj.get(KIND) == "wall"] if room is not None else []
    tops = [(obj.matrix_world @ Vector(corner)).z for obj in walls for corner in obj.bound_box]
    return camera.data.type == "PERSP" and bool(tops) and camera.matrix_world.translation.z < max(tops)


def _unseen(obj: Any) -> Any:
    """A copy that the camera does not see. Of a wall only its inner face: the dark inside of the rest would show."""
    copy = obj.copy()
    copy.visible_camera = False
    copy[STAGE] = True
    if obj.get(KIND) == "wall" and obj.type == "MESH":
        copy.data = obj.data.copy()
        work = bmesh.new()
        work.from_mesh(copy.data)
        behind = [face for face in work.faces if any(v.co.y < -_INNER for v in face.verts)]
        bmesh.ops.delete(work, geom=behind, context="FACES")
        work.to_mesh(copy.data)
        work.free()
    return copy


def _is_rendered(scene: Any, obj: Any) -> bool:
    """Whether one of the collections that an object is in is rendered."""
    hidden = {c for c in scene.collection.children_recursive if c.hide_render}
    return not hidden or any(c not in hidden for c in obj.users_collection)


def _settings(stage: Any, scene: Any, aspect: Sequence[int], long_side: int, engine: Engine) -> None:
    """Resolution, colours, and how carefully to render."""
    stage.world = scene.world
    for name in ("view_transform", "look", "exposure", "gamma"):
        with contextlib.suppress(TypeError):
            setattr(stage.view_settings, name, getattr(scene.view_settings, name))
    render = stage.render
    width, height = aspect
    scale = max(16, int(long_side)) / max(width, height)
    render.resolution_x, render.resolution_y = (max(4, round(side * scale)) for side in (width, height))
    render.resolution_percentage = 100
    render.use_border = render.use_compositing = render.use_sequencer = False
    render.film_transparent = False
    set_png(render.image_settings)
    render.image_settings.color_mode = "RGB"
    if engine == "EEVEE":
        render.engine = eevee_id(stage)
        _careful_eevee(stage.eevee, long_side)
    else:
        render.engine = "CYCLES"
        _careful_cycles(stage.cycles, long_side)


def _careful_cycles(cycles: Any, long_side: int) -> None:
    """Few samples and a denoiser: in a room most light has bounced, and more samples only lessen its grain."""
    cycles.samples = next((count for side, count in _SAMPLES if long_side <= side), _SAMPLES[-1][1])
    cycles.use_adaptive_sampling = True
    quick = long_side <= PREVIEW
    cycles.adaptive_threshold = 0.03 if quick else 0.015
    cycles.time_limit = _PATIENCE if quick else 0.0
    cycles.use_light_tree = True
    cycles.use_denoising = True
    cycles.max_bounces, cycles.diffuse_bounces, cycles.glossy_bounces = (6, 3, 2) if quick else (8, 4, 4)
    wanted = {"denoiser": "OPENIMAGEDENOISE", "denoising_input_passes": "RGB_ALBEDO_NORMAL"}
    # The faster ways of the denoiser leave edges wavy where there are few samples.
    wanted |= {"denoising_prefilter": "ACCURATE", "denoising_quality": "HIGH"}
    for name, value in wanted.items():
        if hasattr(cycles, name):  # the quality is not in every version, nor is the denoiser on every machine
            with contextlib.suppress(TypeError):
                setattr(cycles, name, value)
    cycles.transmission_bounces, cycles.transparent_max_bounces = 6, 16
    cycles.sample_clamp_indirect = _SCREEN_GAMUT_CLAMP
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.blur_glossy = 1.0
    cycles.device = _device()


def _device() -> str:
    """The graphics card where the artist has set one up for Cycles."""
    preferences: Any = bpy.context.preferences
    addon = preferences.addons.get("cycles")
    chosen = getattr(addon.preferences, "compute_device_type", "NONE") if addon is not None else "NONE"
    return "CPU" if chosen in ("", "NONE") else "GPU"


def _careful_eevee(eevee: Any, long_side: int) -> None:
    """Light that bounces, and soft shadows, as far as EEVEE has them."""
    wanted = {
        "taa_render_samples": 32 if long_side <= PREVIEW else 128,
        "use_raytracing": True,
        "use_shadows": True,
        "shadow_ray_count": 2,
        "fast_gi_method": "GLOBAL_ILLUMINATION",
        "gi_diffuse_bounces": 3,
    }
    for name, value in wanted.items():
        if hasattr(eevee, name):
            with contextlib.suppress(TypeError, AttributeError):
                setattr(eevee, name, value)


def _aspect(scene: Any, camera: Any) -> tuple[int, int]:
    """Width and height of a camera's picture: those of its line."""
    line = next((c for c in camera_lines(scene) if c.id == camera.get(ID)), None)
    return line.image_size if line is not None else (1536, 1024)


def _stops(scene: Any, camera: Any) -> float:
    """Stops by which pictures through a camera are brighter than the room's exposure: those of its line."""
    line = next((c for c in camera_lines(scene) if c.id == camera.get(ID)), None)
    return line.stops if line is not None else 0.0


def _camera_model(scene: Any, camera: Any) -> CameraModel:
    """A camera of the room as it stands now."""
    matrix = np.array(camera.matrix_world, dtype=float)
    flat = camera.data.type == "ORTHO"
    return CameraModel(
        kind="orthographic" if flat else "perspective",
        matrix=tuple(float(v) for v in matrix.ravel()),
        fov_y=0.0 if flat else float(camera.data.angle_y),
        ortho_height=float(camera.data.ortho_scale) if flat else 0.0,
        image_size=_aspect(scene, camera),
        principal=ImagePoint(x=500.0, y=500.0),
    )


def cut_for(scene: Any, camera: Any) -> None:
    """Let the artist's own renders through a camera see into the room: walls in its way are not seen, the others are."""
    room = find_room_collection(scene)
    if room is None:
        return
    model = _camera_model(scene, camera)
    meshes = [obj for obj in room.all_objects if obj.type == "MESH"]
    walls = [obj for obj in meshes if obj.get(KIND) == "wall"]
    for obj in meshes:
        hidden = obj.get(KIND) == SECTION and not _cuts(camera)
        if hidden or stands_before(obj, model, walls):
            if obj.visible_camera:
                obj[CUT] = True
                obj.visible_camera = False
        elif CUT in obj:
            obj.visible_camera = True
            del obj[CUT]
