# SPDX-License-Identifier: GPL-3.0-or-later
"""The one way in which operators and properties correct a room: change the corrections, and everything follows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

from ..pipeline.artifacts.analysis import Finding
from ..pipeline.artifacts.corrections import Corrections
from ..pipeline.errors import RoomError
from ..pipeline.run import Run
from ..pipeline.run_corrections import bring_up_to_date, correct, corrections_of
from . import driver, own_room, room_memory, view_state
from .scene_backend import ResolvedScene


def apply(scene: Any, change: Callable[[Corrections], Corrections]) -> list[Finding]:
    """Correct the room of a scene. Asks no model, works without a window; main thread only.

    The caller pushes the undo step. What there is to say of the correction comes back, and is in memory too.

    Args:
        change: from the corrections as they stand to those that shall stand.

    Raises:
        RoomError: a run is going on, there is no picture, Blender is in Edit mode, or the corrections cannot be;
            nothing was changed.
    """
    run = _ready(scene)
    before = corrections_of(run.memory)
    after = change(before)
    findings = [] if after == before else correct(run, after)
    return _done(scene, run, findings)


def follow_settings(scene: Any) -> list[Finding]:
    """After a known size was changed in the scene's settings: the room takes it on at once. As `apply`."""
    run = _ready(scene)
    return _done(scene, run, bring_up_to_date(run))


def _ready(scene: Any) -> Run:
    if driver.is_running():
        raise RoomError("A run is going on.", "Wait for it, or stop it; then correct.")
    if bpy.context.mode not in ("OBJECT", ""):
        raise RoomError("The room cannot follow a correction in Edit mode.", "Go back to Object mode first.")
    own_room.prepare(scene)
    return room_memory.run_of(scene)


def _done(scene: Any, run: Run, findings: list[Finding]) -> list[Finding]:
    from . import fitted_view

    if isinstance(run.backend, ResolvedScene):
        run.backend.flush()
    fitted_view.follow(scene)
    view_state.refresh(scene)
    driver.redraw()
    return findings
