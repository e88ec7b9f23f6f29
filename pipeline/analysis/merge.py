# SPDX-License-Identifier: GPL-3.0-or-later
"""The second look merged into the first: what was missed is added, what was wrong is corrected, all of it reported."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..artifacts.analysis import DetectedObject, Finding, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.replies import BoxReply, CorrectionReply, MissedReply, SecondLookReply
from .clean import MAX_METRES, MAX_OBJECTS, SIDE_NAMES, clean_box, clean_object, facing_yaw, fix_parents

SAME_BOX = 0.6
"""IoU from which two boxes with a word of their categories in common are of one thing."""
SAME_PLACE = 0.8
"""IoU from which two boxes are of one thing whatever it is called, when it stands on the same."""
CUT = 0.8
"""What part of a box that a picture's edge cuts has to lie in another one to be of the same thing."""
AT_EDGE = 12.0
"""A box that comes so near to the edge of its enlarged part (0-1000 of that) is taken to be cut there."""
SMALL = 60.0
"""Sides in 0-1000 below which boxes are compared leniently: a few units are a large part of them."""
LEAST_SIZE = 0.005
BOX_CORRECTED = "corrected box"
"""Source of an object whose box the second look moved: its metres were guessed from the wrong box."""
SEEN_AGAIN = "second look"


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
    objects = with_corrections(analysis.objects, reply.corrections, findings, crops)
    taken = {o.id for o in objects} | {a.id for a in analysis.architecture}
    named: dict[str, str] = {}
    for missed in reply.missed:
        if len(objects) >= MAX_OBJECTS:
            findings.append(Finding(about="objects", message=f"More than {MAX_OBJECTS} objects; the rest is left out."))
            break
        found = _missed(missed, crops, taken, findings)
        if found is None:
            continue
        cut = _is_cut(missed, crops)
        twin = next((o for o in objects if _same(o, found, cut)), None)
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


def _is_cut(missed: MissedReply, crops: list[ImageBox | None]) -> bool:
    """Whether a box ends at the edge of an enlarged part, beyond which the thing may go on."""
    if crops[missed.picture - 1] is None:
        return False
    box = missed.box
    return min(box.x_min, box.y_min) < AT_EDGE or max(box.x_max, box.y_max) > 1000.0 - AT_EDGE


def _same(a: DetectedObject, b: DetectedObject, cut: bool = False) -> bool:
    """Whether two detections are one thing: boxes that agree, and categories that share a word, or one place.

    Args:
        cut: `b` was seen at the edge of an enlarged part, and may be a piece of `a`.
    """
    if a.box is None or b.box is None:
        return False
    iou = a.box.iou(b.box)
    if set(a.category.lower().split()) & set(b.category.lower().split()):
        within = _shared(a.box, b.box) / max(1e-9, b.box.area)
        return iou >= SAME_BOX or (cut and within >= CUT) or _nearly(a.box, b.box)
    return iou >= SAME_PLACE and a.placement == b.placement and a.parent == b.parent


def _nearly(a: ImageBox, b: ImageBox) -> bool:
    """Whether two small boxes are one, read twice with an error of some units: about one size, centres close together."""
    sides = [(box.x_max - box.x_min, box.y_max - box.y_min) for box in (a, b)]
    if max(v for pair in sides for v in pair) > SMALL:
        return False
    return all(
        0.6 < sides[0][i] / sides[1][i] < 1.0 / 0.6
        and abs(a.centre[i] - b.centre[i]) < 0.35 * min(sides[0][i], sides[1][i])
        for i in (0, 1)
    )


def _shared(a: ImageBox, b: ImageBox) -> float:
    width = min(a.x_max, b.x_max) - max(a.x_min, b.x_min)
    height = min(a.y_max, b.y_max) - max(a.y_min, b.y_min)
    return max(0.0, width) * max(0.0, height)


def with_corrections(
    found: Sequence[DetectedObject],
    corrections: Sequence[CorrectionReply],
    findings: list[Finding],
    crops: Sequence[ImageBox | None] = (None,),
) -> list[DetectedObject]:
    """The objects with better boxes and names, and without those that are taken back; all of it is reported.

    Args:
        crops: for each picture of the request, what part of the whole it shows; None for the whole.
    """
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
        objects[i] = _apply(objects[i], fix, findings, crops)
    return [o for o in objects if o.id not in dropped]


def _apply(
    item: DetectedObject, fix: CorrectionReply, findings: list[Finding], crops: Sequence[ImageBox | None]
) -> DetectedObject:
    update: dict[str, object] = {}
    box = None
    if fix.box is not None and not 1 <= fix.picture <= len(crops):
        message = f"Its better box names picture {fix.picture}, which was not sent; the box is not used."
        findings.append(Finding(about=fix.id, message=message))
    elif fix.box is not None:
        box = clean_box(to_whole_picture(fix.box, crops[fix.picture - 1]))
    if box is not None:
        update["box"] = box
    update |= _metres(item, fix)
    if fix.centre_m is not None and "centre" in update:
        update["source"] = SEEN_AGAIN
    elif box is not None:
        update["source"] = BOX_CORRECTED
    if fix.category:
        update["category"] = fix.category.strip()[:60]
    if fix.yaw_deg is not None and math.isfinite(fix.yaw_deg):
        update["yaw"] = fix.yaw_deg % 360.0
    elif fix.facing is not None and fix.facing != "none":
        update["yaw"] = facing_yaw(fix.facing, item.yaw)
    if fix.placement is not None:
        update["placement"] = fix.placement
    if fix.parent is not None:
        update["parent"] = fix.parent or None
    if update:
        findings.append(
            Finding(about=item.id, message=f"Corrected by the second look: {', '.join(update)}. {fix.wrong[:100]}")
        )
    return item.model_copy(update=update)


def _metres(item: DetectedObject, fix: CorrectionReply) -> dict[str, object]:
    """What a correction says of place and size, as far as it is possible; else the underside stays where it is."""
    update: dict[str, object] = {}
    centre, size = fix.centre_m, fix.size_m
    base, sizes = item.centre[2] - item.size[2] / 2, item.size
    raised = fix.base_m is not None and 0.0 <= fix.base_m <= MAX_METRES
    if raised and fix.base_m is not None:
        base = fix.base_m
    if size is not None:
        said = (abs(size.width), abs(size.depth), abs(size.height))
        if min(said) >= LEAST_SIZE and max(said) <= MAX_METRES:
            sizes = said
            update["size"] = said
    x, y = item.centre[:2]
    if centre is not None and max(abs(centre.x_m), abs(centre.y_m)) <= MAX_METRES:
        x, y = centre.x_m, centre.y_m
    if update or centre is not None or raised:
        update["centre"] = (x, y, base + sizes[2] / 2)
    return update
