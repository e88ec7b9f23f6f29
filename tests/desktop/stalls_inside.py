# SPDX-License-Identifier: GPL-3.0-or-later
"""What `stalls.py` does inside Blender's window: it runs every stage and notes each gap of a 10 ms timer.

A gap belongs to the work of the add-on on the main thread that took most of it; where that was little, Blender itself
was drawing, and the gap is told as "Blender draws" with what the job was waiting for. Beside the wall clock the
processor time of the add-on's own work on the main thread is noted, which other programs on the computer do not stretch.
"""

from __future__ import annotations

import cProfile
import importlib.util
import io
import json
import os
import pstats
import shutil
import subprocess
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import addon_utils
import bpy

MODULE = "bl_ext.user_default.code_as_room"
RESULTS = Path(os.environ["STALLS_RESULTS"])
SHOTS = os.environ.get("STALLS_SHOTS", "")
PROFILING = bool(os.environ.get("STALLS_PROFILE"))

gaps: dict[str, list[tuple[float, float, float]]] = {}
spans: list[tuple[str, float, float, float]] = []
works: dict[str, list[tuple[float, float]]] = {}
last: list[float] = []
numbers: dict[str, Any] = {}
phase_of_test = ["idle"]
profile = cProfile.Profile()


def part(name: str) -> Any:
    """A module of the installed add-on."""
    return importlib.import_module(f"{MODULE}.{name}")


def waiting_for() -> str:
    """What the job is waiting for while Blender's main loop is free."""
    job = part("operators.driver")._job
    if job is None:
        return phase_of_test[0]
    what = getattr(job, "phase", None)
    if what is None:
        wish = type(job._session.wish).__name__ if job._session is not None else "start"
        what = "waiting for the model" if wish == "Ask" else f"worker: {wish}"
    return str(what)


def beat() -> float:
    """The timer: notes the gap, and whose it was."""
    now = time.perf_counter()
    if last:
        began = last[0]
        ours = [(name, min(end, now) - max(start, began)) for name, start, end, _ in spans if end > began]
        # One span may lie in another, such as a stage's end in a tick.
        total = max((seconds for _, seconds in ours), default=0.0)
        busy = max((cpu for *_, cpu in spans), default=0.0)
        gap = now - began
        if ours and total > 0.4 * gap:
            name = min((o for o in ours if o[1] > 0.6 * total), key=lambda item: item[1])[0]
        else:
            name = waiting_for()
            if gap > 0.03:
                name = "Blender draws, during: " + name
        gaps.setdefault(name, []).append((gap, total, busy))
    spans.clear()
    last[:] = [now]
    return 0.01


def spanned(owner: Any, name: str, label: Callable[..., str]) -> None:
    """Note how long every call of a function takes on the main thread."""
    import threading

    inner = getattr(owner, name, None)
    if inner is None:
        return

    def outer(*args: Any, **options: Any) -> Any:
        if threading.current_thread() is not threading.main_thread():
            return inner(*args, **options)
        began, cpu = time.perf_counter(), time.thread_time()
        try:
            return inner(*args, **options)
        finally:
            now, name = time.perf_counter(), label(*args)
            spans.append((name, began, now, time.thread_time() - cpu))
            works.setdefault(name, []).append((now - began, time.thread_time() - cpu))

    setattr(owner, name, outer)


def watch() -> None:
    """Put the clocks in."""
    driver, job, run = part("operators.driver"), part("operators.job"), part("pipeline.run")
    steps: dict[str, int] = {}

    def counted(kind: str, wish: Any) -> str:
        kind = type(wish).__name__ if wish is not None else kind
        steps[kind] = steps.get(kind, 0) + 1
        return kind if kind == "Tell" else f"{kind} {steps[kind]}"

    labels: list[str] = []
    tick = job.Job.tick

    def noted(self: Any, budget: float) -> bool:
        labels[:] = ["tick: " + getattr(self, "phase", "")]
        return bool(tick(self, budget))

    job.Job.tick = noted
    spanned(driver, "_tick", lambda *_: labels[0] if labels else "tick")
    building = f"{MODULE}.operators.building"
    if importlib.util.find_spec(building) is not None:
        made = part("operators.building").Building
        spanned(made, "step", lambda *_: "build: a slice")
        spanned(made, "commit", lambda *_: counted("build: commit", None))
    spanned(driver, "_finish", lambda *_: "end of the run")
    if PROFILING:
        spanned_profile(driver, "_tick")
    spanned(run.StageSession, "act", lambda self, wish: counted("", wish))
    spanned(driver, "_push_undo", lambda *_: "undo step")
    spanned(driver, "_refresh", lambda *_: "panel refresh")
    spanned(run.Run, "take_over_edits", lambda *_: "read back")


def spanned_profile(owner: Any, name: str) -> None:
    """Profile every call of a function."""
    inner = getattr(owner, name)

    def outer(*args: Any, **options: Any) -> Any:
        profile.enable()
        try:
            return inner(*args, **options)
        finally:
            profile.disable()

    setattr(owner, name, outer)


def shoot(name: str) -> None:
    """A screenshot, when they were asked for."""
    if SHOTS and shutil.which("scrot"):
        Path(SHOTS).mkdir(parents=True, exist_ok=True)
        subprocess.run(["scrot", "--overwrite", f"{SHOTS}/{name}.png"], check=False, timeout=30)
        last[:] = [time.perf_counter()]
        spans.clear()


def call(verb: Callable[..., Any], *args: Any, **options: Any) -> Any:
    """Call an operator as a click in the sidebar would."""
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
    region = next(r for r in area.regions if r.type == "UI")
    with bpy.context.temp_override(window=window, area=area, region=region):
        return verb(*args, **options)


def until_idle(limit: float = 300.0) -> Iterator[float]:
    """Wait for the end of the run."""
    began = time.monotonic()
    while part("operators.driver").is_running():
        if time.monotonic() - began > limit:
            raise TimeoutError("the run did not end")
        yield 0.05


def steps() -> Iterator[float]:
    """The measurement."""
    yield from blender_alone()
    addon_utils.enable(MODULE, default_set=True)
    yield 3.0
    preferences = bpy.context.preferences.addons[MODULE].preferences
    preferences.provider, preferences.base_url, preferences.model = "OPENAI", os.environ["STALLS_URL"], "prepared"
    for obj in list(bpy.context.scene.objects):
        bpy.data.objects.remove(obj)
    area = next(a for a in bpy.context.window_manager.windows[0].screen.areas if a.type == "VIEW_3D")
    area.spaces.active.show_region_ui = True
    yield 1.0
    next(r for r in area.regions if r.type == "UI").active_panel_category = "Room"
    yield 1.0
    driver = part("operators.driver")
    call(bpy.ops.code_as_room.load_picture, filepath=os.environ["STALLS_PICTURE"])
    yield 2.0
    watch()
    bpy.app.timers.register(beat, persistent=True)
    yield 2.0
    call(bpy.ops.code_as_room.run_all, "INVOKE_DEFAULT")
    yield 0.5
    shoot("waiting")
    yield from until_idle()
    numbers["load of the computer"] = os.getloadavg()[0]
    outcome = driver.outcome_of(bpy.context.scene)
    numbers["outcome"] = f"{outcome.text} {outcome.problem or ''}"
    numbers["objects in the scene"] = sum(o.get("code_as_room_kind") == "proxy" for o in bpy.context.scene.objects)
    phase_of_test[0] = "idle afterwards"
    yield 1.5
    shoot("done")
    last[:] = [time.perf_counter()]
    # The same again from the answers that are kept: builds and renders without waiting.
    call(bpy.ops.code_as_room.run_stage, "INVOKE_DEFAULT", stage="s03_layout")
    yield from until_idle()
    call(bpy.ops.code_as_room.run_stage, "INVOKE_DEFAULT", stage="s04_auxiliary")
    yield from until_idle()
    yield 1.0
    # A service that sends nothing.
    preferences.model = "silent"
    call(bpy.ops.code_as_room.run_stage, "INVOKE_DEFAULT", stage="s01_analysis", fresh=True)
    yield 3.0
    assert driver.is_running(), driver.outcome_of(bpy.context.scene)
    began = time.monotonic()
    call(bpy.ops.code_as_room.stop)
    yield from until_idle()
    numbers["seconds to stop while the service is silent"] = round(time.monotonic() - began, 2)
    numbers["a run can begin again"] = bool(call(bpy.ops.code_as_room.run_stage.poll))
    bpy.app.timers.unregister(beat)


def table() -> list[dict[str, Any]]:
    """A row a phase: how many gaps, the longest, the 99th percentile, and how much of the longest was our own work."""
    rows = []
    for name, found in gaps.items():
        lengths = sorted(gap for gap, *_ in found)
        p99 = lengths[min(len(lengths) - 1, int(0.99 * len(lengths)))]
        row = {"phase": name, "count": len(found), "longest": lengths[-1] * 1000, "p99": p99 * 1000}
        ours, cpu = max(o for _, o, _ in found), max(c for *_, c in found)
        rows.append({**row, "ours": ours * 1000, "cpu": cpu * 1000})
    return sorted(rows, key=lambda row: row["phase"])


def own_work() -> list[dict[str, Any]]:
    """A row for each kind of work of the add-on on the main thread: how often, and the longest."""
    return [
        {"work": name, "count": len(t), "wall": max(w for w, _ in t) * 1000, "cpu": max(c for _, c in t) * 1000}
        for name, t in sorted(works.items())
    ]


def blender_alone() -> Iterator[float]:
    """What Blender needs without us for drawing: a word in the status bar, the sidebar, an object that moved."""
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
    cube = bpy.context.scene.objects[0]
    verbs: dict[str, Callable[[], Any]] = {
        "a word in the status bar": lambda: window.workspace.status_text_set("a word"),
        "the sidebar": lambda: next(r for r in area.regions if r.type == "UI").tag_redraw(),
        "the default cube moved": lambda: setattr(cube, "location", (0.1, 0, 0)),
    }
    yield 3.0
    for name, verb in verbs.items():
        verb()
        began = time.perf_counter()
        yield 0.0
        yield 0.0
        numbers[f"Blender alone, {name}, ms"] = round((time.perf_counter() - began) * 1000)
        yield 2.0 if "cube" not in name else 8.0
    window.workspace.status_text_set(None)


def drive() -> float | None:
    """The timer that takes the measurement from step to step."""
    error = ""
    try:
        return next(TEST)
    except StopIteration:
        pass
    except BaseException:
        error = traceback.format_exc()
    if PROFILING:
        out = io.StringIO()
        pstats.Stats(profile, stream=out).sort_stats("cumulative").print_stats(70)
        numbers["profile"] = out.getvalue()
    RESULTS.write_text(
        json.dumps({"table": table(), "work": own_work(), "numbers": numbers, "error": error}), encoding="utf-8"
    )
    bpy.ops.wm.quit_blender()
    return None


bpy.context.preferences.view.show_splash = False
TEST = steps()
bpy.app.timers.register(drive, first_interval=1.0, persistent=True)
