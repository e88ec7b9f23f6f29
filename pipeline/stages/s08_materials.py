# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 8, materials: which look each part has, in the picture's colours; geometry is not touched.

Everything is decided first by roles, words and measured colours. One round of questions then refines families and their
parameters; colours stay as measured unless the model says why not. (Paper, stage 8.)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..artifacts.analysis import Calibration, Finding, SceneAnalysis
from ..artifacts.layout import Layout, LayoutProgram, ProxyLine
from ..artifacts.materials import Materials, MaterialsReply, OwnFinishes
from ..artifacts.objects import Descriptions, RoomStyle
from ..errors import ProgramError
from ..layout.hand import apply_hand_edits
from ..materials.answered import Answered
from ..materials.decide import Deciding, fittings_of, kept_finishes
from ..materials.own import with_own
from ..materials.shell import ShellColours, shell_choices, shell_colours
from ..objects.asking import batches, object_line, picture_box
from ..objects.text import read_modelling, relaid
from ..program import finishes
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout
from ..program.looks_reference import looks_reference
from ..program.prelude.enclosure import TOPS
from ..program.prelude.recorder import SURFACES
from .base import Reads, Stage, View
from .carrying import carried_on
from .wishes import Ask, Build, Picture, Request, StageRun, Tell

ID = "s08_materials"
BATCH = 30
MOST_CALLS = 3
_PARTS = 12
"""Parts of one object that the model is told of."""


def run(view: View) -> StageRun:
    """Write the `LayoutProgram` with looks and finishes, and `Materials`, which says why; one round of questions."""
    before = view.need(LayoutProgram)
    layout, findings = apply_hand_edits(parse_layout(before.text), view.hand_edits, before.hand_edits)
    text = relaid(before.text, layout)
    yield Tell("Looking at parts and colours", 1, 3)
    former = view.recall(Materials)
    kept = _kept(view, text, layout, former)
    deciding = _decided(view, text, layout)
    yield Tell("Asking what things are made of", 2, 3)
    asked = [p for p in layout.proxies if p.id in deciding.cells and p.id not in kept.finishes]
    requests = _requests(view, deciding, asked)
    replies = (yield Ask(tuple(requests), optional=True)) if requests else []
    if any(reply is not None for reply in replies):
        known = [*deciding.cells, *fittings_of(layout), *SURFACES]
        deciding.take(Answered.of(replies, known))
    looks, materials = deciding.written(text, kept, former or Materials())
    text, problem = _sound(text, looks)
    lost = sum(reply is None for reply in replies)
    if lost:
        message = f"{lost} of {len(requests)} questions had no usable answer; roles and measured colours decided."
        materials = _told(materials, "materials", message)
    if problem:
        materials = _told(materials, "materials", f"The materials could not be used ({problem}); plain ones stand.")
    yield Tell("Building the room", 3, 3)
    yield Build(text)
    return [carried_on(view, before, ID, text, layout, findings, before.ledger), materials]


def _told(materials: Materials, about: str, message: str) -> Materials:
    more = Finding(about=about, message=message, severity="warning")
    return materials.model_copy(update={"findings": [*materials.findings, more]})


def _kept(view: View, text: str, layout: Layout, former: Materials | None) -> finishes.Materials:
    """Finishes that stay: the artist's own, and of what is locked or not chosen."""
    present = finishes.present_names(layout)
    standing = view.recall(LayoutProgram)
    own = view.recall(OwnFinishes) or OwnFinishes()
    source = with_own(standing.text if standing is not None else text, own, view.hand_edits)
    held = set(view.locked)
    if view.only is not None:
        held |= {name for name in present if name not in view.only}
    return kept_finishes(source, former, present, held)


def _decided(view: View, text: str, layout: Layout) -> Deciding:
    record = evaluate(text, FINISHED_ROOM_LIMITS)
    style = view.need(RoomStyle)
    colours = ShellColours()
    if view.need(SceneAnalysis).view != "plan":
        gains = np.array(style.gains)
        colours = shell_colours(layout, view.need(Calibration).camera, view.reference, gains)
    functions = read_modelling(text).functions
    return Deciding.begin(layout, record.furnished, view.need(Descriptions), functions, shell_choices(layout, colours))


def _sound(text: str, looks: finishes.Materials) -> tuple[str, str]:
    """The text with these materials, and "" or why it has none."""
    try:
        made = finishes.with_materials(text, looks)
        evaluate(made, FINISHED_ROOM_LIMITS)
    except ProgramError as error:
        return text, str(error)[:200].rstrip(".")
    return made, ""


def _requests(view: View, deciding: Deciding, asked: Sequence[ProxyLine]) -> list[Request]:
    """One question, or a few side by side where there are many objects."""
    if not asked:
        return []
    size = max(BATCH, -(-len(asked) // MOST_CALLS))
    groups = batches(asked, size)
    return [_request(view, deciding, n, group) for n, group in enumerate(groups, 1)]


def _request(view: View, deciding: Deciding, number: int, group: Sequence[ProxyLine]) -> Request:
    analysis, camera = view.need(SceneAnalysis), view.need(Calibration).camera
    boxes = [(str(n), box) for n, p in enumerate(group, 1) if (box := picture_box(p, camera, analysis)) is not None]
    surfaces = [n for n in deciding.cells if deciding.layout.proxy(n) is None and n != TOPS] if number == 1 else []
    return Request(
        key=f"08_materials/{number}",
        prompt="08_materials",
        reply=MaterialsReply,
        values={
            "style": view.need(RoomStyle).style or "not known",
            "objects": "\n".join(_lines(view, deciding, n, proxy) for n, proxy in enumerate(group, 1)),
            "surfaces": "\n".join(f"{n}, #{deciding.choices[n][0].code}" for n in surfaces) or "none in this list",
            "looks": looks_reference(),
            "room": view.noted(p.id for p in group),
        },
        images=(Picture("room", view.reference.with_boxes_drawn(boxes, long_side=1280)),),
    )


def _lines(view: View, deciding: Deciding, number: int, proxy: ProxyLine) -> str:
    """An object of the question, and under it its parts, the ones that are seen most first."""
    described = view.need(Descriptions).of(proxy.id)
    head = "; ".join(part for part in (object_line(number, proxy, described), described.words) if part)
    pairs = sorted(zip(deciding.cells[proxy.id], deciding.choices[proxy.id], strict=True), key=lambda p: -p[0].share)
    rows = [f"   {c.part or '(no name)'}, {c.role or 'no role'}, #{choice.code}, {c.share:.0%}"
            for c, choice in pairs[:_PARTS]]  # fmt: skip
    return "\n".join([head, *rows])


STAGE = Stage(
    id=ID,
    title="Materials",
    reads=(
        Reads(SceneAnalysis),
        Reads(Calibration),
        Reads(LayoutProgram, ("s07_surfaces",)),
        Reads(Descriptions),
        Reads(RoomStyle),
    ),
    writes=(LayoutProgram, Materials),
    run=run,
    notes=True,
    partial=True,
    recalls=(Reads(LayoutProgram, (ID,)), Reads(Materials), Reads(OwnFinishes)),
)
