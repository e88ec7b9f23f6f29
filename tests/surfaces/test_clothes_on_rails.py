# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of clothes hang from the rail that is above them, whatever height somebody guessed from above."""

from __future__ import annotations

from dataclasses import replace

import pytest
from code_as_room.pipeline.artifacts.layout import ProxyLine
from code_as_room.pipeline.program.prelude.shape import Shape
from code_as_room.pipeline.program.prelude.solids import box, cylinder
from code_as_room.pipeline.surfaces.choose import Carriers
from code_as_room.pipeline.surfaces.hang import on_its_rail, under_rail

WARDROBE = ProxyLine(id="wardrobe_1", category="wardrobe", centre=(1.0, 2.0, 1.1), size=(1.6, 0.6, 2.2), yaw=90.0)
TOP = replace(box((1.6, 0.6, 0.02), at=(0, 0, 2.19)), part="top")
BOARD = replace(box((1.6, 0.6, 0.02), at=(0, 0, 0.49)), part="shelf")
RAIL = replace(cylinder(0.012, 1.5, at=(0, 0, 1.9), axis="x"), part="hanging rail")
HOOK = 1.9 + 0.012 + 0.015


def row(category: str = "row of shirts", height: float = 0.9, at: tuple[float, float] = (1.0, 2.3)) -> ProxyLine:
    size = (0.5, 0.45, height)
    return ProxyLine(
        id="a", category=category, centre=(*at, 0.5 + height / 2), size=size, placement="surface", parent="wardrobe_1"
    )


def hung(thing: ProxyLine, shapes: list[Shape], *others: ProxyLine, own: list[Shape] | None = None) -> ProxyLine | None:
    carriers = Carriers({"wardrobe_1": shapes, "a": own or []})
    for proxy in (WARDROBE, *others):
        carriers.proxies[proxy.id] = proxy
    return under_rail(thing, WARDROBE, carriers)


def ends(thing: ProxyLine | None) -> tuple[float, float]:
    assert thing is not None
    return thing.centre[2] - thing.size[2] / 2, thing.centre[2] + thing.size[2] / 2


@pytest.mark.parametrize("height", [0.5, 0.9, 1.4, 1.6])
def test_a_row_of_clothes_hangs_from_its_rail_down_to_the_board_and_never_lies_on_top(height: float) -> None:
    found = hung(row(height=height), [TOP, BOARD, RAIL])
    assert ends(found) == pytest.approx((0.5, HOOK), abs=0.003)
    assert found is not None and found.centre[:2] == row().centre[:2] and found.size[:2] == row().size[:2]


@pytest.mark.parametrize(("wire", "off"), [(0.004, 0.0), (0.009, 0.04), (0.02, -0.05)])
def test_hooks_rest_on_the_rail_however_thick_they_are_and_wherever_they_stand_out(wire: float, off: float) -> None:
    # A garment whose hook is a bar across the rail, `off` metres before its middle.
    garment = [
        replace(box((0.4, 0.4, 0.8)), part="coat"),
        *(replace(box((0.003, 0.004, wire), at=(0.1, off + y, 0.9 - wire)), part="hook") for y in (-0.01, 0, 0.01)),
    ]
    found = hung(row(at=(0.97, 2.3)).model_copy(update={"yaw": 90.0}), [TOP, BOARD, RAIL], own=garment)
    assert found is not None
    scale = found.size[2] / 0.9
    hook = found.centre[2] - found.size[2] / 2 + scale * (0.9 - wire)
    assert hook == pytest.approx(1.912, abs=0.004)
    # The wardrobe is turned by 90 degrees: its depth runs against x.
    assert found.centre[0] - off == pytest.approx(1.0, abs=0.012) and found.centre[1] == pytest.approx(2.3)


def test_hooks_that_are_longer_in_the_size_that_clothes_hang_in_do_not_sink_into_the_rail() -> None:
    def garment(height: float, hook: float) -> list[Shape]:
        tall = height - 0.1
        wires = [
            replace(box((0.003, 0.004, hook), at=(0.1, y, height - hook / 2)), part="hook") for y in (-0.01, 0, 0.01)
        ]
        return [replace(box((0.4, 0.4, tall), at=(0, 0, tall / 2)), part="coat"), *wires]

    found = hung(row(at=(1.0, 2.3)).model_copy(update={"yaw": 90.0}), [TOP, BOARD, RAIL], own=garment(0.9, 0.02))
    assert found is not None
    longer = garment(found.size[2], 0.045)
    settled = on_its_rail(found, WARDROBE, {"wardrobe_1": [TOP, BOARD, RAIL], "a": longer})
    low, _ = ends(settled)
    assert low == pytest.approx(ends(found)[0])
    lowest = (found.size[2] - 0.045) * settled.size[2] / found.size[2]
    assert low + found.size[2] - 0.045 < 1.905 and low + lowest == pytest.approx(1.912, abs=0.004)
    # What hangs well already stays, to the bit.
    assert on_its_rail(settled, WARDROBE, {"wardrobe_1": [TOP, BOARD, RAIL], "a": garment(1.45, 0.01)}) is settled


def test_clothes_hang_over_the_shoes_below_them() -> None:
    shoes = ProxyLine(id="shoes_1", category="pair of shoes", centre=(1.0, 2.3, 0.56), size=(0.3, 0.25, 0.12),
                      placement="surface", parent="wardrobe_1")  # fmt: skip
    assert ends(hung(row(), [TOP, BOARD, RAIL], shoes)) == pytest.approx((0.62, HOOK), abs=0.003)
    aside = shoes.model_copy(update={"centre": (1.0, 1.4, 0.56)})
    assert ends(hung(row(), [TOP, BOARD, RAIL], aside)) == pytest.approx((0.5, HOOK), abs=0.003)


@pytest.mark.parametrize(
    ("thing", "shapes"),
    [
        (row("stack of folded shirts"), [TOP, BOARD, RAIL]),
        (row("storage box"), [TOP, BOARD, RAIL]),
        (row(), [TOP, BOARD]),
        (row(), [RAIL]),
        (row(at=(1.0, 3.4)), [TOP, BOARD, RAIL]),
    ],
    ids=["folded", "no clothes", "no rail", "nothing below", "beside the rail"],
)
def test_all_else_is_placed_as_anything_is(thing: ProxyLine, shapes: list[Shape]) -> None:
    assert hung(thing, shapes) is None
