"""What the solver promises of every room: apart, inside, by the least, the same every time, and hands off what is locked."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.layout import DoorLine, Layout, ProxyLine, RoomLine, WallLine
from code_as_room.pipeline.geometry.apart import Body, least_moves
from code_as_room.pipeline.geometry.placement import Rect, is_inside, penetration
from code_as_room.pipeline.geometry.polygon import footprint_iou, intersection_area
from code_as_room.pipeline.layout.faces import is_parallel
from code_as_room.pipeline.layout.solve import CORNER, Ties, solve
from code_as_room.pipeline.layout.walls import outer_walls
from hypothesis import assume, given, settings
from hypothesis import strategies as st

NONE: frozenset[frozenset[str]] = frozenset()
FREE: frozenset[str] = frozenset()
L_SHAPE = [(-3.0, -2.0), (3.0, -2.0), (3.0, 0.5), (0.5, 0.5), (0.5, 2.0), (-3.0, 2.0)]
SLANTED = [(-2.5, -2.0), (2.5, -2.0), (2.5, 1.2), (1.6, 2.0), (-2.5, 2.0)]
PLAIN = [(-2.6, -2.0), (2.6, -2.0), (2.6, 2.0), (-2.6, 2.0)]
PARTITION = WallLine(id="p", start=(0.0, 2.0), end=(0.0, 0.2), height=2.6, thickness=0.1, partition=True)


def room(floor: list[tuple[float, float]], proxies: list[ProxyLine], partition: bool = False) -> Layout:
    walls = outer_walls(floor, 2.6) + ([PARTITION] if partition else [])
    return Layout(room=RoomLine(size=(6, 4, 2.6), floor=floor), walls=walls, proxies=proxies)


def thing(name: str, rect: Rect, height: float = 0.8) -> ProxyLine:
    centre = (rect.x, rect.y, height / 2)
    return ProxyLine(id=name, category="thing", centre=centre, size=(rect.width, rect.depth, height), yaw=rect.yaw)


def ground(proxy: ProxyLine) -> Rect:
    return Rect(proxy.centre[0], proxy.centre[1], proxy.size[0], proxy.size[1], proxy.yaw)


@st.composite
def rooms(draw: st.DrawFn) -> Layout:
    """Up to six things, well below what fits, anywhere and turned anyhow, also half outside and in each other."""
    floor = draw(st.sampled_from([L_SHAPE, SLANTED, PLAIN]))
    at, size = st.floats(-2.8, 2.8), st.floats(0.2, 0.9)
    yaw = st.sampled_from([0.0, 90.0, 270.0, 30.0]) | st.floats(0, 359)
    rects = draw(st.lists(st.builds(Rect, at, st.floats(-2.1, 2.1), size, size, yaw), min_size=1, max_size=6))
    return room(floor, [thing(f"t{n}", r) for n, r in enumerate(rects)], draw(st.booleans()) and floor is PLAIN)


def apart(layout: Layout) -> bool:
    rects = [ground(p) for p in layout.proxies]
    shared = sum(intersection_area(a.corners(), b.corners()) for a, b in combinations(rects, 2))
    # The empty corners of what stands askew to every wall may reach into one.
    parts = [1.0 if any(is_parallel(r, (w.start, w.end)) for w in layout.walls) else 1.0 - CORNER for r in rects]
    return shared < 1e-4 and all(
        is_inside(r._replace(width=part * r.width - 1e-4, depth=part * r.depth - 1e-4), layout.room.floor)
        for r, part in zip(rects, parts, strict=True)
    )


@settings(max_examples=60)
@given(rooms())
def test_everything_ends_apart_and_inside_and_stays_so(layout: Layout) -> None:
    solved, _ = solve(layout, NONE, FREE, {})
    assert apart(solved)
    partition = Rect(0.0, 1.1, 1.8, 0.1, 90.0)
    if any(w.partition for w in layout.walls):
        assert all((penetration(ground(p), partition) or (0.0,))[0] < 1e-4 for p in solved.proxies)
    assert solve(layout, NONE, FREE, {})[0] == solved, "deterministic"
    again, findings = solve(solved, NONE, FREE, {})
    assert not findings
    for old, new in zip(solved.proxies, again.proxies, strict=True):
        assert math.dist(old.centre, new.centre) < 1e-4 and old.size == pytest.approx(new.size)


@settings(max_examples=40)
@given(rooms(), st.sets(st.integers(0, 5), min_size=1, max_size=3))
def test_locked_things_stay_to_the_last_bit(layout: Layout, held: set[int]) -> None:
    locked = frozenset(f"t{n}" for n in held)
    solved, findings = solve(layout, NONE, locked, {})
    for old, new in zip(layout.proxies, solved.proxies, strict=True):
        assert old.id not in locked or new == old
    assert not {f.about for f in findings} & locked


@settings(max_examples=40)
@given(rooms())
def test_what_is_right_already_is_not_touched(layout: Layout) -> None:
    solved, _ = solve(layout, NONE, FREE, {})
    once, _ = solve(solved, NONE, FREE, {})
    assume(once == solved)
    assert all(a is b for a, b in zip(once.proxies, solved.proxies, strict=True))


@given(st.floats(0.3, 1.2), st.floats(0.3, 1.2), st.floats(0.01, 0.25), st.floats(0.05, 0.95), st.floats(0.05, 0.95))
def test_two_give_way_by_no_more_than_they_overlap_and_the_surer_less(
    first: float, second: float, overlap: float, sure: float, unsure: float
) -> None:
    a, b = Rect(0, 0, first, 1.0), Rect((first + second) / 2 - overlap, 0, second, 1.0)
    assume(overlap < 0.5 * min(first, second))
    found = least_moves([Body(a, weight=sure), Body(b, weight=unsure)])
    (ax, ay), (bx, by) = found.moves
    assert ay == by == 0 and bx - ax == pytest.approx(overlap, abs=1e-5)
    assert (abs(ax) <= abs(bx)) == (sure >= unsure) or abs(abs(ax) - abs(bx)) < 1e-5


def test_no_single_thing_could_have_moved_less() -> None:
    """Weighed squares of moves are at most those of a few thousand other ways to take the same crowd apart."""
    rng = np.random.default_rng(2)
    rects = [Rect(0, 0, 1, 1), Rect(0.8, 0.1, 1, 0.6, 20.0), Rect(0.2, 0.85, 0.7, 0.5)]
    weights = [3.0, 1.0, 2.0]
    found = least_moves([Body(r, weight=w) for r, w in zip(rects, weights, strict=True)], PLAIN)
    assert found.feasible
    for _ in range(4000):
        moves = rng.normal(0, 0.15, (3, 2))
        cost = sum(w * float(m @ m) for w, m in zip(weights, moves, strict=True))
        moved = [r.moved(*m) for r, m in zip(rects, moves, strict=True)]
        if cost < found.cost - 1e-6:
            assert any(penetration(a, b) for a, b in combinations(moved, 2))


def test_small_errors_cost_little_and_larger_ones_are_mended() -> None:
    """Furniture at walls and beside each other, measured with errors: what the solver does is nearer to the truth."""
    rng = np.random.default_rng(7)
    true = [
        Rect(-1.6, 1.0, 1.6, 2.0), Rect(-2.375, -0.25, 0.45, 0.45), Rect(-0.565, 1.77, 0.45, 0.45), Rect(1.2, 1.7, 1.8, 0.6),
        Rect(2.3, -0.8, 1.4, 0.6, 270.0), Rect(-1.6, -0.25, 1.1, 0.45), Rect(0.9, -1.6, 0.9, 0.8, 180.0),
    ]  # fmt: skip
    for error, least in ((0.015, -0.012), (0.06, 0.005)):
        gain = []
        for _ in range(25):
            moved = [r.moved(*rng.normal(0, error, 2)) for r in true]
            seen = [
                r._replace(
                    width=r.width * math.exp(rng.normal(0, error)), depth=r.depth * math.exp(rng.normal(0, error))
                )
                for r in moved
            ]
            solved, _ = solve(room(PLAIN, [thing(f"t{n}", r) for n, r in enumerate(seen)]), NONE, FREE, {})
            before = np.mean([footprint_iou(t.corners(), s.corners()) for t, s in zip(true, seen, strict=True)])
            after = np.mean(
                [footprint_iou(t.corners(), ground(p).corners()) for t, p in zip(true, solved.proxies, strict=True)]
            )
            gain.append(after - before)
        assert np.mean(gain) > least, error


def test_how_far_something_is_drawn_to_a_wall_depends_on_how_sure_its_place_is() -> None:
    near = thing("near", Rect(0.0, -1.64, 0.8, 0.6))
    layout = room(PLAIN, [near])
    sure, unsure = (solve(layout, NONE, FREE, {}, Ties(spread={"near": s}))[0].proxies[0] for s in (0.01, 0.075))
    assert sure == near and unsure.centre[1] == pytest.approx(-1.7, abs=1e-5)
    against = frozenset({("near", "wall_s")})
    surely_off, perhaps_flush = (Ties(spread={"near": s}, leaning=against) for s in (0.01, 0.025))
    assert solve(layout, NONE, FREE, {}, surely_off)[0].proxies[0] == near
    assert solve(layout, NONE, FREE, {}, perhaps_flush)[0].proxies[0].centre[1] == pytest.approx(-1.7, abs=1e-5)


def test_a_chair_goes_with_its_table_when_the_table_has_to_go_far() -> None:
    table, chair = thing("table", Rect(2.4, 0.0, 1.2, 0.8)), thing("chair", Rect(1.4, 0.0, 0.45, 0.45))
    solved, _ = solve(room(PLAIN, [table, chair]), NONE, FREE, {}, Ties(companions={"chair": "table"}))
    moved = [new.centre[0] - old.centre[0] for old, new in zip((table, chair), solved.proxies, strict=True)]
    assert moved[0] == pytest.approx(-0.4, abs=1e-3) and moved[1] == pytest.approx(moved[0], abs=1e-3)


@pytest.mark.parametrize(("deep", "stays"), [(0.04, False), (0.3, True)])
def test_a_door_swings_free_unless_something_was_clearly_seen_there(deep: float, stays: bool) -> None:
    box = thing("box", Rect(0.0, -2.0 + 0.9 - deep + 0.3, 0.6, 0.6))
    layout = room(PLAIN, [box]).model_copy(
        update={"doors": [DoorLine(id="door", wall="wall_s", start=(-0.45, -2.0), end=(0.45, -2.0))]}
    )
    solved, findings = solve(layout, NONE, FREE, {}, Ties(swings={"door": "in"}))
    assert (solved.proxies[0] == box) == stays
    assert any("opens" in f.message for f in findings) == stays
    assert solve(layout, NONE, FREE, {}, Ties(swings={"door": "out"}))[0].proxies[0] == box


def test_a_table_may_stand_in_the_missing_corner_of_a_sofa() -> None:
    sofa = thing("sofa", Rect(0.0, 0.5, 2.4, 1.8)).model_copy(update={"shape": "l_shape"})
    table = thing("table", Rect(0.55, 0.1, 0.8, 0.6))
    assert solve(room(PLAIN, [sofa, table]), NONE, FREE, {})[0].proxies == [sofa, table]
    block = sofa.model_copy(update={"shape": "box"})
    assert solve(room(PLAIN, [block, table]), NONE, FREE, {})[0].proxies != [block, table]


def test_a_thing_in_a_corner_that_is_cut_off_comes_to_rest() -> None:
    """Two walls there push it one against the other, each time by less."""
    floor = [(-2.5, -2.0), (2.5, -2.0), (2.5, 1.2), (1.6, 2.0), (-2.5, 2.0)]
    walls = [WallLine(id=f"w{i}", start=floor[i], end=floor[(i + 1) % 5], height=2.6, thickness=0.12) for i in range(5)]
    thing = ProxyLine(id="t0", category="thing", centre=(1.5, 2.0625, 0.4), size=(0.5, 0.875, 0.8), yaw=90.0)
    layout = Layout(room=RoomLine(size=(5.0, 4.0, 2.6), floor=floor), walls=walls, proxies=[thing])
    solved, _ = solve(layout, NONE, FREE, {})
    again, findings = solve(solved, NONE, FREE, {})
    assert not findings and math.dist(solved.proxies[0].centre, again.proxies[0].centre) < 1e-4
