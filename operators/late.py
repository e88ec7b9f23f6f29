# SPDX-License-Identifier: GPL-3.0-or-later
"""What is left to do after a job is over: its worker's late answers are kept, and a room that could not be put back
because the artist was in Edit mode is put back when that is possible."""

from __future__ import annotations

import logging

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.memory import dump_memory
from . import driver, room_memory, view_state
from .job import Job
from .meanwhile import missing_answers
from .scene_backend import scene_by_uid

log = logging.getLogger(__name__)
INTERVAL = 0.5
_jobs: list[Job] = []


def look_after(job: Job) -> None:
    """Take care of what a job that is over left behind; nothing when it left nothing."""
    if job.leaves_worker or job.must_put_back:
        _jobs.append(job)
        if not bpy.app.background and not bpy.app.timers.is_registered(_tick):
            bpy.app.timers.register(_tick, first_interval=INTERVAL)


def forget_all() -> None:
    """Another file is opened."""
    _jobs.clear()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)


def _tick() -> float | None:
    try:
        pump()
    except Exception:
        log.exception("What a run left behind could not be tidied")
        _jobs.clear()
    return INTERVAL if _jobs else None


def pump() -> None:
    """Do what can be done now. Never while another run goes on: it has the room, and what it asks is in the journal."""
    if driver.is_running():
        return
    for job in list(_jobs):
        try:
            if not job.leaves_worker and job.settle():
                _jobs.remove(job)
                _keep_answers(job)
        except RoomError as error:
            log.info("A run's leftovers: %s", error)
            _jobs.remove(job)


def _keep_answers(job: Job) -> None:
    """Answers that came after the stop go to memory; nothing else of the stage does."""
    scene = scene_by_uid(job.scene_uid)
    if scene is None:
        return
    memory = room_memory.copy_of(room_memory.memory_of(scene))
    missing = missing_answers(job.run.memory, memory)
    if not missing or memory.picture_hash not in ("", job.run.picture.sha256):
        return
    memory.entries += missing
    memory.picture_hash, memory.picture_name = job.run.memory.picture_hash, job.run.memory.picture_name
    job.backend.save_memory(dump_memory(memory))
    job.backend.flush()
    number = "An answer" if len(missing) == 1 else f"{len(missing)} answers"
    driver.note_outcome(scene, f"{number} came after the stop: kept, not applied. The next run uses it")
    view_state.refresh(scene)
