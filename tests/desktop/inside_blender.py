# SPDX-License-Identifier: GPL-3.0-or-later
"""What `run_panel.py` does inside Blender's window: a generator that a timer drives, so that Blender draws between steps."""

from __future__ import annotations

import importlib
import json
import os
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
SHOTS = Path(os.environ["CODE_AS_ROOM_SHOTS"])
PICTURE = os.environ["CODE_AS_ROOM_PICTURE"]
SAVED = str(SHOTS / "saved.blend")
PAUSE = 0.4
"""Seconds that Blender has for drawing after a step."""

results: dict[str, Any] = {"checks": {}, "numbers": {}, "error": ""}
gaps: list[float] = []
last_beat: list[float] = []


def part(name: str) -> Any:
    """A module of the installed add-on."""
    return importlib.import_module(f"{MODULE}.{name}")


def check(name: str, held: bool) -> None:
    """Note whether something held."""
    results["checks"][name] = bool(held)


def time_main_thread() -> None:
    """Note how long each wish that needs Blender's main thread takes."""
    session = part("pipeline.run").StageSession
    act, took = session.act, results["numbers"].setdefault("main thread, ms", [])

    def timed(self: Any, wish: Any) -> Any:
        began = time.perf_counter()
        try:
            return act(self, wish)
        finally:
            took.append(f"{type(wish).__name__} {(time.perf_counter() - began) * 1000:.0f}")

    session.act = timed


def beat() -> float:
    """Measures for how long Blender's main loop stood still."""
    now = time.perf_counter()
    if last_beat:
        gaps.append(now - last_beat[0])
    last_beat[:] = [now]
    return 0.01


def start_measuring() -> None:
    """From here on."""
    gaps.clear()
    last_beat.clear()
    if not bpy.app.timers.is_registered(beat):
        bpy.app.timers.register(beat, persistent=True)


def view() -> tuple[Any, Any, Any]:
    """Window, 3D view and its sidebar."""
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
    return window, area, next(r for r in area.regions if r.type == "UI")


def show_tab() -> None:
    """Open the sidebar at the tab "Room", and make room for it."""
    _, area, sidebar = view()
    area.spaces.active.show_region_ui = True
    if sidebar.active_panel_category != "Room":
        sidebar.active_panel_category = "Room"


def shoot(name: str) -> None:
    """A screenshot of the screen with `scrot` where there is one; Blender's own comes out black without a graphics card."""
    path = str(SHOTS / f"{name}.png")
    if shutil.which("scrot") and os.environ.get("DISPLAY"):
        subprocess.run(["scrot", "--overwrite", path], check=False, timeout=30)
        last_beat.clear()  # our own waiting is no stall of the add-on
        return
    window, area, sidebar = view()
    with bpy.context.temp_override(window=window, area=area, region=sidebar):
        bpy.ops.screen.screenshot(filepath=path)


def look_from_above() -> None:
    """Show the room as an artist would look at it."""
    window, area, _ = view()
    region = next(r for r in area.regions if r.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.view_all()


def statuses() -> list[str]:
    """What the panel says of each stage."""
    state = part("operators.view_state").peek(bpy.context.scene)
    return [row.status for row in state.stages] if state else []


def room_objects() -> int:
    """How many proxies stand in the scene."""
    return sum("code_as_room_id" in o for o in bpy.context.scene.objects)


def call(verb: Callable[..., Any], *args: Any, **options: Any) -> Any:
    """Call an operator as a click in the 3D view would."""
    window, area, sidebar = view()
    with bpy.context.temp_override(window=window, area=area, region=sidebar):
        return verb(*args, **options)


def until_idle(limit: float = 200.0) -> Iterator[float]:
    """Wait for the end of the run."""
    began = time.monotonic()
    while part("operators.driver").is_running():
        if time.monotonic() - began > limit:
            raise TimeoutError("the run did not end")
        yield 0.1


def steps() -> Iterator[float]:
    """The test itself."""
    ops = bpy.ops
    began = time.perf_counter()
    addon_utils.enable(MODULE, default_set=True)
    results["numbers"]["seconds to enable"] = round(time.perf_counter() - began, 2)
    check("the add-on is enabled", MODULE in bpy.context.preferences.addons)
    for obj in list(bpy.context.scene.objects):
        bpy.data.objects.remove(obj)
    yield PAUSE
    view()[1].spaces.active.show_region_ui = True
    yield 1.0
    show_tab()
    yield PAUSE
    shoot("1_empty")
    driver = part("operators.driver")
    check("nothing can run without a picture", not call(ops.code_as_room.run_all.poll))

    call(ops.code_as_room.load_picture, filepath=PICTURE)
    yield 1.5
    shoot("2_picture")
    yield from run_all(ops, driver)
    yield from undo_and_redo(ops)
    yield from stop(ops, driver)
    yield from results_and_reload(ops)


def run_all(ops: Any, driver: Any) -> Iterator[float]:
    """Run to the end, with a picture in the middle."""
    start_measuring()
    time_main_thread()
    began = time.monotonic()
    call(ops.code_as_room.run_all, "INVOKE_DEFAULT")
    check("the button returns at once", time.monotonic() - began < 1.0)
    shot = 0
    while driver.is_running() and time.monotonic() - began < 200:
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


def undo_and_redo(ops: Any) -> Iterator[float]:
    """One undo step a stage: scene and memory go back together."""
    before = room_objects()
    call(ops.ed.undo)
    yield PAUSE
    check("undo takes the last stage back", statuses()[-1] == "not run" and set(statuses()[:-1]) == {"done"})
    shoot("5_undone")
    call(ops.ed.redo)
    yield PAUSE
    check("redo brings it back", set(statuses()) == {"done"} and room_objects() == before)


def stop(ops: Any, driver: Any) -> Iterator[float]:
    """Stop in the middle of a stage that asks again."""
    call(ops.code_as_room.run_stage, "INVOKE_DEFAULT", stage="s01_analysis", fresh=True)
    yield 0.8
    check("a stage that asks again is running", driver.is_running())
    began = time.monotonic()
    call(ops.code_as_room.stop)
    yield from until_idle()
    results["numbers"]["seconds to stop"] = round(time.monotonic() - began, 2)
    outcome = driver.outcome_of(bpy.context.scene)
    check("stop stops", outcome is not None and outcome.text.startswith("Stopped"))
    check("what was done stays done", set(statuses()) == {"done"})
    yield PAUSE
    shoot("6_stopped")


def results_and_reload(ops: Any) -> Iterator[float]:
    """Write the results, save, load again: everything is still there."""
    folder = SHOTS / "results"
    call(ops.code_as_room.write_outputs, directory=str(folder))
    written = sorted(p.name for p in folder.iterdir())
    wanted = {"room.py", "room.blend", "scene.json", "memory.json", "report.html", "top.png", "view.png"}
    check("all results are written", wanted <= set(written))
    call(ops.wm.save_as_mainfile, filepath=SAVED)
    call(ops.view2d.scroll_down, page=True)
    yield 1.0
    shoot("7_written")
    ops.wm.open_mainfile(filepath=SAVED)
    yield 1.0
    show_tab()
    yield PAUSE
    check("after loading, every stage is still done", set(statuses()) == {"done"})
    check("after loading, the picture is still there", bool(bpy.context.scene.code_as_room.picture))
    shoot("8_reloaded")
    addon_utils.disable(MODULE, default_set=True)
    check("the add-on can be disabled", not hasattr(bpy.types.Scene, "code_as_room"))
    yield PAUSE


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
