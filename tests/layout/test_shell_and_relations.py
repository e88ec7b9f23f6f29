"""Walls from the floor, openings on their walls, relations from geometry."""

from __future__ import annotations

import math

import pytest
from code_as_room.pipeline.artifacts.analysis import ArchitectureItem, Calibration, SceneAnalysis
from code_as_room.pipeline.artifacts.graph import GraphEdge
from code_as_room.pipeline.layout.relations import INVERSE, Placed, geometric_edges, valid_edges, with_inverses
from code_as_room.pipeline.layout.walls import outer_walls, shell

L_SHAPE = [(-3.0, -2.0), (3.0, -2.0), (3.0, 0.5), (0.5, 0.5), (0.5, 2.0), (-3.0, 2.0)]


def test_walls_follow_an_l_shaped_floor_and_have_names_of_their_own() -> None:
    walls = outer_walls(L_SHAPE, 2.6)
    assert len(walls) == 6 and len({w.id for w in walls}) == 6
    assert walls[0].id == "wall_s" and walls[1].id == "wall_e"
    assert all(math.dist(w.start, w.end) > 0.4 for w in walls)


@pytest.mark.parametrize("wall", ["bottom", None])
def test_a_door_is_pushed_onto_its_wall(analysis: SceneAnalysis, calibration: Calibration, wall: str | None) -> None:
    door = ArchitectureItem(id="d", kind="door", start=(1.0, -1.8), end=(1.9, -1.85), height=2.05, wall=wall)
    found = analysis.model_copy(update={"architecture": [door]})
    _, walls, [line], _, _, findings = shell(found, calibration)
    assert line.wall == "wall_s" and not findings
    assert line.start[1] == line.end[1] == -1.95
    assert math.dist(line.start, line.end) == pytest.approx(0.9, abs=0.01)


def test_a_door_without_a_wall_is_reported_not_built(analysis: SceneAnalysis, calibration: Calibration) -> None:
    door = ArchitectureItem(id="d", kind="door", start=(0.0, 0.0), end=(0.9, 0.0), height=2.05)
    _, _, doors, _, _, findings = shell(analysis.model_copy(update={"architecture": [door]}), calibration)
    assert not doors and findings[0].about == "d"


def test_an_opening_keeps_its_sill_and_a_builtin_is_reported(analysis: SceneAnalysis, calibration: Calibration) -> None:
    hatch = ArchitectureItem(id="h", kind="opening", start=(0, 1.95), end=(1, 1.95), height=1.0, sill=0.9, wall="top")
    chimney = ArchitectureItem(id="c", kind="builtin", start=(2.0, 1.5), end=(2.0, 1.9), height=2.6)
    *_, [opening], findings = shell(analysis.model_copy(update={"architecture": [hatch, chimney]}), calibration)
    assert (opening.sill, opening.height) == (0.9, 1.0)
    assert [f.about for f in findings] == ["c"]


def test_a_partition_that_stops_short_reaches_the_wall(analysis: SceneAnalysis, calibration: Calibration) -> None:
    item = ArchitectureItem(id="p", kind="partition", start=(0.5, 1.8), end=(0.5, 0.2), height=2.6)
    _, walls, *_ = shell(analysis.model_copy(update={"architecture": [item]}), calibration)
    partition = next(w for w in walls if w.partition)
    assert partition.start == pytest.approx((0.5, 1.95)) and partition.end == pytest.approx((0.5, 0.2))


def placed(identifier: str, x: float, y: float, w: float = 1.0, d: float = 1.0) -> Placed:
    return Placed(identifier, (x, y, 0.4), (w, d, 0.8), 0.0, "floor", None)


def test_relations_of_a_small_room() -> None:
    walls = outer_walls([(-3, -2), (3, -2), (3, 2), (-3, 2)], 2.6)
    items = [placed("a", -2.5, 1.5), placed("b", 0.0, 1.4), placed("c", 0.0, -1.0)]
    edges = {(e.source, e.relation, e.target) for e in geometric_edges(items, walls)}
    assert ("a", "in_corner", "wall_n") in edges and ("a", "against_wall", "wall_w") in edges
    assert ("b", "against_wall", "wall_n") in edges
    assert ("a", "left_of", "b") in edges and ("c", "below", "b") in edges
    assert not any(s == "c" and r == "against_wall" for s, r, _ in edges)


def test_every_inverse_names_a_relation_whose_inverse_leads_back() -> None:
    assert all(INVERSE[INVERSE[name]] == name for name in INVERSE)


def test_invalid_edges_are_reported_and_inverses_added_once() -> None:
    def edge(source: str, relation: str, target: str) -> GraphEdge:
        return GraphEdge(source=source, relation=relation, target=target, origin="model")

    on = [GraphEdge(source="lamp", relation="on", target="table", origin="geometry")]
    said = [
        edge("table", "on", "lamp"),
        edge("lamp", "near", "ghost"),
        edge("lamp", "loves", "table"),
        edge("x", "on", "x"),
    ]
    kept, findings = valid_edges([*on, *said, *on], {"lamp", "table", "x"}, on)
    assert kept == on and len(findings) == 4
    both = with_inverses(kept)
    assert [(e.source, e.relation, e.target) for e in both] == [("lamp", "on", "table"), ("table", "supports", "lamp")]
    assert with_inverses(both) == both
