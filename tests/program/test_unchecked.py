# SPDX-License-Identifier: GPL-3.0-or-later
"""The prelude of a long file trusts what it is given: no checks, the same results, and what is not changed as it was written."""

from __future__ import annotations

import ast
import runpy
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline.program.assemble import prelude_text
from code_as_room.pipeline.program.narrowing import narrowed
from code_as_room.pipeline.program.unchecked import unchecked
from code_as_room.pipeline.program.wrapping import bare_tuples

TEXT = """
_LIMITS = {"size": (0, 3)}


def _fail(where, words):
    return ValueError(f"{where}: {words}")


def _number(where, value, low=0, high=9):
    if not low <= value <= high:
        raise _fail(where, "out of range")
    return float(value)


def _known(where, names):
    seen = set()
    for name in names:
        if name in seen:
            raise _fail(where, f"{name} is there twice")
        seen.add(name)


def box(size, names=()):
    \"\"\"A box.\"\"\"
    where = "box"
    _known(where, names)
    # Sides may be given as text.
    sides = [_number(where, side, *()) if not size else _number(where, side) for side in size]  # all three
    for side in sides:
        if side > 3:
            raise _fail(where, "too long")
    if len(sides) == 1:
        return sides * 3
    elif len(sides) == 2:
        total = (sum(sides), 1)
        return (sides[0], _number(where, total[0]))
    return  sides  # as it was


class _Line:
    def __init__(self):
        self.ids = []

    def _new(self, where, name):
        if name in self.ids:
            raise _fail(where, name)
        self.ids.append(name)
        return name

    def add(self, name):
        return self._new("line", name)
"""


def ran(text: str, folder: Path) -> dict[str, Any]:
    """What a module binds."""
    (folder / "module.py").write_text(text, encoding="utf-8")
    return runpy.run_path(str(folder / "module.py"))


def test_checks_go_and_all_else_stays_as_it_is_written(tmp_path: Path) -> None:
    text = unchecked(TEXT)
    assert "raise" not in text and "_known(where" not in text and "for side in sides:" not in text
    assert "    # Sides may be given as text.\n" in text and "    return  sides  # as it was\n" in text
    assert "    elif len(sides) == 2:\n        total = (sum(sides), 1)\n" in text
    assert "def _new(self, name):" in text and "return self._new(name)" in text
    before, after = ran(TEXT, tmp_path), ran(text, tmp_path)
    for size in ([1], [1, 2], [1, 2, 3]):
        assert after["box"](size) == before["box"](size)
    assert after["_Line"]().add("a") == "a"


def test_what_is_called_in_ways_that_nobody_can_see_keeps_its_arguments() -> None:
    text = "def _f(a, b):\n    if b:\n        raise ValueError\n    return a\n\n\nx = [_f(1, 0), *map(_f, [1], [0])]\n"
    assert "def _f(a, b):\n    return a\n" in unchecked(text)
    kept = "def _f(a, b):\n    if b:\n        raise ValueError\n    return a\n\n\nx = _f(1, [].pop() if [1].pop() > 2 else 0)\n"
    assert "[1].pop()" in unchecked(kept)


def test_the_whole_prelude_keeps_its_names_and_has_nothing_to_refuse_but_by_its_way() -> None:
    before, after = (ast.parse(text) for text in (prelude_text(), unchecked(prelude_text())))
    public = [
        {n.name for n in tree.body if isinstance(n, ast.FunctionDef) and n.name[0] != "_"} for tree in (before, after)
    ]
    assert public[0] == public[1]
    arguments = [
        {n.name: ast.unparse(n.args) for n in tree.body if isinstance(n, ast.FunctionDef) and n.name[0] != "_"}
        for tree in (before, after)
    ]
    assert arguments[0] == arguments[1]
    raises = [sum(isinstance(n, ast.Raise) for n in ast.walk(tree)) for tree in (before, after)]
    assert raises[1] < 0.2 * raises[0]


def test_branches_for_values_that_no_call_gives_go(tmp_path: Path) -> None:
    tree = ast.parse(
        "def leg(kind, h, bare=False):\n"
        '    if kind == "round":\n        return h\n'
        '    if kind in ("metal", "cast"):\n        return h * 2\n'
        "    if not bare and kind:\n        h = h + 1\n"
        '    return {"square": 4, "cast": 5, "oval": 6}[kind] + h\n\n'
        "def chair(kind, h):\n    return leg(kind, h)\n\n"
        'x = [chair("square", 1), chair("oval", 2)]\n'
    )
    narrowed(tree)
    text = ast.unparse(tree)
    assert "round" not in text and "cast" not in text and "bare" not in text
    assert ran(text, tmp_path)["x"] == [6, 9]


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ("    a, b = (1, f(2))", "    a, b = 1, f(2)"),
        ("    return (a, (b, c))", "    return a, (b, c)"),
        ("    return (a, b) + (c, d)", "    return (a, b) + (c, d)"),
        ("    a = (1,)", "    a = (1,)"),
        ("    return (a if b else c, d)", "    return a if b else c, d"),
        ("    a = (x for x in (1, 2))", "    a = (x for x in (1, 2))"),
    ],
)
def test_brackets_that_a_person_leaves_out(line: str, wanted: str) -> None:
    assert bare_tuples(line) == wanted
