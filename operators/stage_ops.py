# SPDX-License-Identifier: GPL-3.0-or-later
"""Running the stages. Called from the window they return at once and the timer goes on; called by a script they block."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.stages.base import Stage
from . import consent, driver, object_list, view_state, ways
from .base import RoomOperator, allow, log, stage_blocker
from .view_state import StageRow

NEXT = "NEXT"
RAN = ("done", "drafted", "stale", "failed")
"""States of a stage that has run."""


class StageOperator(RoomOperator):
    """Base of the operators that run stages."""

    def begin(self, context: bpy.types.Context) -> None:
        """Start the job; raises RoomError."""
        raise NotImplementedError

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """From the window: start, and let the timer go on."""
        if bpy.app.background:
            return self.execute(context)
        if consent.ask_first(context, self):
            return {"FINISHED"}
        try:
            self.begin(context)
        except RoomError as error:
            return self.refuse(context, error)
        except Exception as error:
            log.exception("%s failed unexpectedly", type(self).__name__)
            return self.refuse(context, error)
        driver.run_in_window()
        return {"FINISHED"}

    def perform(self, context: bpy.types.Context) -> None:
        """From a script or in background mode: block until the end."""
        self.begin(context)
        outcome = driver.run_blocking()
        if outcome.problem is not None:
            raise RoomError(outcome.problem.message, outcome.problem.fix)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Says why no stage can run."""
        return allow(cls, stage_blocker(context))


def _stage_items() -> list[tuple[str, str, str]]:
    first = (NEXT, "The Next One", "The first stage that is not done")
    stages = ways.path_of("draft")
    return [first, *((stage.id, stage.title, f"The stage {stage.title}") for stage in stages)]


def _stage_property() -> Any:
    return bpy.props.EnumProperty(name="Stage", description="Which stage", items=_stage_items())


def place_of(context: Any, identifier: str) -> int:
    """The place of a stage in the order of all; RoomError when there is none, or it waits for another one."""
    stages, state = ways.path(context.scene), view_state.peek(context.scene)
    rows = {row.id: row for row in state.stages} if state is not None else {}
    for place, stage in enumerate(stages):
        row = rows.get(stage.id)
        if stage.id == identifier or (identifier == NEXT and (row is None or not row.is_done)):
            return place
    if identifier == NEXT:
        raise RoomError("Every stage is done.", "Redo one to run it again.")
    raise RoomError(f"There is no stage {identifier!r}.")


def row_of(context: Any, identifier: str) -> StageRow | None:
    """The panel's row of a stage."""
    state = view_state.peek(context.scene)
    return state.stage(identifier) if state is not None else None


def partial_blocker(context: Any, row: StageRow | None) -> str:
    """Why a stage cannot redo only the selected objects, "" when it can."""
    if row is None or not row.partial:
        return "This stage always does all objects"
    if row.status not in RAN:
        return "Run the whole stage first"
    if not object_list.selected_names(context.scene):
        return "Select objects of the room in the viewport first"
    return ""


def follows_draft(context: Any) -> bool:
    """Whether what was not run yet is answered from a draft."""
    state = view_state.peek(context.scene)
    return state is not None and state.way == "draft"


def start_left(context: Any, count: int | None) -> None:
    """Start what is not done of the first so many stages; going stage by stage, what was only drafted is not done."""
    stages, state = ways.path(context.scene)[:count], view_state.peek(context.scene)
    if follows_draft(context):
        driver.start(context.scene, stages, derived=ways.derived(context.scene, stages))
        return
    drafted = frozenset(row.id for row in state.left if row.status == "drafted") if state is not None else frozenset()
    driver.start(context.scene, stages, redo=drafted)


class CODE_AS_ROOM_OT_run_stage(StageOperator):
    """Run one stage; answers that were already given are used again"""

    bl_idname = "code_as_room.run_stage"
    bl_label = "Run Stage"
    bl_options = {"REGISTER"}

    stage: _stage_property()  # type: ignore[valid-type]
    fresh: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Ask Again", description="Ask again even where an answer to the same question is kept", default=False
    )
    selected: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Only Selected",
        description="Do only the objects anew that are selected in the viewport; everything else stays as it is",
        default=False,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The tooltip names the stage, and says what it waits for."""
        row = row_of(context, properties.stage)
        if row is None:
            return "Run the first stage that is not done; answers that were already given are used again"
        if row.blocked:
            return f"{row.title} cannot run yet. {row.blocked}"
        if properties.selected:
            blocker = partial_blocker(context, row)
            return blocker or f"Redo {row.title} for the selected objects only; everything else stays as it is"
        if properties.fresh:
            return f"Redo {row.title}: ask everything again, whatever was answered before"
        if row.status == "answered":
            return f"Run {row.title}; everything was answered already, so nothing is asked"
        return f"Run {row.title}; answers that were already given are used again"

    def begin(self, context: bpy.types.Context) -> None:
        """Start one stage, whether it is done or not."""
        stage = ways.path(context.scene)[place_of(context, self.stage)]
        row = row_of(context, stage.id)
        if not self.selected:
            # What is run on top of a draft is asked; what was not run yet follows from it.
            asked = (
                {stage.id} if self.fresh or (row is not None and row.is_done) or not follows_draft(context) else set()
            )
            derived = ways.derived(context.scene, [stage], asked)
            driver.start(context.scene, [stage], again=True, fresh=self.fresh, derived=derived)
            return
        blocker = partial_blocker(context, row_of(context, stage.id))
        if blocker:
            raise RoomError(f"{blocker}.")
        names = object_list.selected_names(context.scene)
        driver.start(context.scene, [stage], again=True, fresh=self.fresh, only=names)


class CODE_AS_ROOM_OT_run_to(StageOperator):
    """Run what is not done, up to and with this stage"""

    bl_idname = "code_as_room.run_to"
    bl_label = "Run to Stage"
    bl_options = {"REGISTER"}

    stage: _stage_property()  # type: ignore[valid-type]

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The tooltip names the stage."""
        row = row_of(context, properties.stage)
        return f"Run what is not done, up to and with {row.title}" if row is not None else (cls.__doc__ or "")

    def begin(self, context: bpy.types.Context) -> None:
        """Start the stages that are not done."""
        start_left(context, place_of(context, self.stage) + 1)


class CODE_AS_ROOM_OT_redo_from(StageOperator):
    """Redo this stage and every one after it: ask everything again, whatever was answered before"""

    bl_idname = "code_as_room.redo_from"
    bl_label = "Redo from Stage"
    bl_options = {"REGISTER"}

    stage: _stage_property()  # type: ignore[valid-type]

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The tooltip names the stage."""
        row = row_of(context, properties.stage)
        if row is None:
            return cls.__doc__ or ""
        if row.blocked:
            return f"{row.title} cannot run yet. {row.blocked}"
        return f"Redo {row.title} and every stage after it: ask everything again, whatever was answered before"

    def begin(self, context: bpy.types.Context) -> None:
        """Start the stages."""
        stages: Sequence[Stage] = ways.path(context.scene)[place_of(context, self.stage) :]
        asked = () if stages[0].id == ways.DRAFT else [stage.id for stage in stages]
        driver.start(context.scene, stages, again=True, fresh=True, derived=ways.derived(context.scene, stages, asked))


class CODE_AS_ROOM_OT_run_all(StageOperator):
    """Run every stage that is not done, in order, to the end"""

    bl_idname = "code_as_room.run_all"
    bl_label = "Run to the End"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Says why no stage can run, or that there is none left."""
        state = view_state.peek(context.scene)
        done = state is not None and bool(state.stages) and not state.left
        left = "" if not done else "Every stage is done; redo one to run it again"
        return allow(cls, stage_blocker(context) or left)

    def begin(self, context: bpy.types.Context) -> None:
        """Start all stages."""
        start_left(context, None)


class CODE_AS_ROOM_OT_stop(RoomOperator):
    """Stop the run; what was already answered is kept, and the next run goes on from there. What stands of a draft stays"""

    bl_idname = "code_as_room.stop"
    bl_label = "Stop"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """A run must be going on."""
        return allow(cls, "" if driver.is_running() else "Nothing is running")

    def perform(self, context: bpy.types.Context) -> None:
        """Stop."""
        driver.stop()


CLASSES = (
    CODE_AS_ROOM_OT_run_stage,
    CODE_AS_ROOM_OT_run_to,
    CODE_AS_ROOM_OT_redo_from,
    CODE_AS_ROOM_OT_run_all,
    CODE_AS_ROOM_OT_stop,
)
