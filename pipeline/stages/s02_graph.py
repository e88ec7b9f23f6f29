# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 2, scene graph: what geometry decides is computed, the model adds meaning, invalid claims are filtered. (Paper, stage 2.)"""

from __future__ import annotations

from ..analysis.look import numbered_boxes
from ..artifacts.analysis import Calibration, DetectedObject, Finding, SceneAnalysis
from ..artifacts.graph import GraphEdge, GraphNode, MinorObjects, SceneGraph
from ..artifacts.layout import WallLine
from ..artifacts.replies import GraphReply
from ..layout.initial import is_major
from ..layout.relations import Placed, contradiction, geometric_edges, valid_edges, with_inverses
from ..layout.walls import shell
from .base import Reads, Stage, View
from .wishes import Ask, Picture, Request, StageRun, Tell

ID = "s02_graph"


def run(view: View) -> StageRun:
    """Write `SceneGraph` and `MinorObjects`; one request."""
    analysis, calibration = view.need(SceneAnalysis), view.need(Calibration)
    _, walls, doors, windows, openings, _ = shell(analysis, calibration)
    yield Tell("Asking what belongs to what", 1, 2)
    [reply] = yield Ask((_request(view, analysis, walls),))
    yield Tell("Building the scene graph", 2, 2)
    cut = [
        (o.id, kind, o.wall)
        for kind, items in (("door", doors), ("window", windows), ("opening", openings))
        for o in items
    ]
    return [make_graph(analysis, walls, cut, reply), minor_objects(analysis)]


def _request(view: View, analysis: SceneAnalysis, walls: list[WallLine]) -> Request:
    objects = "\n".join(
        f"{n}, {o.id}, {o.category}, {o.placement}, {o.parent or '-'}" for n, o in enumerate(analysis.objects, 1)
    )
    picture = numbered_boxes(view.reference, analysis.objects)
    return Request(
        key="02_graph",
        prompt="02_graph",
        reply=GraphReply,
        values={
            "objects": objects + view.noted(o.id for o in analysis.objects),
            "walls": "; ".join(f"{w.id} ({_where(w, walls)})" for w in walls),
        },
        images=(Picture("reference", view.reference.for_model()), Picture("boxes", picture)),
    )


def _where(wall: WallLine, walls: list[WallLine]) -> str:
    """Where a wall is in the picture, in words; with its ends where that would not tell which."""
    (ax, ay), (bx, by) = wall.start, wall.end
    x, y = (ax + bx) / 2, (ay + by) / 2
    across = abs(bx - ax) >= abs(by - ay)
    side = (
        "inside the room"
        if wall.partition
        else ("top" if y > 0 else "bottom")
        if across
        else "right"
        if x > 0
        else "left"
    )
    if len(walls) <= 4:
        return side
    return f"{side}, from {ax:.1f} {ay:.1f} to {bx:.1f} {by:.1f} m"


def make_graph(
    analysis: SceneAnalysis, walls: list[WallLine], cut: list[tuple[str, str, str]], reply: GraphReply
) -> SceneGraph:
    """Nodes for room, walls, openings and objects; structural, geometric and the model's edges with inverses.

    Args:
        cut: (id, kind, wall id) of what is cut into walls.
    """
    facts = {a.id: {k: v[:80] for k, v in a.model_dump(exclude={"id"}).items() if v} for a in reply.attributes}
    nodes = [GraphNode(id="room", kind="room", category=analysis.room_type)]
    nodes += [GraphNode(id=w.id, kind="wall", category="partition" if w.partition else "wall") for w in walls]
    nodes += [GraphNode(id=name, kind="opening", category=kind) for name, kind, _ in cut]
    for item in analysis.objects:
        kind = "major" if is_major(item) else "minor"
        nodes.append(GraphNode(id=item.id, kind=kind, category=item.category, attributes=facts.get(item.id, {})))
    edges = [GraphEdge(source=name, relation="cut_into", target=wall, origin="structure") for name, _, wall in cut]
    edges += [GraphEdge(source=w.id, relation="part_of", target="room", origin="structure") for w in walls]
    edges += [
        GraphEdge(source=o.id, relation=_carried(o), target=o.parent, origin="structure")
        for o in analysis.objects
        if o.parent
    ]
    placed = {o.id: _placed(o) for o in analysis.objects}
    geometric = geometric_edges(list(placed.values()), walls)
    said, unlikely = _believed(reply, placed, {w.id: w for w in walls})
    unknown = [
        Finding(about=i, message=f"Facts were given on {i!r}, which does not exist.")
        for i in facts
        if i not in {n.id for n in nodes}
    ]
    kept, findings = valid_edges([*edges, *geometric, *said], {n.id for n in nodes}, geometric)
    return SceneGraph(nodes=nodes, edges=with_inverses(kept), findings=[*unknown, *unlikely, *findings])


def _believed(
    reply: GraphReply, placed: dict[str, Placed], walls: dict[str, WallLine]
) -> tuple[list[GraphEdge], list[Finding]]:
    """The relations that the model claims and geometry does not speak against."""
    edges: list[GraphEdge] = []
    findings: list[Finding] = []
    for r in reply.relations:
        edge = GraphEdge(source=r.source, relation=r.relation, target=r.target, origin="model")
        against = contradiction(edge, placed, walls)
        if against is None:
            edges.append(edge)
        else:
            said = f"It is said to be {r.relation.replace('_', ' ')} {r.target}, but {against}; dropped."
            findings.append(Finding(about=r.source, message=said))
    return edges, findings


def minor_objects(analysis: SceneAnalysis) -> MinorObjects:
    """The sidecar: ids of minor objects by what carries them."""
    by_parent: dict[str, list[str]] = {}
    for item in analysis.objects:
        if not is_major(item):
            by_parent.setdefault(item.parent or "", []).append(item.id)
    return MinorObjects(by_parent=by_parent)


def _carried(item: DetectedObject) -> str:
    return (
        "hangs_on" if item.placement in ("wall", "ceiling") else "on" if item.placement == "surface" else "belongs_to"
    )


def _placed(item: DetectedObject) -> Placed:
    fronted = bool(item.front) and item.shape != "round"
    return Placed(item.id, item.centre, item.size, item.yaw, item.placement, item.parent, fronted)


STAGE = Stage(
    id=ID,
    title="Scene graph",
    reads=(Reads(SceneAnalysis), Reads(Calibration)),
    writes=(SceneGraph, MinorObjects),
    run=run,
    notes=True,
)
