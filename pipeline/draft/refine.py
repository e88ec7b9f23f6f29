# SPDX-License-Identifier: GPL-3.0-or-later
"""What a drafted room is worth asking for: the steps that its measured findings call for, and nothing else.

A step is a stage that the model is asked in, for some objects or for all. What follows it is answered from the draft again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..artifacts.analysis import SceneAnalysis
from ..artifacts.corrections import Corrections
from ..artifacts.draft import DraftProgram
from ..artifacts.hand import HandEdits
from ..artifacts.layout import LayoutEdit, LayoutProgram
from ..artifacts.materials import Materials
from ..artifacts.objects import Descriptions, Geometry
from ..errors import ProgramError, RoomError
from ..layout.hand import name_now
from ..materials.difference import difference
from ..memory import Memory
from ..models.prices import Price
from ..program.lines import parse_layout
from ..spending_estimate import RunEstimate, stage_work
from .artifact import read_again
from .kept import is_before_draft, is_drafted

GOOD_FIT = 0.955
"""Measured score of a layout from which on a critic has little to say."""
LARGE = 0.12
"""Square metres of an object's faces from which its own program is worth asking for."""
SHOWN = 2500.0
"""Of the picture's million: how large an object's box must be for a look at its render to be worth asking for."""
MOST_OBJECTS = 20
ODD_COLOUR = 20.0
"""CIEDE2000 by which a thing's main colour may miss the measured one before it is asked about."""
_DESCRIBED, _WRITTEN = 8, 5  # objects that one question is about


@dataclass(frozen=True)
class Step:
    """One stage that is asked anew.

    Attributes:
        stage: its id. only: ids of the objects that it is about, None for all. why: for the artist, a sentence.
        calls: fewest and most questions.
        looks: the draft's programs are rendered and mended, instead of written anew.
    """

    stage: str
    only: frozenset[str] | None
    why: str
    calls: tuple[int, int]
    looks: bool = False


def plan(memory: Memory) -> list[Step]:
    """The steps that a drafted room calls for, in the order of the stages; [] where nothing does, or nothing is drafted.

    Only what is still as the draft has it is asked for: what was refined, or what the artist holds, is left alone.
    """
    if memory.latest(DraftProgram) is None:
        return []
    steps = [
        *_layout(memory),
        *_looks(memory),
        *_objects(memory),
        *_colours(memory),
        *_light(memory),
    ]
    return sorted(steps, key=lambda step: step.stage)


def estimate(steps: Sequence[Step], price_of: Callable[[str], tuple[str, Price | None]]) -> RunEstimate:
    """What the steps may cost.

    Args:
        price_of: model and price for a stage, as for `spending_estimate.estimate_run`.
    """
    calls, tokens, dollars = [0, 0], [0, 0], [0.0, 0.0]
    unpriced: list[str] = []
    for step in steps:
        work = stage_work(step.stage, 3)
        model, price = price_of(step.stage)
        for end, number in enumerate(step.calls):
            calls[end] += number
            answered = work.completion_tokens * (1 + 2 * end)
            tokens[end] += number * (work.prompt_tokens + answered)
            dollars[end] += price.of(number * work.prompt_tokens, number * answered) if price else 0.0
        if price is None and model not in unpriced:
            unpriced.append(model)
    known = None if unpriced else (dollars[0], dollars[1])
    return RunEstimate((calls[0], calls[1]), (tokens[0], tokens[1]), known, tuple(unpriced))


def is_better(memory: Memory, before: LayoutProgram | None) -> bool:
    """Whether the room that stands after a step is no worse than the one before it, by what was measured of both."""
    after = memory.latest(LayoutProgram)
    if before is None or after is None:
        return after is not None
    lost = {"dropped", "deferred"}
    gone = [sum(entry.state in lost for entry in program.ledger) for program in (before, after)]
    return after.score.measured >= before.score.measured - 0.004 and gone[1] <= gone[0]


def _stands(memory: Memory, kind: str, stage: str) -> bool:
    """Whether what a stage wrote is still as the draft had it."""
    entry = memory.latest_entry(kind, (stage,))
    return entry is not None and is_drafted(entry.meta.client) and not is_before_draft(memory, stage, entry)


def _held(memory: Memory) -> frozenset[str]:
    """Ids of what the artist changed by hand or locked."""
    edited = {edit.new_id or edit.id for edit in _edits(memory) if edit.origin != "parent"}
    said = memory.latest(Corrections) or Corrections()
    return frozenset(edited | {c.id for c in said.objects if c.locked})


def _edits(memory: Memory) -> list[LayoutEdit]:
    """All edits by hand, for the names that things have by them."""
    entries = [e for e in memory.entries if e.type == HandEdits.__name__]
    return [edit for entry in entries for edit in HandEdits.model_validate(entry.output).edits]


def _layout(memory: Memory) -> list[Step]:
    """The critic, where the layout fits the picture less than it could."""
    program = memory.latest(LayoutProgram, ("s03_layout",))
    if program is None or not _stands(memory, LayoutProgram.__name__, "s03_layout"):
        return []
    if program.score.measured >= GOOD_FIT:
        return []
    return [Step("s03_layout", None, f"The layout fits the picture to {program.score.measured:.0%}.", (1, 3))]


def _looks(memory: Memory) -> list[Step]:
    """Programs that nobody has seen rendered, of what takes a large part of the picture."""
    geometry, analysis = memory.latest(Geometry), memory.latest(SceneAnalysis)
    if geometry is None or analysis is None or not _stands(memory, Geometry.__name__, "s06_geometry"):
        return []
    held, edits = _held(memory), _edits(memory)
    shown = {name_now(edits, o.id) or o.id: o.box.area for o in analysis.objects if o.box is not None}
    unseen = {
        made.id: shown[made.id]
        for made in geometry.objects
        if made.source == "program" and not made.like and made.id not in held and shown.get(made.id, 0.0) >= SHOWN
    }
    chosen = frozenset(sorted(unseen, key=lambda i: -unseen[i])[:MOST_OBJECTS])
    if not chosen:
        return []
    calls = math.ceil(len(chosen) / _WRITTEN)
    why = f"{_counted(len(chosen), 'was', 'were')} written without being seen: each is rendered beside the picture and mended."
    twins = {made.id for made in geometry.objects if made.like in chosen and made.id not in held}
    return [Step("s06_geometry", chosen | twins, why, (calls, calls), looks=True)]


def _objects(memory: Memory) -> list[Step]:
    """Programs for what has a stock piece though it is large, or though the draft had a program that could not be used."""
    geometry, program, draft = memory.latest(Geometry), memory.latest(LayoutProgram), memory.latest(DraftProgram)
    if geometry is None or program is None or draft is None or not _stands(memory, Geometry.__name__, "s06_geometry"):
        return []
    try:
        layout = parse_layout(program.text)
        read, _ = read_again(draft)
    except (ProgramError, RoomError):
        return []
    held, edits = _held(memory), _edits(memory)
    refused = {name_now(edits, i) or i for i in read.problems}
    wanted: dict[str, float] = {}
    for made in geometry.objects:
        proxy = layout.proxy(made.id)
        if proxy is None or made.source not in ("library", "proxy") or made.like or made.id in held:
            continue
        w, d, h = proxy.size
        faces = w * d + w * h + d * h
        if made.id in refused or faces >= LARGE:
            wanted[made.id] = faces
    chosen = frozenset(sorted(wanted, key=lambda i: -wanted[i])[:MOST_OBJECTS])
    if not chosen:
        return []
    broken = len(chosen & refused)
    reason = f"{_counted(len(chosen))} stock pieces only"
    if broken:
        reason += f", {broken} of them since {'its program' if broken == 1 else 'their programs'} could not be used"
    described, written = math.ceil(len(chosen) / _DESCRIBED), math.ceil(len(chosen) / _WRITTEN)
    return [
        Step("s05_descriptions", chosen, f"{reason}: what they look like.", (described, described)),
        Step("s06_geometry", chosen, f"{reason}.", (written, 2 * written)),
    ]


def _counted(number: int, one: str = "has", more: str = "have") -> str:
    return f"1 object {one}" if number == 1 else f"{number} objects {more}"


def _colours(memory: Memory) -> list[Step]:
    """Materials of what plainly shows another colour than the picture."""
    descriptions, materials = memory.latest(Descriptions), memory.latest(Materials)
    if descriptions is None or materials is None or not _stands(memory, Materials.__name__, "s08_materials"):
        return []
    held = _held(memory)
    odd = []
    for thing in materials.objects:
        seen = descriptions.of(thing.id)
        coloured = [p.colour.lstrip("#") for p in thing.parts if len(p.colour.lstrip("#")) == 6]
        if thing.id in held or seen.seen < 0.4 or not seen.measured or seen.measured[0].share < 0.5 or not coloured:
            continue
        if min(difference(code, seen.measured[0].code) for code in coloured) > ODD_COLOUR:
            odd.append(thing.id)
    if not odd:
        return []
    why = f"{_counted(len(odd))} other colours in the room than in the picture."
    return [Step("s08_materials", frozenset(odd), why, (1, 1))]


def _light(memory: Memory) -> list[Step]:
    """The light, where the draft says nothing of it."""
    draft = memory.latest(DraftProgram)
    if draft is None or not _stands(memory, LayoutProgram.__name__, "s10_finish"):
        return []
    if any(s.kind in ("lighting", "light") and not s.is_lost for s in draft.statements):
        return []
    return [Step("s10_finish", None, "The draft says nothing of the light.", (1, 1))]
