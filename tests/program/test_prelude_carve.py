# SPDX-License-Identifier: GPL-3.0-or-later
"""Taking bodies away from bodies, holes, panels: what is left is closed and has the right volume."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from code_as_room.pipeline.program.prelude import carve, joinery, outlines, profiles, reshape, solids
from code_as_room.pipeline.program.prelude.budget import vertex_budget
from code_as_room.pipeline.program.prelude.rings import signed_volume
from code_as_room.pipeline.program.prelude.shape import Shape
from hypothesis import given, settings
from hypothesis import strategies as st

CUBE = solids.box((1, 1, 1))
L_OUTLINE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]


def volume(shape: Shape) -> float:
    return signed_volume(shape.vertices, list(shape.faces))


def open_edges(shape: Shape) -> int:
    edges = Counter((a, b) for f in shape.faces for a, b in zip(f, f[1:] + f[:1], strict=True))
    return sum(1 for (a, b), count in edges.items() if count != 1 or edges[b, a] != 1)


def polygon_area(sides: int, radius: float) -> float:
    return sides / 2 * radius * radius * math.sin(math.tau / sides)


CUTS = {
    "through": (solids.box((0.5, 0.5, 3)), 0.75),
    "pocket": (solids.box((0.5, 0.5, 0.5), at=(0, 0, 0.5)), 1 - 0.25 * 0.25),
    "corner": (solids.box((1, 1, 1), at=(0.5, 0.5, 0.5)), 1 - 0.125),
    "edge": (solids.box((3, 0.4, 0.4), at=(0, 0.5, 0.5)), 1 - 0.04),
    "flush with the top": (solids.box((0.5, 0.5, 0.5), at=(0, 0, 0.25)), 1 - 0.125),
    "flush with three sides": (solids.box((0.5, 0.5, 0.5), at=(0.25, 0.25, 0.25)), 1 - 0.125),
    "drilled": (solids.cylinder(0.3, 2), 1 - polygon_area(24, 0.3)),
    "drilled across": (solids.cylinder(0.3, 2, axis="x", segments=16), 1 - polygon_area(16, 0.3)),
    "a hollow inside": (solids.box((0.2, 0.2, 0.2)), 1 - 0.008),
    "half of it": (solids.box((2, 2, 2), at=(1, 0, 0)), 0.5),
    "beside it": (solids.box((0.5, 0.5, 0.5), at=(2, 0, 0)), 1.0),
    "only touching": (solids.box((1, 1, 1), at=(1, 0, 0)), 1.0),
}


@pytest.mark.parametrize("name", CUTS)
def test_what_is_left_of_a_cube(name: str) -> None:
    cutter, left = CUTS[name]
    shape = carve.carve(CUBE, cutter)
    assert isinstance(shape, Shape)
    assert open_edges(shape) == 0 and volume(shape) == pytest.approx(left, rel=1e-6)


@settings(max_examples=30, deadline=None)
@given(
    st.tuples(*[st.floats(0.05, 0.9)] * 3),
    st.tuples(*[st.floats(-0.6, 0.6)] * 3),
    st.floats(0, 90),
)
def test_any_block_anywhere_leaves_a_closed_body(size, at, angle) -> None:
    from code_as_room.pipeline.program.prelude import operations

    cutter = operations.turn(solids.box(size, at=at), angle, "z", about=at)
    shape = carve.carve(CUBE, cutter)
    assert isinstance(shape, Shape)
    assert open_edges(shape) == 0
    assert 1 - math.prod(size) - 1e-6 <= volume(shape) <= 1 + 1e-6


def test_holes_meet_inside_and_concave_and_round_shapes_are_cut_too() -> None:
    crossed = carve.carve(CUBE, [solids.cylinder(0.3, 2, axis=axis) for axis in "xyz"])
    board = carve.carve(profiles.extrude(L_OUTLINE, 0.1), solids.box((1.2, 1.2, 0.4), at=(1, 1, 0)))
    worktop = carve.carve(
        solids.rounded_box((1, 1, 0.2), 0.03), solids.rounded_box((0.5, 0.4, 0.3), 0.05, at=(0, 0, 0.1))
    )
    tub = carve.carve(solids.cylinder(0.5, 1, segments=32), solids.cylinder(0.4, 1, at=(0, 0, 0.1), segments=32))
    for shape in (crossed, board, worktop, tub):
        assert isinstance(shape, Shape)
        assert open_edges(shape) == 0 and volume(shape) > 0
    assert volume(board) == pytest.approx(0.3 - 0.144 + 0.036)  # type: ignore[arg-type]


def test_few_faces_are_made_and_they_can_be_bevelled() -> None:
    shape = carve.carve(CUBE, solids.box((0.5, 0.5, 3)))
    assert isinstance(shape, Shape) and len(shape.faces) <= 12
    soft = reshape.bevel(shape, 0.02)
    assert isinstance(soft, Shape) and open_edges(soft) == 0


def test_what_cannot_be_cut_is_said() -> None:
    with pytest.raises(ValueError, match="bulge everywhere"):
        carve.carve(CUBE, profiles.extrude(L_OUTLINE, 1))
    with pytest.raises(ValueError, match="nothing is left"):
        carve.carve(CUBE, solids.box((3, 3, 3)))
    with vertex_budget(1000), pytest.raises(ValueError, match="too many vertices"):
        carve.carve(solids.sphere(1, segments=40, rings=20), solids.sphere(0.5, at=(1, 0, 0), segments=40, rings=20))


def test_a_board_with_holes() -> None:
    holes = [outlines.ellipse(0.3, 0.3, at=(0.2, 0.2)), outlines.rectangle(0.2, 0.2, at=(-0.2, -0.2))]
    for axis in ("x", "y", "z"):
        board = profiles.extrude(outlines.rectangle(1, 1), 0.1, axis=axis, holes=holes)
        assert open_edges(board) == 0
        assert volume(board) == pytest.approx(0.1 * (1 - 0.04 - polygon_area(32, 0.15)))
    with pytest.raises(ValueError, match="inside of the outline"):
        profiles.extrude(outlines.rectangle(1, 1), 0.1, holes=[outlines.ellipse(2, 0.3)])


@pytest.mark.parametrize("style", ["sunk", "raised"])
def test_a_panelled_front_fills_its_size(style: str) -> None:
    door = joinery.panelled((0.6, 0.03, 1.9), columns=2, rows=3, style=style)
    assert open_edges(door) == 0 and np.allclose(np.ptp(door.vertices, axis=0), (0.6, 0.03, 1.9))
    assert 0.8 * 0.6 * 0.03 * 1.9 < volume(door) < 0.6 * 0.03 * 1.9


def test_rounded_rims_fill_the_same_size() -> None:
    for shape in (
        solids.cylinder(0.3, 0.2, edge=0.03),
        solids.cone(0.3, 0.2, 0.2, edge=0.03),
        solids.prism(6, 0.3, 0.2, edge=0.03),
        profiles.extrude(outlines.rectangle(0.6, 0.6, 0.05), 0.2, edge=0.03),
        solids.wedge((0.6, 0.6, 0.2), 0.05),
        solids.torus(0.3, 0.1, angle=120),
    ):
        assert open_edges(shape) == 0 and volume(shape) > 0
        assert np.ptp(shape.vertices[:, 2]) == pytest.approx(0.2)
