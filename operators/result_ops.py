# SPDX-License-Identifier: GPL-3.0-or-later
"""Results: writing the output files, and looking at the program and the memory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from ..pipeline.errors import OutputError, RoomError
from . import driver, rooms, view_state
from .base import RoomOperator, allow, manager

REPORT = "report.html"
PICTURES = {"FOLDER": "", "TOP": "top.png", "VIEW": "view.png"}


class CODE_AS_ROOM_OT_write_outputs(RoomOperator):
    """Write the room's program, a copy of the .blend, pictures and a report to a folder"""

    bl_idname = "code_as_room.write_outputs"
    bl_label = "Write Results"
    bl_options = {"REGISTER"}

    directory: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH")  # type: ignore[valid-type]
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})  # type: ignore[valid-type]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a layout, and no run."""
        if driver.is_running():
            return allow(cls, "A run is going on; wait for it, or stop it")
        state = view_state.peek(context.scene)
        return allow(cls, "" if state is None or state.has_layout else "Run the stages up to the layout first")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Let the artist choose the folder."""
        manager(context).fileselect_add(self)
        return {"RUNNING_MODAL"}

    def perform(self, context: bpy.types.Context) -> None:
        """Write the files."""
        from . import render_ops
        from .outputs import write_outputs
        from .report_pictures import fresh_renders

        scene = context.scene
        folder = chosen_folder(self.directory)
        run, backend = driver.make_run(scene)
        run.take_over_edits()
        backend.flush()
        run.reports.extend(driver.reports_of(scene))
        cameras = [name for name, _ in render_ops.cameras(scene)]
        renders = fresh_renders(render_ops.folder_of(scene), cameras, run.memory)
        paths = write_outputs(run, folder, renders)
        rooms.note_results(scene, folder)
        view_state.refresh(scene)
        driver.note_outcome(scene, f"{len(paths)} files written to {folder.name or folder}")
        self.report({"INFO"}, f"{len(paths)} files written to {folder}")


def chosen_folder(directory: str) -> Path:
    """The folder that was chosen, made when it is not there; OutputError when that cannot be."""
    if not directory:
        raise OutputError("No folder was chosen.", "Choose one.")
    folder = Path(bpy.path.abspath(directory))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"Nothing can be written in {folder}: {error.strerror}.", "Choose another folder.") from error
    return folder


class CODE_AS_ROOM_OT_open_report(RoomOperator):
    """Open the report that was written last in the web browser"""

    bl_idname = "code_as_room.open_report"
    bl_label = "Open Report"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Results must have been written in this session."""
        return allow(cls, "" if rooms.results_of(context.scene) else "Write the results first")

    def perform(self, context: bpy.types.Context) -> None:
        """Open it."""
        folder = rooms.results_of(context.scene)
        path = folder / REPORT if folder is not None else None
        if path is None or not path.is_file():
            raise RoomError("The report is not there any more.", "Write the results again.")
        bpy.ops.wm.url_open(url=path.as_uri())


class CODE_AS_ROOM_OT_open_results(RoomOperator):
    """Open the folder of the results that were written last, or one of their pictures"""

    bl_idname = "code_as_room.open_results"
    bl_label = "Open Room Results"
    bl_options = {"REGISTER"}

    what: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="What",
        description="What to open",
        items=(
            ("FOLDER", "Folder", "The folder with all results"),
            ("TOP", "From Above", "The room through the fitted camera"),
            ("VIEW", "From a Corner", "The room from a raised corner"),
        ),
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The tooltip says what."""
        said = {
            "FOLDER": "Open the folder with all results in the file browser of the system",
            "TOP": "Open the picture of the room through the fitted camera",
            "VIEW": "Open the picture of the room from a raised corner",
        }
        return said.get(properties.what, cls.__doc__ or "")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Results must have been written in this session."""
        return allow(cls, "" if rooms.results_of(context.scene) else "Write the results first")

    def perform(self, context: bpy.types.Context) -> None:
        """Open it with the system's program."""
        folder = rooms.results_of(context.scene)
        path = folder / PICTURES[self.what] if folder is not None else None
        if path is None or not path.exists():
            raise RoomError("It is not there any more.", "Write the results again.")
        bpy.ops.wm.path_open(filepath=str(path))


class CODE_AS_ROOM_OT_open_text(RoomOperator):
    """Show the room's program or its memory in a text editor"""

    bl_idname = "code_as_room.open_text"
    bl_label = "Open Text"
    bl_options = {"REGISTER"}

    which: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Text",
        items=(
            ("PROGRAM", "Program", "The Python text that builds the room"),
            ("MEMORY", "Memory", "What the stages wrote, as JSON"),
        ),
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The tooltip says which text."""
        if properties.which == "PROGRAM":
            return "Show the Python text that builds the room in a text editor"
        return "Show what the stages wrote, as JSON, in a text editor"

    def perform(self, context: bpy.types.Context) -> None:
        """Show the text in an open text editor, else in a new window."""
        text = rooms.room_text(context.scene, self.which)
        if text is None:
            raise RoomError("There is no such text yet.", "Run the stages first.")
        show_text(context, text)


def show_text(context: Any, text: Any) -> None:
    """Show a text in a text editor that is open, else in a new window; without a window nothing is shown."""
    if bpy.app.background:
        return
    spaces = [a.spaces.active for w in manager(context).windows for a in w.screen.areas if a.type == "TEXT_EDITOR"]
    if not spaces:
        bpy.ops.wm.window_new()
        area = manager(context).windows[-1].screen.areas[0]
        area.ui_type = "TEXT_EDITOR"
        spaces = [area.spaces.active]
    spaces[0].text = text
    spaces[0].top = 0


CLASSES = (
    CODE_AS_ROOM_OT_write_outputs,
    CODE_AS_ROOM_OT_open_report,
    CODE_AS_ROOM_OT_open_results,
    CODE_AS_ROOM_OT_open_text,
)
