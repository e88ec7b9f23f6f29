"""The measured score: one for the truth, never better for a growing error, and every part says what is wrong."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.analysis import ArchitectureItem, Calibration, SceneAnalysis
from code_as_room.pipeline.artifacts.graph import GraphEdge
from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine, Score
from code_as_room.pipeline.layout.initial import empty_layout
from code_as_room.pipeline.layout.placed import placed, tucked_pairs
from code_as_room.pipeline.layout.relations import geometric_edges
from code_as_room.pipeline.layout.score import WEIGHTS, Expected, is_carried, measure, with_model, with_support

PARTS = tuple(WEIGHTS)


@pytest.fixture
def layout(analysis: SceneAnalysis, calibration: Calibration) -> Layout:
    """The true room with everything that is in it, and a door and a window where nothing stands."""
    openings = [
        ArchitectureItem(id="door", kind="door", start=(-0.4, -1.95), end=(0.4, -1.95), height=2.05, swing="in"),
        ArchitectureItem(id="window", kind="window", start=(-2.3, -0.4), end=(-2.3, 0.6), height=1.2, sill=0.9),
    ]
    empty, _ = empty_layout(analysis.model_copy(update={"architecture": openings}), calibration)
    proxies = [
        ProxyLine(
            id=o.id, category=o.category, centre=o.centre, size=o.size, yaw=o.yaw, placement=o.placement,
            parent="wall_n" if o.placement == "wall" else o.parent,
        )
        for o in analysis.objects
    ]  # fmt: skip
    return empty.model_copy(update={"proxies": proxies})


@pytest.fixture
def expected(analysis: SceneAnalysis, layout: Layout) -> Expected:
    boxes = {o.id: o.box for o in analysis.objects if o.box is not None}
    edges = geometric_edges([placed(p) for p in layout.proxies], layout.walls)
    return Expected(tuple(boxes), boxes, edges, frozenset(), {"door": "in"})


def test_the_truth_is_perfect_in_every_part(layout: Layout, calibration: Calibration, expected: Expected) -> None:
    score, problems = measure(layout, calibration.camera, expected)
    assert {p: round(getattr(score, p), 9) for p in PARTS} == dict.fromkeys(PARTS, 1.0)
    assert score.total == pytest.approx(1.0) and problems == []


def test_the_weights_are_those_of_a_mean_and_every_part_is_in_the_report() -> None:
    assert sum(WEIGHTS.values()) == pytest.approx(1.0)
    assert set(WEIGHTS) <= set(Score.model_fields)


@pytest.mark.parametrize("seed", range(6))
def test_a_growing_error_never_raises_the_score_much(
    layout: Layout, calibration: Calibration, expected: Expected, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    ways = {p.id: rng.normal(0, 1, 2) for p in layout.proxies}
    scores = []
    for step in np.linspace(0, 2.0, 21):
        moved = [
            p.model_copy(update={"centre": (p.centre[0] + step * ways[p.id][0], p.centre[1] + step * ways[p.id][1], p.centre[2])})
            for p in layout.proxies
        ]  # fmt: skip
        score, _ = measure(layout.model_copy(update={"proxies": moved}), calibration.camera, expected)
        assert all(0.0 <= getattr(score, part) <= 1.0 for part in (*PARTS, "total", "measured"))
        scores.append(score.total)
    best_after = np.maximum.accumulate(scores[::-1])[::-1]
    assert max(best_after[1:] - np.array(scores[:-1])) < 0.06
    assert scores[-1] < 0.75 < 0.95 < scores[0]


def with_proxy(layout: Layout, identifier: str, **update: Any) -> Layout:
    proxies = [p.model_copy(update=update) if p.id == identifier else p for p in layout.proxies]
    return layout.model_copy(update={"proxies": proxies})


@pytest.mark.parametrize(
    ("identifier", "update", "part", "said"),
    [
        ("chair", {"centre": (0.2, 0.4, 0.4)}, "overlap", "overlaps"),
        ("chair", {"centre": (-2.3, -1.9, 0.4)}, "bounds", "outside the room"),
        ("chair", {"centre": (0.0, -1.4, 0.4)}, "clear", "stands before door"),
        ("closet", {"centre": (-2.0, 0.1, 1.0), "yaw": 90.0}, "clear", "stands before window"),
        ("lamp", {"centre": (-1.0, 1.7, 1.4)}, "support", "hangs in the air"),
        ("lamp", {"centre": (1.0, 0.0, 0.7)}, "support", "hangs in the air"),
        ("chair", {"centre": (-1.6, -1.2, 0.7)}, "support", "hangs in the air"),
        ("closet", {"centre": (1.2, -0.6, 1.0)}, "relations", "covers its place"),
    ],
)
def test_each_part_notices_its_own_kind_of_error(
    layout: Layout, calibration: Calibration, expected: Expected, identifier: str, update: Any, part: str, said: str
) -> None:
    worse, problems = measure(with_proxy(layout, identifier, **update), calibration.camera, expected)
    assert getattr(worse, part) < 0.999 and worse.total < 0.999
    assert any(identifier in p and said in p for p in problems), problems


def test_what_is_missing_costs_coverage(layout: Layout, calibration: Calibration, expected: Expected) -> None:
    gone = layout.model_copy(update={"proxies": layout.proxies[1:]})
    score, problems = measure(gone, calibration.camera, expected)
    assert score.coverage == pytest.approx(6 / 7) and "bed is missing" in problems


def test_a_seat_that_is_said_to_face_something_and_does_not_is_a_problem(
    layout: Layout, calibration: Calibration, expected: Expected
) -> None:
    faces = GraphEdge(source="chair", relation="faces", target="bed", origin="model")
    asking = Expected(expected.ids, expected.boxes, [faces], frozenset())
    for yaw, good in ((140.0, True), (320.0, False)):
        score, problems = measure(with_proxy(layout, "chair", yaw=yaw), calibration.camera, asking)
        assert (score.relations == 1.0) is good and ("chair does not face bed" in problems) is not good


def test_a_shelf_carries_things_inside_it_and_a_lamp_needs_its_parent(layout: Layout) -> None:
    by_id = {p.id: p for p in layout.proxies}
    book = by_id["lamp"].model_copy(update={"centre": (-1.0, 1.7, 0.3), "size": (0.2, 0.2, 0.1)})
    assert is_carried(book, by_id, set(), 2.6)
    assert not is_carried(book.model_copy(update={"parent": "ghost"}), by_id, set(), 2.6)


def test_support_is_measured_again_once_everything_is_placed(
    layout: Layout, calibration: Calibration, expected: Expected
) -> None:
    majors = Expected(("bed", "closet"), expected.boxes, [], frozenset())
    score = with_model(measure(layout, calibration.camera, majors)[0], 80.0)
    assert with_support(score, layout) == score
    worse = with_support(score, with_proxy(layout, "lamp", centre=(-1.0, 1.7, 1.4)))
    assert worse.support == pytest.approx(6 / 7) and worse.total < score.total and worse.model == score.model


def test_the_model_weighs_little_and_nonsense_from_it_is_bounded(
    layout: Layout, calibration: Calibration, expected: Expected
) -> None:
    score, _ = measure(layout, calibration.camera, expected)
    assert with_model(score, None) == score
    assert with_model(score, -1e9).total == pytest.approx(0.85) and with_model(score, 1e9).total == pytest.approx(1.0)


def test_a_chair_that_faces_its_desk_may_run_into_it_and_a_nightstand_into_its_bed_may_not() -> None:
    def box(name: str, x: float, y: float, size: tuple[float, float, float], yaw: float) -> ProxyLine:
        return ProxyLine(id=name, category=name, centre=(x, y, size[2] / 2), size=size, yaw=yaw)

    def said(source: str, relation: str, target: str) -> GraphEdge:
        return GraphEdge(source=source, relation=relation, target=target, origin="model")

    desk, chair = box("desk", 0, 0, (1.4, 0.7, 0.75), 0.0), box("chair", 0, -0.45, (0.5, 0.5, 0.9), 180.0)
    bed, stand = box("bed", 3, 0, (1.6, 2.0, 0.6), 0.0), box("stand", 1.98, 0.7, (0.5, 0.4, 0.5), 0.0)
    edges = [said("chair", "belongs_to", "desk"), said("stand", "belongs_to", "bed")]
    assert tucked_pairs(edges, [desk, chair, bed, stand]) == {frozenset({"desk", "chair"})}
    away = chair.model_copy(update={"yaw": 0.0})
    assert tucked_pairs(edges, [desk, away, bed, stand]) == frozenset()
