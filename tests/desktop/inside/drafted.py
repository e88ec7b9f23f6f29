# SPDX-License-Identifier: GPL-3.0-or-later
"""Started in Blender's window by `drafting.py`: a room is drafted while it is photographed, then stopped and undone."""

from __future__ import annotations

import cProfile
import io
import json
import math
import os
import pstats
import sys
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
from mathutils import Euler

sys.path.insert(0, str(Path(__file__).parent))

import basics
from window import (
    PAUSE,
    PICTURE,
    SHOTS,
    call,
    check,
    gaps,
    last_beat,
    part,
    results,
    room_objects,
    shoot,
    show_tab,
    start_measuring,
    statuses,
    until_idle,
    view,
)

SHOWN = 7
"""Screenshots while it grows."""
late: list[float] = []
ticks: list[tuple[float, float, str]] = []
PROFILING = bool(os.environ.get("CODE_AS_ROOM_PROFILE"))
profiled = [0.0]


def watch() -> None:
    """Note how long it takes from a statement's being heard to its standing, and how long the job holds the main thread."""
    growing, job = part("operators.growing").Growing, part("operators.job").Job
    hear, grow, go_on, tick = growing.hear, growing._grow, growing.go_on, job.tick
    began: dict[str, float] = {}
    moments: list[tuple[int, float]] = []

    def heard(self: Any, text: str) -> None:
        moments.append((len(text), time.perf_counter()))
        hear(self, text)

    def grown(self: Any, text: str) -> None:
        before = self._ready
        grow(self, text)
        if self._ready is not None and self._ready is not before:
            now = time.perf_counter()
            began[self._ready.plan.text] = next((at for length, at in moments if length >= len(text)), now)

    def went_on(self: Any, deadline: float, must_wait: bool) -> bool:
        stands = bool(go_on(self, deadline, must_wait))
        if stands and self.built in began:
            late.append(time.perf_counter() - began.pop(self.built))
        return stands

    def ticked(self: Any, budget: float) -> bool:
        profile = cProfile.Profile() if PROFILING else None
        start, cpu, doing = time.perf_counter(), time.thread_time(), f"{self.progress.title}: {self.phase}"
        try:
            return bool(tick(self, budget) if profile is None else profile.runcall(tick, self, budget))
        finally:
            ticks.append((time.perf_counter() - start, time.thread_time() - cpu, doing))
            if profile is not None and ticks[-1][0] > profiled[0]:
                profiled[0] = ticks[-1][0]
                results["profile"] = told(profile, doing)

    growing.hear, growing._grow, growing.go_on, job.tick = heard, grown, went_on, ticked


def told(profile: cProfile.Profile, doing: str) -> str:
    """What a tick did, the longest first."""
    out = io.StringIO()
    pstats.Stats(profile, stream=out).sort_stats("cumulative").print_stats(40)
    return f"{doing}\n{out.getvalue()}"


def longest(name: str) -> None:
    """Note what was measured since the last time."""
    worst = sorted(gaps, reverse=True)[:3]
    results["numbers"][f"{name}: longest gaps of the window, ms"] = [round(1000 * gap) for gap in worst]
    for number, clock in enumerate(("wall", "processor")):
        slow = sorted(ticks, key=lambda tick: -tick[number])[:5]
        told = [f"{1000 * tick[number]:.0f} {tick[2]}" for tick in slow]
        results["numbers"][f"{name}: longest ticks of the job, ms, {clock}"] = told
    gaps.clear()
    last_beat.clear()
    ticks.clear()


def solid_from_above() -> None:
    """Look into the room as an artist would."""
    window, area, _ = view()
    space = area.spaces.active
    space.shading.type, space.shading.color_type = "SOLID", "MATERIAL"
    space.overlay.show_floor = space.overlay.show_axis_x = space.overlay.show_axis_y = False
    space.region_3d.view_distance, space.region_3d.view_location = 8.5, (0.4, 0.0, 0.6)
    space.region_3d.view_rotation = Euler((math.radians(34), 0.0, math.radians(18))).to_quaternion()


def load() -> Iterator[float]:
    """Load the picture; the way is Draft."""
    call(bpy.ops.code_as_room.load_picture, filepath=PICTURE)
    solid_from_above()
    yield 1.5
    show_tab()
    yield PAUSE
    state = part("operators.view_state").peek(bpy.context.scene)
    check("a draft is the way of this model", state.way == "draft" and state.offers_draft)
    check("the list begins with the draft", state.stages[0].id == "s00_draft")
    scroll(-30)
    yield PAUSE
    shoot("1_before")
    call(bpy.ops.ed.undo_push, message="Loaded")
    watch()


def scroll(steps: int) -> None:
    """Turn the mouse wheel over the sidebar, down where it is negative."""
    window, _, sidebar = view()
    x, y = sidebar.x + sidebar.width // 2, sidebar.y + sidebar.height // 2
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
    for _ in range(abs(steps)):
        window.event_simulate(type="WHEELUPMOUSE" if steps > 0 else "WHEELDOWNMOUSE", value="PRESS", x=x, y=y)


def grow() -> Iterator[float]:
    """Draft the room."""
    start_measuring()
    began = time.monotonic()
    call(bpy.ops.code_as_room.draft_room, "INVOKE_DEFAULT")
    scroll(40)
    shots, seen = 0, -1
    said: list[str] = []
    progress = part("operators.driver").progress_of(bpy.context.scene)
    first = None
    while progress is not None and progress.stage in ("", "s00_draft"):
        count = room_objects()
        if first is None and any("code_as_room_id" in o for o in bpy.context.scene.objects):
            first = time.monotonic() - began
        if progress.what not in said:
            said.append(progress.what)
        if shots < SHOWN and progress.what.endswith(("so far", "stand")) and count >= seen + 5:
            shots, seen = shots + 1, count
            shoot(f"2_growing_{shots}")
        yield 0.2
        progress = part("operators.driver").progress_of(bpy.context.scene)
    longest("drafting")
    results["numbers"]["seconds of drafting"] = round(time.monotonic() - began, 1)
    results["numbers"]["what was said"] = said
    results["numbers"]["from heard to standing, s, longest"] = round(max(late, default=0.0), 2)
    results["numbers"]["from heard to standing, s, middle"] = round(sorted(late)[len(late) // 2], 2) if late else None
    results["numbers"]["builds"] = len(late)
    check("it grew", len(late) > 3)
    results["numbers"]["from heard to standing, s, first"] = round(late[0], 2) if late else None
    yield PAUSE
    shoot("3_drafted")
    yield from until_idle(1500)
    longest("after the draft")
    yield 1.5
    outcome = part("operators.driver").outcome_of(bpy.context.scene)
    results["numbers"]["outcome"] = [outcome.text, outcome.problem.sentence if outcome.problem else "", outcome.notices]
    results["numbers"]["statuses"] = statuses()
    check("every stage is drafted", set(statuses()[1:]) == {"drafted"})
    scroll(-16)
    yield PAUSE
    shoot("4_done")
    call(bpy.ops.code_as_room.refine_all, "INVOKE_DEFAULT")
    yield 1.0
    shoot("4_refine")
    window, _, _ = view()
    window.event_simulate(type="ESC", value="PRESS", x=900, y=500)
    window.event_simulate(type="ESC", value="RELEASE", x=900, y=500)
    yield PAUSE


def undo() -> Iterator[float]:
    """The draft is one step, and each stage after it is one."""
    count, steps = room_objects(), len(statuses())
    names = []
    for _ in range(steps):
        call(bpy.ops.ed.undo)
        yield 0.3
        names.append(statuses())
    yield PAUSE
    shoot("5_undone")
    results["numbers"]["objects before and after undo"] = [count, room_objects()]
    results["numbers"]["statuses while undoing"] = [row.count("drafted") for row in names]
    check("undo takes the whole draft back", room_objects() < count and "drafted" not in names[-1])
    for _ in range(steps):
        call(bpy.ops.ed.redo)
        yield 0.3
    check("redo brings it back", room_objects() == count)


def stop() -> Iterator[float]:
    """Draft again, stop in the middle: what stands stays."""
    call(bpy.ops.code_as_room.draft_room, "INVOKE_DEFAULT")
    driver = part("operators.driver")
    while "so far" not in driver.progress_of(bpy.context.scene).what or room_objects() < 12:
        yield 0.1
    gaps.clear()
    began = time.monotonic()
    call(bpy.ops.code_as_room.stop)
    yield from until_idle(60)
    results["numbers"]["seconds from stop to the end"] = round(time.monotonic() - began, 2)
    yield 1.5
    outcome = driver.outcome_of(bpy.context.scene)
    results["numbers"]["said after the stop"] = outcome.text
    results["numbers"]["objects after the stop"] = room_objects()
    results["numbers"]["statuses after the stop"] = statuses()
    check("what stood at the stop stays", room_objects() >= 12 and "What stands is kept" in outcome.text)
    shoot("6_stopped")


STEPS = (basics.enable, load, grow, undo, stop)


def steps() -> Iterator[float]:
    """All steps, one after the other."""
    for step in STEPS:
        print(f"step: {step.__name__}", flush=True)
        yield from step()


def drive() -> float | None:
    """The timer."""
    try:
        return next(TEST)
    except StopIteration:
        pass
    except BaseException:
        results["error"] = traceback.format_exc()
    (SHOTS / "results.json").write_text(json.dumps(results, indent=1), encoding="utf-8")
    bpy.ops.wm.quit_blender()
    return None


bpy.context.preferences.view.show_splash = False
TEST = steps()
bpy.app.timers.register(drive, first_interval=1.0, persistent=True)
