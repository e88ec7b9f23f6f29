# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run left behind: its room, the direct answer of the same run, and what it asked.

A run's folder is what `code-as-room --out` writes; of it, `scene.json` and `memory.json` are read.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from code_as_room.pipeline.artifacts.layout import LayoutProgram
from code_as_room.pipeline.artifacts.scene import SceneDocument
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.memory import Memory, load_memory
from code_as_room.pipeline.program.lines import parse_layout

from .direct import direct_answer
from .rooms import Room, load_result, room_of

LAYOUT_STAGES = ("s01_analysis", "s02_graph", "s03_layout", "s04_auxiliary")
FURNISHING_STAGES = ("s05_descriptions", "s06_geometry", "s07_surfaces")
CRITIQUE = "03_critique"


@dataclass(frozen=True)
class Costs:
    """What some stages asked, 1 to 4 unless said otherwise.

    Attributes:
        calls: of the model, repairs among them. prompt_bytes: bytes of prompt text.
        rounds: how often it was waited for; what is asked side by side is one round.
        rounds_before_critique: the same without the iterations of the layout loop.
    """

    calls: int
    rounds: int
    rounds_before_critique: int
    prompt_bytes: int


@dataclass(frozen=True)
class Outcome:
    """A run's rooms; None for what is not there, and then why."""

    result: Room | None
    direct: Room | None
    costs: Costs | None
    problem: str = ""


def read_run(folder: Path) -> Outcome:
    """Read a run's folder; a run that failed half-way gives what it has."""
    try:
        memory = load_memory((folder / "memory.json").read_text(encoding="utf-8"))
    except (OSError, RoomError) as error:
        memory, problem = None, f"memory.json: {error}"
    else:
        problem = ""
    try:
        result = load_result(folder / "scene.json", shapes_of(memory))
    except (OSError, ValueError, KeyError, TypeError) as error:
        result, problem = None, f"scene.json: {error}"
    if memory is None:
        return Outcome(result, None, None, problem)
    return Outcome(result, direct_answer(memory), costs_of(memory), problem)


def result_of(document: SceneDocument | Mapping[str, Any], memory: Memory | None = None) -> Room:
    """A result as a room, from the document that would be written to `scene.json`."""
    data = document.model_dump(mode="json") if isinstance(document, SceneDocument) else document
    return room_of(data, shapes_of(memory))


def shapes_of(memory: Memory | None) -> dict[str, str] | None:
    """Which proxies are round or L-shaped, by id; None when memory holds no layout that can be read."""
    program = memory.latest(LayoutProgram, LAYOUT_STAGES) if memory is not None else None
    if program is None:
        return None
    try:
        return {proxy.id: proxy.shape for proxy in parse_layout(program.text).proxies}
    except RoomError:
        return None


def costs_of(memory: Memory, stages: Sequence[str] = LAYOUT_STAGES) -> Costs:
    """What these stages asked, from the answers that memory keeps."""
    calls = prompt_bytes = 0
    rounds: dict[tuple[str, int], int] = {}
    critiques = set()
    for entry in memory.entries:
        if entry.type != "Answer" or entry.stage not in stages:
            continue
        calls += entry.meta.tries
        prompt_bytes += entry.meta.prompt_bytes
        # Repairs are waited for one after the other.
        place = (entry.stage, entry.meta.round)
        rounds[place] = max(rounds.get(place, 0), entry.meta.tries)
        if str(entry.output.get("key", "")).startswith(CRITIQUE):
            critiques.add(place)
    before = sum(tries for place, tries in rounds.items() if place not in critiques)
    return Costs(calls, sum(rounds.values()), before, prompt_bytes)
