# SPDX-License-Identifier: GPL-3.0-or-later
"""Running the stages. Called from the window they return at once and the timer goes on; called by a script they block."""

from __future__ import annotations

from typing import Any

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.stages import all_stages
from ..pipeline.stages.base import Stage
from . import driver, view_state
from .base import RoomOperator, allow, log, stage_blocker


class StageOperator(RoomOperator):
    """Base of the operators that run stages."""

    def begin(self, context: bpy.types.Context) -> None:
        """Start the job; raises RoomError."""
        raise NotImplementedError

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """From the window: start, and let the timer go on."""
        if bpy.app.background:
            return self.execute(context)
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


def stage_by_id(identifier: str) -> Stage:
    """A stage by its id, such as "s01_analysis"; RoomError when there is none."""
    for stage in all_stages():
        if stage.id == identifier:
            return stage
    raise RoomError(f"There is no stage {identifier!r}.")


class CODE_AS_ROOM_OT_run_stage(StageOperator):
    """Run this stage; answers that were already given are used again"""

    bl_idname = "code_as_room.run_stage"
    bl_label = "Run Stage"
    bl_options = {"REGISTER"}

    stage: bpy.props.StringProperty(name="Stage", description="Id of the stage, such as s01_analysis")  # type: ignore[valid-type]
    fresh: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Ask Again", description="Ask again even where an answer to the same question is kept", default=False
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The tooltip names the stage, and says what it waits for."""
        state = view_state.peek(context.scene)
        row = next((r for r in state.stages if r.id == properties.stage), None) if state else None
        if row is None:
            return "Run this stage; answers that were already given are used again"
        if row.blocked:
            return f"{row.title} cannot run yet. {row.blocked}"
        if properties.fresh:
            return f"Redo {row.title}: ask everything again, whatever was answered before"
        return f"Run {row.title}; answers that were already given are used again"

    def begin(self, context: bpy.types.Context) -> None:
        """Start one stage, whether it is done or not."""
        driver.start(context.scene, [stage_by_id(self.stage)], again=True, fresh=self.fresh)


class CODE_AS_ROOM_OT_run_all(StageOperator):
    """Run every stage that is not done, in order, to the end"""

    bl_idname = "code_as_room.run_all"
    bl_label = "Run to the End"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Says why no stage can run, or that there is none left."""
        state = view_state.peek(context.scene)
        done = state is not None and bool(state.stages) and all(row.status == "done" for row in state.stages)
        left = "" if not done else "Every stage is done; redo one to run it again"
        return allow(cls, stage_blocker(context) or left)

    def begin(self, context: bpy.types.Context) -> None:
        """Start all stages."""
        driver.start(context.scene, all_stages())


class CODE_AS_ROOM_OT_stop(RoomOperator):
    """Stop the run; what was already answered is kept, and the next run goes on from there"""

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


CLASSES = (CODE_AS_ROOM_OT_run_stage, CODE_AS_ROOM_OT_run_all, CODE_AS_ROOM_OT_stop)
