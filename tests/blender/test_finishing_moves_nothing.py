# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, textures and light leave every mesh and every place as they were: the whole method in Blender, no model."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import code_as_room
import numpy as np
from code_as_room.operators import driver
from code_as_room.pipeline.artifacts.correction import FAULT_KINDS
from code_as_room.pipeline.scene.tags import find_room_collection
from code_as_room.pipeline.stages import all_stages

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "bedroom"
ADDED = ("ceiling", "section", "skirting", "wall_tops")
"""What the view line and the finish of wall tops bring, and nothing else may."""


def run(stages: Any) -> None:
    driver.start(bpy.context.scene, stages)
    outcome = driver.run_blocking()
    assert outcome.problem is None, outcome.problem


def stands() -> dict[str, tuple[Any, ...]]:
    """Every mesh object of the room: where it is, its vertices, edges and faces."""
    bpy.context.view_layer.update()
    found = {}
    for obj in find_room_collection(bpy.context.scene).all_objects:
        if obj.type != "MESH" or obj.name in ADDED:
            continue
        points = np.empty(3 * len(obj.data.vertices), dtype=np.float32)
        obj.data.vertices.foreach_get("co", points)
        faces = np.empty(len(obj.data.loops), dtype=np.int32)
        obj.data.loops.foreach_get("vertex_index", faces)
        parent = obj.parent.name if obj.parent is not None else ""
        found[obj.name] = (np.array(obj.matrix_world).tolist(), parent, points.tobytes(), faces.tobytes())
    return found


def test_the_last_three_stages_leave_every_mesh_and_transform() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    try:
        bpy.ops.code_as_room.load_picture(filepath=str(SAMPLE / "picture.png"))
        settings = bpy.context.scene.code_as_room
        settings.corrections = set()
        stages = all_stages()
        run(stages[:7])
        before = stands()
        assert len(before) > 10
        for number in (8, 9, 10):
            run(stages[:number])
            after = stands()
            assert after.keys() == before.keys(), number
            assert [name for name in before if before[name] != after[name]] == [], number
        materials = {s.material.name for o in bpy.data.objects for s in o.material_slots if s.material is not None}
        assert len(materials) > 5 and bpy.context.scene.world is not None
        # With corrections things may move; all that moved is told of.
        settings.corrections = set(FAULT_KINDS)
        run(stages)
        from code_as_room.operators import view_state

        told = {row.id for row in view_state.refresh(bpy.context.scene).finish.fixes}
        moved = {name for name, was in stands().items() if before[name][0] != was[0]}
        carried = {o.name for o in bpy.data.objects if o.parent is not None}
        assert moved <= told | carried
    finally:
        code_as_room.unregister()
