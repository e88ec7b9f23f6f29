# SPDX-License-Identifier: GPL-3.0-or-later
"""Sanitise: what the critic asks for becomes typed edits, unless evidence speaks against it. (Paper, stage 3.)"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from ..analysis.clean import clean_box, clean_id, facing_yaw
from ..analysis.facing import faces_its_wall
from ..analysis.merge import BOX_CORRECTED
from ..artifacts.analysis import Calibration, DetectedObject, Finding
from ..artifacts.common import ImageBox
from ..artifacts.layout import Layout, LayoutEdit
from ..artifacts.replies import CritiqueReply, EditReply
from ..artifacts.trust import Trust
from ..geometry.camera import GeometryError
from ..geometry.footprint import image_box_of, lift_box
from ..geometry.polygon import outside_fraction, overlap_fraction, rectangle_corners
from .initial import Evidence, proxy_of
from .past import Past, state_of
from .score import box_iou, corners
from .standing import FLAT

MAX_EDITS = 12
SURE = 0.6
"""From this confidence on, something was clearly seen."""
SEEN_IOU = 0.3
"""Boxes that share less are of different places."""
AGREE_IOU = 0.5
"""Two measurements that share so much agree on the place."""
SAME_THING = 0.5
SAME_KIND = 0.25
"""Boxes that share so much are of one thing; with a word of their categories in common, less is enough."""
BEYOND = 2.0
"""Boxes that are further apart than so many of their usual differences are not two readings of one place."""
BELIEVED = 2.0 / 3.0
"""How far a corrected box goes to where the critic sees it."""
TURN_LOSS = 0.12
"""A turn after which a thing covers so much less of its box is not what the picture shows."""
MOST_OUTSIDE = 0.5
INSIDE_ANOTHER = 0.7
OFF_FLOOR = 0.15
"""What is added higher above the floor than this, metres, is for the next stage."""

Result = tuple[LayoutEdit, Evidence] | Finding | None
"""An edit with the evidence that it changes; why it is refused; or nothing, where it would change nothing."""


@dataclass(frozen=True)
class Sanitised:
    """The edits that stay, the evidence they change, and what was refused and why."""

    edits: list[LayoutEdit]
    evidence: Evidence
    refused: list[Finding]


@dataclass
class _Judge:
    """What one round's edits are judged by. `evidence` grows with each edit that is taken."""

    layout: Layout
    evidence: Evidence
    calibration: Calibration
    locked: frozenset[str]
    past: Past = field(default_factory=Past)


def sanitise(
    reply: CritiqueReply,
    layout: Layout,
    evidence: Evidence,
    calibration: Calibration,
    locked: frozenset[str],
    only: frozenset[str] | None = None,
    past: Past | None = None,
) -> Sanitised:
    """Keep what can be done and is not against strong evidence; everything else is reported.

    Refused: unknown ids, architecture, locked objects, boxes outside the picture or without room on the floor, removal
    of what was clearly seen, moves to where both earlier measurements agree that it is not, turns to a wall or against
    the picture's box, doubles of what is known, and what goes back and forth; with `only`, whatever is not of it.
    """
    judge = _Judge(layout, evidence, calibration, locked, Past() if past is None else past)
    edits: list[LayoutEdit] = []
    refused: list[Finding] = []
    for asked in reply.edits[:MAX_EDITS]:
        if only is not None and (asked.op == "add" or asked.id not in only):
            refused.append(Finding(about=asked.id, message=f"The critic wants to {asked.op} it, but it is not chosen."))
            continue
        result = _one(asked, judge)
        if isinstance(result, Finding):
            refused.append(result)
        elif result is not None:
            edit, judge.evidence = result
            edits.append(edit)
    if len(reply.edits) > MAX_EDITS:
        refused.append(Finding(about="critique", message=f"Only the first {MAX_EDITS} edits are taken in one round."))
    return Sanitised(edits, judge.evidence, refused)


def _one(asked: EditReply, judge: _Judge) -> Result:
    if asked.op == "add":
        return _add(asked, judge)
    layout = judge.layout
    cut = (layout.walls, layout.doors, layout.windows, layout.openings)
    if asked.id in {line.id for lines in cut for line in lines} | {"room"}:
        return Finding(about=asked.id, message=f"The critic wants to {asked.op} a part of the room itself; refused.")
    item = judge.evidence.objects.get(asked.id)
    if layout.proxy(asked.id) is None or item is None:
        return Finding(about=asked.id, message=f"The critic wants to {asked.op} {asked.id!r}, which is not a proxy.")
    if asked.id in judge.locked:
        return Finding(
            about=asked.id, message=f"The critic wants to {asked.op} it, but it is locked or edited by hand."
        )
    way = _WAYS[asked.op]
    return way(asked, item, judge)


def _remove(asked: EditReply, item: DetectedObject, judge: _Judge) -> Result:
    if item.confidence >= SURE:
        return Finding(about=item.id, message="The critic wants to remove it, but it was clearly seen.")
    carried = [o.id for o in judge.evidence.objects.values() if o.parent == item.id and o.confidence >= SURE]
    if carried:
        return Finding(about=item.id, message=f"The critic wants to remove it, but it carries {carried[0]}.")
    if judge.past.is_back_and_forth("remove", item.id, True, False):
        return _undecided(item.id)
    return LayoutEdit(op="remove", id=item.id, reason=asked.reason[:160]), judge.evidence.without(item.id)


def _recategorise(asked: EditReply, item: DetectedObject, judge: _Judge) -> Result:
    category = (asked.category or "").strip()[:60]
    if not category:
        return Finding(about=item.id, message="A new category was announced but not given.")
    if category.lower() == item.category.lower():
        return None
    if judge.past.is_back_and_forth("recategorise", item.id, item.category, category):
        return _undecided(item.id)
    edit = LayoutEdit(op="recategorise", id=item.id, category=category, reason=asked.reason[:160])
    return edit, judge.evidence.with_object(item.model_copy(update={"category": category}))


def _turn(asked: EditReply, item: DetectedObject, judge: _Judge) -> Result:
    proxy = judge.layout.proxy(item.id)
    assert proxy is not None
    yaw = facing_yaw(asked.facing or "none", asked.yaw_deg if asked.yaw_deg is not None else proxy.yaw)
    if abs((yaw - proxy.yaw + 180) % 360 - 180) < 3:
        return None
    if judge.past.is_back_and_forth("turn", item.id, proxy.yaw, yaw):
        return _undecided(item.id)
    turned = item.model_copy(update={"yaw": yaw})
    here = turned.model_copy(update={"centre": proxy.centre, "size": proxy.size})
    now = here.model_copy(update={"yaw": proxy.yaw})
    if faces_its_wall(here, judge.layout.walls) and not faces_its_wall(now, judge.layout.walls):
        return Finding(about=item.id, message="The critic turns it to face the wall that it stands at; refused.")
    if item.box is not None:
        placed, _ = proxy_of(turned, judge.calibration, proxy.centre[2] - proxy.size[2] / 2)
        camera = judge.calibration.camera
        if box_iou(placed, camera, item.box) < box_iou(proxy, camera, item.box) - TURN_LOSS:
            return Finding(about=item.id, message="Turned so, it would not fit its place in the picture; refused.")
    return LayoutEdit(op="turn", id=item.id, yaw=yaw, reason=asked.reason[:160]), judge.evidence.with_object(turned)


def _move(asked: EditReply, item: DetectedObject, judge: _Judge) -> Result:
    """A new box is a further measurement of the same thing: it is weighed with the earlier ones and fused again."""
    box = clean_box(asked.box)
    size = _said_size(asked)
    if box is None and (size is None or asked.op != "resize"):
        return Finding(about=item.id, message=f"The critic wants to {asked.op} it but gives no usable box.")
    update: dict[str, object] = {}
    if box is not None:
        against = _against(box, item, judge.calibration)
        if against is not None:
            return against
        if judge.past.is_back_and_forth(asked.op, item.id, state_of(asked.op, item), box):
            return _undecided(item.id)
        if item.box is not None and box.iou(item.box) > 0.97 and size is None:
            return None
        update |= _weighed(box, item, judge.calibration)
    if size is not None:
        update["size"] = tuple(math.sqrt(a * b) for a, b in zip(size, item.size, strict=True))
    changed = item.model_copy(update=update)
    base = item.centre[2] - item.size[2] / 2 if item.placement != "floor" else 0.0
    proxy, _ = proxy_of(changed, judge.calibration, base)
    if outside_fraction(corners(proxy), judge.calibration.floor) > MOST_OUTSIDE:
        return Finding(about=item.id, message="The critic moves it out of the room; refused.")
    edit = LayoutEdit(op="move", id=item.id, centre=proxy.centre, size=proxy.size, reason=asked.reason[:160])
    return edit, judge.evidence.with_object(changed)


_WAYS: dict[str, Callable[[EditReply, DetectedObject, _Judge], Result]] = {
    "remove": _remove,
    "recategorise": _recategorise,
    "turn": _turn,
    "move": _move,
    "resize": _move,
}


def _undecided(identifier: str) -> Finding:
    return Finding(about=identifier, message="The critic goes back and forth on it; it is left as it is.")


def _said_size(asked: EditReply) -> tuple[float, float, float] | None:
    if asked.size_m is None:
        return None
    sizes = (asked.size_m.width, asked.size_m.depth, asked.size_m.height)
    return sizes if all(0.01 < s < 20 for s in sizes) else None


def _by_metres(item: DetectedObject, calibration: Calibration) -> ImageBox | None:
    """Where the metres alone put a thing in the picture."""
    try:
        return image_box_of(calibration.camera, item.centre, item.size, item.yaw, item.shape)
    except GeometryError:
        return None


def _against(box: ImageBox, item: DetectedObject, calibration: Calibration) -> Finding | None:
    """Why a new box cannot be of this thing: what was measured before speaks against it, and agrees with itself."""
    if item.box is None or box.iou(item.box) >= SEEN_IOU:
        return None
    metres = _by_metres(item, calibration)
    agree = metres is not None and metres.iou(item.box) >= AGREE_IOU
    if agree and metres is not None and box.iou(metres) < SEEN_IOU:
        return Finding(about=item.id, message="The critic moves it to where neither measurement saw it; refused.")
    near_metres = metres is not None and box.iou(metres) >= SEEN_IOU
    if item.confidence >= SURE and not near_metres:
        return Finding(about=item.id, message="The critic moves it to where it was not seen before; refused.")
    return None


def _weighed(box: ImageBox, item: DetectedObject, calibration: Calibration) -> dict[str, object]:
    """The new box weighed with the old one, and whether the metres count less from now on.

    Within what boxes usually err, the two are equals. Beyond it one of them is wrong, and the critic, who saw the outline
    beside the thing, is believed more; alone, where the metres side with it. What goes for the old box goes for metres
    that were guessed from it.
    """
    if item.box is None:
        return {"box": box}
    metres = _by_metres(item, calibration)
    if metres is not None and metres.iou(item.box) < SEEN_IOU <= metres.iou(box) and box.iou(item.box) < AGREE_IOU:
        return {"box": box}
    usual = (calibration.trust or Trust()).box_sigma * math.sqrt(2.0)
    if _apart(box, item.box) <= BEYOND * usual:
        return {"box": _mean_box(item.box, box, 0.5)}
    return {"box": _mean_box(item.box, box, BELIEVED), "source": BOX_CORRECTED}


def _apart(a: ImageBox, b: ImageBox) -> float:
    """Root mean square difference of two boxes' edges, in 0-1000."""
    edges = zip(a.model_dump().values(), b.model_dump().values(), strict=True)
    return math.sqrt(sum((m - n) ** 2 for m, n in edges) / 4)


def _mean_box(old: ImageBox, new: ImageBox, share: float) -> ImageBox:
    """Between two boxes, `share` of the way to the new one."""
    was, is_now = old.model_dump(), new.model_dump()
    return ImageBox(**{k: was[k] + share * (is_now[k] - was[k]) for k in was})


def _add(asked: EditReply, judge: _Judge) -> Result:
    layout, evidence, calibration = judge.layout, judge.evidence, judge.calibration
    box, said = clean_box(asked.box), _said_size(asked)
    category = (asked.category or "").strip()[:60]
    if box is None or said is None or not category:
        return Finding(about=asked.id, message="The critic wants to add something without box, size or category.")
    if (asked.base_m or 0.0) > OFF_FLOOR:
        return Finding(about=asked.id, message="The critic adds what does not stand on the floor; that comes later.")
    known = next((o for o in evidence.objects.values() if _is_known(o, box, category)), None)
    if known is not None:
        return Finding(about=asked.id, message=f"The critic wants to add what is already known as {known.id}.")
    size = (min(10.0, max(0.02, said[0])), min(10.0, max(0.02, said[1])), min(10.0, max(0.02, said[2])))
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
        size=size,
        yaw=yaw,
        confidence=0.5,
        source="critique",
    )
    proxy, _ = proxy_of(item, calibration, 0.0)
    ground = rectangle_corners(proxy.centre, proxy.size, proxy.yaw)
    if outside_fraction(ground, calibration.floor) > MOST_OUTSIDE:
        return Finding(about=name, message="The critic adds it outside the room; refused.")
    solid = [p for p in layout.proxies if p.placement == "floor" and p.size[2] >= FLAT and size[2] >= FLAT]
    inside = next((p.id for p in solid if overlap_fraction(ground, corners(p)) > INSIDE_ANOTHER), None)
    if inside is not None:
        return Finding(about=name, message=f"The critic adds it where {inside} stands; refused.")
    if judge.past.is_back_and_forth("add", name, False, True):
        return _undecided(name)
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


def _is_known(item: DetectedObject, box: ImageBox, category: str) -> bool:
    """Whether what is added is something that was found before."""
    if item.box is None:
        return False
    alike = set(category.lower().split()) & set(item.category.lower().split())
    return item.box.iou(box) > (SAME_KIND if alike else SAME_THING)
