# SPDX-License-Identifier: GPL-3.0-or-later
"""Started in Blender's window by `take_screenshots.py`: sets the scene for each picture and takes it."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))

import basics
from window import (
    MODULE,
    PAUSE,
    PICTURE,
    REPLIES,
    call,
    first_proxy,
    part,
    preferences,
    shoot,
    show_tab,
    until_idle,
    view,
)


def in_view(verb: object, **options: object) -> None:
    """Call a view operator in the 3D view's main region."""
    window, area, _ = view()
    region = next(r for r in area.regions if r.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        verb(**options)  # type: ignore[operator]


def look_down(distance: float = 9.0, tilt: float = 0.62, turn: float = 0.55) -> None:
    """A raised view into the room."""
    from mathutils import Euler

    space = view()[1].spaces.active.region_3d
    space.view_perspective = "PERSP"
    space.view_rotation = Euler((tilt, 0.0, turn)).to_quaternion()
    space.view_location, space.view_distance = (0.9, 0.0, 0.6), distance


def steps() -> Iterator[float]:
    """Load, run, edit, look."""
    yield from basics.enable()
    preferences().replies_folder, preferences().provider = REPLIES, "RECORDED"
    call(bpy.ops.code_as_room.load_picture, filepath=PICTURE)
    yield 1.5
    view()[1].spaces.active.shading.color_type = "MATERIAL"
    look_down()
    driver = part("operators.driver")
    call(bpy.ops.code_as_room.run_all, "INVOKE_DEFAULT")
    taken = False
    while driver.is_running():
        progress = driver.progress_of(bpy.context.scene)
        if not taken and progress is not None and progress.number >= 3 and progress.step >= 2:
            taken = True
            shoot("sidebar-running")
        yield 0.1
    yield 1.0
    look_down(7.0)
    bed = first_proxy("bed")
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    bed.select_set(True)
    bpy.context.view_layer.objects.active = bed
    bed.location.x += 0.35
    bpy.context.view_layer.update()
    call(bpy.ops.ed.undo_push, message="Move")
    call(bpy.ops.code_as_room.run_stage, "INVOKE_DEFAULT", stage="s04_auxiliary")
    yield from until_idle()
    yield 1.0
    show_tab()
    shoot("hand-editing")
    in_view(bpy.ops.object.select_all, action="DESELECT")
    call(bpy.ops.ed.undo)
    call(bpy.ops.ed.undo)
    yield PAUSE
    look_down(6.2, 0.75)
    yield 1.0
    shoot("result")


def drive() -> float | None:
    """The timer."""
    try:
        return next(TEST)
    except StopIteration:
        pass
    except BaseException:
        traceback.print_exc()
    bpy.ops.wm.quit_blender()
    return None


bpy.context.preferences.view.show_splash = False
assert MODULE
TEST = steps()
bpy.app.timers.register(drive, first_interval=1.0, persistent=True)
