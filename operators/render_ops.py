# SPDX-License-Identifier: GPL-3.0-or-later
"""Looking at the finished room: through its cameras, and as rendered pictures that keep nobody waiting.

In a window each picture is a render job of Blender's own, which goes on in the background and is stopped like any other. A
timer looks when it is done, keeps the picture and starts the next one: Blender calls its render handlers on the job's
thread, where nothing may be changed.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy

from ..pipeline.errors import OutputError, RoomError, SceneError
from ..pipeline.scene import shoot
from ..pipeline.scene.tags import ID, KIND, find_room_collection
from . import driver, view_state
from .base import RoomOperator, allow
from .scene_backend import scene_by_uid

log = logging.getLogger(__name__)
_EVERY = 0.25  # seconds
_PATIENCE = 20  # looks until a job that never began counts as refused
TITLES = {
    "reference": "As in the picture",
    "top": "From above",
    "eye_1": "At eye level",
    "eye_2": "At eye level, again",
}


@dataclass
class _Queue:
    """Pictures that are being made.

    Attributes:
        scene: session_uid of the artist's scene. waiting: ids of cameras. now: the one that is rendered, "" before.
        ended: set by the render handlers, "done" or "stopped". display: where Blender shows renders, to put it back.
    """

    scene: int
    folder: Path
    engine: Any
    long_side: int
    waiting: list[str]
    display: str
    now: str = ""
    ended: str = ""
    looks: int = 0
    made: list[Path] = field(default_factory=list)


_queue: _Queue | None = None
_folders: dict[int, Path] = {}


def cameras(scene: Any) -> list[tuple[str, str]]:
    """Ids and titles of the room's cameras that stand in a scene, the reference first. No I/O."""
    room = find_room_collection(scene)
    if room is None:
        return []
    found = [str(o[ID]) for c in room.children for o in c.objects if o.type == "CAMERA" and o.get(KIND) == "camera"]
    order = list(TITLES)
    found.sort(key=lambda name: (order.index(name) if name in order else len(order), name))
    return [(name, TITLES.get(name, name)) for name in found]


def progress() -> str:
    """What is being rendered, in one sentence; "" when nothing is."""
    if _queue is None:
        return ""
    count = len(_queue.made) + 1
    title = TITLES.get(_queue.now, _queue.now)
    return f"Rendering picture {count} of {count + len(_queue.waiting)}: {title.lower()}"


def folder_of(scene: Any) -> Path | None:
    """Where this session's pictures of a scene's room are, None before there are any."""
    return _folders.get(scene.session_uid)


def picture_folder() -> Path:
    """Beside the .blend file; for one that was never saved, in the add-on's own folder.

    Raises:
        OutputError: it cannot be made.
    """
    from .. import __package__ as base

    saved = bpy.data.filepath
    try:
        if saved:
            folder = Path(saved).with_name(f"{Path(saved).stem} views")
            folder.mkdir(parents=True, exist_ok=True)
            return folder
        return Path(bpy.utils.extension_path_user(str(base), path="views", create=True))
    except (OSError, ValueError) as error:
        raise OutputError(
            f"There is no place for the pictures: {error}.", "Save the .blend in a folder that you may write in."
        ) from error


def is_rendering() -> bool:
    """Whether Blender renders something, ours or the artist's."""
    return bool(bpy.app.is_job_running("RENDER"))


class CODE_AS_ROOM_OT_render_views(RoomOperator):
    """Render the room through its cameras and keep the pictures; you can go on working meanwhile"""

    bl_idname = "code_as_room.render_views"
    bl_label = "Render Views"
    bl_options = {"REGISTER"}

    camera: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="View", description="Which of the room's cameras; all of them when empty", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be cameras, and neither a run nor a render."""
        if driver.is_running():
            return allow(cls, "A run is going on; wait for it, or stop it")
        if _queue is not None or is_rendering():
            return allow(cls, "A render is going on; wait for it, or stop it in the status bar")
        return allow(cls, "" if cameras(context.scene) else "Run the stages first; the room has no cameras yet")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Start the first picture's job."""
        try:
            scene: Any = context.scene
            names, folder = self._wanted(context), picture_folder()
            engine, long_side = _choice(scene)
            _start(_Queue(scene.session_uid, folder, engine, long_side, names, _view().render_display_type))
        except RoomError as error:
            return self.refuse(context, error)
        return {"FINISHED"}

    def perform(self, context: bpy.types.Context) -> None:
        """Scripts wait for the pictures."""
        scene: Any = context.scene
        names, folder = self._wanted(context), picture_folder()
        engine, long_side = _choice(scene)
        for name in names:
            shoot.shoot(scene, name, folder / f"{name}.png", long_side, engine)
        _folders[scene.session_uid] = folder

    def _wanted(self, context: Any) -> list[str]:
        known = [name for name, _ in cameras(context.scene)]
        if self.camera and self.camera not in known:
            raise RoomError(f"The room has no camera {self.camera}.", "Choose one from the list.")
        return [self.camera] if self.camera else known


class CODE_AS_ROOM_OT_show_view(RoomOperator):
    """Look through this camera of the room, and make it the one that Blender renders; walls in its way are not rendered"""

    bl_idname = "code_as_room.show_view"
    bl_label = "Look from Here"
    bl_options = {"REGISTER", "UNDO"}

    camera: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="View", description="Which of the room's cameras", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be cameras."""
        return allow(cls, "" if cameras(context.scene) else "Run the stages first; the room has no cameras yet")

    def perform(self, context: bpy.types.Context) -> None:
        """Make it the scene's camera with its picture's shape."""
        scene: Any = context.scene
        room = find_room_collection(scene)
        found = next(
            (o for o in (room.all_objects if room else ()) if o.type == "CAMERA" and o.get(ID) == self.camera), None
        )
        if found is None:
            raise RoomError(f"The room has no camera {self.camera}.", "Choose one from the list.")
        scene.camera = found
        line = next((c for c in shoot.camera_lines(scene) if c.id == self.camera), None)
        if line is not None:
            width, height = line.image_size
            side = max(scene.render.resolution_x, scene.render.resolution_y)
            scale = side / max(width, height)
            scene.render.resolution_x, scene.render.resolution_y = (max(4, round(v * scale)) for v in (width, height))
        shoot.cut_for(scene, found)
        space: Any = context.space_data
        if space is not None and space.type == "VIEW_3D" and space.region_3d is not None:
            space.region_3d.view_perspective = "CAMERA"


class CODE_AS_ROOM_OT_open_views(RoomOperator):
    """Open the folder with the rendered pictures in the file browser of the system"""

    bl_idname = "code_as_room.open_views"
    bl_label = "Open Pictures"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Something must have been rendered in this session."""
        return allow(cls, "" if folder_of(context.scene) else "Render the views first")

    def perform(self, context: bpy.types.Context) -> None:
        """Open it."""
        folder = folder_of(context.scene)
        if folder is None or not folder.is_dir():
            raise RoomError("The pictures are not there any more.", "Render the views again.")
        bpy.ops.wm.path_open(filepath=str(folder))


def _choice(scene: Any) -> tuple[Any, int]:
    """Engine and longest side that the artist chose."""
    settings = scene.code_as_room
    return settings.render_engine, shoot.FINE if settings.render_quality == "FINE" else shoot.PREVIEW


# ---- the jobs ----


def _start(queue: _Queue) -> None:
    """Begin; raises RoomError when the first picture cannot even be begun."""
    global _queue
    _queue = queue
    handlers: Any = bpy.app.handlers
    handlers.render_complete.append(_on_complete)
    handlers.render_cancel.append(_on_cancel)
    # A window for each picture would be in the artist's way.
    _view().render_display_type = "NONE"
    try:
        _begin_next(queue)
    except Exception:
        _finish()
        raise
    bpy.app.timers.register(_tick, first_interval=_EVERY)


def _view() -> Any:
    preferences: Any = bpy.context.preferences
    return preferences.view


def _begin_next(queue: _Queue) -> None:
    scene = scene_by_uid(queue.scene)
    if scene is None:
        raise SceneError("The scene is gone.", "Render the views again.")
    queue.now, queue.ended, queue.looks = queue.waiting.pop(0), "", 0
    stage = shoot.set_stage(scene, queue.now, queue.long_side, queue.engine)
    stage.render.filepath = str(queue.folder / f"{queue.now}.png")
    try:
        started: Any = bpy.ops.render.render("INVOKE_DEFAULT", write_still=True, scene=stage.name)
    except RuntimeError as error:
        raise SceneError(f"Blender could not render: {error}.", "Try the other engine.") from error
    if "CANCELLED" in started:
        raise SceneError("Blender did not start the render.", "Stop what is being rendered, then try again.")


def _on_complete(*_: Any) -> None:
    """On the job's thread: nothing but this."""
    if _queue is not None:
        _queue.ended = "done"


def _on_cancel(*_: Any) -> None:
    """On the job's thread: nothing but this."""
    if _queue is not None:
        _queue.ended = "stopped"


def _tick() -> float | None:
    """Look whether a picture is done; the timer's function."""
    queue = _queue
    if queue is None:
        return None
    queue.looks += 1
    if is_rendering() or (not queue.ended and queue.looks < _PATIENCE):
        return _EVERY
    try:
        path = queue.folder / f"{queue.now}.png"
        if queue.ended == "done" and path.is_file():
            queue.made.append(path)
        else:
            queue.waiting.clear()
        if queue.waiting:
            _begin_next(queue)
            _redraw()
            return _EVERY
        _tell(queue, None)
    except Exception as error:
        if not isinstance(error, RoomError):
            log.exception("Rendering the views failed unexpectedly")
        _tell(queue, error)
    _finish()
    return None


def _tell(queue: _Queue, error: BaseException | None) -> None:
    """What came of it, in the panel."""
    scene = scene_by_uid(queue.scene)
    if scene is None:
        return
    if queue.made:
        _folders[queue.scene] = queue.folder
    if error is not None:
        driver.note_outcome(scene, "", view_state.Problem.of(error))
    elif queue.made and queue.ended == "done":
        driver.note_outcome(scene, f"{len(queue.made)} pictures rendered to {queue.folder.name}")
    else:
        driver.note_outcome(scene, f"The render was stopped; {len(queue.made)} pictures are done")


def _finish() -> None:
    """Take everything away that was there for the jobs."""
    global _queue
    queue, _queue = _queue, None
    handlers: Any = bpy.app.handlers
    for group, function in ((handlers.render_complete, _on_complete), (handlers.render_cancel, _on_cancel)):
        while function in group:
            group.remove(function)
    if queue is not None:
        _view().render_display_type = queue.display
    shoot.clear_stages()
    _redraw()


def _redraw() -> None:
    windows: Any = bpy.context.window_manager
    for window in windows.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _after_load(*_: Any) -> None:
    """A file that was saved during a render holds the scene that it was made in."""
    global _queue
    if _queue is not None:
        _finish()
    shoot.clear_stages()


def register() -> None:
    """Register the handler."""
    bpy.app.handlers.load_post.append(bpy.app.handlers.persistent(_after_load))


def unregister() -> None:
    """Undo `register`; pictures that wait are not made."""
    if _queue is not None:
        _finish()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    if _after_load in bpy.app.handlers.load_post:
        bpy.app.handlers.load_post.remove(_after_load)


CLASSES = (CODE_AS_ROOM_OT_render_views, CODE_AS_ROOM_OT_show_view, CODE_AS_ROOM_OT_open_views)
