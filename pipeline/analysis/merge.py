# SPDX-License-Identifier: GPL-3.0-or-later
"""The second look merged into the first: what was missed is added, what was wrong is corrected, all of it reported."""

from __future__ import annotations

from collections.abc import Sequence

from ..artifacts.analysis import DetectedObject, Finding, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.replies import BoxReply, CorrectionReply, MissedReply, SecondLookReply
from .clean import MAX_OBJECTS, SIDE_NAMES, clean_box, clean_object, facing_yaw, fix_parents

SAME_BOX = 0.6
BOX_CORRECTED = "corrected box"
"""Source of an object whose box the second look moved: its metres were guessed from the wrong box."""


def to_whole_picture(box: BoxReply, crop: ImageBox | None) -> BoxReply:
    """A box given in 0-1000 of a crop, in 0-1000 of the whole picture (unchanged when `crop` is None)."""
    if crop is None:
        return box
    sx, sy = (crop.x_max - crop.x_min) / 1000.0, (crop.y_max - crop.y_min) / 1000.0
    return BoxReply(
        x_min=crop.x_min + box.x_min * sx,
        y_min=crop.y_min + box.y_min * sy,
        x_max=crop.x_min + box.x_max * sx,
        y_max=crop.y_min + box.y_max * sy,
    )


def merge_second_look(analysis: SceneAnalysis, reply: SecondLookReply, crops: list[ImageBox | None]) -> SceneAnalysis:
    """Stage 1's result after the second look.

    Args:
        crops: for each picture of the request, what part of the whole it shows; None for the whole.
    """
    findings = list(analysis.findings)
    objects = with_corrections(analysis.objects, reply.corrections, findings)
    taken = {o.id for o in objects} | {a.id for a in analysis.architecture}
    named: dict[str, str] = {}
    for missed in reply.missed:
        if len(objects) >= MAX_OBJECTS:
            findings.append(Finding(about="objects", message=f"More than {MAX_OBJECTS} objects; the rest is left out."))
            break
        found = _missed(missed, crops, taken, findings)
        if found is None:
            continue
        twin = next((o for o in objects if _same(o, found)), None)
        if twin is not None:
            findings.append(Finding(about=found.id, message=f"Seen again in the second look; it is {twin.id}."))
            taken.discard(found.id)
            named.setdefault(missed.id, twin.id)
            continue
        named.setdefault(missed.id, found.id)
        objects.append(found)
    # A parent is named as the answer called it, which may be a twin of something found before.
    known = taken | SIDE_NAMES
    objects = [
        o if o.parent is None or o.parent in known else o.model_copy(update={"parent": named.get(o.parent, o.parent)})
        for o in objects
    ]
    walls = {a.id for a in analysis.architecture} | SIDE_NAMES
    return analysis.model_copy(update={"objects": fix_parents(objects, walls, findings), "findings": findings})


def _missed(
    missed: MissedReply, crops: list[ImageBox | None], taken: set[str], findings: list[Finding]
) -> DetectedObject | None:
    index = missed.picture - 1
    if not 0 <= index < len(crops):
        findings.append(
            Finding(about=missed.id, message=f"It names picture {missed.picture}, which was not sent; dropped.")
        )
        return None
    placed = missed.model_copy(update={"box": to_whole_picture(missed.box, crops[index])})
    return clean_object(placed, taken, findings, "second look")


def _same(a: DetectedObject, b: DetectedObject) -> bool:
    """Whether two detections are one thing: boxes that agree, and categories that share a word."""
    if a.box is None or b.box is None or a.box.iou(b.box) < SAME_BOX:
        return False
    return bool(set(a.category.lower().split()) & set(b.category.lower().split()))


def with_corrections(
    found: Sequence[DetectedObject], corrections: Sequence[CorrectionReply], findings: list[Finding]
) -> list[DetectedObject]:
    """The objects with better boxes and names, and without those that are taken back; all of it is reported."""
    objects = list(found)
    index = {o.id: i for i, o in enumerate(objects)}
    dropped: set[str] = set()
    for fix in corrections:
        if fix.id not in index:
            findings.append(Finding(about=fix.id, message="The second look corrects an object that does not exist."))
            continue
        if fix.remove:
            dropped.add(fix.id)
            findings.append(Finding(about=fix.id, message=f"Taken back by the second look: {fix.wrong[:120]}"))
            continue
        i = index[fix.id]
        objects[i] = _apply(objects[i], fix, findings)
    return [o for o in objects if o.id not in dropped]


def _apply(item: DetectedObject, fix: CorrectionReply, findings: list[Finding]) -> DetectedObject:
    update: dict[str, object] = {}
    box = clean_box(fix.box)
    if box is not None:
        update["box"] = box
        update["source"] = BOX_CORRECTED
    if fix.category:
        update["category"] = fix.category.strip()[:60]
    if fix.facing is not None and fix.facing != "none":
        update["yaw"] = facing_yaw(fix.facing, item.yaw)
    if fix.parent is not None:
        update["parent"] = fix.parent or None
    if update:
        findings.append(
            Finding(about=item.id, message=f"Corrected by the second look: {', '.join(update)}. {fix.wrong[:100]}")
        )
    return item.model_copy(update=update)
