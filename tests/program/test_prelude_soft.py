# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft things and operations: closed, of the size that was asked for, the same for the same seed, and never through
what they lie on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.prelude import cloth, growing, profiles, reshape, sheets, soft, solids, weaving
from code_as_room.pipeline.program.prelude.rings import signed_volume
from code_as_room.pipeline.program.prelude.shape import Shape
from hypothesis import given, settings
from hypothesis import strategies as st

SIZES = st.tuples(st.floats(0.15, 2.5), st.floats(0.15, 2.5), st.floats(0.05, 0.8))
L_OUTLINE = [(0, 0), (0.6, 0), (0.6, 0.2), (0.2, 0.2), (0.2, 0.5), (0, 0.5)]


def size_of(shape: Shape) -> Any:
    return np.ptp(shape.vertices, axis=0)


def open_edges(shape: Shape) -> int:
    """How many edges do not have exactly two faces running along them in opposite directions."""
    edges = Counter((a, b) for f in shape.faces for a, b in zip(f, f[1:] + f[:1], strict=True))
    return sum(1 for (a, b), count in edges.items() if count != 1 or edges[b, a] != 1)


FILLING: dict[str, Callable[[Any], Shape]] = {
    "cushion": lambda s: soft.cushion(s, seam=False),
    "round cushion": lambda s: soft.cushion(s, puff=1.0, radius=0.2, seam=False),
    "pillow": soft.pillow,
    "limp pillow": lambda s: soft.pillow(s, plump=0.0, ears=1.0, seed="x"),
    "tufted": lambda s: soft.tufted(s, 3, 2, depth=0.01),
    "curtain": cloth.curtain,
    "tied curtain": lambda s: cloth.curtain(s, gather=0.6, seed=4),
}


@pytest.mark.parametrize("name", FILLING)
@settings(max_examples=12)
@given(size=SIZES)
def test_what_fills_its_size_fills_it(name: str, size: tuple[float, float, float]) -> None:
    shape = FILLING[name](size)
    # A curtain's cloth is as thick as it is; its depth is kept to within that.
    assert np.allclose(size_of(shape), size, atol=0.011 if "curtain" in name else 1e-6)
    assert open_edges(shape) == 0 and signed_volume(shape.vertices, list(shape.faces)) > 0


@settings(max_examples=12)
@given(size=SIZES)
def test_piping_stays_at_the_cushion(size: tuple[float, float, float]) -> None:
    assert np.all(size_of(soft.cushion(size)) <= np.array(size) + 0.03)


@settings(max_examples=25)
@given(
    size=st.tuples(st.floats(0.4, 2.2), st.floats(0.4, 2.2)),
    hang=st.tuples(*[st.floats(0.0, 0.6)] * 4),
    folds=st.floats(0, 1),
    seed=st.integers(0, 9),
)
def test_a_cloth_never_goes_through_what_it_lies_on(size: Any, hang: Any, folds: float, seed: int) -> None:
    shape = cloth.drape(size, hang=hang, folds=folds, seed=seed)
    x, y, z = shape.vertices.T
    inside = (np.abs(x) < size[0] / 2 - 1e-4) & (np.abs(y) < size[1] / 2 - 1e-4) & (z < -1e-4)
    assert not inside.any() and open_edges(shape) == 0


def test_a_cloth_hangs_as_far_as_it_is_told() -> None:
    for down in (0.06, 0.15, 0.4):
        for thickness, radius in ((0.01, 0.02), (0.04, 0.02), (0.01, 0.06)):
            made = cloth.drape((1.0, 1.0), hang=(down, 0, 0, 0), thickness=thickness, radius=radius)
            assert abs(made.vertices[:, 2].min() + down) < 0.015, (down, thickness, radius)
    lying = cloth.drape((1.0, 1.0), hang=0.8, floor=0.0, at=(0, 0, 0.5))
    assert lying.vertices[:, 2].min() >= -1e-6


def test_a_rug_lies_on_the_floor_in_its_size() -> None:
    for form in ("box", "round", "hide"):
        shape = weaving.rug((2.0, 1.4, 0.02), shape=form, fringe=0.05)
        assert shape.vertices[:, 2].min() >= 0 and np.allclose(size_of(shape)[:2], (2.0, 1.4), atol=0.02)
        assert open_edges(shape) == 0


def test_leaves_grow_round_their_stem() -> None:
    shape = growing.leaves(40, 0.3, 0.1, height=0.6, at=(1, 2, 3))
    low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
    assert np.allclose((low + high)[:2] / 2, (1, 2), atol=0.06) and low[2] > 2.9 and high[2] < 4.0


@pytest.mark.parametrize("make", [lambda s: soft.pillow((1, 1, 0.2), seed=s), lambda s: cloth.drape((1, 1), seed=s)])
def test_the_same_seed_gives_the_same_thing_and_another_another(make: Callable[[Any], Shape]) -> None:
    assert np.array_equal(make(("a", 1)).vertices, make(("a", 1)).vertices)
    assert not np.array_equal(make(1).vertices, make(2).vertices)


@pytest.mark.parametrize(
    "shape",
    [
        solids.box((1, 2, 3)),
        profiles.extrude(L_OUTLINE, 0.2),
        solids.cylinder(0.5, 1, segments=24),
        solids.prism(6, 1, 2),
        solids.cone(1, 1, 0.4, segments=5),
    ],
    ids=["box", "L", "cylinder", "prism", "frustum"],
)
def test_a_bevel_cuts_edges_off_and_keeps_the_shape_closed(shape: Shape) -> None:
    cut = reshape.bevel(shape, 0.02)
    assert isinstance(cut, Shape) and open_edges(cut) == 0
    assert np.allclose(size_of(cut), size_of(shape), atol=0.04)
    before, after = (signed_volume(s.vertices, list(s.faces)) for s in (shape, cut))
    assert 0.8 * before < after < before


def test_a_bevel_leaves_smooth_edges_alone() -> None:
    ball = solids.sphere(1.0, segments=48, rings=24)
    assert np.array_equal(reshape.bevel(ball, 0.1).vertices, ball.vertices)  # type: ignore[union-attr]


def test_subdividing_a_cube_comes_near_a_ball() -> None:
    ball = reshape.subdivide(solids.box((2, 2, 2)), 3)
    assert isinstance(ball, Shape) and open_edges(ball) == 0
    reach = np.linalg.norm(ball.vertices, axis=1)
    assert reach.max() / reach.min() < 1.12


def test_a_thickened_sheet_is_closed() -> None:
    sheet = sheets.grid(lambda u, v: u * v, 4, 3)
    thick = reshape.solidify(sheet, 0.05)
    assert isinstance(thick, Shape) and open_edges(thick) == 0
    assert signed_volume(thick.vertices, list(thick.faces)) > 0


def test_taper_and_bend_do_what_they_say() -> None:
    narrow = reshape.taper(solids.box((1, 1, 2)), 0.5)
    assert isinstance(narrow, Shape)
    top = narrow.vertices[narrow.vertices[:, 2] > 0]
    assert np.allclose(np.ptp(top, axis=0), (0.5, 0.5, 0))
    bent = reshape.bend(profiles.loft([[(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)]] * 9, [i / 8 for i in range(9)]), 90)
    assert isinstance(bent, Shape)
    assert bent.vertices[:, 1].min() < -0.55 and open_edges(bent) == 0
    assert signed_volume(bent.vertices, list(bent.faces)) > 0


def test_lofting_through_unequal_outlines_is_refused() -> None:
    with pytest.raises(ValueError, match="same number of points"):
        profiles.loft([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 0), (1, 1), (0, 1)]], [0, 1])
    with pytest.raises(ValueError, match="rise"):
        profiles.loft([[(0, 0), (1, 0), (1, 1)]] * 2, [1, 0])


def test_a_program_may_use_them_and_a_bomb_is_refused() -> None:
    room = "room(size=(4, 4, 2.5), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])\n"
    room += 'proxy("bed_1", "bed", centre=(0, 0, 0.3), size=(1.6, 2, 0.6))\n'
    good = "def bed_1():\n    return [cushion((1.6, 2, 0.3), at=(0, 0, 0.15)), drape((1.6, 1.6), at=(0, 0, 0.3))]\n\n"
    record = evaluate(room + good + 'furnish("bed_1", bed_1())\nbuild()\n')
    assert len(record.furnished["bed_1"]) == 2
    bomb = "s = box((1, 1, 1))\nfor i in range(9):\n    s = subdivide(s, 4)\n"
    with pytest.raises(ProgramError, match="vertices"):
        evaluate(room + bomb + "build()\n")
