# SPDX-License-Identifier: GPL-3.0-or-later
"""Which object is which: ids that last from one analysis to the next, and corrections that find their object again."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from ..artifacts.analysis import DetectedObject, Finding, SceneAnalysis
from ..artifacts.common import ImageBox, ImagePoint
from ..artifacts.corrections import AddedObject, Corrections, Found, ObjectCorrection
from .clean import SHELL_NAMES, clean_id

AGREES, AGREES_BLINDLY = 0.5, 0.7
"""IoU from which two boxes are of one thing: with a word of their categories in common, and without."""
LONGEST_NOTE = 300


def keep_ids(before: SceneAnalysis, new: SceneAnalysis) -> SceneAnalysis:
    """The new analysis with the ids that its objects had before, as far as they are seen to be the same things.

    What the artist did (edits, locks, notes) is kept by id, and a model calls things differently every time it is asked.
    """
    names = _same_things(before.objects, new.objects)
    taken = {*names.values(), *(a.id for a in new.architecture), *SHELL_NAMES}
    for item in new.objects:
        if item.id not in names:
            names[item.id] = clean_id(item.id, taken, "object")
    if all(old == now for old, now in names.items()):
        return new
    objects = [
        o.model_copy(update={"id": names[o.id], "parent": names.get(o.parent or "", o.parent)}) for o in new.objects
    ]
    return new.model_copy(update={"objects": objects})


def _same_things(before: list[DetectedObject], new: list[DetectedObject]) -> dict[str, str]:
    """New id to old id, for the objects that are the same."""
    pairs = []
    for a in before:
        for b in new:
            iou = 0.0 if a.box is None or b.box is None else a.box.iou(b.box)
            words = bool(set(a.category.lower().split()) & set(b.category.lower().split()))
            if iou >= (AGREES if words else AGREES_BLINDLY):
                pairs.append((iou + (0.1 if words else 0.0) + (0.2 if a.id == b.id else 0.0), a.id, b.id))
    names: dict[str, str] = {}
    given: set[str] = set()
    for _, old, now in sorted(pairs, key=lambda p: (-p[0], p[1], p[2])):
        if now not in names and old not in given:
            names[now] = old
            given.add(old)
    old_ids = {o.id for o in before}
    for item in new:
        # The same name at another place: seen better now, unless that name's thing was seen elsewhere.
        if item.id in old_ids and item.id not in names and item.id not in given:
            names[item.id] = item.id
            given.add(item.id)
    return names


def found_again(
    corrections: Corrections, new: SceneAnalysis, by_hand: Collection[str] = ()
) -> tuple[Corrections, list[Finding]]:
    """The corrections for another analysis: by id, else by place; what fits nothing is kept as added, or reported.

    Args:
        by_hand: ids that the artist made or renamed in the scene; the analysis need not know them.
    """
    objects = {o.id: o for o in new.objects}
    claimed = {c.id for c in corrections.objects if c.id in objects} | {a.id for a in corrections.added}
    findings: list[Finding] = []
    kept: list[ObjectCorrection] = []
    added = list(corrections.added)
    own = {a.id for a in added}
    for said in corrections.objects:
        if said.id in objects or said.id in own or said.id in by_hand:
            kept.append(said)
            continue
        there = _at(said.box or said.seen, objects, claimed)
        if there is not None:
            claimed.add(there)
            kept.append(said.model_copy(update={"id": there}))
        elif said.box is not None and said.category and said.include is not False:
            added.append(AddedObject(id=said.id, category=said.category, box=said.box))
            kept.append(said.model_copy(update={"box": None, "category": ""}))
            findings.append(Finding(about=said.id, message="It was not found again; it is kept as you corrected it."))
        else:
            message = "It was not found again; what you said of it has no effect."
            findings.append(Finding(about=said.id, message=message, severity="warning"))
            kept.append(said)
    return corrections.model_copy(update={"objects": kept, "added": added}), findings


def _at(box: ImageBox | None, objects: Mapping[str, DetectedObject], claimed: set[str]) -> str | None:
    """Id of the object that the box agrees with most, None when there is none that nothing was said of."""
    if box is None:
        return None
    free = [(o.box.iou(box), i) for i, o in objects.items() if i not in claimed and o.box is not None]
    best = max(free, default=(0.0, ""))
    return best[1] if best[0] >= AGREES else None


def normal(corrections: Corrections, found: Found) -> Corrections:
    """The same corrections in one form: clean ids of what was added, boxes inside the picture, nothing said twice.

    Applied to its own result it changes nothing.
    """
    analysis = found.analysis
    boxes = {o.id: o.box for o in analysis.objects}
    taken = {*boxes, *(a.id for a in analysis.architecture), *SHELL_NAMES}
    added: list[AddedObject] = []
    for new in corrections.added:
        box = _inside(new.box)
        category = " ".join(new.category.split())[:60] or "object"
        if box is not None:
            name = clean_id(new.id or category, taken, "object")
            added.append(AddedObject(id=name, category=category, box=box))
    objects: dict[str, ObjectCorrection] = {}
    for said in corrections.objects:
        update: dict[str, object] = {
            "note": " ".join(said.note.split())[:LONGEST_NOTE],
            "category": " ".join(said.category.split())[:60],
            "box": None if said.box is None else _inside(said.box),
            "seen": boxes.get(said.id) or said.seen,
        }
        objects[said.id] = said.model_copy(update=update)
    polygon = corrections.floor_polygon
    if polygon is not None:
        polygon = [ImagePoint(x=max(-200.0, min(1200.0, p.x)), y=max(-200.0, min(1200.0, p.y))) for p in polygon[:64]]
    kept = [said for said in objects.values() if not said.says_nothing]
    same = polygon == analysis.floor_polygon
    return corrections.model_copy(update={"objects": kept, "added": added, "floor_polygon": None if same else polygon})


def _inside(box: ImageBox) -> ImageBox | None:
    """The box inside the picture with its corners in order; None when hardly anything is left."""
    x = sorted(min(1000.0, max(0.0, v)) for v in (box.x_min, box.x_max))
    y = sorted(min(1000.0, max(0.0, v)) for v in (box.y_min, box.y_max))
    if x[1] - x[0] < 1.0 or y[1] - y[0] < 1.0:
        return None
    return ImageBox(x_min=x[0], y_min=y[0], x_max=x[1], y_max=y[1])
