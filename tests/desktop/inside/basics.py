# SPDX-License-Identifier: GPL-3.0-or-later
"""Enable, load the picture, run every stage, stop one."""

from __future__ import annotations

import time
from collections.abc import Iterator

import addon_utils
import bpy
from window import (
    MODULE,
    PAUSE,
    PICTURE,
    REPLIES,
    call,
    check,
    gaps,
    look_from_above,
    part,
    preferences,
    results,
    room_objects,
    shoot,
    show_tab,
    start_measuring,
    statuses,
    time_main_thread,
    until,
    until_idle,
    view,
)


def enable() -> Iterator[float]:
    """Enable the installed extension, and choose who answers."""
    began = time.perf_counter()
    addon_utils.enable(MODULE, default_set=True)
    results["numbers"]["seconds to enable"] = round(time.perf_counter() - began, 3)
    yield from until("everything is registered", lambda: hasattr(bpy.types.Scene, "code_as_room"))
    results["numbers"]["seconds until everything is registered"] = round(time.perf_counter() - began, 3)
    check("the add-on is enabled", MODULE in bpy.context.preferences.addons)
    if REPLIES:
        preferences().replies_folder = REPLIES
        preferences().provider = "RECORDED"
    for obj in list(bpy.context.scene.objects):
        bpy.data.objects.remove(obj)
    yield PAUSE
    view()[1].spaces.active.show_region_ui = True
    yield 1.0
    show_tab()
    yield PAUSE
    shoot("1_empty")
    check("nothing can run without a picture", not call(bpy.ops.code_as_room.run_all.poll))


def load() -> Iterator[float]:
    """Load the picture."""
    call(bpy.ops.code_as_room.load_picture, filepath=PICTURE)
    yield 1.5
    check("the picture is there", bool(bpy.context.scene.code_as_room.picture))
    shoot("2_picture")


def run_all() -> Iterator[float]:
    """Run to the end, with a picture in the middle of each stage."""
    driver = part("operators.driver")
    start_measuring()
    time_main_thread()
    began = time.monotonic()
    call(bpy.ops.code_as_room.run_all, "INVOKE_DEFAULT")
    check("the button returns at once", driver.is_running())
    shot = 0
    while driver.is_running() and time.monotonic() - began < 400:
        progress = driver.progress_of(bpy.context.scene)
        if progress is not None and progress.number > shot and progress.what not in ("", "Starting"):
            shot = progress.number
            yield 0.15
            shoot(f"3_running_{shot}")
        yield 0.1
    results["numbers"]["seconds of the run"] = round(time.monotonic() - began, 1)
    results["numbers"]["longest stalls, ms"] = [round(g * 1000) for g in sorted(gaps)[-8:]]
    outcome = driver.outcome_of(bpy.context.scene)
    results["numbers"]["outcome"] = outcome.text if outcome else ""
    check("the run ends without a problem", outcome is not None and outcome.problem is None)
    check("every stage is done", bool(statuses()) and set(statuses()) == {"done"})
    check("the room stands in the scene", room_objects() > 5)
    look_from_above()
    yield 1.0
    shoot("4_done")


def stop() -> Iterator[float]:
    """Stop in the middle of a stage that asks again: the built-in analysis takes a few seconds."""
    driver = part("operators.driver")
    before = preferences().provider
    preferences().provider = "BUILTIN"
    call(bpy.ops.code_as_room.run_stage, "INVOKE_DEFAULT", stage="s01_analysis", fresh=True)
    yield 0.8
    check("a stage that asks again is running", driver.is_running())
    began = time.monotonic()
    call(bpy.ops.code_as_room.stop)
    yield from until_idle()
    results["numbers"]["seconds to stop"] = round(time.monotonic() - began, 2)
    preferences().provider = before
    outcome = driver.outcome_of(bpy.context.scene)
    check("stop stops", outcome is not None and outcome.text.startswith("Stopped"))
    check("what was done stays done", set(statuses()) == {"done"})
    yield PAUSE
    shoot("6_stopped")
