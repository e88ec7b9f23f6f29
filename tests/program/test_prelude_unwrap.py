# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures: a metre is a metre on every surface, grain runs along a part, and operations carry it along."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_as_room.pipeline.program.prelude import cloth, growing, operations, profiles, reshape, soft, solids
from code_as_room.pipeline.program.prelude.outlines import rectangle
from code_as_room.pipeline.program.prelude.shape import Shape
from code_as_room.pipeline.program.prelude.unwrap import corner_uvs, face_normals

RAIL = [(-0.02, -0.01), (0.02, -0.01), (0.02, 0.01), (-0.02, 0.01)]
POINTS = [(0, 0, 0), (0.4, 0, 0.3), (0.9, 0.2, 0.3), (1.4, 0.2, 0.0)]

METRIC: dict[str, Shape] = {
    "box": solids.box((0.5, 0.3, 0.2)),
    "leg": solids.cylinder(0.03, 0.7),
    "drum": solids.cylinder(0.4, 0.3, axis="x"),
    "board": profiles.extrude(rectangle(1.2, 0.3, 0.05), 0.03),
    "rail": profiles.sweep(RAIL, POINTS),
    "hose": profiles.tube([(math.cos(t), math.sin(t), 0.0) for t in np.linspace(0, 6, 30).tolist()], 0.03, closed=True),
    "vase": profiles.lathe([(0, 0), (0.1, 0), (0.12, 0.15), (0.06, 0.3)]),
    "tablecloth": cloth.drape((0.8, 0.6), hang=0, puff=0),
}


def ratios(shape: Shape) -> np.ndarray:
    """Length on the texture over length in the room, of every edge of every face."""
    uvs, found, start = corner_uvs(shape), [], 0
    for face in shape.faces:
        flat, points = uvs[start : start + len(face)], shape.vertices[list(face)]
        length = np.linalg.norm(points - np.roll(points, -1, axis=0), axis=1)
        found.append(
            (np.linalg.norm(flat - np.roll(flat, -1, axis=0), axis=1) / np.maximum(length, 1e-9))[length > 1e-6]
        )
        start += len(face)
    return np.concatenate(found)


@pytest.mark.parametrize("name", METRIC)
@pytest.mark.parametrize("scaled", [False, True], ids=["as made", "scaled"])
def test_a_metre_of_texture_is_a_metre(name: str, scaled: bool) -> None:
    shape = operations.scale(METRIC[name], 3.0) if scaled else METRIC[name]
    assert isinstance(shape, Shape)
    found = ratios(shape)
    assert 0.9 < np.median(found) < 1.1
    assert np.quantile(found, 0.1) > 0.5 and np.quantile(found, 0.9) < 1.5


def grain(shape: Shape, direction: tuple[float, float, float]) -> float:
    """How far U goes on for a metre along the direction: 1 where the grain follows it, 0 where it lies across."""
    uvs, start, way = corner_uvs(shape), 0, np.array(direction) / np.linalg.norm(direction)
    found = []
    for face in shape.faces:
        flat, points = uvs[start : start + len(face)], shape.vertices[list(face)]
        step, along = flat[0] - flat[1], float((points[0] - points[1]) @ way)
        other, across = flat[1] - flat[2], float((points[1] - points[2]) @ way)
        edge, length = (step, along) if abs(along) > abs(across) else (other, across)
        if abs(length) > 0.2:
            found.append(abs(edge[0] / length))
        start += len(face)
    return float(np.mean(found))


def test_the_grain_of_a_long_part_runs_along_it() -> None:
    assert grain(solids.box((0.04, 0.04, 0.7)), (0, 0, 1)) == pytest.approx(1, abs=0.01)
    assert grain(solids.cylinder(0.03, 0.7), (0, 0, 1)) == pytest.approx(1, abs=0.01)
    assert grain(solids.box((0.3, 1.5, 0.02)), (0, 1, 0)) == pytest.approx(1, abs=0.01)
    assert grain(profiles.tube([(0, 0, 0), (0, 0.5, 0), (0, 1, 0)], 0.02), (0, 1, 0)) == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("leg", [solids.box((0.04, 0.05, 0.7)), solids.rounded_box((0.04, 0.05, 0.7), 0.01)])
def test_a_leaning_leg_keeps_the_texture_of_the_upright_one(leg: Shape) -> None:
    upright = corner_uvs(leg)
    leaning = operations.turn(operations.turn(leg, 37, "x"), 20, "y", about=(1, 2, 3))
    bevelled = reshape.bevel(operations.turn(solids.box((0.04, 0.05, 0.7)), 37, "x"), 0.005)
    assert isinstance(leaning, Shape) and isinstance(bevelled, Shape)
    moved, ends = corner_uvs(leaning), np.cumsum([len(face) for face in leg.faces])[:-1]
    for one, other in zip(np.split(upright, ends), np.split(moved, ends), strict=True):
        assert np.allclose(one - one[0], other - other[0])
    assert grain(bevelled, (0, -math.sin(math.radians(37)), math.cos(math.radians(37)))) == pytest.approx(1, abs=0.02)


def test_textures_are_never_mirrored() -> None:
    block = operations.turn(solids.box((0.5, 0.1, 0.3)), 25)
    for shape in (block, operations.mirror(block, "x"), operations.mirror(solids.box((1, 1, 1)), "y")):
        assert isinstance(shape, Shape)
        uvs, normals, start = corner_uvs(shape), face_normals(shape), 0
        for face, normal in zip(shape.faces, normals, strict=True):
            a, b, c = uvs[start : start + 3]
            turned = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            assert turned > 0, (face, normal)
            start += len(face)


def test_turned_and_lofted_things_are_unrolled_after_they_were_bent() -> None:
    bent = reshape.bend(profiles.loft([rectangle(0.3, 0.03)] * 9, [i * 0.1 for i in range(9)]), 60)
    assert isinstance(bent, Shape)
    found = ratios(bent)
    assert np.quantile(found, 0.1) > 0.97 and np.quantile(found, 0.9) < 1.03


@pytest.mark.parametrize(
    "shape", [soft.cushion((0.5, 0.5, 0.1)), growing.leaves(5, 0.3, 0.1), soft.pouf((0.5, 0.5, 0.4))]
)
def test_every_corner_has_a_place(shape: Shape) -> None:
    joined = operations.join([shape, operations.move(shape, (1, 0, 0))])
    for found in (shape, joined):
        uvs = corner_uvs(found)
        assert uvs.shape == (sum(map(len, found.faces)), 2) and np.isfinite(uvs).all()
        assert np.ptp(uvs, axis=0).min() > 0.05
