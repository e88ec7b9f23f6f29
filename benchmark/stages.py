# SPDX-License-Identifier: GPL-3.0-or-later
"""What all stages and the export take beside the model's answers, for a room of 40 objects: `python -m benchmark.stages`.

The room is made up (the same every time), drawn through a known camera, and answered from the truth with small errors,
so that nothing is waited for and every step has its usual work; its objects get the programs that the sample's model
wrote. Add `--profile N` for the costliest functions, `--run FOLDER` for what another run's stages 5 to 7 asked.
"""

from __future__ import annotations

import argparse
import cProfile
import io
import json
import math
import pstats
import random
import re
import resource
import sys
import tempfile
import threading
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from code_as_room.operators import outputs
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import LayoutProgram
from code_as_room.pipeline.geometry.camera import camera_from, project, tilt_rotation
from code_as_room.pipeline.geometry.footprint import image_box_of
from code_as_room.pipeline.memory import Memory, load_memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.picture import read_picture
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages
from PIL import Image, ImageDraw

from .metrics.runs import FURNISHING_STAGES, costs_of

WIDTH, DEPTH, HEIGHT = 8.0, 6.0, 2.6
PIXELS = (2400, 1900)
CAMERA_HEIGHT = 9.0
TARGETS = {"seconds": 10.0, "gigabytes": 1.5, "prompt": 40_000}
FURNISHING = {"calls": 20, "rounds": 4, "prompt_bytes": 250_000}
RECORDED = Path(__file__).resolve().parents[1] / "samples" / "bedroom" / "replies" / "replies.json"
_NAMED = re.compile(r"name the def (\w+)")
Thing = dict[str, Any]


def furniture(dice: random.Random) -> list[Thing]:
    """Forty things: 20 majors on a loose grid, then what stands on them, hangs on walls, lies and hangs above."""
    things: list[Thing] = []

    def put(kind: str, at: tuple[float, ...], size: tuple[float, ...], yaw: float = 0.0, **more: Any) -> None:
        name = f"{kind.replace(' ', '_')}_{len(things) + 1}"
        base = {"placement": "floor", "parent": None, "salience": "major"}
        things.append({"id": name, "category": kind, "at": at, "size": size, "yaw": yaw, **base, **more})

    kinds = ("bed", "wardrobe", "desk", "sofa", "armchair", "dining table", "chair", "bookshelf", "cabinet", "stool")
    for n in range(20):
        size = (dice.uniform(0.6, 1.3), dice.uniform(0.5, 0.9), dice.uniform(0.4, 1.6))
        at = (-3.2 + 1.6 * (n % 5), -2.3 + 1.5 * (n // 5), size[2] / 2)
        put(kinds[n % 10], at, size, dice.choice((0, 90, 180, 270, 20)))
    for n in range(10):
        under = things[2 * n]
        size = (0.25, 0.2, dice.uniform(0.1, 0.4))
        at = (under["at"][0], under["at"][1], under["size"][2] + size[2] / 2)
        put("table lamp", at, size, placement="surface", parent=under["id"], salience="minor")
    for n in range(6):
        put("painting", (-3 + 1.2 * n, 2.98, 1.6), (0.7, 0.03, 0.5), placement="wall", parent="top", salience="minor")
    for n in range(2):
        put("rug", (-1.6 + 3.2 * n, 0.0, 0.005), (2.4, 1.7, 0.01), salience="minor")
    put("pendant lamp", (0.0, 0.4, 2.2), (0.4, 0.4, 0.5), placement="ceiling", salience="minor")
    put("plant", (3.6, 2.6, 0.5), (0.4, 0.4, 1.0), salience="minor")
    return things


def draw(camera: CameraModel, things: list[Thing], dice: random.Random) -> bytes:
    """The room as a picture with the grain of a photograph."""
    image = Image.new("RGB", PIXELS, (90, 80, 70))
    pen = ImageDraw.Draw(image)
    pen.polygon(_pixels(camera, _outline(WIDTH, DEPTH), 0.0), fill=(190, 160, 120))
    for thing in sorted(things, key=lambda t: float(t["at"][2])):
        x, y, z = thing["at"]
        c, s = math.cos(math.radians(thing["yaw"])), math.sin(math.radians(thing["yaw"]))
        corners = [(x + c * u - s * v, y + s * u + c * v) for u, v in _outline(*thing["size"][:2])]
        colour = tuple(dice.randrange(40, 240) for _ in range(3))
        pen.polygon(_pixels(camera, corners, z + thing["size"][2] / 2), fill=colour, outline=(20, 20, 20))
    pixels = np.asarray(image, dtype=np.int16) + np.random.default_rng(7).integers(-9, 10, (PIXELS[1], PIXELS[0], 3))
    buffer = io.BytesIO()
    Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8)).save(buffer, "PNG", compress_level=1)
    return buffer.getvalue()


def _outline(width: float, depth: float) -> list[tuple[float, float]]:
    return [(u * width / 2, v * depth / 2) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def _pixels(camera: CameraModel, corners: list[tuple[float, float]], z: float) -> list[tuple[float, float]]:
    seen = project(camera, [(x, y, z) for x, y in corners])
    return [(float(x) * PIXELS[0] / 1000, float(y) * PIXELS[1] / 1000) for x, y in seen]


class Answers:
    """Answers from the truth with small errors; the critic moves two things in each of its first two rounds."""

    name, describes = "benchmark", "Answers made up by the benchmark."

    def __init__(self, camera: CameraModel, things: list[Thing], dice: random.Random) -> None:
        self.calls, self.largest, self.seconds = 0, 0, 0.0
        objects = [_object(camera, thing, dice) for thing in things]
        self._by_key = {
            "01_analysis": _analysis(camera, objects[:-2]),
            "01_second_look": {"missed": objects[-2:], "corrections": []},
            "02_graph": _graph(things),
            "03_critique/0": {"score": 70, "edits": [_move(o, 4) for o in objects[:2]]},
            "03_critique/1": {"score": 80, "edits": [_move(o, -4) for o in objects[2:4]]},
            "03_critique": {"score": 90, "edits": []},
            "04_auxiliary": {"placements": []},
            "05_descriptions": {"room_style": "calm", "objects": []},
            "06_correct": {"objects": []},
        }
        self._programs = _recorded_programs()

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        began = time.perf_counter()
        self.calls += 1
        self.largest = max(self.largest, len(prompt.text.encode()))
        if prompt.key.startswith("06_programs"):
            text = json.dumps(self._written(prompt))
        else:
            text = json.dumps(next(v for k, v in self._by_key.items() if prompt.key.startswith(k)))
        self.seconds += time.perf_counter() - began
        return Reply(text=text, model=self.name)

    def _written(self, prompt: Prompt) -> Thing:
        """A program for every object that is asked for."""
        names = _NAMED.findall(prompt.text)
        sources = [self._programs[(3 * self.calls + n) % len(self._programs)] for n in range(len(names))]
        written = zip(names, sources, strict=True)
        return {"objects": [{"id": name, "program": source.replace("_OWN_NAME_", name)} for name, source in written]}


def _recorded_programs() -> list[str]:
    """The programs that the sample's model wrote, without their names."""
    replies = json.loads(RECORDED.read_text(encoding="utf-8"))["replies"]
    objects = [o for key, r in replies.items() if "06_programs" in key for o in r["reply"]["objects"]]
    return [re.sub(rf"\b{re.escape(o['id'])}\b(?=\(size)", "_OWN_NAME_", o["program"]) for o in objects]


def _object(camera: CameraModel, thing: Thing, dice: random.Random) -> Thing:
    box = image_box_of(camera, thing["at"], thing["size"], thing["yaw"]).model_dump()
    x, y, z = thing["at"]
    return {
        **{k: thing[k] for k in ("id", "category", "placement", "parent", "salience")},
        "label": f"a {thing['category']}",
        "box": {k: v + dice.gauss(0, 2) for k, v in box.items()},
        "centre_m": {"x_m": x + dice.gauss(0, 0.03), "y_m": y + dice.gauss(0, 0.03)},
        "base_m": z - thing["size"][2] / 2,
        "size_m": {
            k: v * dice.gauss(1, 0.03) for k, v in zip(("width", "depth", "height"), thing["size"], strict=True)
        },
        "yaw_deg": thing["yaw"],
        "confidence": 0.9,
    }


def _analysis(camera: CameraModel, objects: list[Thing]) -> Thing:
    def outline(z: float) -> list[dict[str, float]]:
        seen = project(camera, [(x, y, z) for x, y in _outline(WIDTH, DEPTH)])
        return [{"x": float(x), "y": float(y)} for x, y in seen]

    def cut(name: str, kind: str, x: float, wall: str) -> Thing:
        y = DEPTH / 2 if wall == "top" else -DEPTH / 2
        return {"id": name, "kind": kind, "start": {"x_m": x, "y_m": y}, "end": {"x_m": x + 0.9, "y_m": y},
                "height_m": 1.2 if kind == "window" else 2.05, "sill_m": 0.9, "wall": wall}  # fmt: skip

    return {
        "view": "perspective",
        "room_width_m": WIDTH,
        "room_depth_m": DEPTH,
        "wall_height_m": HEIGHT,
        "floor_polygon": outline(0.0),
        "wall_top_polygon": outline(HEIGHT),
        "architecture": [cut(f"door_{n}", "door", -3.0 + 2 * n, "bottom") for n in range(2)]
        + [cut(f"window_{n}", "window", -2.5 + 2 * n, "top") for n in range(3)],
        "objects": objects,
    }


def _graph(things: list[Thing]) -> Thing:
    facts = [{"id": t["id"], "color": "oak", "material": "wood", "form": "simple"} for t in things]
    beside = [
        {"source": a["id"], "relation": "beside", "target": b["id"]} for a, b in zip(things, things[1:20], strict=False)
    ]
    return {"attributes": facts, "relations": beside}


def _move(item: Thing, by: float) -> Thing:
    return {"op": "move", "id": item["id"], "box": {k: v + by for k, v in item["box"].items()}, "reason": "too far"}


class Timed:
    """Hands on to a backend and adds up the time of its methods by name."""

    def __init__(self, inner: Any) -> None:
        self._inner = inner
        self.seconds: defaultdict[str, float] = defaultdict(float)

    def __getattr__(self, name: str) -> Any:
        method = getattr(self._inner, name)

        def timed(*arguments: Any, **named: Any) -> Any:
            began = time.perf_counter()
            try:
                return method(*arguments, **named)
            finally:
                self.seconds[name] += time.perf_counter() - began

        return timed


def measure(folder: Path) -> tuple[list[tuple[str, float]], Run, Answers]:
    """Run everything once; returns (step, seconds) pairs that add up to the whole, the run, and what was asked."""
    import bpy
    from code_as_room.pipeline.scene.backend import BlenderScene

    bpy.ops.wm.read_factory_settings(use_empty=True)
    dice = random.Random(40)
    focal = PIXELS[1] / 2 / (DEPTH * 0.62 / CAMERA_HEIGHT)
    camera = camera_from("perspective", (0, 0, CAMERA_HEIGHT), tilt_rotation(0, 0), focal, PIXELS)
    things = furniture(dice)
    data = draw(camera, things, dice)
    answers, backend = Answers(camera, things, dice), Timed(BlenderScene(bpy.context.scene))
    lines: list[tuple[str, float]] = []

    def step(name: str, act: Callable[[], Any]) -> Any:
        before, said, began = dict(backend.seconds), answers.seconds, time.perf_counter()
        result = act()
        rest = time.perf_counter() - began - (answers.seconds - said)
        for method, seconds in backend.seconds.items():
            spent = seconds - before.get(method, 0.0)
            rest -= spent
            if spent > 0.001:
                lines.append((f"{name}: scene.{method}", spent))
        lines.append((f"{name}: the rest", rest))
        return result

    picture = step("picture", lambda: read_picture(data, "room.png"))
    run = Run(picture, Memory(), answers, backend)
    for stage in all_stages():
        step(stage.id, lambda stage=stage: run.run_stage(stage))  # type: ignore[misc]
    step("export", lambda: outputs.write_outputs(run, folder))
    return lines, run, answers


def main() -> None:
    """Measure, and print plain lines against the targets."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--profile", type=int, default=0, metavar="N", help="also print the N costliest functions")
    options.add_argument("--run", type=Path, metavar="FOLDER", help="only tell what stages 5 to 7 of a run asked")
    chosen = options.parse_args()
    if chosen.run:
        _tell_furnishing(load_memory((chosen.run / "memory.json").read_text(encoding="utf-8")))
        return
    most = chosen.profile
    profile = cProfile.Profile() if most else None
    with tempfile.TemporaryDirectory() as folder:
        if profile:
            lines, run, answers = profile.runcall(measure, Path(folder))
        else:
            lines, run, answers = measure(Path(folder))
    for name, seconds in lines:
        print(f"{name:<42}{seconds:8.2f} s")
    layout, final = run.memory.latest(LayoutProgram, ("s03_layout",)), run.memory.latest(LayoutProgram)
    assert layout is not None and final is not None
    rounds = len(layout.iterations)
    states = [entry.state for entry in final.ledger]
    furnishing = sum(seconds for name, seconds in lines if name.startswith(FURNISHING_STAGES))
    total = sum(seconds for _, seconds in lines) - furnishing
    # Kilobytes on Linux, bytes on macOS.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1e9 if sys.platform == "darwin" else 1e6)
    counts = ", ".join(f"{states.count(state)} {state}" for state in sorted(set(states)))
    print(f"objects: {len(states)}, {counts}; rounds of the layout loop: {rounds}")
    _against("stages 1 to 4 and the export, but the model's answers", total, TARGETS["seconds"], "s")
    print(f"stages 5 to 7, but the model's answers: {furnishing:.2f} s")
    _against("most memory of the process", peak, TARGETS["gigabytes"], "GB")
    asked = costs_of(run.memory)
    _against("model calls of stages 1 to 4", asked.calls, 4 + 2 * rounds, "")
    _tell_furnishing(run.memory)
    _against("largest prompt text", answers.largest, TARGETS["prompt"], "bytes")
    if profile:
        pstats.Stats(profile).sort_stats("cumulative").print_stats(most)
        pstats.Stats(profile).sort_stats("tottime").print_stats(most)


def _tell_furnishing(memory: Memory) -> None:
    """What stages 5 to 7 asked, against the limits of a room of 40 objects."""
    asked = costs_of(memory, FURNISHING_STAGES)
    _against("model calls of stages 5 to 7", asked.calls, FURNISHING["calls"], "")
    _against("sequential rounds of stages 5 to 7", asked.rounds, FURNISHING["rounds"], "")
    _against("prompt text of stages 5 to 7", asked.prompt_bytes, FURNISHING["prompt_bytes"], "bytes")


def _against(what: str, value: float, most: float, unit: str) -> None:
    shown = f"{value:.2f}" if isinstance(value, float) else str(value)
    print(f"{what}: {shown} {unit} (at most {most:g}) {'reached' if value <= most else 'NOT REACHED'}")


if __name__ == "__main__":
    main()
