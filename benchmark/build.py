# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a furnished room takes to build: 40 pieces of furniture and 60 small things, `python -m benchmark.build`.

Nothing is asked of a model. Times are of the processor, as other work on the machine would disturb the clock.
`--profile N` lists the costliest functions.
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
import time
from collections.abc import Callable
from typing import Any

import bpy
from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.scene.realise import lacking, new_mesh, realise_plan
from code_as_room.pipeline.scene.tags import find_room_collection
from code_as_room.pipeline.scene.targets import plan_record

LARGE = (
    "double_bed", "nightstand", "nightstand", "wardrobe", "sofa", "armchair", "coffee_table", "tv_stand", "television",
    "bookcase", "desk", "office_chair", "dining_table", "chair", "chair", "chair", "chair", "sideboard", "floor_lamp",
    "potted_plant", "kitchen_run", "refrigerator", "range_hood", "toilet", "vanity_basin", "bath", "washing_machine",
    "console_table", "bench", "ottoman", "stool", "stool", "chest_of_drawers", "radiator", "curtain_pair",
    "standing_mirror", "picture_frame", "picture_frame", "pendant", "shoe_rack",
)  # fmt: skip
SMALL = (
    "cup",
    "mug",
    "plate",
    "bowl",
    "bottle",
    "laptop",
    "keyboard",
    "mouse",
    "monitor",
    "candle",
    "table_lamp",
    "tray",
)
_TIMES = 5
TARGETS = {"build": 2.0, "redo": 0.1}


def room() -> str:
    """The program of the room."""
    known = catalogue.pieces()
    names = [*LARGE, *(SMALL[i % len(SMALL)] for i in range(60))]
    lines = ["room(size=(14, 14, 2.6), floor=[(-7, -7), (7, -7), (7, 7), (-7, 7)])"]
    ends = []
    for n, name in enumerate(names):
        w, d, h = known[name].typical
        centre = (-6.3 + 1.3 * (n % 10), -6.3 + 1.3 * (n // 10), h / 2)
        lines.append(f'proxy("{name}_{n}", "{name}", centre={centre}, size={(w, d, h)}, yaw={(n * 37) % 360})')
        ends.append(f'furnish("{name}_{n}", {name}({(w, d, h)}))')
    return "\n".join([*lines, catalogue.source(sorted(set(names))), *ends, "build()", ""])


def measure() -> dict[str, float]:
    """Processor seconds by step."""
    found: dict[str, float] = {}

    def step(name: str, act: Callable[[], Any]) -> Any:
        began = time.process_time()
        result = act()
        found[name] = time.process_time() - began
        return result

    bpy.ops.wm.read_factory_settings(use_empty=True)
    text = room()
    record = step("program", lambda: evaluate(text, FINISHED_ROOM_LIMITS))
    plan = step("plan", lambda: plan_record(record))
    step("arrays", lambda: [plan.mesh(target) for target in plan.targets])
    made = step("meshes", lambda: {t.key: new_mesh(t, plan) for t in lacking(plan, None)})
    step("commit", lambda: realise_plan(plan, "Code-as-Room", bpy.context.scene, made))
    shapes = [shape for found_shapes in record.furnished.values() for shape in found_shapes]
    print(f"{len(record.furnished)} objects, {len(shapes)} parts, {sum(s.vertex_count for s in shapes)} vertices")
    print(f"text: {len(text)} characters")
    found["build"] = sum(found[name] for name in ("arrays", "meshes", "commit", "plan"))

    changed = plan_record(record)
    for target in changed.targets:
        if target.key[0].startswith("sofa"):
            target.shapes.append(target.shapes[0])
    again = plan_record(record)
    room_collection = find_room_collection(bpy.context.scene)
    one = lacking(again, room_collection)

    def redo() -> None:
        fresh = {t.key: new_mesh(t, again) for t in one}
        realise_plan(again, "Code-as-Room", bpy.context.scene, fresh)

    step("redo", redo)
    print("redone:", [target.key[0] for target in one])
    return found


def main() -> None:
    """Measure, and print plain lines against the targets."""
    options = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    options.add_argument("--profile", type=int, default=0, metavar="N")
    most = options.parse_args().profile
    profile = cProfile.Profile()
    times = profile.runcall(measure) if most else measure()
    for name, seconds in times.items():
        limit = TARGETS.get(name)
        print(f"{name:<10}{seconds:8.3f} s" + (f"   (at most {limit:g} s)" if limit else ""))
    if most:
        pstats.Stats(profile).sort_stats("tottime").print_stats(most)


if __name__ == "__main__":
    main()
