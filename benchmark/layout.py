# SPDX-License-Identifier: GPL-3.0-or-later
"""How well a room matches its ground truth: `python -m benchmark.layout scene.json truth.json [memory.json]`.

With a memory, the direct answer is scored beside the result: the metres of the model's first reply as it gave them,
without camera, fusing, loop or solver.
"""

from __future__ import annotations

import argparse
import json
import math
from itertools import combinations
from pathlib import Path
from typing import Any

from code_as_room.pipeline.artifacts.replies import AnalysisReply
from code_as_room.pipeline.geometry.polygon import outside_fraction, overlap_fraction
from code_as_room.pipeline.memory import load_memory
from code_as_room.pipeline.models.validate import validate_reply

from .matching import match, scaled
from .rooms import Room, Thing, _scene, load_room


def figures(truth: Room, result: Room) -> dict[str, Any]:
    """The figures of one result."""
    pairs = match(truth, result)
    matched = {t.id: (p, iou) for t, p, iou in pairs}
    majors = [t for t in truth.things if t.major]
    ious = [matched[t.id][1] if t.id in matched else 0.0 for t in majors]
    aspect, true_aspect = result.metres[0] / result.metres[1], truth.metres[0] / truth.metres[1]
    turned = [_apart(t.yaw, matched[t.id][0].yaw) for t in majors if t.id in matched and t.yaw is not None]
    return {
        "aspect": aspect,
        "aspect_error": abs(aspect / true_aspect - 1),
        "recall": len(matched) / len(truth.things) if truth.things else 1.0,
        "recall_majors": sum(t.id in matched for t in majors) / len(majors) if majors else 1.0,
        "iou_majors": sum(ious) / len(ious) if ious else 1.0,
        "facing_within_15": sum(a <= 15 for a in turned) / len(turned) if turned else 1.0,
        "worst_major_overlap": _worst_overlap(result),
        "worst_major_outside": max(
            (outside_fraction(t.footprint, result.floor) for t in _standing(result)), default=0.0
        ),
        "objects": len(result.things),
        "missed": [t.id for t in truth.things if t.id not in matched],
        "iou_by_major": {t.id: round(i, 3) for t, i in zip(majors, ious, strict=True)},
    }


def _apart(a: float | None, b: float | None) -> float:
    if a is None or b is None:
        return 180.0
    return abs((a - b + 180) % 360 - 180)


def _standing(room: Room) -> list[Thing]:
    return [t for t in room.things if t.major and t.placement == "floor" and not t.flat]


def _worst_overlap(room: Room) -> float:
    solid = [scaled(t.footprint, room.metres) for t in _standing(room)]
    return max((overlap_fraction(a, b) for a, b in combinations(solid, 2)), default=0.0)


def direct_answer(memory_path: Path) -> Room:
    """The first reply's metres as a room."""
    memory = load_memory(memory_path.read_text(encoding="utf-8"))
    entry = next(e for e in memory.entries if e.type == "Answer" and e.output.get("key") == "01_analysis")
    reply, _ = validate_reply(entry.output["text"], AnalysisReply, salvage=True)
    objects = [
        {
            "id": o.id,
            "category": o.category,
            "centre": (o.centre_m.x_m, o.centre_m.y_m, o.base_m + o.size_m.height / 2),
            "size": (o.size_m.width, o.size_m.depth, o.size_m.height),
            "yaw": o.yaw_deg,
            "placement": o.placement,
            "parent": o.parent,
            "salience": o.salience,
        }
        for o in reply.objects
    ]
    half = (reply.room_width_m / 2, reply.room_depth_m / 2)
    floor = [[-half[0], -half[1]], [half[0], -half[1]], [half[0], half[1]], [-half[0], half[1]]]
    return _scene({"objects": objects}, floor, "salience")


def main() -> None:
    """Print the figures as a table, and as JSON with --json."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", type=Path)
    parser.add_argument("truth", type=Path)
    parser.add_argument("memory", type=Path, nargs="?")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    truth = load_room(options.truth)
    columns = {"result": figures(truth, load_room(options.scene))}
    if options.memory is not None:
        columns["direct"] = figures(truth, direct_answer(options.memory))
    if options.json:
        print(json.dumps(columns, indent=1))
        return
    for name in columns["result"]:
        values = [column[name] for column in columns.values()]
        shown = "".join(f"{v:>12.3f}" if isinstance(v, float) and math.isfinite(v) else f"  {v}" for v in values)
        print(f"{name:<22}{shown}")


if __name__ == "__main__":
    main()
