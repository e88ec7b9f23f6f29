# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference that a model is given: short, complete, and true; and the examples behind the documentation's pictures."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.program.prelude import registry
from code_as_room.pipeline.program.reference import EXAMPLE, LONGEST, reference

from benchmark.constructor_examples import GROUPS, MARKS, SHEETS, documentation, program

PAGE = Path(__file__).resolve().parents[2] / "docs" / "geometry.md"
ALL = {title: expression for sheet in SHEETS.values() for title, expression in sheet.items()}


def test_it_is_short_and_names_everything() -> None:
    text = reference()
    assert len(text.encode()) <= LONGEST
    for name in (*registry.CONSTRUCTORS, *registry.MATH, *registry.CONSTANTS):
        assert re.search(rf"\b{name}\b", text), name


def test_its_example_is_a_chair_that_fills_its_size_and_stands() -> None:
    shapes = evaluate_object(EXAMPLE, "armchair_1")
    points = np.concatenate([shape.vertices for shape in shapes])
    assert np.allclose(np.ptp(points, axis=0), (0.8, 0.78, 0.85), atol=0.02) and abs(points[:, 2].min()) < 1e-6
    assert all(shape.part and shape.material for shape in shapes)


@pytest.mark.parametrize("title", ALL)
def test_every_example_of_the_pictures_evaluates(title: str) -> None:
    shapes = evaluate_object(program(ALL[title]), "made")
    assert shapes and sum(len(shape.faces) for shape in shapes)


def test_every_constructor_that_makes_or_changes_shapes_is_in_a_picture() -> None:
    numbers = {"lerp", "clamp", "smoothstep", "rand", "noise", "append", "keys", "values", "items", "bounds", "size_of"}
    shown = " ".join(ALL.values())
    assert not [name for name in registry.CONSTRUCTORS if name not in numbers and f"{name}(" not in shown]


def test_the_documentation_is_what_the_constructors_say_of_themselves() -> None:
    text = PAGE.read_text(encoding="utf-8")
    written = text.split(MARKS[0])[1].split(MARKS[1])[0]
    assert written.strip() == documentation().strip(), "run python -m benchmark.constructor_sheets"
    numbers = {"lerp", "clamp", "smoothstep", "rand", "noise", "append", "keys", "values", "items"}
    assert {name for names in GROUPS.values() for name in names} == set(registry.CONSTRUCTORS) - numbers
    for name in SHEETS:
        assert (PAGE.parent / "pictures" / "geometry" / f"{name}.png").stat().st_size < 300_000
