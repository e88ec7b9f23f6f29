# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 5, descriptions: what each placed object looks like, in words from its crop and in colours from its pixels."""

from __future__ import annotations

from collections.abc import Sequence

from ..artifacts.analysis import Calibration, Finding, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.layout import Layout, LayoutProgram, ProxyLine
from ..artifacts.objects import DescribedReply, Descriptions, DescriptionsReply, ObjectDescription, RoomStyle
from ..layout.hand import apply_hand_edits
from ..objects.asking import batches, crop_of, object_line, picture_box
from ..objects.colours import ColourMeter, clean_code
from ..program.lines import parse_layout
from .base import Reads, Stage, View
from .wishes import Ask, Picture, Request, StageRun, Tell

ID = "s05_descriptions"
BATCH = 8
_LONGEST = 160


def run(view: View) -> StageRun:
    """Write `Descriptions` and `RoomStyle`; one round of requests side by side, a crop for each object."""
    analysis, calibration, program = view.need(SceneAnalysis), view.need(Calibration), view.need(LayoutProgram)
    layout, _ = apply_hand_edits(parse_layout(program.text), view.hand_edits, program.hand_edits)
    before = view.recall(Descriptions) or Descriptions()
    yield Tell("Measuring colours", 1, 2)
    boxes = {o.id: o.box for o in [*analysis.objects, *analysis.left_out] if o.box is not None}
    meter = ColourMeter(view.reference, calibration.camera, layout, boxes)
    fresh = [p for p in layout.proxies if view.only is None or view.chosen(p.id)]
    measured = {p.id: _measured(meter, p) for p in fresh}
    yield Tell("Describing the objects", 2, 2)
    requests, unseen = _requests(view, analysis, calibration, fresh, measured)
    answers = (yield Ask(tuple(requests), optional=True)) if requests else []
    said = {o.id: o for reply in answers if reply is not None for o in reply.objects}
    objects = []
    for proxy in layout.proxies:
        if proxy.id in measured:
            objects.append(_worded(measured[proxy.id], said.get(proxy.id)))
        else:
            objects.append(before.of(proxy.id))
    findings = [
        Finding(about=i, message="The picture does not show it; it is described by its category.") for i in unseen
    ]
    findings += _missing(requests, answers)
    styles = [
        reply.room_style.strip()[:_LONGEST] for reply in answers if reply is not None and reply.room_style.strip()
    ]
    standing = view.recall(RoomStyle)
    style = styles[0] if styles else standing.style if standing is not None and view.only is not None else ""
    red, green, blue = (float(g) for g in meter.gains)
    return [Descriptions(objects=objects, findings=findings), RoomStyle(style=style, gains=(red, green, blue))]


def _measured(meter: ColourMeter, proxy: ProxyLine) -> ObjectDescription:
    colours, seen = meter.measure(proxy)
    return ObjectDescription(id=proxy.id, measured=colours, seen=round(min(1.0, seen), 3))


def _worded(measured: ObjectDescription, said: DescribedReply | None) -> ObjectDescription:
    """What was measured, with what the model said."""
    if said is None:
        return measured
    words = {n: getattr(said, n).strip()[:_LONGEST] for n in ("colour", "material", "function", "structure", "style")}
    return measured.model_copy(update={**words, "code": clean_code(said.main_colour)})


def _missing(requests: Sequence[Request], answers: Sequence[DescriptionsReply | None]) -> list[Finding]:
    lost = sum(answer is None for answer in answers)
    if not lost:
        return []
    message = f"{lost} of {len(requests)} questions had no usable answer; measured colours stand for the words."
    return [Finding(about="descriptions", message=message, severity="warning")]


def _requests(
    view: View,
    analysis: SceneAnalysis,
    calibration: Calibration,
    proxies: Sequence[ProxyLine],
    measured: dict[str, ObjectDescription],
) -> tuple[list[Request], list[str]]:
    """The questions about what the picture shows, and the ids of what it does not."""
    boxes = {p.id: picture_box(p, calibration.camera, analysis) for p in proxies}
    shown = [(p, box) for p in proxies if (box := boxes[p.id]) is not None]
    found = [_request(view, n, batch, measured) for n, batch in enumerate(batches(shown, BATCH), 1)]
    return found, [p.id for p in proxies if boxes[p.id] is None]


def _request(
    view: View, number: int, batch: Sequence[tuple[ProxyLine, ImageBox]], measured: dict[str, ObjectDescription]
) -> Request:
    lines = [object_line(n, proxy, measured[proxy.id]) for n, (proxy, _) in enumerate(batch, 1)]
    whole = view.reference.with_boxes_drawn([(str(n), box) for n, (_, box) in enumerate(batch, 1)], long_side=900)
    crops = [Picture(proxy.id, crop_of(view.reference, box)) for proxy, box in batch]
    return Request(
        key=f"05_descriptions/{number}",
        prompt="05_descriptions",
        reply=DescriptionsReply,
        values={"objects": "\n".join(lines), "room": view.noted(proxy.id for proxy, _ in batch)},
        images=(Picture("room", whole), *crops),
    )


def described_layout(view: View) -> Layout:
    """The layout that stands, with all hand edits."""
    program = view.need(LayoutProgram)
    return apply_hand_edits(parse_layout(program.text), view.hand_edits, program.hand_edits)[0]


STAGE = Stage(
    id=ID,
    title="Descriptions",
    reads=(Reads(SceneAnalysis), Reads(Calibration), Reads(LayoutProgram, ("s04_auxiliary",))),
    writes=(Descriptions, RoomStyle),
    run=run,
    notes=True,
    partial=True,
    recalls=(Reads(Descriptions), Reads(RoomStyle)),
)
