# SPDX-License-Identifier: GPL-3.0-or-later
"""Part names of library pieces: materials are given by them, so one name is one thing made of one thing."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import pytest
from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.program.evaluate import evaluate_object

PIECES = catalogue.pieces()
MANY = frozenset({
    "ball", "bauble", "blanket", "block", "book", "bottle", "bottle cap", "box", "box lid", "brush", "button", "coat", "cover",
    "cushion", "drawing", "duvet", "folded clothes", "folder", "grains", "head", "hill", "icing", "knob", "label", "laundry",
    "liquid", "magnet", "mill", "pastry", "pen", "pen cap", "pencil", "petal", "pillow", "shape", "shirt", "shoe", "sleeve",
    "spice", "stool seat", "towel", "trousers", "valve", "vase",
})  # fmt: skip
"""Things of which a piece has several of one kind that differ only in what they are made of."""
SAYS_NOTHING = frozenset(
    {"part", "piece", "thing", "object", "shape 1", "solid", "mesh", "item", "element", "other", "x"}
)


def variants(piece: catalogue.Piece) -> Iterator[dict[str, Any]]:
    yield {}
    for name, (default, meaning) in piece.parameters.items():
        value = ast.literal_eval(default)
        if isinstance(value, bool):
            yield {name: not value}
        else:
            yield from ({name: word} for word in meaning.split('"')[1::2] if word != value)


def materials(name: str, options: dict[str, Any]) -> dict[str, set[str]]:
    given = "".join(f", {key}={value!r}" for key, value in options.items())
    text = f"{catalogue.source([name])}\n\ndef made():\n    return {name}({PIECES[name].typical!r}{given})\n"
    found = defaultdict(set)
    for shape in evaluate_object(text, "made"):
        found[shape.part].add(shape.material)
    return found


@pytest.mark.parametrize("name", PIECES)
def test_a_name_is_one_thing_of_one_material(name: str) -> None:
    for options in variants(PIECES[name]):
        for part, made_of in materials(name, options).items():
            assert part in MANY or len(made_of) == 1, f"{name} {options}: {part} is made of {sorted(made_of)}"


@pytest.mark.parametrize("name", PIECES)
def test_a_name_says_what_it_is(name: str) -> None:
    for part in materials(name, {}):
        assert part == part.strip().lower() and part not in SAYS_NOTHING and not part.isdigit()


def test_each_block_has_a_name_of_its_own() -> None:
    made = materials("toy_blocks", {})
    assert len(made) == 7 and all(len(v) == 1 for v in made.values())
    assert {"engine", "middle wagon", "last wagon"} <= set(materials("toy_blocks", {"kind": "train"}))
