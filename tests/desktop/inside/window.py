# SPDX-License-Identifier: GPL-3.0-or-later
"""What the steps of the window test share: looking at Blender, calling verbs, waiting, measuring, taking screenshots."""

from __future__ import annotations

import importlib
import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy

MODULE = os.environ.get("CODE_AS_ROOM_MODULE", "bl_ext.user_default.code_as_room")
SHOTS = Path(os.environ["CODE_AS_ROOM_SHOTS"])
PICTURE = os.environ["CODE_AS_ROOM_PICTURE"]
SAVED = str(SHOTS / "saved.blend")
REPLIES = os.environ.get("CODE_AS_ROOM_REPLIES", "")
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


def until(what: str, holds: Callable[[], bool], limit: float = 60.0) -> Iterator[float]:
    """Wait until something holds; TimeoutError names it when it never does."""
    began = time.monotonic()
    while not holds():
        if time.monotonic() - began > limit:
            raise TimeoutError(f"it never came to this: {what}")
        yield 0.1


def preferences() -> Any:
    """The add-on's preferences."""
    return bpy.context.preferences.addons[MODULE].preferences


def object_of(identifier: str) -> Any:
    """The scene's object of a proxy."""
    return next(o for o in bpy.context.scene.objects if o.get("code_as_room_id") == identifier)


def first_proxy(category: str) -> Any:
    """The first proxy of a category."""
    names = (o for o in bpy.context.scene.objects if str(o.get("code_as_room_id", "")).startswith(category))
    return next(names)
