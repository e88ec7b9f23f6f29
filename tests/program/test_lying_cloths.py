# SPDX-License-Identifier: GPL-3.0-or-later
"""Cloths that lie on things: measured on the meshes, with the rasters that find surfaces."""

from __future__ import annotations

import numpy as np
import pytest
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.prelude.covers import seen_from
from code_as_room.pipeline.program.prelude.record import Record
from code_as_room.pipeline.program.prelude.shape import Shape
from code_as_room.pipeline.surfaces.rasters import Samples, sample

ROOM = """
room(size=(5, 5, 2.6), floor=[(-2.5, -2.5), (2.5, -2.5), (2.5, 2.5), (-2.5, 2.5)])
proxy("bed_1", "bed", centre=(0.4, 0.2, 0.5), size=(1.6, 2.0, 1.0), yaw=30)
proxy("throw_1", "throw", centre=(0.4, 0.1, 0.75), size=(1.9, 0.5, 0.05), yaw=25, placement="surface", parent="bed_1")
proxy("duvet_1", "duvet", centre=(0.4, 0.1, 0.62), size=(1.62, 1.4, 0.12), yaw=30, placement="surface", parent="bed_1")

def bed_1(size):
    w, d, h = size
    lump = sphere((0.4, 0.5, 0.06), at=(0.2, -0.3, 0.5))
    return [part("mattress", [rounded_box((w, d, 0.5), 0.05, at=(0, 0, 0.25)), lump], material="linen"),
            part("headboard", box((w, 0.08, h), at=(0, d / 2 - 0.04, h / 2)), material="wood")]

def duvet_1(size):
    w, d, h = size
    return part("duvet", drape((w - 0.1, d - 0.1), hang=0.1, thickness=0.04, puff=0.6, at=(0, 0, h - 0.06), seed=2), material="linen")

def throw_1(size):
    w, d, h = size
    return part("throw", solidify(grid(lambda u, v: 0.004 * sin(60 * u), 60, 20, (w, d)), 0.01), material="fabric")

furnish("throw_1", throw_1, lying=True)
furnish("bed_1", bed_1)
furnish("duvet_1", duvet_1, lying=True)
build()
"""


def made(text: str = ROOM) -> Record:
    return evaluate(text)


def in_room(record: Record, name: str) -> list[Shape]:
    line = next(p for p in record.proxies if p["id"] == name)
    return seen_from(record.furnished[name], line, {"centre": (0, 0, 0), "size": (0, 0, 0), "yaw": 0})


def heights(shapes: list[Shape], lowest: bool) -> dict[tuple[int, int], float]:
    """Height of the underside, or of the top, by cell of one grid of 1 cm over the whole room."""
    frame = np.array(((-2.5, -2.5, -9.0), (2.5, -2.5, -9.0), (2.5, 2.5, -9.0)))
    samples = sample([*shapes, Shape(frame, ((0, 1, 2),))], 0.01)
    assert isinstance(samples, Samples)
    found: dict[tuple[int, int], float] = {}
    for cell, z in zip(samples.cells.tolist(), samples.heights.tolist(), strict=True):
        if z > -8:
            key = divmod(cell, samples.grid.shape[1])
            found[key] = (min if lowest else max)(found.get(key, z), z)
    return found


def gaps(cloth: list[Shape], below: list[Shape]) -> np.ndarray:
    under, ground = heights(cloth, True), heights(below, False)
    return np.array([under[c] - ground[c] for c in under if c in ground and under[c] - ground[c] < 0.2])


def level_gaps(cloth: list[Shape], below: list[Shape]) -> np.ndarray:
    """As `gaps`, where what is below rises by less than 5 mm from one centimetre to the next."""
    under, ground = heights(cloth, True), heights(below, False)
    round_it = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    found = []
    for c in under:
        near = [ground.get((c[0] + i, c[1] + j), -9.0) for i, j in round_it]
        if c in ground and max(near) - min(near) < 0.005 and under[c] - ground[c] < 0.2:
            found.append(under[c] - ground[c])
    return np.array(found)


@pytest.mark.parametrize(("name", "carriers"), [("duvet_1", ["bed_1"]), ("throw_1", ["bed_1", "duvet_1"])])
def test_a_cloth_touches_what_is_below_it_and_never_sinks_in(name: str, carriers: list[str]) -> None:
    record = made()
    mattress = [s for c in carriers for s in in_room(record, c) if s.part != "headboard"]
    found = gaps(in_room(record, name), mattress)
    assert len(found) > 3000
    # Straight down from a steep edge a millimetre of cloth looks like several.
    assert np.percentile(found, 0.5) > -0.008
    level = level_gaps(in_room(record, name), mattress)
    assert len(level) > 3000 and level.min() > -0.002
    assert np.percentile(found, 75) < 0.005
    before = gaps(seen_from(record.plain[name], *lines(record, name)), mattress)
    assert np.percentile(np.abs(before), 75) > 0.02


def lines(record: Record, name: str) -> tuple[dict[str, object], dict[str, object]]:
    return next(p for p in record.proxies if p["id"] == name), {"centre": (0, 0, 0), "size": (0, 0, 0), "yaw": 0}


def test_folds_stay_where_they_are_seen() -> None:
    record = made()
    top = np.concatenate([s.vertices for s in record.furnished["duvet_1"]])[:, 2]
    assert np.ptp(top) > 0.08


def test_what_reaches_beyond_an_edge_hangs_down_there() -> None:
    text = """
room(size=(5, 5, 2.6), floor=[(-2.5, -2.5), (2.5, -2.5), (2.5, 2.5), (-2.5, 2.5)])
proxy("table_1", "table", centre=(0, 0, 0.4), size=(0.8, 1.6, 0.8))
proxy("cloth_1", "runner", centre=(0, 0, 0.9), size=(1.6, 0.4, 0.01), placement="surface", parent="table_1")

def table_1(size):
    return part("top", box((0.8, 1.6, 0.04), at=(0, 0, 0.78)), material="wood")

def cloth_1(size):
    return part("cloth", solidify(grid(lambda u, v: 0, 80, 16, (1.6, 0.4)), 0.005), material="linen")

furnish("table_1", table_1)
furnish("cloth_1", cloth_1, lying=True)
build()
"""
    points = np.concatenate([s.vertices for s in in_room(made(text), "cloth_1")])
    assert np.abs(points[:, 0]).max() < 0.5
    assert 0.38 < points[:, 2].min() < 0.46
    assert points[:, 2].max() < 0.82
    inside = (np.abs(points[:, 0]) < 0.398) & (points[:, 2] < 0.799)
    assert not inside.any()


def test_nothing_below_leaves_a_cloth_as_it_is() -> None:
    text = ROOM.replace("centre=(0.4, 0.1, 0.75)", "centre=(-1.9, -1.9, 0.75)")
    record = made(text)
    for new, old in zip(record.furnished["throw_1"], record.plain["throw_1"], strict=True):
        np.testing.assert_array_equal(new.vertices, old.vertices)


def test_a_second_evaluation_that_knows_the_functions_lays_them_just_so() -> None:
    first, second = made(), made()
    moved = made(ROOM.replace('"bed", centre=(0.4, 0.2, 0.5)', '"bed", centre=(0.4, 0.2, 0.6)'))
    for a, b, c in zip(
        first.furnished["throw_1"], second.furnished["throw_1"], moved.furnished["throw_1"], strict=True
    ):
        np.testing.assert_array_equal(a.vertices, b.vertices)
        assert 0.05 < float((c.vertices - a.vertices)[:, 2].mean()) < 0.11


BESIDE = """
room(size=(6, 6, 2.6), floor=[(-3, -3), (3, -3), (3, 3), (-3, 3)])
proxy("bed_1", "bed", centre=(0, 0, 0.25), size=(1.6, 2.0, 0.5))
proxy("bench_1", "bench", centre=(0, -1.23, {middle}), size=(1.2, 0.4, {bench}))
proxy("nightstand_1", "nightstand", centre=(1.06, 0.3, 0.3), size=(0.4, 0.4, 0.6))
proxy("duvet_1", "duvet", centre=(0, -0.2, 0.45), size=(1.8, 1.8, 0.3), placement="surface", parent="bed_1")

def bed_1(size):
    return part("mattress", box(size, at=(0, 0, size[2] / 2)), material="linen")

def bench_1(size):
    return part("bench", box(size, at=(0, 0, size[2] / 2)), material="wood")

def duvet_1(size):
    w, d, h = size
    return part("duvet", drape((1.6, 1.6), hang=(0.3, 0.3, 0.35, 0), thickness=0.03, at=(0, 0, h - 0.05), seed=2), material="linen")

furnish("bed_1", bed_1)
furnish("bench_1", bench_1)
furnish("nightstand_1", bench_1)
furnish("duvet_1", duvet_1, lying=True)
build()
"""


@pytest.mark.parametrize("bench", [0.4, 0.46, 0.3])
def test_its_ends_hang_into_nothing_that_stands_beside_the_bed(bench: float) -> None:
    record = made(BESIDE.replace("{bench}", str(bench)).replace("{middle}", str(bench / 2)))
    points = np.concatenate([s.vertices for s in in_room(record, "duvet_1")])
    for name in ("bench_1", "nightstand_1"):
        solid = np.concatenate([s.vertices for s in in_room(record, name)])
        low, high = solid.min(axis=0) + 0.001, solid.max(axis=0) - 0.001
        assert not ((points > low) & (points < high)).all(axis=1).any(), name
    apart = made(
        BESIDE.replace("{bench}", str(bench))
        .replace("{middle}", str(bench / 2))
        .replace("centre=(0, -1.23", "centre=(0, -2.6")
    )
    alone = np.concatenate([s.vertices for s in in_room(apart, "duvet_1")])
    front = np.abs(points[:, 0]) < 0.5
    assert alone[front & (alone[:, 1] < -1.0)][:, 2].min() < bench - 0.02 or bench <= 0.3
    np.testing.assert_array_equal(points[points[:, 2] > 0.52], alone[points[:, 2] > 0.52])


TURNED_DOWN = """    z = h - 0.06
    sheet = drape((w + 0.1, d - 0.1), hang=(z, z, z, 0), thickness=0.03, folds=0.4, puff=0.3, at=(0, 0, z), seed=2)
    band = drape((w + 0.14, 0.4), hang=(0.16, 0.16, 0, 0), thickness=0.02, folds=0.3, at=(0, d / 2 - 0.25, z + 0.035), seed=5)
    return [part("duvet", sheet, material="linen"), part("turned-down band", band, material="linen")]
"""


def test_two_hanging_layers_do_not_lie_in_one_plane() -> None:
    """Faces in one plane are drawn black: the light of each is taken away by the other."""
    before, rest = ROOM.split("def duvet_1(size):\n    w, d, h = size\n")
    plain = rest.partition("\n\n")[2]
    record = made(f"{before}def duvet_1(size):\n    w, d, h = size\n{TURNED_DOWN}\n{plain}")
    sheet, band = (shape.vertices for shape in record.furnished["duvet_1"])
    for side in (-1, 1):
        own, other = (v[(side * v[:, 0] > 0.7) & (v[:, 2] < 0.02) & (v[:, 1] > 0.2)] for v in (sheet, band))
        assert len(own) > 20 and len(other) > 20
        same = np.abs(other[:, None, 0] - own[None, :, 0]) < 1e-5
        assert same.any(axis=1).mean() < 0.2
