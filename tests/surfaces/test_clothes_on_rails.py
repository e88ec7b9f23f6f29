# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of clothes hang from the rail that is above them, whatever height somebody guessed from above."""

from __future__ import annotations

from dataclasses import replace

import pytest
from code_as_room.pipeline.artifacts.layout import ProxyLine
from code_as_room.pipeline.program.prelude.solids import box, cylinder
from code_as_room.pipeline.surfaces.hang import reaching_rail

WARDROBE = ProxyLine(id="wardrobe_1", category="wardrobe", centre=(1.0, 2.0, 1.1), size=(1.6, 0.6, 2.2), yaw=90.0)
BOARD = replace(box((1.6, 0.6, 0.02), at=(0, 0, 0.49)), part="shelf")
RAIL = replace(cylinder(0.012, 1.5, at=(0, 0, 1.9), axis="x"), part="hanging rail")


def row(category: str = "row of shirts", height: float = 0.9, at: tuple[float, float] = (1.0, 2.3)) -> ProxyLine:
    size = (0.5, 0.45, height)
    return ProxyLine(
        id="a", category=category, centre=(*at, 0.5 + height / 2), size=size, placement="surface", parent="wardrobe_1"
    )


def test_a_row_of_clothes_reaches_its_rail_and_stays_where_it_is() -> None:
    found = reaching_rail(row(), WARDROBE, [BOARD, RAIL])
    assert found.centre[2] - found.size[2] / 2 == pytest.approx(0.5)
    assert found.centre[2] + found.size[2] / 2 == pytest.approx(1.9 + 0.012 + 0.015, abs=1e-6)
    assert found.centre[:2] == row().centre[:2] and found.size[:2] == row().size[:2]


@pytest.mark.parametrize(
    ("thing", "shapes"),
    [
        (row("stack of folded shirts"), [BOARD, RAIL]),
        (row("storage box"), [BOARD, RAIL]),
        (row(), [BOARD]),
        (row(height=0.4), [BOARD, RAIL]),  # nobody wears that
        (row(height=1.6), [BOARD, RAIL]),  # it is longer than there is room for: nothing here mends that
        (row(at=(1.0, 3.4)), [BOARD, RAIL]),
    ],
    ids=["folded", "no clothes", "no rail", "far too short", "too long", "beside the rail"],
)
def test_all_else_stays_as_it_is(thing: ProxyLine, shapes: list[object]) -> None:
    assert reaching_rail(thing, WARDROBE, shapes) == thing  # type: ignore[arg-type]
