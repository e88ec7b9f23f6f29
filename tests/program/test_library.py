# SPDX-License-Identifier: GPL-3.0-or-later
"""The furniture library: every piece fills any size, stands on the floor, and says what it is made of."""

from __future__ import annotations

import ast
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.program.prelude.palette import ROLE_COLOURS
from code_as_room.pipeline.program.prelude.shape import Shape

PIECES = catalogue.pieces()
SCALES = ((1.0, 1.0, 1.0), (0.55, 1.6, 0.8), (1.7, 0.6, 1.35))
MOST_VERTICES = 60_000


def made(name: str, size: tuple[float, ...], **options: Any) -> list[Shape]:
    arguments = "".join(f", {key}={value!r}" for key, value in options.items())
    text = catalogue.source([name]) + f"\n\ndef made():\n    return {name}({tuple(size)!r}{arguments})\n"
    return evaluate_object(text, "made")


@pytest.mark.parametrize("name", PIECES)
def test_a_piece_fills_any_size_and_stands_on_the_floor(name: str) -> None:
    for factors in SCALES:
        size = tuple(round(a * b, 4) for a, b in zip(PIECES[name].typical, factors, strict=True))
        points = np.concatenate([shape.vertices for shape in made(name, size)])
        low, high = points.min(axis=0), points.max(axis=0)
        assert np.allclose(high - low, size, atol=0.002), f"{name} at {size}: {high - low}"
        assert abs(low[2]) < 1e-6 and np.allclose((low + high)[:2], 0, atol=0.002)


@pytest.mark.parametrize("name", PIECES)
def test_its_parts_are_named_and_made_of_something(name: str) -> None:
    shapes = made(name, PIECES[name].typical)
    assert all(shape.part for shape in shapes)
    assert {shape.material for shape in shapes} <= set(ROLE_COLOURS)
    assert sum(shape.vertex_count for shape in shapes) <= MOST_VERTICES


@pytest.mark.parametrize("name", PIECES)
def test_its_parameters_are_explained_and_change_it(name: str) -> None:
    piece = PIECES[name]
    plain = np.concatenate([shape.vertices for shape in made(name, piece.typical)])
    for parameter, (default, meaning) in piece.parameters.items():
        assert meaning, f"{name}: {parameter} is not explained"
        value = ast.literal_eval(default)
        words = [w for w in ast_texts(meaning) if w != value]
        other = words[0] if words else value + 1 if isinstance(value, int) and not isinstance(value, bool) else None
        if isinstance(value, bool):
            other = not value
        if other is None:
            continue
        changed = np.concatenate([shape.vertices for shape in made(name, piece.typical, **{parameter: other})])
        assert changed.shape != plain.shape or not np.allclose(changed, plain), f"{name}: {parameter} changes nothing"


def ast_texts(meaning: str) -> list[str]:
    """The words in double quotes."""
    return meaning.split('"')[1::2]


def test_defs_are_named_once_over_all_files() -> None:
    names = [
        n.name for p in catalogue.FOLDER.glob("*.room") for n in ast.parse(p.read_text()).body if hasattr(n, "name")
    ]
    assert len(names) == len(set(names)) == len(catalogue.definitions())


@pytest.mark.parametrize(
    ("category", "label", "wanted"),
    [("sofa", "", "sofa"), ("grey couch", "", "sofa"), ("two-seater sofa", "", "sofa"), ("couches", "", "sofa")],
)
def test_the_catalogue_finds_by_words(category: str, label: str, wanted: str) -> None:
    assert catalogue.find(category, label)[0][1].name == wanted


def test_what_is_not_there_is_not_found() -> None:
    assert catalogue.find("zeppelin") == []


@pytest.mark.parametrize(
    ("size", "stands"), [((0.95, 0.2, 0.26), True), ((0.5, 0.2, 0.24), True), ((0.26, 0.2, 0.14), False)]
)
def test_books_stand_where_they_are_a_row_and_lie_where_they_are_a_pile(
    size: tuple[float, float, float], stands: bool
) -> None:
    """Rows of books in a bookcase were one pile, drawn out to a metre."""
    covers = [s.vertices for s in made("book_stack", size) if s.part == "cover"]
    extents = [np.ptp(np.concatenate(covers[i : i + 3]), axis=0) for i in range(0, len(covers), 3)]
    thin = [int(np.argmin(extent)) for extent in extents]
    assert set(thin) == {0 if stands else 2}
    # The boards that hold the spines are where one looks at a shelf.
    spines = [c for c in covers if stands and np.ptp(c[:, 1]) < 0.02]
    assert all(c[:, 1].max() < 0 for c in spines) and (not stands or len(spines) == len(covers) // 3)
