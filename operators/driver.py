# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a job in the window from an application timer, or blocking where there is no window.

Not a modal operator: Blender suspends auto-save while one runs, and models take minutes. The timer is not persistent,
so Blender itself ends it when another file is loaded; `cancel_for_load` drops the job before that.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import bpy

from ..pipeline.ask_replaced import replaced_answers
from ..pipeline.draft.refine import Step
from ..pipeline.errors import Cancelled, RoomError
from ..pipeline.run import Run, StageReport
from ..pipeline.run_corrections import bring_up_to_date
from ..pipeline.stages import all_stages
from ..pipeline.stages.base import Stage
from . import (
    asset_shelf,
    clients,
    journals,
    late,
    own_room,
    painters,
    properties,
    reference,
    room_memory,
    view_state,
    ways,
)
from .desk import DESK
from .job import Job
from .meanwhile import NotApplied, in_hand
from .progress import Durations, Progress
from .scene_backend import ResolvedScene, scene_by_uid
from .todo import Todo, refining

log = logging.getLogger(__name__)
BUDGET = 0.03
"""Seconds of a tick that are spent on the job."""
INTERVAL = 0.03
TAB = "Room"
_PATIENCE = 0.2


@dataclass(frozen=True)
class Outcome:
    """How the last job of a scene ended: a sentence, what went wrong, and what the scene's building had to say."""

    text: str
    problem: view_state.Problem | None = None
    notices: tuple[str, ...] = ()


_job: Job | None = None
_outcomes: dict[int, Outcome] = {}
_reports: dict[int, list[StageReport]] = {}
_shown: tuple[Any, ...] = ()


def is_running() -> bool:
    """Whether a job is on its way, in whatever scene."""
    return _job is not None


def progress_of(scene: Any) -> Progress | None:
    """What the job of this scene is doing, None when it has none."""
    return _job.progress if _job is not None and _job.scene_uid == scene.session_uid else None


def outcome_of(scene: Any) -> Outcome | None:
    """How the last job of this scene ended."""
    return _outcomes.get(scene.session_uid)


def note_outcome(
    scene: Any, text: str, problem: view_state.Problem | None = None, notices: tuple[str, ...] = ()
) -> None:
    """Show a sentence where the result of a job is shown."""
    _outcomes[scene.session_uid] = Outcome(text, problem, notices)
    redraw()


def reports_of(scene: Any) -> list[StageReport]:
    """What the stages took that ran in this session."""
    return list(_reports.get(scene.session_uid, []))


def forget_scene(uid: int) -> None:
    """The scene's room was put aside: what was told of it does not hold any more."""
    _outcomes.pop(uid, None)
    _reports.pop(uid, None)


def make_run(scene: Any) -> tuple[Run, ResolvedScene]:
    """A run for the scene's picture, memory and settings.

    Raises:
        RoomError: there is no picture, memory cannot be read, or the model's settings are not complete.
    """
    notices = own_room.prepare(scene)
    picture = room_memory.picture_of(scene)
    if picture is None:
        raise reference.missing(scene)
    backend = ResolvedScene(scene)
    backend.notices += notices
    memory = room_memory.copy_of(room_memory.memory_of(scene))
    memory.settings = properties.memory_settings(scene.code_as_room, memory.settings)
    journal = journals.journal_of(picture.sha256)
    spent = memory.cost()[2]
    client, painter = clients.room_client(picture.sha256, spent), painters.room_painter(picture.sha256, spent)
    shelf, painted = asset_shelf.shelf(), painters.painted_images() if painter is not None else None
    run = Run(picture, memory, client, backend, journal=journal, shelf=shelf, painter=painter, painted=painted)
    return run, backend


def start(
    scene: Any,
    stages: Sequence[Stage],
    again: bool = False,
    fresh: bool = False,
    only: frozenset[str] | None = None,
    step: str = "",
    derived: frozenset[str] = frozenset(),
    redo: frozenset[str] = frozenset(),
) -> Job:
    """Begin a job; `run_blocking` or the window's timer takes it to its end.

    Args:
        again: run the stages even where they are done.
        fresh: ask again even where memory holds an answer.
        only: ids of the objects that are to be done anew, None for all.
        step: name of the one undo step of all stages together, "" for one a stage.
        derived: ids of the stages that are answered from the draft.
        redo: ids of the stages that are run even where they are done.

    Raises:
        RoomError: another job is on its way, or as `make_run`.
    """
    if _job is not None:
        raise RoomError("Another run is going on.", "Wait for it, or stop it.")
    run, backend = make_run(scene)
    drafted = ways.deriving(run) if derived else run.client
    todo = [Todo(s, drafted if s.id in derived else run.client, again or s.id in redo, fresh, only) for s in stages]
    return _begin(scene, run, backend, todo, step)


def start_refining(scene: Any, steps: Sequence[Step], name: str) -> Job:
    """Begin a job that asks for what these steps say; all that follows is answered from the draft. One undo step.

    Raises:
        RoomError: as `start`.
    """
    if _job is not None:
        raise RoomError("Another run is going on.", "Wait for it, or stop it.")
    run, backend = make_run(scene)
    return _begin(scene, run, backend, refining(steps, all_stages(), run.client, ways.deriving(run)), name)


def _begin(scene: Any, run: Run, backend: ResolvedScene, todo: list[Todo], step: str) -> Job:
    global _job
    bring_up_to_date(run)  # a known size may have been changed while another run was going on
    uid = scene.session_uid

    def stage_done(title: str) -> None:
        view_state.forget_failure(uid, job.progress.stage)
        _follow_camera(uid)
        if not step or job.is_last:
            _push_undo(f"Room: {step or title}")
        else:
            job.wrote = True  # else undoing what the artist does next would take it along, were the job stopped now
        _refresh(uid)

    for item in todo:
        view_state.forget_failure(uid, item.stage.id)
    durations = Durations(clients.user_folder())
    job = _job = Job(run, backend, todo, stage_done, durations)
    _outcomes.pop(uid, None)
    return job


def run_in_window() -> None:
    """Let Blender's timer take the job to its end."""
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0.0)
    redraw()


def run_blocking() -> Outcome:
    """Take the job to its end here and now."""
    job = _job
    if job is None:
        return Outcome("Nothing to run")
    try:
        while job.tick(BUDGET):
            job.wait(_PATIENCE)
    except BaseException:  # a keyboard interrupt in background mode
        job.stop()
        _finish(job)
        raise
    return _finish(job)


def stop() -> None:
    """Stop the job that is on its way."""
    if _job is not None:
        _job.stop()
        redraw()


def cancel_for_load() -> None:
    """Drop the job and all that belongs to the present file, before Blender loads another."""
    global _job
    if _job is not None:
        _job.drop()
    _job = None
    _outcomes.clear()
    _reports.clear()
    late.forget_all()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)


def _tick() -> float | None:
    """The timer. Nothing may be raised here: Blender would end the timer and the job would hang."""
    job = _job
    if job is None:
        return None
    try:
        if job.tick(BUDGET):
            _redraw_on_change(job.progress)
            return INTERVAL
        _finish(job)
    except Exception as error:
        log.exception("The run ended unexpectedly")
        job.drop()
        _give_up(job, error)
    redraw()
    return None


def _give_up(job: Job, error: Exception) -> None:
    """The run cannot even be ended as it should be; Blender and the panel go on."""
    global _job
    _job = None
    _outcomes[job.scene_uid] = Outcome("The run failed", view_state.Problem.of(error))


def _finish(job: Job) -> Outcome:
    """Take the job's result over into what the panel shows."""
    global _job
    if _job is job:
        _job = None
    uid, progress = job.scene_uid, job.progress
    seconds = time.monotonic() - progress.began
    done = f"{job.stages_done} stage{'' if job.stages_done == 1 else 's'} in {seconds:.1f} s"
    if job.error is None:
        outcome = Outcome(f"Done: {done}" if job.stages_done else "Nothing to do: every stage is done")
    elif job.error is job.cut:
        stopped = isinstance(job.cut, Cancelled)
        text = "Stopped. What stands is kept as the draft" if stopped else "The draft broke off. What stands is kept"
        outcome = Outcome(text, None if stopped else view_state.Problem.of(job.error))
    elif isinstance(job.error, Cancelled):
        outcome = Outcome("Stopped. What was answered is kept")
    elif isinstance(job.error, NotApplied):
        outcome = Outcome("", view_state.Problem.of(job.error))
    else:
        view_state.note_failure(uid, progress.stage, job.error)
        outcome = Outcome(f"{progress.title or 'The run'} failed", view_state.Problem.of(job.error))
    replaced = replaced_answers(job.run.memory, [report.stage for report in job.run.reports])
    outcome = replace(outcome, notices=(*job.backend.notices, *(finding.message for finding in replaced)))
    _outcomes[uid] = outcome
    _reports.setdefault(uid, []).extend(job.run.reports)
    if job.wrote and not in_hand():
        # Else undoing what the artist does next would take what was answered along.
        _push_undo("Room: Answers")
    if scene_by_uid(uid) is None and bpy.context.scene is not None:
        _outcomes[bpy.context.scene.session_uid] = outcome  # where it can be seen
    late.look_after(job)
    _refresh(uid)
    return outcome


def keep_answers() -> None:
    """Write into the file what was answered so far, as before it is saved. Never raises."""
    if _job is not None:
        _job.keep_answers()


def _refresh(uid: int) -> None:
    scene = next((s for s in bpy.data.scenes if s.session_uid == uid), None)
    if scene is not None:
        view_state.refresh(scene)


def _follow_camera(uid: int) -> None:
    """The camera that the artist looks through stands where the stage fitted it."""
    from . import fitted_view

    scene = next((s for s in bpy.data.scenes if s.session_uid == uid), None)
    if scene is not None:
        fitted_view.follow(scene)


def _push_undo(message: str) -> None:
    """One undo step a stage: the scene's objects and the memory text together."""
    if not bpy.app.background:
        bpy.ops.ed.undo_push(message=message)


def _redraw_on_change(progress: Progress) -> None:
    """Redraw only when the panel would look different: at once on news, once a second for the clock and small talk."""
    global _shown
    seconds = int(time.monotonic() - progress.began)
    calls = progress.calls_open, progress.calls_done
    news = (progress.stage, progress.what, progress.step, progress.stopping, calls, seconds, DESK.waiting)
    if news != _shown:
        _shown = news
        redraw()


def redraw() -> None:
    """Redraw the sidebars of all 3D views in all windows that show our tab, and the status bars while a run goes on."""
    manager: Any = bpy.context.window_manager
    for window in manager.windows if manager is not None else ():
        for area in window.screen.areas:
            if area.type != "VIEW_3D" or not area.spaces.active.show_region_ui:
                continue
            for region in area.regions:
                if region.type == "UI" and getattr(region, "active_panel_category", TAB) in (TAB, "UNSUPPORTED"):
                    region.tag_redraw()
