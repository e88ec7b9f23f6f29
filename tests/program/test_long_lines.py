# SPDX-License-Identifier: GPL-3.0-or-later
"""Long lines of room.py are broken where a person would break them."""

from __future__ import annotations

import ast

from code_as_room.pipeline.program.wrapping import WIDTH, wrapped

BLOCK = "kitchen_block((-iw / 2, -d / 2 + 0.02, key_z - bed), (iw / 2, front + 0.03, key_z - 0.03), 0.004, tall, 'bed')"


def test_a_call_at_the_end_of_a_call_is_broken_and_not_the_outer_one() -> None:
    text = f"if piano:\n    append(made, part({BLOCK}, material=wood))"
    lines = wrapped(text).split("\n")
    assert lines[1] == "    append(made, part(" and lines[-1] == "    ))" and max(map(len, lines)) <= WIDTH
    assert ast.dump(ast.parse("\n".join(lines))) == ast.dump(ast.parse(text))


def test_what_stands_beside_others_keeps_a_line_for_each() -> None:
    text = f"made = [{BLOCK}, {BLOCK}]"
    lines = wrapped(text).split("\n")
    assert lines[0] == "made = [" and lines[-1] == "]" and max(map(len, lines)) <= WIDTH
    assert ast.dump(ast.parse("\n".join(lines))) == ast.dump(ast.parse(text))
