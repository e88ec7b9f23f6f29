# SPDX-License-Identifier: GPL-3.0-or-later
"""What can be done with the geometry of single objects: shown as a box, modelled again, its function edited."""

from __future__ import annotations

from typing import Any

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.program.assemble import split_room
from ..pipeline.run_assets import take_off
from ..pipeline.run_modelling import GEOMETRY, forget_own, function_line, show_as_boxes
from ..pipeline.stages import all_stages
from ..pipeline.stages.base import Stage
from . import driver, object_list, own_room, room_memory, rooms, view_state, ways
from .base import RoomOperator, allow, busy_blocker
from .program_ops import show_line
from .result_ops import show_text
from .scene_backend import ResolvedScene
from .stage_ops import StageOperator


def blocker(context: Any) -> str:
    """Why nothing can be done with an object's geometry now, "" when it can."""
    busy = busy_blocker(context)
    if busy:
        return busy
    state = view_state.peek(context.scene)
    row = state.stage(GEOMETRY) if state is not None else None
    if row is None or row.status == "not run":
        return "Run the stages up to Geometry first"
    return "" if object_list.selected_names(context.scene) else "Select objects of the room in the viewport first"


class DetailOperator(RoomOperator):
    """Base of the operators about the geometry of what is selected."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Geometry must have run, and objects be selected."""
        return allow(cls, blocker(context))


class CODE_AS_ROOM_OT_show_boxes(DetailOperator):
    """Show the selected objects as their plain boxes, or modelled again; nothing is lost either way"""

    bl_idname = "code_as_room.show_boxes"
    bl_label = "Show as Boxes"
    bl_options = {"REGISTER", "UNDO"}

    boxes: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="As Boxes", description="Show boxes; else the geometry", default=True
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The tooltip says which way."""
        if properties.boxes:
            return "Show the selected objects as plain boxes; their geometry is kept"
        return "Show the geometry of the selected objects again"

    def perform(self, context: bpy.types.Context) -> None:
        """Build the room so."""
        scene = context.scene
        own_room.prepare(scene)
        run = room_memory.run_of(scene)
        count = show_as_boxes(run, object_list.selected_names(scene), self.boxes)
        if isinstance(run.backend, ResolvedScene):
            run.backend.flush()
        view_state.refresh(scene)
        what = "shown as boxes" if self.boxes else "shown modelled"
        self.report({"INFO"}, f"{count} object{'' if count == 1 else 's'} {what}")


class CODE_AS_ROOM_OT_detail_again(StageOperator):
    """Model the selected objects anew; also those whose functions you edited. Everything else stays as it is"""

    bl_idname = "code_as_room.detail_again"
    bl_label = "Detail Again"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Geometry must have run, and objects be selected."""
        return allow(cls, blocker(context))

    def begin(self, context: bpy.types.Context) -> None:
        """Start the geometry stage for them, and what was done after it: it begins where stage 4 had put small things."""
        scene = context.scene
        names = object_list.selected_names(scene)
        driver.make_run(scene)  # what cannot be started is refused before anything is given up
        run = room_memory.run_of(scene)
        run.take_over_edits()
        forget_own(run.memory, names)
        take_off(run, names, refused=False)
        room_memory.keep(run)
        stages = _stages_from_geometry(scene)
        derived = ways.derived(scene, stages, [GEOMETRY])
        driver.start(scene, stages, again=True, fresh=True, only=names, step=self.bl_label, derived=derived)


def _stages_from_geometry(scene: Any) -> list[Stage]:
    """The geometry stage, and those after it that are done: what they added would be gone otherwise."""
    state, stages = view_state.peek(scene), all_stages()
    place = next(n for n, stage in enumerate(stages) if stage.id == GEOMETRY)
    done = {row.id for row in state.stages if row.is_done} if state is not None else set()
    return [stages[place], *(s for s in stages[place + 1 :] if s.id in done)]


class CODE_AS_ROOM_OT_edit_function(RoomOperator):
    """Show the function that models the active object in a text editor; edit it, then apply the edited program"""

    bl_idname = "code_as_room.edit_function"
    bl_label = "Edit Function"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a program."""
        text = rooms.room_text(context.scene, "PROGRAM")
        return allow(cls, "" if text is not None else "There is no program yet; run the stages first")

    def perform(self, context: bpy.types.Context) -> None:
        """Open the text at the function."""
        text = rooms.room_text(context.scene, "PROGRAM")
        row = object_list.active_row(context.scene)
        if text is None or row is None:
            raise RoomError("There is no object chosen.", "Choose one in the list of objects.")
        above, program = split_room(text.as_string())
        line = function_line(program, row.name or row.id)
        if not line:
            raise RoomError(f"{row.title} has no function; it is a plain box.", "Run the stage Geometry first.")
        show_text(context, text)
        show_line(context, text, above + line)


CLASSES = (CODE_AS_ROOM_OT_show_boxes, CODE_AS_ROOM_OT_detail_again, CODE_AS_ROOM_OT_edit_function)
