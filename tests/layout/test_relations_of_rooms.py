"""Relations that geometry decides: found in a room, still held after small moves, and given up after large ones."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from code_as_room.pipeline.artifacts.graph import GraphEdge
from code_as_room.pipeline.artifacts.layout import WallLine
from code_as_room.pipeline.layout.relations import (
    INVERSE,
    Placed,
    contradiction,
    geometric_edges,
    holds,
    with_inverses,
)
from code_as_room.pipeline.layout.standing import corner_walls, facing_error, is_under
from code_as_room.pipeline.layout.walls import outer_walls
from hypothesis import given
from hypothesis import strategies as st

FLOOR = [(-3.0, -2.0), (3.0, -2.0), (3.0, 2.0), (-3.0, 2.0)]
WALLS = outer_walls(FLOOR, 2.6)
BY_ID = {w.id: w for w in WALLS}


def thing(
    name: str,
    at: tuple[float, float],
    size: tuple[float, float, float] = (0.8, 0.8, 0.8),
    yaw: float = 0.0,
    base: float = 0.0,
    **more: object,
) -> Placed:
    placed = Placed(name, (*at, base + size[2] / 2), size, yaw, "floor", None, True)
    return replace(placed, **more)  # type: ignore[arg-type]


ROOM = [
    thing("bed", (0.0, 0.9), (1.6, 2.0, 0.6)),
    thing("stand", (-1.1, 1.75), (0.45, 0.4, 0.5)),
    thing("bench", (0.0, -0.4), (1.2, 0.4, 0.45), fronted=False),
    thing("desk", (2.6, -1.0), (1.4, 0.7, 0.75), 270.0),
    thing("chair", (1.9, -1.0), (0.5, 0.5, 0.9), 90.0),
    thing("rug", (0.0, 0.0), (2.6, 2.0, 0.01), fronted=False),
    thing("lamp", (-1.1, 1.75), (0.2, 0.2, 0.4), base=0.5, placement="surface", parent="stand"),
    thing("pendant", (0.0, 0.5), (0.4, 0.4, 0.4), base=2.1, placement="ceiling", fronted=False),
]


def triples(items: list[Placed]) -> set[tuple[str, str, str]]:
    return {(e.source, e.relation, e.target) for e in with_inverses(geometric_edges(items, WALLS))}


def test_a_bedroom_is_described_completely() -> None:
    found = triples(ROOM)
    expected = {
        ("bed", "against_wall", "wall_n"), ("stand", "against_wall", "wall_n"), ("desk", "against_wall", "wall_e"),
        ("wall_n", "has_against_it", "bed"), ("stand", "left_of", "bed"), ("bed", "right_of", "stand"),
        ("bench", "below", "bed"), ("bed", "above", "bench"), ("bed", "near", "stand"), ("bed", "beside", "stand"),
        ("bench", "in_front_of", "bed"), ("chair", "in_front_of", "desk"), ("chair", "faces", "desk"),
        ("desk", "faces", "chair"), ("bed", "faces", "bench"), ("lamp", "on", "stand"), ("stand", "supports", "lamp"),
        ("rug", "under", "bed"), ("bed", "over", "rug"), ("rug", "under", "bench"),
    }  # fmt: skip
    assert expected <= found, expected - found
    wrong = {
        ("bed", "on", "rug"),
        ("stand", "faces", "bed"),
        ("bench", "faces", "bed"),
        ("chair", "against_wall", "wall_e"),
    }
    assert not wrong & found
    assert {r for _, r, _ in found} <= set(INVERSE)
    assert all(e.origin == "geometry" for e in geometric_edges(ROOM, WALLS))


@given(st.floats(-0.02, 0.02), st.floats(-0.02, 0.02), st.sampled_from(range(6)))
def test_what_was_found_survives_the_move_of_a_hand(dx: float, dy: float, index: int) -> None:
    edges = geometric_edges(ROOM, WALLS)
    moved = list(ROOM)
    was = moved[index]
    moved[index] = replace(was, centre=(was.centre[0] + dx, was.centre[1] + dy, was.centre[2]))
    items = {p.id: p for p in moved}
    assert all(holds(e, items, WALLS) in (True, None) for e in edges)


def test_what_is_mirrored_loses_its_sides_and_walls() -> None:
    edges = [e for e in geometric_edges(ROOM, WALLS) if e.relation in ("left_of", "against_wall", "faces")]
    mirrored = {p.id: replace(p, centre=(-p.centre[0], -p.centre[1], p.centre[2])) for p in ROOM}
    held = [e for e in edges if holds(e, mirrored, WALLS)]
    assert not [e for e in held if e.relation == "left_of"] and len(held) < len(edges) / 2


@pytest.mark.parametrize(
    ("at", "walls"),
    [((-2.6, 1.6), {"wall_n", "wall_w"}), ((0.0, 1.6), set()), ((2.55, -1.55), {"wall_s", "wall_e"})],
)
def test_a_corner_is_where_two_walls_meet(at: tuple[float, float], walls: set[str]) -> None:
    assert set(corner_walls(thing("x", at), WALLS)) == walls


def test_a_thing_between_parallel_walls_is_in_no_corner() -> None:
    lane = [WallLine(id="a", start=(0, 0), end=(4, 0), height=2), WallLine(id="b", start=(4, 1), end=(0, 1), height=2)]
    assert corner_walls(thing("x", (2.0, 0.5)), lane) == []


@given(st.floats(-math.pi, math.pi), st.floats(0.8, 3.0), st.floats(0, 360))
def test_a_front_that_points_at_something_faces_it(angle: float, distance: float, turn: float) -> None:
    other = thing("other", (distance * math.cos(angle), distance * math.sin(angle)), (0.2, 0.2, 0.5))
    towards = math.degrees(angle) + 90.0
    assert facing_error(thing("x", (0, 0), yaw=towards), other) < 1e-3
    error = facing_error(thing("x", (0, 0), yaw=towards + turn), other)
    apart = abs((turn + 180) % 360 - 180)
    assert error <= apart + 1e-6 and (error > 60 or apart < 80)


def test_only_what_covers_it_is_over_something() -> None:
    rug, bed = thing("rug", (0, 0), (2.0, 1.5, 0.01)), thing("bed", (0.2, 0.4), (1.6, 1.2, 0.5))
    assert is_under(rug, bed) and not is_under(bed, rug)
    assert not is_under(rug, replace(bed, centre=(2.2, 0.4, 0.25)))
    table, pendant = ROOM[0], ROOM[-1]
    assert is_under(table, pendant) and not is_under(replace(table, parent="pendant"), pendant)


@pytest.mark.parametrize(
    ("edge", "against"),
    [
        (("chair", "against_wall", "wall_w"), "away from that wall"),
        (("bed", "against_wall", "wall_n"), None),
        (("chair", "under", "desk"), None),
        (("chair", "under", "bed"), "m away"),
        (("bench", "behind", "bed"), "other side"),
        (("bench", "in_front_of", "bed"), None),
        (("chair", "faces", "bed"), None),
        (("ghost", "under", "bed"), None),
    ],
)
def test_the_model_may_add_meaning_but_not_contradict_geometry(edge: tuple[str, str, str], against: str | None) -> None:
    said = contradiction(
        GraphEdge(source=edge[0], relation=edge[1], target=edge[2], origin="model"), {p.id: p for p in ROOM}, BY_ID
    )
    assert (said is None) == (against is None) and (against is None or against in (said or ""))
