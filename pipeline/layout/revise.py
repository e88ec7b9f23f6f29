# SPDX-License-Identifier: GPL-3.0-or-later
"""Sanitise and revise: what the critic asks for becomes typed edits, unless evidence speaks against it. (Paper, stage 3.)"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..analysis.clean import clean_box, clean_id, facing_yaw
from ..artifacts.analysis import Calibration, DetectedObject, Finding
from ..artifacts.common import ImageBox
from ..artifacts.layout import Layout, LayoutEdit
from ..artifacts.replies import CritiqueReply, EditReply
from ..geometry.camera import GeometryError
from ..geometry.footprint import lift_box
from ..geometry.polygon import outside_fraction, rectangle_corners
from .initial import Evidence, proxy_of

MAX_EDITS = 12
SURE = 0.6
SEEN_IOU = 0.3


@dataclass(frozen=True)
class Sanitised:
    """The edits that stay, the evidence they change, and what was refused and why."""

    edits: list[LayoutEdit]
    evidence: Evidence
    refused: list[Finding]


def sanitise(
    reply: CritiqueReply,
    layout: Layout,
    evidence: Evidence,
    calibration: Calibration,
    locked: frozenset[str],
    only: frozenset[str] | None = None,
) -> Sanitised:
    """Keep what can be done and is not against strong evidence; everything else is reported.

    Refused: unknown ids, architecture, locked objects, boxes outside the picture or without room on the floor, removal
    of what was clearly seen, moves to where the first detection sees nothing of it; with `only`, whatever is not of it.
    """
    edits: list[LayoutEdit] = []
    refused: list[Finding] = []
    for asked in reply.edits[:MAX_EDITS]:
        if only is not None and (asked.op == "add" or asked.id not in only):
            refused.append(Finding(about=asked.id, message=f"The critic wants to {asked.op} it, but it is not chosen."))
            continue
        result = _one(asked, layout, evidence, calibration, locked)
        if isinstance(result, Finding):
            refused.append(result)
        elif result is not None:
            edit, evidence = result
            edits.append(edit)
    if len(reply.edits) > MAX_EDITS:
        refused.append(Finding(about="critique", message=f"Only the first {MAX_EDITS} edits are taken in one round."))
    return Sanitised(edits, evidence, refused)


def _one(
    asked: EditReply, layout: Layout, evidence: Evidence, calibration: Calibration, locked: frozenset[str]
) -> tuple[LayoutEdit, Evidence] | Finding | None:
    if asked.op == "add":
        return _add(asked, layout, evidence, calibration)
    proxy = layout.proxy(asked.id)
    item = evidence.objects.get(asked.id)
    if proxy is None or item is None:
        return Finding(about=asked.id, message=f"The critic wants to {asked.op} {asked.id!r}, which is not a proxy.")
    if asked.id in locked:
        return Finding(
            about=asked.id, message=f"The critic wants to {asked.op} it, but it is locked or edited by hand."
        )
    if asked.op == "remove":
        if item.confidence >= SURE:
            return Finding(about=asked.id, message="The critic wants to remove it, but it was clearly seen.")
        return LayoutEdit(op="remove", id=asked.id, reason=asked.reason[:160]), evidence.without(asked.id)
    if asked.op == "recategorise":
        category = (asked.category or "").strip()[:60]
        if not category:
            return Finding(about=asked.id, message="A new category was announced but not given.")
        edit = LayoutEdit(op="recategorise", id=asked.id, category=category, reason=asked.reason[:160])
        return edit, evidence.with_object(item.model_copy(update={"category": category}))
    if asked.op == "turn":
        yaw = facing_yaw(asked.facing or "none", asked.yaw_deg if asked.yaw_deg is not None else proxy.yaw)
        if abs((yaw - proxy.yaw + 180) % 360 - 180) < 3:
            return None
        turned = evidence.with_object(item.model_copy(update={"yaw": yaw}))
        return LayoutEdit(op="turn", id=asked.id, yaw=yaw, reason=asked.reason[:160]), turned
    return _move(asked, item, evidence, calibration)


def _move(
    asked: EditReply, item: DetectedObject, evidence: Evidence, calibration: Calibration
) -> tuple[LayoutEdit, Evidence] | Finding | None:
    """A new box is a second measurement of the same thing: it is averaged with the first one and fused again."""
    box = clean_box(asked.box)
    if box is None:
        return Finding(about=item.id, message=f"The critic wants to {asked.op} it but gives no usable box.")
    if item.box is not None:
        apart = box.iou(item.box)
        if apart < SEEN_IOU and item.confidence >= SURE:
            return Finding(about=item.id, message="The critic moves it to where it was not seen before; refused.")
        if apart > 0.97 and asked.size_m is None:
            return None
        box = _mean_box(item.box, box)
    update: dict[str, object] = {"box": box}
    if asked.size_m is not None:
        sizes = (asked.size_m.width, asked.size_m.depth, asked.size_m.height)
        if all(0.01 < s < 20 for s in sizes):
            update["size"] = tuple(math.sqrt(a * b) for a, b in zip(sizes, item.size, strict=True))
    changed = item.model_copy(update=update)
    proxy, _ = proxy_of(changed, calibration, item.centre[2] - item.size[2] / 2 if item.placement != "floor" else 0.0)
    if outside_fraction(rectangle_corners(proxy.centre, proxy.size, proxy.yaw), calibration.floor) > 0.5:
        return Finding(about=item.id, message="The critic moves it out of the room; refused.")
    edit = LayoutEdit(op="move", id=item.id, centre=proxy.centre, size=proxy.size, reason=asked.reason[:160])
    return edit, evidence.with_object(changed)


def _add(
    asked: EditReply, layout: Layout, evidence: Evidence, calibration: Calibration
) -> tuple[LayoutEdit, Evidence] | Finding:
    box = clean_box(asked.box)
    category = (asked.category or "").strip()[:60]
    if box is None or asked.size_m is None or not category:
        return Finding(about=asked.id, message="The critic wants to add something without box, size or category.")
    size = tuple(max(0.02, min(10.0, abs(v))) for v in (asked.size_m.width, asked.size_m.depth, asked.size_m.height))
    known = next((o for o in evidence.objects.values() if o.box is not None and o.box.iou(box) > 0.5), None)
    if known is not None:
        return Finding(about=asked.id, message=f"The critic wants to add what is already known as {known.id}.")
    yaw = facing_yaw(asked.facing or "none", asked.yaw_deg or 0.0)
    try:
        lifted = lift_box(calibration.camera, box, 0.0, size[2], yaw, size)
    except GeometryError as error:
        return Finding(about=asked.id, message=f"What the critic adds cannot be placed: {error.message}")
    cut = [line.id for lines in (layout.doors, layout.windows, layout.openings) for line in lines]
    taken = {*evidence.objects, *(w.id for w in layout.walls), *(p.id for p in layout.proxies), *cut}
    name = clean_id(asked.id or category, taken, "object")
    item = DetectedObject(
        id=name,
        category=category,
        box=box,
        centre=(lifted.centre[0], lifted.centre[1], size[2] / 2),
        size=(size[0], size[1], size[2]),
        yaw=yaw,
        confidence=0.5,
        source="critique",
    )
    proxy, _ = proxy_of(item, calibration, 0.0)
    if outside_fraction(rectangle_corners(proxy.centre, proxy.size, proxy.yaw), calibration.floor) > 0.5:
        return Finding(about=name, message="The critic adds it outside the room; refused.")
    edit = LayoutEdit(
        op="add",
        id=name,
        category=item.category,
        centre=proxy.centre,
        size=proxy.size,
        yaw=proxy.yaw,
        placement="floor",
        salience="major",
        reason=asked.reason[:160],
    )
    return edit, evidence.with_object(item)


def _mean_box(a: ImageBox, b: ImageBox) -> ImageBox:
    return ImageBox(
        x_min=(a.x_min + b.x_min) / 2,
        y_min=(a.y_min + b.y_min) / 2,
        x_max=(a.x_max + b.x_max) / 2,
        y_max=(a.y_max + b.y_max) / 2,
    )


def revise(layout: Layout, sanitised: Sanitised, calibration: Calibration) -> Layout:
    """The layout after the edits: touched proxies are placed anew from their evidence, the rest stays as it is."""
    removed = {e.id for e in sanitised.edits if e.op == "remove"}
    renamed = {e.id: e.category for e in sanitised.edits if e.op == "recategorise" and e.category}
    moved = {e.id for e in sanitised.edits if e.op in ("move", "resize", "turn", "add")}
    proxies = []
    for proxy in layout.proxies:
        if proxy.id in removed:
            continue
        if proxy.id in moved:
            base = proxy.centre[2] - proxy.size[2] / 2
            again = proxy_of(sanitised.evidence.objects[proxy.id], calibration, base)[0]
            # The detected parent may be nothing that stage 3 places, such as the rug below a chair.
            proxy = again.model_copy(update={"parent": proxy.parent})
        if proxy.id in renamed:
            proxy = proxy.model_copy(update={"category": renamed[proxy.id]})
        proxies.append(proxy)
    known = {p.id for p in layout.proxies}
    for edit in sanitised.edits:
        if edit.op == "add" and edit.id not in known:
            proxies.append(proxy_of(sanitised.evidence.objects[edit.id], calibration, 0.0)[0])
    return layout.model_copy(update={"proxies": proxies})
