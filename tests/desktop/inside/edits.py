# SPDX-License-Identifier: GPL-3.0-or-later
"""Move a proxy by hand, resume, undo and redo."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
from window import PAUSE, call, check, first_proxy, object_of, part, results, room_objects, shoot, statuses, until_idle


def undo_and_redo() -> Iterator[float]:
    """One undo step a stage: scene and memory go back together, and what was answered is not lost."""
    before = room_objects()
    call(bpy.ops.ed.undo)
    yield PAUSE
    check("undo takes the last stage back", statuses()[-1] == "answered" and set(statuses()[:-1]) == {"done"})
    shoot("5_undone")
    call(bpy.ops.ed.redo)
    yield PAUSE
    check("redo brings it back", set(statuses()) == {"done"} and room_objects() == before)


def move_and_resume() -> Iterator[float]:
    """A proxy that was moved by hand stays exactly where it is when a stage runs again."""
    scene = bpy.context.scene
    obj = first_proxy("bed")
    name = obj["code_as_room_id"]
    obj.location.x += 0.1234567
    obj.rotation_euler.z += 0.05
    bpy.context.view_layer.update()
    wanted = [tuple(row) for row in obj.matrix_world]
    call(bpy.ops.ed.undo_push, message="Move")
    yield PAUSE
    call(bpy.ops.code_as_room.run_stage, "INVOKE_DEFAULT", stage="s04_auxiliary")
    yield from until_idle()
    yield PAUSE
    check("the edit is taken over", part("operators.view_state").peek(scene).hand_edits >= 1)
    check("the moved proxy is where it was put", [tuple(row) for row in object_of(name).matrix_world] == wanted)
    call(bpy.ops.code_as_room.run_stage, "INVOKE_DEFAULT", stage="s03_layout")
    yield from until_idle()
    outcome = part("operators.driver").outcome_of(scene)
    results["numbers"]["outcome of the layout run"] = repr(outcome)
    check("the layout ran again", outcome is not None and outcome.text.startswith("Done: 1 stage"))
    yield PAUSE
    results["numbers"]["moved since, m"] = [
        round(a - b, 7)
        for r, w in zip(object_of(name).matrix_world, wanted, strict=True)
        for a, b in zip(r, w, strict=True)
    ]
    check("also after the layout ran again", [tuple(row) for row in object_of(name).matrix_world] == wanted)
    if call(bpy.ops.code_as_room.run_all.poll):
        call(bpy.ops.code_as_room.run_all, "INVOKE_DEFAULT")
        yield from until_idle()
        yield PAUSE
    check("and to the end", [tuple(row) for row in object_of(name).matrix_world] == wanted)
    check("every stage is done again", set(statuses()) == {"done"})
    shoot("7_hand_edit")
