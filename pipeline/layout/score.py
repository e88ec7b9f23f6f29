# SPDX-License-Identifier: GPL-3.0-or-later
"""How good a layout is: measured parts, and the model's judgement where it gave one. Weights are here and nowhere else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox, Metres2
from ..artifacts.graph import GraphEdge
from ..artifacts.layout import Layout, ProxyLine, Score, WallLine
from ..geometry.camera import GeometryError
from ..geometry.footprint import image_box_of
from ..geometry.placement import Rect
from ..geometry.polygon import area, intersection_area, outside_fraction, overlap_fraction, rectangle_corners
from .keep_clear import blocked, door_areas, window_areas
from .lshape import parts_of
from .placed import may_share, placed
from .relations import holds

WEIGHTS = {
    "coverage": 0.2,
    "overlap": 0.2,
    "bounds": 0.15,
    "relations": 0.12,
    "boxes": 0.25,
    "clear": 0.03,
    "support": 0.05,
}
"""What each measured part counts; together 1."""
MODEL_WEIGHT = 0.15
"""What the model's own judgement counts beside all that is measured."""
KEPT_RELATIONS = frozenset({"against_wall", "in_corner", "left_of", "below", "near", "on", "faces"})
OVERLAP_LIMIT = 0.02
OUTSIDE_LIMIT = 0.01
POOR_IOU = 0.6
BLOCKED = 0.1
"""Part of a door's or window's free space that may be taken before it is called a problem."""
CARRIED = 0.06
"""Most metres between a thing's underside and what carries it."""


@dataclass(frozen=True)
class Expected:
    """What a layout is measured against.

    Attributes:
        ids: objects that should be in it; boxes: their boxes in the picture, where known.
        edges: the scene graph's edges; tucked: pairs that may overlap.
        swings: for doors, "in" where the leaf comes into the room.
        fronted: ids of what has a front that is known; only of these it is measured what they face.
    """

    ids: tuple[str, ...]
    boxes: Mapping[str, ImageBox]
    edges: Sequence[GraphEdge]
    tucked: frozenset[frozenset[str]]
    swings: Mapping[str, str] = field(default_factory=dict)
    fronted: frozenset[str] = frozenset()


def measure(layout: Layout, camera: CameraModel, expected: Expected) -> tuple[Score, list[str]]:
    """The measured score (no model part), and what is wrong in sentences for the model and the report."""
    problems: list[str] = []
    wanted = set(expected.ids)
    proxies = [p for p in layout.proxies if p.id in wanted]
    present = {p.id for p in proxies}
    missing = [i for i in expected.ids if i not in present]
    problems += [f"{i} is missing" for i in missing]
    parts = {
        "coverage": 1.0 if not expected.ids else 1.0 - len(missing) / len(expected.ids),
        "overlap": _overlap(proxies, expected.tucked, problems),
        "bounds": _bounds(proxies, layout.room.floor, problems),
        "relations": _relations(layout.proxies, layout.walls, expected, problems),
        "boxes": _boxes(proxies, camera, expected.boxes, problems),
        "clear": _clear(proxies, layout, expected.swings, problems),
        "support": _support(proxies, layout, problems),
    }
    total = min(1.0, sum(WEIGHTS[name] * value for name, value in parts.items()))
    return Score(total=total, measured=total, **parts), problems


def with_model(score: Score, judged: float | None) -> Score:
    """The score with the model's judgement (0..100) weighed in; unchanged when it gave none."""
    if judged is None:
        return score
    model = max(0.0, min(1.0, judged / 100.0))
    total = (1 - MODEL_WEIGHT) * score.measured + MODEL_WEIGHT * model
    return score.model_copy(update={"model": model, "total": total})


def with_support(score: Score, layout: Layout) -> Score:
    """The score with `support` measured over everything that is placed by now, not only the majors."""
    support = _support(layout.proxies, layout, [])
    measured = min(1.0, max(0.0, score.measured + WEIGHTS["support"] * (support - score.support)))
    again = score.model_copy(update={"support": support, "measured": measured, "total": measured})
    return with_model(again, None if score.model is None else 100.0 * score.model)


def corners(proxy: ProxyLine) -> list[Metres2]:
    """The footprint's corners."""
    return [(float(x), float(y)) for x, y in rectangle_corners(proxy.centre, proxy.size, proxy.yaw)]


def _overlap(proxies: Sequence[ProxyLine], tucked: frozenset[frozenset[str]], problems: list[str]) -> float:
    rects = [corners(p) for p in proxies]
    shared = 0.0
    for i, a in enumerate(proxies):
        for j in range(i + 1, len(proxies)):
            b = proxies[j]
            part = 0.0 if may_share(a, b, tucked) else intersection_area(rects[i], rects[j])
            if part > 0 and "l_shape" in (a.shape, b.shape):
                part = min(part, _shared_by_arms(a, b))
            shared += part
            if part > 0 and overlap_fraction(rects[i], rects[j]) > OVERLAP_LIMIT:
                problems.append(f"{a.id} overlaps {b.id}")
    whole = sum(area(r) for r in rects)
    return 1.0 if whole <= 0 else max(0.0, 1.0 - 5.0 * shared / whole)


def _shared_by_arms(a: ProxyLine, b: ProxyLine) -> float:
    """What two things share when an L counts as its two arms."""
    first, second = _rect(a), _rect(b)
    mine = parts_of(first, a.shape, [second]) or (first,)
    its = parts_of(second, b.shape, [first]) or (second,)
    return sum(intersection_area(m.corners(), i.corners()) for m in mine for i in its)


def _rect(proxy: ProxyLine) -> Rect:
    return Rect(proxy.centre[0], proxy.centre[1], proxy.size[0], proxy.size[1], proxy.yaw)


def _bounds(proxies: Sequence[ProxyLine], floor: Sequence[Metres2], problems: list[str]) -> float:
    fractions = []
    for proxy in proxies:
        outside = outside_fraction(corners(proxy), floor)
        fractions.append(outside)
        if outside > OUTSIDE_LIMIT:
            problems.append(f"{proxy.id} is {outside:.0%} outside the room")
    return 1.0 if not fractions else max(0.0, 1.0 - 5.0 * sum(fractions) / len(fractions))


def _relations(
    proxies: Sequence[ProxyLine], walls: Sequence[WallLine], expected: Expected, problems: list[str]
) -> float:
    """Part of the graph's relations between things that are there which still hold, with a little slack."""
    items = {p.id: placed(p) for p in proxies}
    kept, judged = 0, 0
    for edge in expected.edges:
        if edge.relation not in KEPT_RELATIONS:
            continue
        if edge.relation == "faces" and edge.source not in expected.fronted and edge.origin != "model":
            continue
        held = holds(edge, items, walls)
        if held is None:
            continue
        judged += 1
        kept += held
        if not held and edge.relation == "faces":
            problems.append(f"{edge.source} does not face {edge.target}")
    return 1.0 if judged == 0 else kept / judged


def _boxes(
    proxies: Sequence[ProxyLine], camera: CameraModel, boxes: Mapping[str, ImageBox], problems: list[str]
) -> float:
    ious = []
    for proxy in proxies:
        box = boxes.get(proxy.id)
        if box is None:
            continue
        iou = box_iou(proxy, camera, box)
        ious.append(iou)
        if iou < POOR_IOU:
            problems.append(f"{proxy.id} covers its place in the picture only by {iou:.0%}")
    return 1.0 if not ious else sum(ious) / len(ious)


def box_iou(proxy: ProxyLine, camera: CameraModel, box: ImageBox) -> float:
    """How well a proxy, seen through the camera, covers a box of the picture, 0..1."""
    try:
        return image_box_of(camera, proxy.centre, proxy.size, proxy.yaw, proxy.shape).iou(box)
    except GeometryError:
        return 0.0


def _clear(proxies: Sequence[ProxyLine], layout: Layout, swings: Mapping[str, str], problems: list[str]) -> float:
    """How free it is before doors and windows: 1 minus the taken part, on average over all of them."""
    areas = [*door_areas(layout, swings), *window_areas(layout)]
    taken = dict.fromkeys((a.id for a in areas), 0.0)
    for identifier, opening, share in blocked(proxies, areas):
        taken[opening] = min(1.0, taken[opening] + share)
        if share > BLOCKED:
            problems.append(f"{identifier} stands before {opening}")
    return 1.0 if not taken else 1.0 - sum(taken.values()) / len(taken)


def _support(proxies: Sequence[ProxyLine], layout: Layout, problems: list[str]) -> float:
    """Part of the things that rest on, or hang from, what is there."""
    by_id = {p.id: p for p in layout.proxies}
    walls = {w.id for w in layout.walls}
    good = 0
    for proxy in proxies:
        carried = is_carried(proxy, by_id, walls, layout.room.size[2])
        good += carried
        if not carried:
            problems.append(f"{proxy.id} hangs in the air")
    return 1.0 if not proxies else good / len(proxies)


def is_carried(proxy: ProxyLine, others: Mapping[str, ProxyLine], walls: set[str], ceiling: float) -> bool:
    """Whether a thing stands on the floor, hangs at a wall or the ceiling that is there, or rests on its parent."""
    low, high = proxy.centre[2] - proxy.size[2] / 2, proxy.centre[2] + proxy.size[2] / 2
    if proxy.placement == "floor":
        return abs(low) <= CARRIED
    if proxy.placement == "ceiling":
        return abs(high - ceiling) <= CARRIED
    if proxy.placement == "wall":
        return proxy.parent in walls
    parent = others.get(proxy.parent or "")
    if parent is None or intersection_area(corners(proxy), corners(parent)) <= 0:
        return False
    bottom, top = parent.centre[2] - parent.size[2] / 2, parent.centre[2] + parent.size[2] / 2
    # Shelves, beds and sofas carry things below their highest edge too.
    return bottom - CARRIED <= low <= top + CARRIED
