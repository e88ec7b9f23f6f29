# SPDX-License-Identifier: GPL-3.0-or-later
"""Constructors make closed, outward, well-sized meshes; operations keep them so."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from code_as_room.pipeline.program.prelude import operations, profiles, sheets, solids
from code_as_room.pipeline.program.prelude.budget import vertex_budget
from code_as_room.pipeline.program.prelude.recorder import Recorder
from code_as_room.pipeline.program.prelude.rings import signed_volume
from code_as_room.pipeline.program.prelude.shape import Shape
from hypothesis import given
from hypothesis import strategies as st

L_OUTLINE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
KNOT = [(math.cos(t) * 2, math.sin(t) * 2, math.sin(3 * t) * 0.7) for t in np.linspace(0, 2 * math.pi, 40)[:-1]]

# name: (shape, its exact volume or None)
CLOSED: dict[str, tuple[Shape, float | None]] = {
    "box": (solids.box((1, 2, 3), at=(4, 5, 6)), 6.0),
    "rounded_box": (solids.rounded_box((1, 2, 3), 0.2), None),
    "bevelled box": (solids.rounded_box((1, 2, 3), 0.2, segments=1), None),
    "very round box": (solids.rounded_box((1, 1, 1), 5.0, segments=8), None),
    "cylinder": (solids.cylinder(1, 2, segments=4), 4.0),
    "lying cylinder": (solids.cylinder(1, 2, segments=4, axis="y"), 4.0),
    "cone": (solids.cone(1, 3, segments=4), 2.0),
    "cone on its head": (solids.cone(0, 3, top_radius=1, segments=4, axis="x"), 2.0),
    "truncated cone": (solids.cone(2, 3, top_radius=1, segments=4), 14.0),
    "sphere": (solids.sphere(1, segments=96, rings=48), 4 / 3 * math.pi),
    "ellipsoid": (solids.sphere((1, 2, 3), segments=96, rings=48), 8 * math.pi),
    "torus": (solids.torus(2, 0.5, segments=96, rings=48), math.pi * 0.25 * 2 * math.pi * 2),
    "capsule": (solids.capsule(1, 5, segments=96, rings=32), math.pi * 3 + 4 / 3 * math.pi),
    "round capsule": (solids.capsule(1, 2, segments=96, rings=32), 4 / 3 * math.pi),
    "prism": (solids.prism(6, 1, 2), 3 * math.sqrt(3)),
    "vase": (profiles.lathe([(0, 0), (1, 0), (1, 2), (0.9, 2), (0.9, 0.1), (0, 0.1)], segments=64), None),
    "vase drawn downward": (profiles.lathe([(1, 2), (1, 0)], segments=4), 4.0),
    "rim": (profiles.lathe([(1, 0), (1.2, 0), (1.2, 0.1), (1, 0.1), (1, 0)]), None),
    "L": (profiles.extrude(L_OUTLINE, 2), 6.0),
    "L clockwise": (profiles.extrude(L_OUTLINE[::-1], 2, axis="x"), 6.0),
    "L along y": (profiles.extrude(L_OUTLINE, 2, axis="y"), 6.0),
    "straight tube": (profiles.tube([(0, 0, 0), (0, 0, 2)], 1, segments=4), 4.0),
    "bent tube": (profiles.tube([(0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1)], 0.1), None),
    "thinning tube": (profiles.tube([(0, 0, 0), (0, 0.5, 1), (1, 0, 3)], [0.2, 0.1, 0.05]), None),
    "closed tube": (profiles.tube(KNOT, 0.1, closed=True), None),
    "rail": (profiles.sweep([(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 0, 0), (4, 0, 0), (4, 4, 0)]), None),
    "frame": (
        profiles.sweep([(0, 0), (0.1, 0), (0, 0.1)], [(0, 0, 0), (4, 0, 0), (4, 3, 0), (0, 3, 0)], closed=True),
        None,
    ),
}


def assert_closed(shape: Shape) -> None:
    """Every edge belongs to exactly two faces, which run along it in opposite directions; the inside is inside."""
    edges = Counter((a, b) for face in shape.faces for a, b in zip(face, face[1:] + face[:1], strict=True))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)
    assert {i for face in shape.faces for i in face} == set(range(shape.vertex_count))
    assert np.isfinite(shape.vertices).all()
    assert signed_volume(shape.vertices, list(shape.faces)) > 0


def volume(shape: Shape) -> float:
    """Volume in cubic metres."""
    return signed_volume(shape.vertices, list(shape.faces))


@pytest.mark.parametrize("name", CLOSED)
def test_solids_are_closed_and_face_outward(name: str) -> None:
    shape, exact = CLOSED[name]
    assert_closed(shape)
    if exact is not None:
        assert volume(shape) == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("name", CLOSED)
def test_operations_keep_solids_closed(name: str) -> None:
    shape, _ = CLOSED[name]
    before = volume(shape)
    for changed, factor in (
        (operations.move(shape, (1, 2, 3)), 1),
        (operations.turn(shape, 33, "y", about=(1, 1, 1)), 1),
        (operations.scale(shape, (1, 2, 3)), 6),
        (operations.scale(shape, (-1, 1, 2)), 2),
        (operations.mirror(shape, "y", at=3), 1),
        (operations.join([shape, operations.move(shape, (9, 0, 0))]), 2),
    ):
        assert isinstance(changed, Shape)
        assert_closed(changed)
        assert volume(changed) == pytest.approx(before * factor, rel=0.01)  # bent quads have two volumes


positive = st.floats(0.01, 50)
coordinate = st.floats(-50, 50)


@given(
    st.tuples(positive, positive, positive), positive, st.tuples(coordinate, coordinate, coordinate), st.integers(1, 5)
)
def test_a_rounded_box_fills_its_size_exactly(size, radius, at, segments) -> None:
    shape = solids.rounded_box(size, radius, at, segments)
    assert_closed(shape)
    low, high = operations.bounds(shape)
    assert np.allclose(low, np.array(at) - np.array(size) / 2) and np.allclose(high, np.array(at) + np.array(size) / 2)
    assert volume(shape) <= size[0] * size[1] * size[2] * (1 + 1e-9)


@given(st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=2, max_size=9), st.booleans())
def test_a_tube_along_any_path_is_finite(points, closed) -> None:
    try:
        shape = profiles.tube(points, 0.1, 6, closed=closed)
    except ValueError as error:
        assert "different points" in str(error)
        return
    assert np.isfinite(shape.vertices).all()
    distances = np.linalg.norm(shape.vertices[:, None] - np.array(points)[None], axis=2).min(axis=1)
    assert distances.max() < 0.26  # the radius, widened at most 2.5 times by a mitre
    assert distances.min() > 0.09


def test_turning_is_counter_clockwise_about_each_axis() -> None:
    for axis, start, end in (("x", (0, 1, 0), (0, 0, 1)), ("y", (0, 0, 1), (1, 0, 0)), ("z", (1, 0, 0), (0, 1, 0))):
        turned = operations.turn(solids.box((0.1, 0.1, 0.1), at=start), 90, axis)
        assert isinstance(turned, Shape)
        assert np.allclose(turned.vertices.mean(axis=0), end)


def test_extrude_puts_the_outline_in_the_named_plane() -> None:
    spans = {"z": (2, 1, 5), "y": (2, 5, 1), "x": (5, 2, 1)}
    for axis, span in spans.items():
        assert operations.size_of(profiles.extrude([(0, 0), (2, 0), (2, 1), (0, 1)], 5, axis=axis)) == span


def test_a_corner_of_a_swept_profile_is_mitred() -> None:
    square = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    low, high = operations.bounds(profiles.sweep(square, [(0, 0, 0), (4, 0, 0), (4, 4, 0)]))
    assert np.allclose(low, (0, -0.5, -0.5)) and np.allclose(high, (4.5, 4, 0.5))


def test_a_grid_takes_heights_or_points_and_faces_up() -> None:
    sheet = sheets.grid(lambda u, v: u * v, 4, 3, size=(2, 1), at=(0, 0, 1))
    assert sheet.vertex_count == 20 and len(sheet.faces) == 12
    low, high = operations.bounds(sheet)
    assert np.allclose(low, (-1, -0.5, 1)) and np.allclose(high, (1, 0.5, 2))
    a, b, c = (sheet.vertices[i] for i in sheet.faces[0][:3])
    assert np.cross(b - a, c - b)[2] > 0
    wall = sheets.grid(lambda u, v: (u, 0, v), 1, 1)
    assert operations.size_of(wall) == (1, 0, 1)


def test_operations_work_on_nested_lists_and_keep_names() -> None:
    legs = operations.part("leg", operations.array(solids.cylinder(0.02, 0.4), 2, (1, 0, 0)), material="metal")
    both = operations.move([legs, [operations.part("seat", solids.box((1, 1, 0.1)))]], (0, 0, 1))
    assert [(s.part, s.material) for s in both] == [("leg", "metal"), ("leg", "metal"), ("seat", "")]
    assert not operations.smooth(both[0], False).smooth
    with pytest.raises(ValueError, match="different materials"):
        operations.join(both)


def test_mirrored_uvs_stay_with_their_corners() -> None:
    shape = sheets.mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])
    corners = [shape.vertices[i, :2] for face in shape.faces for i in face]
    shape = Shape(shape.vertices, shape.faces, uvs=np.array(corners))
    mirrored = operations.mirror(shape, "z")
    assert isinstance(mirrored, Shape) and mirrored.uvs is not None
    assert np.allclose(mirrored.uvs, [mirrored.vertices[i, :2] for face in mirrored.faces for i in face])


REFUSED = {
    "box: size must be three positive numbers": lambda: solids.box((1, 0, 1)),
    "box: size must be three positive": lambda: solids.box(2),
    "box: at must be": lambda: solids.box((1, 1, 1), at=(0, float("nan"), 0)),
    "cylinder: segments must be a whole number between 3 and 512": lambda: solids.cylinder(1, 1, segments=2),
    "cylinder: axis must be one of x, y, z": lambda: solids.cylinder(1, 1, axis="w"),
    "cylinder: radius must be a positive": lambda: solids.cylinder(True, 1),
    "cone: radius and top_radius must not both": lambda: solids.cone(0, 1),
    "capsule: height is over all": lambda: solids.capsule(1, 1),
    "torus: thickness": lambda: solids.torus(1, 2),
    "lathe: all points lie on the axis": lambda: profiles.lathe([(0, 0), (0, 1), (0, 2)]),
    "lathe: a radius must not be negative": lambda: profiles.lathe([(-1, 0), (1, 1)]),
    "extrude: outline must go round an area": lambda: profiles.extrude([(0, 0), (1, 0), (2, 0)], 1),
    "tube: points needs at least 2 different": lambda: profiles.tube([(0, 0, 0), (0, 0, 0)], 1),
    "tube: radius must be a number or a list of 2": lambda: profiles.tube([(0, 0, 0), (0, 0, 1)], [1]),
    "grid: the first argument must be a function": lambda: sheets.grid(3, 1, 1),
    "grid: the function must return": lambda: sheets.grid(lambda u, v: "a", 1, 1),
    "grid: all points must lie within": lambda: sheets.grid(lambda u, v: 1e200, 1, 1),
    "mesh: each vertex number": lambda: sheets.mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 3)]),
    "mesh: a face must not use": lambda: sheets.mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 1)]),
    "move: expected a shape or a list of shapes, not a number": lambda: operations.move(3, (0, 0, 0)),
    "scale: factor must not be 0": lambda: operations.scale(solids.box((1, 1, 1)), 0),
    "part: the name must be text": lambda: operations.part(solids.box((1, 1, 1)), "leg"),
    "join: there are no shapes": lambda: operations.join([]),
    "bounds: there are no shapes": lambda: operations.bounds([]),
}


@pytest.mark.parametrize("sentence", REFUSED)
def test_wrong_arguments_are_refused_with_a_sentence(sentence: str) -> None:
    with pytest.raises(ValueError) as caught:
        REFUSED[sentence]()
    assert sentence in str(caught.value)


BOMBS = [
    lambda: solids.sphere(1, segments=512, rings=256),
    lambda: solids.torus(2, 1, segments=512, rings=256),
    lambda: sheets.grid(lambda u, v: 0, 2000, 2000),
    lambda: operations.array(solids.box((1, 1, 1)), 10_000, (1, 0, 0)),
    lambda: profiles.tube([(0, 0, i / 10) for i in range(20_000)], 1, 512),
    lambda: [operations.move(solids.sphere(1), (0, 0, 0)) for _ in range(10_000)],
]


@pytest.mark.parametrize("bomb", BOMBS)
def test_vertices_are_counted_before_they_are_made(bomb) -> None:
    with vertex_budget(50_000), pytest.raises(ValueError, match="too many vertices"):
        bomb()


def test_the_budget_counts_what_is_made() -> None:
    makers = [
        lambda: solids.box((1, 1, 1)),
        lambda: solids.rounded_box((1, 1, 1), 0.1, segments=2),
        lambda: solids.sphere(1),
        lambda: profiles.extrude(L_OUTLINE, 1),
        lambda: profiles.tube(KNOT, 0.1, closed=True),
        lambda: sheets.grid(lambda u, v: 0, 5, 7),
    ]
    for make in makers:
        with vertex_budget(100_000) as left:
            assert make().vertex_count == 100_000 - left[0]


def test_a_shape_nested_in_itself_is_refused() -> None:
    endless: list[object] = []
    endless.append(endless)
    endless.append(endless)
    with pytest.raises(ValueError, match="too many shapes"):
        Recorder().furnish("bed_1", endless)


def test_an_edge_may_be_given_where_the_reference_lists_it() -> None:
    from code_as_room.pipeline.program.prelude import profiles, solids

    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    for by_place, by_name in (
        (solids.cylinder(0.1, 0.4, 0.01), solids.cylinder(0.1, 0.4, edge=0.01)),
        (solids.cone(0.1, 0.4, 0.05, 0.01), solids.cone(0.1, 0.4, 0.05, edge=0.01)),
        (solids.prism(6, 0.1, 0.4, 0.01), solids.prism(6, 0.1, 0.4, edge=0.01)),
        (solids.torus(0.3, 0.05, 90), solids.torus(0.3, 0.05, angle=90)),
        (profiles.extrude(square, 0.4, 0.01), profiles.extrude(square, 0.4, edge=0.01)),
    ):
        assert by_place.vertices.tolist() == by_name.vertices.tolist() and by_place.faces == by_name.faces
    assert solids.cylinder(0.1, 0.4, (1, 0, 0)).vertices[:, 0].min() > 0.8


def test_a_waist_on_the_axis_is_thin_and_not_refused() -> None:
    glass = profiles.lathe([(1, 0), (0, 1), (1, 2)], segments=16)
    at_waist = glass.vertices[np.abs(glass.vertices[:, 2] - 1) < 1e-9]
    assert len(at_waist) and np.hypot(at_waist[:, 0], at_waist[:, 1]).max() <= 1.01e-4
    assert len(np.unique(np.round(glass.vertices, 9), axis=0)) == len(glass.vertices)
