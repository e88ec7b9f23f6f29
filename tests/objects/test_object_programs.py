# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs of objects as models write them: what is repaired, what is refused, and what is measured on them."""

from __future__ import annotations

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.layout import ProxyLine
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.objects.checks import check
from code_as_room.pipeline.objects.written import take_program
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.program.prelude.palette import ROLE_COLOURS, split_role

TABLE = ProxyLine(id="table_1", category="table", centre=(0, 0, 0.375), size=(1.2, 0.6, 0.75))
GOOD = """
def table_1(size):
    w, d, h = size
    a, b, t = w / 2 - 0.025, d / 2 - 0.025, h - 0.03
    legs = [part("leg", box((0.05, 0.05, t), at=(x * a, y * b, t / 2)), material="wood #8A5A3C") for x in (-1, 1) for y in (-1, 1)]
    return [part("top", box((w, d, 0.03), at=(0, 0, h - 0.015)), material="wood")] + legs
"""


def extent(shapes: object) -> np.ndarray:
    points = np.concatenate([s.vertices for s in shapes])  # type: ignore[attr-defined]
    return np.concatenate([points.min(axis=0), points.max(axis=0)])


def test_a_good_program_stays_as_it_was_written() -> None:
    made = take_program(GOOD, TABLE, "table_1")
    assert made.checked.findings == () and made.code == GOOD.strip()
    assert "wood #8A5A3C" in {s.material for s in made.shapes}


def test_a_fence_other_names_and_furnish_lines_do_no_harm() -> None:
    text = (
        "Here it is:\n```python\n"
        + GOOD.replace("table_1", "my_table")
        + 'furnish("table_1", my_table)\nbuild()\n```\n'
    )
    made = take_program(text, TABLE, "table_1")
    assert made.code.startswith("def table_1(size):") and "furnish" not in made.code


def test_helpers_get_names_that_no_other_object_has() -> None:
    text = "def leg(x):\n    return part('leg', box((0.1, 0.1, 0.7), at=(x, 0, 0.35)), material='wood')\n\n\n" + (
        "def table_1(size):\n    w, d, h = size\n"
        "    return [leg(-0.5), leg(0.5), part('top', box((w, d, 0.05), at=(0, 0, h - 0.025)), material='wood')]\n"
    )
    made = take_program(text, TABLE, "table_1", taken={"leg"})
    assert "def table_1_leg(x):" in made.code and "part('leg'" in made.code and "def leg(" not in made.code


def test_what_misses_its_box_a_little_is_stretched_to_fill_it() -> None:
    made = take_program(GOOD.replace("w, d, h = size", "w, d, h = (1.0, 0.62, 0.7)"), TABLE, "table_1")
    assert any("ends" in f or "sticks" in f for f in made.checked.findings)
    np.testing.assert_allclose(extent(made.shapes), (-0.6, -0.3, 0, 0.6, 0.3, 0.75), atol=1e-6)


def test_what_misses_its_box_by_far_is_refused_with_the_reason() -> None:
    with pytest.raises(ProgramError, match="far from the size"):
        take_program(GOOD.replace("w, d, h = size", "w, d, h = (12.0, 6.0, 7.5)"), TABLE, "table_1")


def test_unknown_materials_become_known_ones() -> None:
    made = take_program(GOOD.replace('material="wood")]', 'material="polished oak")]'), TABLE, "table_1")
    assert {split_role(s.material)[0] for s in made.shapes} == {"wood"} <= set(ROLE_COLOURS)


@pytest.mark.parametrize(
    ("program", "reason"),
    [
        ("import os\ndef table_1(size):\n    return box(size)", "import"),
        ("def table_1(size):\n    return table_1(size)", "table_1"),
        ("def table_1(size):\n    while True:\n        pass", "while"),
        ("def table_1(size):\n    return [sphere(1, segments=900, rings=900) for i in range(100)]", ""),
        ("def table_1(size):\n    return box((0 / 0, 1, 1))", ""),
        ("def table_1(size):\n    return fancy_box(size)", "fancy_box"),
        ("def table_1(size):\n    return []", "no shapes"),
        ("def table_1(size):\n    return 7", "shape"),
        ("def table_1():\n    return box((1, 1, 1))", "size"),
        ("print('hello')", ""),
        ("", "def"),
        ("def table_1(size:\n  return", ""),
        ("def table_1(size):\n    return box(size, at=(0, 0, size[2] / 2)).scale(2)", ""),
        ("x = [0]\ndef table_1(size):\n    return [box(size) for i in range(10 ** 9)]", ""),
    ],
)
def test_what_no_program_may_be_is_one_sentence(program: str, reason: str) -> None:
    with pytest.raises(ProgramError) as caught:
        take_program(program, TABLE, "table_1")
    assert reason in str(caught.value) and "Traceback" not in str(caught.value)


def made(body: str) -> list[object]:
    return evaluate_object(f"def made():\n    return {body}\n", "made")  # type: ignore[return-value]


def found(body: str, placement: str = "floor") -> str:
    return " ".join(check(made(body), (1, 1, 1), placement).findings)  # type: ignore[arg-type]


SEAT = 'part("seat", box((1, 1, 0.1), at=(0, 0, 0.95)), material="wood")'
LEGS = '[part("leg", box((0.1, 0.1, 0.9), at=(x, y, 0.45)), material="wood") for x in (-0.4, 0.4) for y in (-0.4, 0.4)]'


def test_a_sound_stool_has_no_findings() -> None:
    assert check(made(f"[{SEAT}] + {LEGS}"), (1, 1, 1)).penalty == 0.0  # type: ignore[arg-type]


def test_a_seat_above_its_legs_floats() -> None:
    short = LEGS.replace("0.9)", "0.7)").replace("0.45)", "0.35)")
    assert "seat" in found(f"[{SEAT}] + {short}") and "float" in found(f"[{SEAT}] + {short}")


def test_beams_that_cross_touch() -> None:
    cross = '[part("a", box((1, 0.1, 1), at=(0, 0, 0.5)), material="wood"), part("b", box((0.1, 1, 0.1), at=(0, 0, 0.5)), material="wood")]'
    assert "float" not in found(cross)


def solid(name: str, size: str, at: str) -> str:
    return f'part("{name}", box({size}, at={at}), material="wood")'


def test_a_lamp_hangs_from_the_ceiling_and_a_shelf_from_its_wall() -> None:
    lamp = f"[{solid('cord', '(0.02, 0.02, 0.5)', '(0, 0, 0.75)')}, {solid('shade', '(1, 1, 0.5)', '(0, 0, 0.25)')}]"
    assert "float" not in found(lamp, "ceiling")
    shelf = f"[{solid('board', '(1, 1, 0.1)', '(0, 0, 0.05)')}, {solid('upper', '(1, 0.4, 0.1)', '(0, 0.3, 0.95)')}]"
    assert "float" not in found(shelf, "wall") and "upper" in found(shelf, "floor")


def test_what_leans_over_would_fall() -> None:
    body = f"[{solid('foot', '(0.1, 1, 0.5)', '(-0.45, 0, 0.25)')}, {solid('top', '(1, 1, 0.5)', '(0, 0, 0.75)')}]"
    assert "fall over" in found(body)


def test_one_box_is_no_furniture_and_nameless_parts_are_told() -> None:
    assert "plain box" in found("box((1, 1, 1), at=(0, 0, 0.5))")
    assert "no part name" in found("box((1, 1, 1), at=(0, 0, 0.5))")


def test_a_toy_block_may_be_a_plain_box_and_a_chest_may_not() -> None:
    for side, told in ((0.05, False), (0.6, True)):
        shapes = made(f"part('block', box(({side}, {side}, {side}), at=(0, 0, {side / 2})), material='wood')")
        assert ("plain box" in " ".join(check(shapes, (side, side, side)).findings)) == told  # type: ignore[arg-type]


def test_a_program_that_has_to_be_fitted_may_replace_one_that_had_to_be() -> None:
    small = GOOD.replace("return [", "return scale([").rstrip() + ", 0.9)\n"
    made = take_program(small, TABLE, "table_1", taken=("table_1_shapes", "leg"))
    assert "def table_1_shapes2(size)" in made.code
    assert np.allclose(extent(made.shapes), (-0.6, -0.3, 0, 0.6, 0.3, 0.75), atol=1e-3)
