# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel shows of a room, worked out once whenever something changed and never while drawing.

`refresh` reads memory and the picture and may take some milliseconds; operators, handlers, property updates and the
driver call it. `peek` is what `draw` and `poll` use: a look into a dictionary.
"""

from __future__ import annotations

import logging
from collections import Counter
from dataclasses import dataclass, replace
from typing import Any

import bpy

from ..pipeline.artifacts.analysis import Calibration, Finding, SceneAnalysis
from ..pipeline.artifacts.layout import LayoutProgram
from ..pipeline.errors import RoomError
from ..pipeline.memory import Memory, load_memory
from ..pipeline.picture import ReferencePicture
from ..pipeline.report import all_findings, floor_size
from ..pipeline.run import Run
from ..pipeline.stages import all_stages
from . import clients, properties, reference
from .scene_backend import ResolvedScene

log = logging.getLogger(__name__)
MOST_FINDINGS = 6


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


@dataclass(frozen=True)
class StageRow:
    """One stage in the panel.

    Attributes:
        status: "not run", "done", "stale" (something it read has changed) or "failed".
        blocked: why it cannot run yet, "" when it can.
    """

    id: str
    title: str
    status: str
    detail: str = ""
    blocked: str = ""


@dataclass(frozen=True)
class RoomState:
    """A room as the panel shows it; plain values only, no Blender data."""

    picture_name: str = ""
    picture_size: tuple[int, int] = (0, 0)
    answers: str = ""
    uses_model: bool = False
    client_problem: Problem | None = None
    problem: Problem | None = None
    stages: tuple[StageRow, ...] = ()
    room_size: tuple[float, float, float] | None = None
    camera_kind: str = ""
    error_px: float = 0.0
    score: float | None = None
    hand_edits: int = 0
    ledger: tuple[tuple[str, int], ...] = ()
    severities: tuple[tuple[str, int], ...] = ()
    findings: tuple[Finding, ...] = ()
    has_layout: bool = False
    has_memory: bool = False

    @property
    def blocker(self) -> str:
        """Why no stage can run, "" when one can."""
        if not self.picture_name:
            return "Load a picture of a room first"
        problem = self.problem or self.client_problem
        return problem.message.rstrip(".") if problem else ""


_states: dict[int, RoomState] = {}
_failures: dict[tuple[int, str], Problem] = {}


def peek(scene: Any) -> RoomState | None:
    """The state as it was worked out last; None for a scene that was not looked at yet."""
    return _states.get(scene.session_uid)


def refresh(scene: Any) -> RoomState:
    """Work the state out anew. Main thread only; never raises."""
    try:
        state = _read(scene)
    except RoomError as error:
        state = RoomState(picture_name=scene.code_as_room.picture_name, problem=Problem.of(error))
    except Exception as error:
        log.exception("The state of the room could not be read")
        state = RoomState(picture_name=scene.code_as_room.picture_name, problem=Problem.of(error))
    _states[scene.session_uid] = state
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


def forget_failure(scene_uid: int, stage: str = "") -> None:
    """A stage, or every stage of a scene, runs again."""
    for key in [k for k in _failures if k[0] == scene_uid and stage in ("", k[1])]:
        del _failures[key]


def _read(scene: Any) -> RoomState:
    state = RoomState()
    try:
        client = clients.current_client()
        state = replace(state, answers=client.describes, uses_model=client.name != "builtin")
    except RoomError as error:
        state = replace(state, client_problem=Problem.of(error), uses_model=True)
    picture = reference.kept_picture(scene)
    if picture is None:
        return state
    state = replace(state, picture_name=picture.name, picture_size=(picture.width, picture.height))
    backend = ResolvedScene(scene)
    try:
        memory = load_memory(backend.load_memory())
    except RoomError as error:
        return replace(state, problem=Problem.of(error), has_memory=True)
    memory.settings = properties.memory_settings(scene.code_as_room, memory.settings)
    return _with_memory(state, scene.session_uid, memory, picture, backend)


def _with_memory(
    state: RoomState, uid: int, memory: Memory, picture: ReferencePicture, backend: ResolvedScene
) -> RoomState:
    run = Run(picture, memory, clients.NOBODY, backend)
    calibration, program = memory.latest(Calibration), memory.latest(LayoutProgram)
    analysis = memory.latest(SceneAnalysis)
    findings = all_findings(memory)
    if calibration is not None:
        size = (*floor_size(calibration), calibration.height)
        kind = calibration.camera.kind
        state = replace(state, room_size=size, camera_kind=kind, error_px=calibration.error_px)
    states: list[str] = [entry.state for entry in program.ledger] if program is not None else []
    if not states and analysis is not None:
        states = ["detected"] * len(analysis.objects)
    return replace(
        state,
        stages=_rows(run, uid),
        score=program.score.total if program is not None else None,
        has_layout=program is not None,
        has_memory=bool(memory.entries),
        hand_edits=len(run.hand_edits()),
        ledger=tuple(Counter(states).items()),
        severities=tuple(Counter(f.severity for f in findings).items()),
        findings=tuple(findings[:MOST_FINDINGS]),
    )


def _rows(run: Run, uid: int) -> tuple[StageRow, ...]:
    rows: list[StageRow] = []
    blocked = ""
    for stage in all_stages():
        status: str = run.status(stage)
        failure = _failures.get((uid, stage.id))
        detail = "what it was made from has changed" if status == "stale" else ""
        if failure is not None:
            rows.append(StageRow(stage.id, stage.title, "failed", f"{failure.message} {failure.fix}".strip(), blocked))
        else:
            rows.append(StageRow(stage.id, stage.title, status, detail, blocked))
        if status == "not run" and not blocked:
            blocked = f"It needs the stage before it: {stage.title}"
    return tuple(rows)
