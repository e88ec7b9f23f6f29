# SPDX-License-Identifier: GPL-3.0-or-later
"""Relations that geometry decides, and the graph that is made of them and of what the model says. (Paper, stage 2.)

The vocabulary is closed; `INVERSE` names the relation that holds the other way round.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from ..artifacts.analysis import Finding
from ..artifacts.graph import GraphEdge
from ..artifacts.layout import WallLine
from .standing import (
    FACING_ANGLE,
    FLAT,
    FRONT_GAP,
    NEAR_GAP,
    SLACK,
    WALL_GAP,
    Placed,
    against_walls,
    corner_walls,
    directed,
    facing_error,
    footprint_gap,
    is_behind,
    is_beside,
    is_in_front_of,
    is_under,
    wall_gap,
)

__all__ = ["INVERSE", "Placed", "contradiction", "geometric_edges", "holds", "valid_edges", "with_inverses"]

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
NEIGHBOURS = 5
FAR = 0.6
"""What stands further than this from a wall, or from what it is said to be under, metres, is not there."""


def geometric_edges(items: Sequence[Placed], walls: Sequence[WallLine]) -> list[GraphEdge]:
    """All edges that geometry decides, each once; `with_inverses` adds the other direction.

    Walls and corners; directions and what has a front between nearest neighbours; nearness; what is on, or under, what.
    """
    edges: list[GraphEdge] = []
    floor = [i for i in items if i.placement == "floor"]
    for item in floor:
        edges += [_edge(item.id, "against_wall", wall) for wall in against_walls(item, walls)]
        edges += [_edge(item.id, "in_corner", wall) for wall in corner_walls(item, walls)]
    for item in floor:
        nearest = sorted((math.dist(o.centre[:2], item.centre[:2]), n) for n, o in enumerate(floor) if o.id != item.id)
        edges += _between(item, [floor[n] for _, n in nearest[:NEIGHBOURS]])
    ids = {i.id for i in items}
    edges += [_edge(i.id, "on", i.parent) for i in items if i.placement == "surface" and i.parent in ids]
    return edges + _covered(items)


def _between(item: Placed, nearest: Sequence[Placed]) -> list[GraphEdge]:
    """Edges of one thing on the floor with its neighbours."""
    edges: list[GraphEdge] = []
    for other in nearest:
        edges += [_edge(item.id, name, other.id) for name in ("left_of", "below") if directed(name, item, other)]
        # Symmetric ones are found from both sides; each is kept from the side whose id comes first.
        if item.id < other.id and footprint_gap(item, other) <= NEAR_GAP:
            edges.append(_edge(item.id, "near", other.id))
            if is_beside(item, other):
                edges.append(_edge(item.id, "beside", other.id))
        if is_in_front_of(other, item):
            edges.append(_edge(other.id, "in_front_of", item.id))
        if is_behind(other, item):
            edges.append(_edge(other.id, "behind", item.id))
    looked_at = [o for o in nearest if o.size[2] >= FLAT and _looks_at(item, o)]
    if looked_at:
        edges.append(_edge(item.id, "faces", min(looked_at, key=lambda o: footprint_gap(item, o)).id))
    return edges


def _looks_at(item: Placed, other: Placed) -> bool:
    return item.fronted and footprint_gap(item, other) <= FRONT_GAP and facing_error(item, other) <= FACING_ANGLE


def _covered(items: Sequence[Placed]) -> list[GraphEdge]:
    """What lies under what without carrying it: a rug under a bed, a table under a pendant lamp."""
    edges: list[GraphEdge] = []
    for low in items:
        for high in items:
            if high.placement != "wall" and is_under(low, high):
                edges.append(_edge(low.id, "under", high.id))
    return edges


def holds(edge: GraphEdge, items: Mapping[str, Placed], walls: Sequence[WallLine]) -> bool | None:
    """Whether a relation still holds where things are now, with a little slack; None when geometry cannot tell."""
    item, other = items.get(edge.source), items.get(edge.target)
    if item is None:
        return None
    if edge.relation == "against_wall":
        return edge.target in against_walls(item, walls, WALL_GAP * SLACK)
    if edge.relation == "in_corner":
        return edge.target in corner_walls(item, walls, WALL_GAP * SLACK)
    if other is None:
        return None
    if edge.relation in ("left_of", "below"):
        return directed(edge.relation, item, other, SLACK)
    if edge.relation == "near":
        return footprint_gap(item, other) <= NEAR_GAP * SLACK
    if edge.relation == "faces":
        # What the model says of use is looser than what geometry finds: a chair at a corner of its table faces it.
        return facing_error(item, other) <= FACING_ANGLE * (SLACK if edge.origin == "geometry" else 2.0)
    if edge.relation == "on" and item.placement == "surface":
        return item.parent == other.id
    return None


def contradiction(edge: GraphEdge, items: Mapping[str, Placed], walls: Mapping[str, WallLine]) -> str | None:
    """What geometry has against a relation that the model claims, None when nothing."""
    item, other = items.get(edge.source), items.get(edge.target)
    wall = walls.get(edge.target)
    if item is not None and wall is not None and edge.relation == "against_wall" and item.placement == "floor":
        gap = wall_gap(item, wall)
        return None if abs(gap) <= FAR else "it stands away from that wall"
    if item is None or other is None or "floor" not in (item.placement, other.placement):
        return None
    if edge.relation in ("under", "beside", "on") and footprint_gap(item, other) > FAR:
        return f"it is {footprint_gap(item, other):.1f} m away from it"
    if edge.relation in ("in_front_of", "behind") and other.fronted:
        opposite = is_behind if edge.relation == "in_front_of" else is_in_front_of
        return "it is on its other side" if opposite(item, other) else None
    return None


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
