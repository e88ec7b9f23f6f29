# SPDX-License-Identifier: GPL-3.0-or-later
"""The shell as geometry: closed, mitred, with holes where the lines say, and forgiving."""

from __future__ import annotations

import math
from collections import Counter
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.program.prelude.palette import FAMILY_COLOURS, category_family
from code_as_room.pipeline.program.prelude.proxies import proxy_shapes
from code_as_room.pipeline.program.prelude.record import Record
from code_as_room.pipeline.program.prelude.shell import shell_pieces
from hypothesis import given
from hypothesis import strategies as st

SQUARE = [(-2.0, -1.5), (2.0, -1.5), (2.0, 1.5), (-2.0, 1.5)]


def square_room(**lists: Any) -> Record:
    """A 4 x 3 m room with four walls s, e, n, w and what is given."""
    walls = [
        {"id": name, "start": a, "end": b, "height": 2.5, "thickness": 0.2, "partition": False}
        for name, a, b in zip("senw", SQUARE, SQUARE[1:] + SQUARE[:1], strict=True)
    ]
    return Record(room={"size": (4.0, 3.0, 2.5), "floor": SQUARE}, walls=walls, **lists)


def window(start: float, end: float, sill: float = 0.9, height: float = 1.2, name: str = "win") -> dict[str, Any]:
    """A window in the south wall between two x."""
    return {"id": name, "wall": "s", "start": (start, -1.5), "end": (end, -1.5), "sill": sill, "height": height}


def volume(shape: Any) -> float:
    """Signed volume of a closed mesh by the divergence theorem; positive when its faces look outwards."""
    total = 0.0
    for face in shape.faces:
        a = shape.vertices[face[0]]
        for i, j in zip(face[1:-1], face[2:], strict=True):
            total += float(a @ np.cross(shape.vertices[i], shape.vertices[j])) / 6
    return total


def is_closed(shapes: list[Any]) -> bool:
    """Whether every edge is used once in each direction, over all shapes together."""
    edges: Counter[Any] = Counter()
    for shape in shapes:
        points = [tuple(np.round(v, 6)) for v in shape.vertices]
        for face in shape.faces:
            for i, j in zip(face, (*face[1:], face[0]), strict=True):
                edges[points[i], points[j]] += 1
    return all(count == 1 and edges[b, a] == 1 for (a, b), count in list(edges.items()))


def test_every_piece_is_closed_and_faces_outwards(record: Any) -> None:
    pieces, notes = shell_pieces(record)
    assert notes == []
    for piece in pieces:
        for shape in piece.shapes:
            if shape.faces:
                assert is_closed([shape]), piece.id
                assert volume(shape) > 0, piece.id


def test_mitred_walls_have_the_volume_of_the_ring_around_the_room() -> None:
    pieces, _ = shell_pieces(square_room())
    walls = sum(volume(p.shapes[0]) for p in pieces if p.kind == "wall")
    ring = (4.4 * 3.4 - 4.0 * 3.0) * (2.5 + 0.1)
    assert walls == pytest.approx(ring, rel=1e-9)


def test_an_inner_corner_is_mitred_too(record: Any) -> None:
    pieces, _ = shell_pieces(record)
    nook = next(p for p in pieces if p.id == "wall_nook").shapes[0].vertices
    outer = nook[np.isclose(nook[:, 1], -0.15)]
    assert np.ptp(nook[np.isclose(nook[:, 1], 0.0)][:, 0]) == pytest.approx(1.0)
    assert outer[:, 0].min() == pytest.approx(-0.15)
    assert outer[:, 0].max() == pytest.approx(1.0 - 0.15)


def test_a_hole_takes_exactly_its_volume() -> None:
    whole = next(p for p in shell_pieces(square_room())[0] if p.id == "s")
    holed = next(p for p in shell_pieces(square_room(windows=[window(-0.5, 0.7)]))[0] if p.id == "s")
    assert volume(whole.shapes[0]) - volume(holed.shapes[0]) == pytest.approx(1.2 * 1.2 * 0.2)


@given(st.integers(0, 12_000), st.integers(20_000, 30_000))
def test_a_hole_up_to_the_walls_height_leaves_no_film_over_it(sill: int, height: int) -> None:
    # 0.95 + 1.6843 is less than 2.6343 in binary numbers: from above the film that was left was black.
    room = square_room(windows=[window(-0.5, 0.5, sill / 1e4, (height - sill) / 1e4)])
    for wall in room.walls:
        wall["height"] = height / 1e4
    pieces, _ = shell_pieces(room)
    wall = next(p for p in pieces if p.id == "s")
    over = [v for shape in wall.shapes for v in shape.vertices if abs(v[2] - height / 1e4) < 1e-3]
    assert all(v[2] == height / 1e4 for v in over)
    faces = [[shape.vertices[i] for i in face] for shape in wall.shapes for face in shape.faces]
    xs = [sorted(v[0] for v in f) for f in faces if all(v[2] == height / 1e4 for v in f)]
    middle = wall_middle(wall)
    assert xs and not any(low[0] < middle < low[-1] for low in xs)


def wall_middle(wall: Any) -> float:
    """Along the wall in its own frame, where the windows of these tests are."""
    xs = [v[0] for shape in wall.shapes for v in shape.vertices]
    return (min(xs) + max(xs)) / 2


def test_walls_drawn_clockwise_are_turned_round() -> None:
    record = square_room()
    for wall in record.walls:
        wall["start"], wall["end"] = wall["end"], wall["start"]
    pieces, _ = shell_pieces(record)
    for piece in (p for p in pieces if p.kind == "wall"):
        assert piece.inward is not None
        assert np.dot(piece.inward, piece.origin[:2]) < 0  # the room is around the origin


@pytest.mark.parametrize(
    ("lists", "words"),
    [
        ({"windows": [window(-5, 5)]}, "past the end"),
        ({"windows": [window(7, 8)]}, "not within"),
        ({"windows": [window(0, 1, sill=2.0, height=4.0)]}, "higher than"),
        ({"windows": [window(0, 1), window(0.5, 1.5, name="other")]}, "cut back"),
        ({"windows": [window(0, 1), window(0, 1, name="other")]}, "left out"),
        ({"windows": [{**window(0, 1), "wall": "nowhere"}]}, "put in s"),
        ({"doors": [{"id": "d", "wall": "s", "start": (0, -1.5), "end": (0.001, -1.5), "height": 2}]}, "left out"),
    ],
)
def test_impossible_openings_are_clamped_and_told(lists: Any, words: str) -> None:
    pieces, notes = shell_pieces(square_room(**lists))
    assert any(words in note for note in notes), notes
    assert all(is_closed(p.shapes) and volume(p.shapes[0]) > 0 for p in pieces if p.kind == "wall")


def test_a_room_without_walls_or_floor_does_not_break() -> None:
    pieces, notes = shell_pieces(Record(doors=[{"id": "d", "wall": "s", "start": (0, 0), "end": (1, 0), "height": 2}]))
    assert pieces == []
    assert len(notes) == 2


numbers = st.floats(-6, 6, allow_nan=False)
heights = st.floats(0.01, 4)


@given(st.lists(st.tuples(numbers, numbers, heights, heights), max_size=4))
def test_any_windows_leave_a_closed_wall(rows: list[tuple[float, float, float, float]]) -> None:
    windows = [window(a, b, sill, high, f"w{i}") for i, (a, b, sill, high) in enumerate(rows)]
    wall = next(p for p in shell_pieces(square_room(windows=windows))[0] if p.id == "s")
    assert volume(wall.shapes[0]) >= 0
    edges: Counter[Any] = Counter()
    for face in wall.shapes[0].faces:
        for i, j in zip(face, (*face[1:], face[0]), strict=True):
            edges[i, j] += 1
    assert all(edges[b, a] == count for (a, b), count in list(edges.items()))  # holes may touch along an edge


@pytest.mark.parametrize("open_degrees", [0, 45, 90, -60])
@pytest.mark.parametrize("against", [False, True])
def test_a_door_opens_into_the_room_about_its_start(open_degrees: float, against: bool) -> None:
    ends = [(0.2, -1.5), (1.1, -1.5)]
    start, end = reversed(ends) if against else ends
    door = {"id": "d", "wall": "s", "start": start, "end": end, "height": 2.0, "open": open_degrees}
    pieces, _ = shell_pieces(square_room(doors=[door]))
    leaf = next(p for p in pieces if p.part == "leaf")
    angle = math.radians(leaf.yaw)
    direction = np.array((math.cos(angle), math.sin(angle)))
    assert direction[1] == pytest.approx(math.sin(math.radians(open_degrees)), abs=1e-9)
    assert direction[0] * (-1 if against else 1) == pytest.approx(math.cos(math.radians(open_degrees)), abs=1e-9)
    # One that opens outwards hangs at the outer face of its wall.
    assert math.dist(leaf.origin[:2], start) < (0.25 if open_degrees < 0 else 0.1)
    assert (leaf.origin[1] < start[1] - 0.1) == (open_degrees < 0)


sizes = st.floats(0.005, 6)


@given(st.tuples(sizes, sizes, sizes), st.sampled_from(["box", "round", "l_shape"]))
def test_a_proxy_is_closed_and_fills_its_box(size: tuple[float, float, float], shape: str) -> None:
    shapes = proxy_shapes({"size": size, "shape": shape})
    points = np.concatenate([s.vertices for s in shapes])
    assert np.allclose(points.min(axis=0), (-size[0] / 2, -size[1] / 2, 0), atol=1e-9)
    assert np.allclose(points.max(axis=0), (size[0] / 2, size[1] / 2, size[2]), atol=1e-9)
    used: Counter[Any] = Counter()
    for part in shapes:
        at = [tuple(v) for v in part.vertices]
        for face in part.faces:
            for i, j in zip(face, (*face[1:], face[0]), strict=True):
                used[at[i], at[j]] += 1
    assert all(used[b, a] == count for (a, b), count in list(used.items()))


def test_the_arrow_is_on_top_and_near_the_front() -> None:
    arrow = next(s for s in proxy_shapes({"size": (1, 2, 0.5)}) if s.part == "arrow")
    assert np.allclose(arrow.vertices[:, 2], 0.5)
    assert arrow.vertices[0, 1] == arrow.vertices[:, 1].min() < -0.5


@pytest.mark.parametrize(
    ("category", "family"),
    [
        ("double bed", "bed"),
        ("bedside table", "table"),
        ("table_lamp", "lamp"),
        ("desk chair", "seating"),
        ("Bookshelves", "storage"),
        ("wall art", "wall"),
        ("thingummy", "other"),
        ("", "other"),
    ],
)
def test_category_families(category: str, family: str) -> None:
    assert category_family(category) == family
    assert family in FAMILY_COLOURS
