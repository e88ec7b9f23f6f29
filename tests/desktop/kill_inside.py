# SPDX-License-Identifier: GPL-3.0-or-later
"""Started in Blender's window by `kill.py`: open or load, run all stages, and tell how it ended, if it gets that far."""

from __future__ import annotations

import importlib
import json
import os
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import addon_utils
import bpy

MODULE = "bl_ext.user_default.code_as_room"
PICTURE, URL, FOLDER = os.environ["KILL_PICTURE"], os.environ["KILL_URL"], Path(os.environ["KILL_FOLDER"])
OPEN, SAVE = os.environ.get("KILL_OPEN", ""), os.environ.get("KILL_SAVE", "")


def part(name: str) -> Any:
    """A module of the installed add-on."""
    return importlib.import_module(f"{MODULE}.{name}")


def tell(name: str, **values: Any) -> None:
    """Leave a file for `kill.py`, whole or not at all."""
    path = FOLDER / name
    path.with_suffix(".part").write_text(json.dumps(values), encoding="utf-8")
    os.replace(path.with_suffix(".part"), path)


def call(verb: Any, *args: Any, **options: Any) -> Any:
    """Call an operator as a click in the 3D view would."""
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
    area.spaces.active.show_region_ui = True
    region = next(r for r in area.regions if r.type == "UI")
    with bpy.context.temp_override(window=window, area=area, region=region):
        return verb(*args, **options)


def found() -> dict[str, Any]:
    """The room as it stands."""
    scene, tags = bpy.context.scene, part("pipeline.scene.tags")
    state, room = part("operators.view_state").refresh(scene), tags.find_room_collection(scene)
    ours = [o for o in bpy.data.objects if tags.ID in o and tags.AWAY not in o]
    inside = set(room.all_objects) if room is not None else set()
    program = room.get("room.py") if room is not None else None
    return {
        "statuses": [row.status for row in state.stages],
        "problem": state.problem.message if state.problem else "",
        "proxies": sum(o.get(tags.KIND) == "proxy" for o in ours),
        "ids twice": len(ours) - len({(o[tags.ID], o.get(tags.PART, "")) for o in ours}),
        "outside": sum(o not in inside for o in ours),
        "rooms": sum(c.get(tags.ROLE) == "room" for c in bpy.data.collections),
        "texts": sorted(t.name for t in bpy.data.texts),
        "program": program.as_string() if program is not None else "",
    }


def steps() -> Iterator[float]:
    """Open, run, tell."""
    addon_utils.enable(MODULE, default_set=True)
    while not hasattr(bpy.types.Scene, "code_as_room"):
        yield 0.02
    preferences = bpy.context.preferences.addons[MODULE].preferences
    preferences.provider = "CUSTOM"
    preferences.base_url, preferences.model = URL, "recorded"
    if OPEN:
        bpy.ops.wm.open_mainfile(filepath=OPEN)
        yield 0.3
    else:
        for obj in list(bpy.context.scene.objects):
            bpy.data.objects.remove(obj)
        call(bpy.ops.code_as_room.load_picture, filepath=PICTURE)
        yield 0.3
    if SAVE:
        bpy.ops.wm.save_as_mainfile(filepath=SAVE)
    opened = found()
    call(bpy.ops.code_as_room.run_all, "INVOKE_DEFAULT")
    tell("running.json", pid=os.getpid(), at=time.time(), opened=opened)
    driver = part("operators.driver")
    while driver.is_running():
        yield 0.05
    outcome = driver.outcome_of(bpy.context.scene)
    said = f"{outcome.text} {outcome.problem.message if outcome.problem else ''}" if outcome else ""
    tell("ended.json", at=time.time(), outcome=said, **found())


def drive() -> float | None:
    """The timer."""
    try:
        return next(TEST)
    except StopIteration:
        pass
    except BaseException:
        tell("error.json", error=traceback.format_exc())
    bpy.ops.wm.quit_blender()
    return None


bpy.context.preferences.view.show_splash = False
TEST = steps()
bpy.app.timers.register(drive, first_interval=0.5, persistent=True)
