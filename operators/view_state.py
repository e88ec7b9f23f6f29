# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel shows of a room, worked out once whenever something changed and never while drawing.

`refresh` reads memory and the picture and may take some milliseconds; operators, handlers, property updates and the
driver call it. `peek` is what `draw` and `poll` use: a look into a dictionary.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import bpy

from ..pipeline.artifacts.analysis import Finding
from ..pipeline.errors import RoomError
from .finish_rows import FinishState
from .texture_rows import TextureState

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ..pipeline.artifacts.assets import ChosenAsset
    from ..pipeline.report_objects import ObjectRow
    from ..pipeline.report_rounds import RoundRow
    from . import ways

log = logging.getLogger(__name__)
MOST_EDITS = 12
"""Edits by hand that are told one by one."""


@dataclass(frozen=True)
class Problem:
    """Something that went wrong, in one plain sentence, and the next step ("" when there is none)."""

    message: str
    fix: str = ""

    @classmethod
    def of(cls, error: BaseException) -> Problem:
        """An error as the artist sees it; what is no `RoomError` is a fault of ours and its traceback is in the log."""
        if isinstance(error, RoomError):
            return cls(error.message, error.fix)
        return cls("Something unexpected went wrong.", "The details are in Blender's console; please report them.")

    @property
    def sentence(self) -> str:
        """Both in one."""
        return f"{self.message} {self.fix}".strip()


@dataclass(frozen=True)
class StageRow:
    """One stage in the panel.

    Attributes:
        status: "not run", "answered" (only its result is missing, nothing would be asked), "done", "drafted" (done, with
            answers taken from a draft), "stale" (something it read has changed) or "failed".
        blocked: why it cannot run yet, "" when it can.
        partial: whether it can do some objects anew and leave the others.
        by_draft: whether no model was asked for its present result, if it has one.
    """

    id: str
    title: str
    status: str
    detail: str = ""
    blocked: str = ""
    partial: bool = False
    by_draft: bool = True

    @property
    def is_done(self) -> bool:
        """Whether its result stands."""
        return self.status in ("done", "drafted")


@dataclass(frozen=True)
class RoomState:
    """A room as the panel shows it; plain values only, no Blender data.

    Attributes:
        last_edits: edits by hand that were taken over last, in words; last_count: how many they were.
        hand_edits: edits by hand in all.
        camera_name: how the picture was taken, in words; scale_words: where the size comes from and how sure it is.
        reference_key: names the reference image, "" when there is none.
        assets: what objects look like, of the artist's asset libraries.
        textures: the images on surfaces, and what the artist says of their sources.
        finish: the light, and what was corrected.
        estimate: what running the stages that are left may cost, in words; spending: what was spent, and the cap.
        way: "draft" or "stages"; offers_draft: whether there is a choice. has_draft: whether the room was drafted;
            verdict: how good the draft is, in a sentence; is_poor: whether going stage by stage is advised.
    """

    picture_name: str = ""
    picture_size: tuple[int, int] = (0, 0)
    answers: str = ""
    uses_model: bool = False
    client_problem: Problem | None = None
    problem: Problem | None = None
    stages: tuple[StageRow, ...] = ()
    room_size: tuple[float, float, float] | None = None
    camera_kind: str = ""
    camera_name: str = ""
    scale_words: str = ""
    error_px: float = 0.0
    score: float | None = None
    hand_edits: int = 0
    last_edits: tuple[str, ...] = ()
    last_count: int = 0
    ledger: tuple[tuple[str, int], ...] = ()
    severities: tuple[tuple[str, int], ...] = ()
    findings: tuple[Finding, ...] = ()
    objects: tuple[ObjectRow, ...] = ()
    rounds: tuple[RoundRow, ...] = ()
    assets: tuple[ChosenAsset, ...] = ()
    textures: TextureState = field(default_factory=TextureState)
    finish: FinishState = field(default_factory=FinishState)
    has_layout: bool = False
    has_memory: bool = False
    estimate: str = ""
    spending: str = ""
    way: ways.Way = "stages"
    offers_draft: bool = False
    has_draft: bool = False
    verdict: str = ""
    is_poor: bool = False

    @property
    def blocker(self) -> str:
        """Why no stage can run, "" when one can."""
        if not self.picture_name:
            return "Load a picture of a room first"
        problem = self.problem or self.client_problem
        return problem.message.rstrip(".") if problem else ""

    @property
    def left(self) -> tuple[StageRow, ...]:
        """The stages that are still to be run; going stage by stage, also those that were only drafted."""
        done = ("done", "drafted") if self.way == "draft" else ("done",)
        return tuple(row for row in self.stages if row.status not in done)

    @cached_property
    def by_id(self) -> Mapping[str, ObjectRow]:
        """The objects by id."""
        return {row.id: row for row in self.objects}

    @cached_property
    def by_name(self) -> Mapping[str, ObjectRow]:
        """The objects that stand in the layout by what they are called there."""
        return {row.name: row for row in self.objects if row.name}

    @cached_property
    def locked(self) -> tuple[ObjectRow, ...]:
        """The objects that no automatic step may change."""
        return tuple(row for row in self.objects if row.locked)

    def stage(self, identifier: str) -> StageRow | None:
        """A stage's row."""
        return next((row for row in self.stages if row.id == identifier), None)


_states: dict[int, RoomState] = {}
_failures: dict[tuple[int, str], Problem] = {}
listeners: list[Callable[[Any, RoomState], None]] = []
"""Called with the scene and its state after each refresh, on the main thread."""


def peek(scene: Any) -> RoomState | None:
    """The state as it was worked out last; None for a scene that was not looked at yet."""
    return _states.get(scene.session_uid)


def has_something(scene: Any) -> bool:
    """Whether anything was found or built in this scene; without a picture a setting is only noted."""
    state = peek(scene)
    return state is not None and state.has_memory


def refresh(scene: Any) -> RoomState:
    """Work the state out anew. Main thread only; never raises."""
    from . import state_reading

    try:
        state = state_reading.read(scene)
    except RoomError as error:
        state = RoomState(picture_name=scene.code_as_room.picture_name, problem=Problem.of(error))
    except Exception as error:
        log.exception("The state of the room could not be read")
        state = RoomState(picture_name=scene.code_as_room.picture_name, problem=Problem.of(error))
    _states[scene.session_uid] = state
    for listener in tuple(listeners):
        try:
            listener(scene, state)
        except Exception:
            log.exception("What follows the state of the room could not be brought up to date")
    return state


def refresh_all() -> None:
    """Work out the state of every scene, as after a load, an undo or a change of the preferences."""
    for scene in bpy.data.scenes:
        refresh(scene)


def forget_all() -> None:
    """Drop everything that was worked out or remembered."""
    _states.clear()
    _failures.clear()


def note_failure(scene_uid: int, stage: str, error: BaseException) -> None:
    """Remember why a stage failed, until it runs again."""
    _failures[(scene_uid, stage)] = Problem.of(error)


def failure(scene_uid: int, stage: str) -> Problem | None:
    """Why a stage failed when it ran last; None when it did not."""
    return _failures.get((scene_uid, stage))


def forget_failure(scene_uid: int, stage: str = "") -> None:
    """A stage, or every stage of a scene, runs again."""
    for key in [k for k in _failures if k[0] == scene_uid and stage in ("", k[1])]:
        del _failures[key]
