# SPDX-License-Identifier: GPL-3.0-or-later
"""How long materials, textures, light and the correction of a room of 100 objects take, and where the time goes:
`python -m benchmark.finishing [--objects 100] [--faults 10] [--profile N] [--stage 08|09|10]`.

No model is asked and nothing is rendered; building in Blender counts. Times are of the processor, since other work on the
machine would disturb the clock; `--clock` shows the clock's.
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import bpy
import numpy as np
from code_as_room.pipeline.artifacts.correction import CorrectionReport
from code_as_room.pipeline.artifacts.layout import Layout, LayoutProgram
from code_as_room.pipeline.artifacts.objects import RoomStyle
from code_as_room.pipeline.artifacts.textures import TextureChoices, Textures
from code_as_room.pipeline.objects.text import relaid
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.stages import s08_materials, s09_textures, s10_finish
from code_as_room.pipeline.stages.wishes import Ask, Build

from .large_room import LargeRoom, make_room

TARGET = 5.0
"""Seconds for all of it."""


@dataclass
class Sheet:
    """Seconds by step; those of "building" are in those of their stage as well."""

    seconds: dict[str, float] = field(default_factory=dict)
    now: Callable[[], float] = time.process_time

    @property
    def total(self) -> float:
        """Seconds of all stages."""
        return sum(seconds for name, seconds in self.seconds.items() if not name.startswith(" "))

    def step(self, name: str, act: Callable[[], Any]) -> Any:
        """Do it, and add its time to a step."""
        began = self.now()
        result = act()
        self.seconds[name] = self.seconds.get(name, 0.0) + self.now() - began
        return result


def perform(stage: Any, view: Any, scene: BlenderScene, sheet: Sheet) -> list[Any]:
    """Run a stage's generator without a model; its building counts for the stage, and by itself."""
    run = stage.run(view)
    answer: Any = None
    while True:
        try:
            wish = run.send(answer)
        except StopIteration as end:
            found: list[Any] = end.value
            return found
        answer = None
        if isinstance(wish, Ask):
            answer = [None] * len(wish.requests)
        elif isinstance(wish, Build):
            sheet.step("  of it building", partial(scene.build, wish.text))


def measure(room: LargeRoom, faults: int, sheet: Sheet, only: str = "", profile: Any = None) -> dict[str, Any]:
    """Seconds for each stage, and what came of them."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = BlenderScene(bpy.context.scene)
    text, stage = with_faults(room.text, faults), "s07_surfaces"
    scene.build(text)
    found: dict[str, Any] = {}
    looking = s10_finish.correct
    s10_finish.correct = lambda *given: sheet.step("  of it correcting", partial(looking, *given))  # type: ignore[attr-defined]
    choices = TextureChoices(first=["picture", "procedural"])
    recalled: dict[type, Any] = {TextureChoices: choices, RoomStyle: room.artifacts[RoomStyle]}
    try:
        for module in (s08_materials, s09_textures, s10_finish):
            view = room.view(text, stage, recalled)
            if profile is not None and only in module.ID:
                profile.enable()
            made = sheet.step(module.ID, partial(perform, module.STAGE, view, scene, sheet))
            if profile is not None:
                profile.disable()
            found |= {type(artifact).__name__: artifact for artifact in made}
            text, stage = found[LayoutProgram.__name__].text, module.ID
    finally:
        s10_finish.correct = looking  # type: ignore[attr-defined]
    return found


def with_faults(text: str, count: int) -> str:
    """The room with things moved so that they float, stand in others or outside."""
    layout = parse_layout(text)
    rng = np.random.default_rng(1)
    loose = [p for p in layout.proxies if p.placement == "floor" and p.size[2] > 0.1]
    moved: dict[str, tuple[float, float, float]] = {}
    for n, index in enumerate(rng.permutation(len(loose))[:count]):
        p = loose[int(index)]
        x, y, z = p.centre
        way = rng.uniform(-0.5, 0.5, 2)
        at = ((x, y, z + 0.12), (x + way[0], y + way[1], z), (x + way[0], y + 6.0 * np.sign(y), z))[n % 3]
        moved[p.id] = (float(at[0]), float(at[1]), float(at[2]))
    proxies = [p.model_copy(update={"centre": moved.get(p.id, p.centre)}) for p in layout.proxies]
    broken: Layout = layout.model_copy(update={"proxies": proxies})
    return relaid(text, broken)


def text_of(sheet: Sheet, room: LargeRoom, found: dict[str, Any]) -> str:
    """The table for a terminal."""
    text = found[LayoutProgram.__name__].text
    record = evaluate(text, FINISHED_ROOM_LIMITS)
    parts = sum(len(shapes) for shapes in record.furnished.values())
    report = found[CorrectionReport.__name__]
    lines = [
        f"{len(room.layout.proxies)} objects, {parts} parts, {len(text) / 1000:.0f} kB of text; "
        f"{len(report.fixes)} faults mended, {len(report.left)} left"
    ]
    lines += [f"{name:<20}{seconds:8.2f} s" for name, seconds in sheet.seconds.items()]
    total = sheet.total
    lines.append(f"{'all':<20}{total:8.2f} s   (at most {TARGET:g} s) {'reached' if total < TARGET else 'NOT REACHED'}")
    for surface in found[Textures.__name__].surfaces:
        lines.append(f"  {surface.surface}: {surface.source} {surface.note}".rstrip())
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 when it takes longer than it may."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--objects", type=int, default=100)
    parser.add_argument("--faults", type=int, default=10)
    parser.add_argument("--profile", type=int, default=0, metavar="N", help="list the costliest functions")
    parser.add_argument("--stage", default="", help="profile this one only")
    parser.add_argument("--sort", default="tottime")
    parser.add_argument("--clock", action="store_true")
    options = parser.parse_args(arguments)
    room = make_room(options.objects)
    sheet = Sheet(now=time.perf_counter if options.clock else time.process_time)
    profile = cProfile.Profile() if options.profile else None
    found = measure(room, options.faults, sheet, options.stage, profile)
    print(text_of(sheet, room, found))
    if profile is not None:
        pstats.Stats(profile).sort_stats(options.sort).print_stats(options.profile)
    return 0 if sheet.total < TARGET else 1


if __name__ == "__main__":
    sys.exit(main())
