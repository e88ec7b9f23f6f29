# SPDX-License-Identifier: GPL-3.0-or-later
"""Relations that geometry decides, and the graph that is made of them and of what the model says. (Paper, stage 2.)

The vocabulary is closed; `INVERSE` names the relation that holds the other way round.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..artifacts.analysis import Finding
from ..artifacts.common import Metres2, Metres3, Placement
from ..artifacts.graph import GraphEdge
from ..artifacts.layout import WallLine
from ..geometry.polygon import rectangle_corners
from .walls import along

INVERSE = {
    "left_of": "right_of",
    "right_of": "left_of",
    "above": "below",
    "below": "above",
    "near": "near",
    "beside": "beside",
    "on": "supports",
    "supports": "on",
    "under": "over",
    "over": "under",
    "in_front_of": "behind",
    "behind": "in_front_of",
    "belongs_to": "has",
    "has": "belongs_to",
    "faces": "faced_by",
    "faced_by": "faces",
    "hangs_on": "carries",
    "carries": "hangs_on",
    "lights": "lit_by",
    "lit_by": "lights",
    "against_wall": "has_against_it",
    "has_against_it": "against_wall",
    "in_corner": "has_in_corner",
    "has_in_corner": "in_corner",
    "cut_into": "holds",
    "holds": "cut_into",
    "part_of": "contains",
    "contains": "part_of",
}
WALL_GAP = 0.18
NEAR_GAP = 0.4
NEIGHBOURS = 5


@dataclass(frozen=True)
class Placed:
    """An object's oriented box, as relations need it; metres and degrees, frame of the room."""

    id: str
    centre: Metres3
    size: Metres3
    yaw: float
    placement: Placement
    parent: str | None

    @property
    def corners(self) -> list[Metres2]:
        """The footprint's corners."""
        return [(float(x), float(y)) for x, y in rectangle_corners(self.centre[:2], self.size[:2], self.yaw)]


def wall_gap(item: Placed, wall: WallLine) -> float:
    """Free space between a footprint and a wall's face, metres; infinite beside the wall's ends."""
    length = math.dist(wall.start, wall.end)
    spots = [along(wall, corner) for corner in item.corners]
    low, high = min(t for t, _ in spots), max(t for t, _ in spots)
    if min(high, length) - max(low, 0.0) < 0.3 * max(1e-6, high - low):
        return math.inf
    half = wall.thickness / 2 if wall.partition else 0.0
    distances = [off for _, off in spots]
    if wall.partition and max(distances) < 0:
        return -max(distances) - half
    return min(distances) - half if wall.partition else min(distances)


def against_walls(item: Placed, walls: Sequence[WallLine], gap: float = WALL_GAP) -> list[str]:
    """Ids of the walls that a footprint stands at, nearest first."""
    found = [(abs(g), w.id) for w in walls if (g := wall_gap(item, w)) < gap and g > -gap]
    return [name for _, name in sorted(found)]


def footprint_gap(a: Placed, b: Placed) -> float:
    """Distance between two footprints (0 when they touch or overlap), from their bounding rectangles; metres."""
    ax, ay = zip(*a.corners, strict=True)
    bx, by = zip(*b.corners, strict=True)
    dx = max(min(bx) - max(ax), min(ax) - max(bx), 0.0)
    dy = max(min(by) - max(ay), min(ay) - max(by), 0.0)
    return math.hypot(dx, dy)


def geometric_edges(items: Sequence[Placed], walls: Sequence[WallLine]) -> list[GraphEdge]:
    """Wall, corner, direction, nearness and support edges, each once; `with_inverses` adds the other direction."""
    edges: list[GraphEdge] = []
    floor = [i for i in items if i.placement == "floor"]
    for item in floor:
        touching = against_walls(item, walls)
        edges += [_edge(item.id, "against_wall", wall) for wall in touching]
        if len(touching) >= 2:
            edges += [_edge(item.id, "in_corner", wall) for wall in touching[:2]]
    for item in floor:
        nearest = sorted((math.dist(o.centre[:2], item.centre[:2]), n) for n, o in enumerate(floor) if o.id != item.id)
        for other in (floor[n] for _, n in nearest[:NEIGHBOURS]):
            edges += _direction(item, other)
            if item.id < other.id and footprint_gap(item, other) <= NEAR_GAP:
                edges.append(_edge(item.id, "near", other.id))
    ids = {i.id for i in items}
    edges += [_edge(i.id, "on", i.parent) for i in items if i.placement == "surface" and i.parent in ids]
    return edges


def _direction(item: Placed, other: Placed) -> list[GraphEdge]:
    dx, dy = other.centre[0] - item.centre[0], other.centre[1] - item.centre[1]
    least = max(0.2, 0.25 * min(max(item.size[:2]), max(other.size[:2])))
    result = []
    if dx >= least:
        result.append(_edge(item.id, "left_of", other.id))
    if dy >= least:
        result.append(_edge(item.id, "below", other.id))
    return result


def _edge(source: str, relation: str, target: str | None) -> GraphEdge:
    return GraphEdge(source=source, relation=relation, target=target or "", origin="geometry")


def valid_edges(
    edges: Iterable[GraphEdge], nodes: set[str], geometric: Iterable[GraphEdge]
) -> tuple[list[GraphEdge], list[Finding]]:
    """Edges between known nodes that do not contradict geometry; the rest is reported."""
    opposite = {(e.target, e.source) for e in geometric if e.relation == "on"}
    kept: list[GraphEdge] = []
    findings: list[Finding] = []
    seen: set[tuple[str, str, str]] = set()
    for edge in edges:
        key = (edge.source, edge.relation, edge.target)
        if key in seen:
            continue
        seen.add(key)
        if edge.source not in nodes or edge.target not in nodes:
            missing = edge.source if edge.source not in nodes else edge.target
            findings.append(
                Finding(about=missing, message=f"A relation names {missing!r}, which does not exist; dropped.")
            )
        elif edge.source == edge.target:
            findings.append(Finding(about=edge.source, message="A relation of a thing with itself was dropped."))
        elif edge.relation not in INVERSE:
            findings.append(
                Finding(about=edge.source, message=f"The relation {edge.relation!r} is not known; dropped.")
            )
        elif edge.relation == "on" and (edge.source, edge.target) in opposite:
            findings.append(
                Finding(about=edge.source, message=f"It cannot be on {edge.target}, which is on it; dropped.")
            )
        else:
            kept.append(edge)
    return kept, findings


def with_inverses(edges: Sequence[GraphEdge]) -> list[GraphEdge]:
    """All edges, and for each its inverse unless that is there already."""
    seen = {(e.source, e.relation, e.target) for e in edges}
    result = list(edges)
    for edge in edges:
        back = (edge.target, INVERSE[edge.relation], edge.source)
        if back not in seen:
            seen.add(back)
            result.append(GraphEdge(source=back[0], relation=back[1], target=back[2], origin=edge.origin))
    return result
