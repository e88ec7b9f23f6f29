# SPDX-License-Identifier: GPL-3.0-or-later
"""How good a layout is: measured parts, and the model's judgement where it gave one. Weights are here and nowhere else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox, Metres2
from ..artifacts.graph import GraphEdge
from ..artifacts.layout import Layout, ProxyLine, Score, WallLine
from ..geometry.camera import GeometryError
from ..geometry.footprint import image_box_of
from ..geometry.polygon import area, intersection_area, outside_fraction, overlap_fraction, rectangle_corners
from .placed import may_share, placed
from .relations import geometric_edges

WEIGHTS = {"coverage": 0.2, "overlap": 0.2, "bounds": 0.15, "relations": 0.15, "boxes": 0.3}
MODEL_WEIGHT = 0.15
KEPT_RELATIONS = ("against_wall", "left_of", "below", "on")
OVERLAP_LIMIT = 0.02
OUTSIDE_LIMIT = 0.01
POOR_IOU = 0.6


@dataclass(frozen=True)
class Expected:
    """What a layout is measured against.

    Attributes:
        ids: objects that should be in it; boxes: their boxes in the picture, where known.
        edges: the scene graph's edges; tucked: pairs that may overlap.
    """

    ids: tuple[str, ...]
    boxes: Mapping[str, ImageBox]
    edges: Sequence[GraphEdge]
    tucked: frozenset[frozenset[str]]


def measure(layout: Layout, camera: CameraModel, expected: Expected) -> tuple[Score, list[str]]:
    """The measured score (no model part), and what is wrong in sentences for the model and the report."""
    problems: list[str] = []
    proxies = [p for p in layout.proxies if p.id in expected.ids]
    present = {p.id for p in proxies}
    missing = [i for i in expected.ids if i not in present]
    problems += [f"{i} is missing" for i in missing]
    parts = {
        "coverage": 1.0 if not expected.ids else 1.0 - len(missing) / len(expected.ids),
        "overlap": _overlap(proxies, expected.tucked, problems),
        "bounds": _bounds(proxies, layout.room.floor, problems),
        "relations": _relations(layout.proxies, layout.walls, expected.edges),
        "boxes": _boxes(proxies, camera, expected.boxes, problems),
    }
    total = sum(WEIGHTS[name] * value for name, value in parts.items())
    return Score(total=total, measured=total, **parts), problems


def with_model(score: Score, judged: float | None) -> Score:
    """The score with the model's judgement (0..100) weighed in; unchanged when it gave none."""
    if judged is None:
        return score
    model = max(0.0, min(1.0, judged / 100.0))
    total = (1 - MODEL_WEIGHT) * score.measured + MODEL_WEIGHT * model
    return score.model_copy(update={"model": model, "total": total})


def corners(proxy: ProxyLine) -> list[Metres2]:
    """The footprint's corners."""
    return [(float(x), float(y)) for x, y in rectangle_corners(proxy.centre, proxy.size, proxy.yaw)]


def _overlap(proxies: Sequence[ProxyLine], tucked: frozenset[frozenset[str]], problems: list[str]) -> float:
    rects = [corners(p) for p in proxies]
    shared = 0.0
    for i, a in enumerate(proxies):
        for j in range(i + 1, len(proxies)):
            if may_share(a, proxies[j], tucked):
                continue
            part = intersection_area(rects[i], rects[j])
            shared += part
            if part > 0 and overlap_fraction(rects[i], rects[j]) > OVERLAP_LIMIT:
                problems.append(f"{a.id} overlaps {proxies[j].id}")
    whole = sum(area(r) for r in rects)
    return 1.0 if whole <= 0 else max(0.0, 1.0 - 5.0 * shared / whole)


def _bounds(proxies: Sequence[ProxyLine], floor: Sequence[Metres2], problems: list[str]) -> float:
    fractions = []
    for proxy in proxies:
        outside = outside_fraction(corners(proxy), floor)
        fractions.append(outside)
        if outside > OUTSIDE_LIMIT:
            problems.append(f"{proxy.id} is {outside:.0%} outside the room")
    return 1.0 if not fractions else max(0.0, 1.0 - 5.0 * sum(fractions) / len(fractions))


def _relations(proxies: Sequence[ProxyLine], walls: Sequence[WallLine], edges: Sequence[GraphEdge]) -> float:
    present = {p.id for p in proxies} | {w.id for w in walls}
    wanted = {
        (e.source, e.relation, e.target)
        for e in edges
        if e.relation in KEPT_RELATIONS and e.source in present and e.target in present
    }
    if not wanted:
        return 1.0
    holding = {(e.source, e.relation, e.target) for e in geometric_edges([placed(p) for p in proxies], walls)}
    return len(wanted & holding) / len(wanted)


def _boxes(
    proxies: Sequence[ProxyLine], camera: CameraModel, boxes: Mapping[str, ImageBox], problems: list[str]
) -> float:
    ious = []
    for proxy in proxies:
        box = boxes.get(proxy.id)
        if box is None:
            continue
        try:
            iou = image_box_of(camera, proxy.centre, proxy.size, proxy.yaw, proxy.shape).iou(box)
        except GeometryError:
            iou = 0.0
        ious.append(iou)
        if iou < POOR_IOU:
            problems.append(f"{proxy.id} covers its place in the picture only by {iou:.0%}")
    return 1.0 if not ious else sum(ious) / len(ious)
