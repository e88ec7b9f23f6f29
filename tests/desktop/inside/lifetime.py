# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the results, save, load again, resume, disable."""

from __future__ import annotations

from collections.abc import Iterator

import addon_utils
import bpy
from window import MODULE, PAUSE, SAVED, SHOTS, call, check, part, room_objects, shoot, show_tab, statuses, until_idle


def results_and_reload() -> Iterator[float]:
    """Everything is still there after the file was saved and loaded."""
    folder = SHOTS / "results"
    call(bpy.ops.code_as_room.write_outputs, directory=str(folder))
    written = sorted(p.name for p in folder.iterdir())
    wanted = {"room.py", "room.blend", "scene.json", "memory.json", "report.html", "top.png", "view.png"}
    check("all results are written", wanted <= set(written))
    before = room_objects()
    call(bpy.ops.wm.save_as_mainfile, filepath=SAVED)
    yield 1.0
    shoot("8_written")
    bpy.ops.wm.open_mainfile(filepath=SAVED)
    yield 1.0
    show_tab()
    yield PAUSE
    check("after loading, every stage is still done", set(statuses()) == {"done"})
    check("after loading, the picture is still there", bool(bpy.context.scene.code_as_room.picture))
    check("after loading, the room still stands", room_objects() == before)
    shoot("9_reloaded")


def resume_after_reload() -> Iterator[float]:
    """A stage that runs again after loading uses the answers that are kept."""
    scene = bpy.context.scene
    edits = part("operators.view_state").peek(scene).hand_edits
    call(bpy.ops.code_as_room.run_stage, "INVOKE_DEFAULT", stage="s04_auxiliary")
    yield from until_idle()
    yield PAUSE
    outcome = part("operators.driver").outcome_of(scene)
    check("after loading, a stage runs again", outcome is not None and outcome.problem is None)
    check(
        "after loading, nothing is read back that was not edited",
        part("operators.view_state").peek(scene).hand_edits == edits,
    )


def disable() -> Iterator[float]:
    """Nothing is left behind."""
    addon_utils.disable(MODULE, default_set=True)
    check("the add-on can be disabled", not hasattr(bpy.types.Scene, "code_as_room"))
    check("no panel is left", not any(n.startswith("CODE_AS_ROOM") for n in dir(bpy.types)))
    yield PAUSE
