# SPDX-License-Identifier: GPL-3.0-or-later
"""The prelude as text: complete, closed to the room, and split off again exactly."""

from __future__ import annotations

import ast
import builtins
import symtable

import pytest
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.program.assemble import MARKER, assemble, prelude_text, room_part, split_room
from code_as_room.pipeline.program.joiner import JoinError, join_modules
from code_as_room.pipeline.program.prelude import registry
from hypothesis import given
from hypothesis import strategies as st


def public_names() -> set[str]:
    """What a room may use of the prelude."""
    return {*registry.CONSTANTS, *registry.MATH, *registry.CONSTRUCTORS, *registry.LOOKS, *registry.LINE_NAMES}


def module_names(text: str) -> tuple[set[str], set[str]]:
    """Names that a module binds at its top level, and names that it looks up there from anywhere."""
    bound: set[str] = set()
    used: set[str] = set()

    def walk(table: symtable.SymbolTable) -> None:
        for symbol in table.get_symbols():
            if table.get_type() == "module":
                (bound if symbol.is_assigned() or symbol.is_imported() or symbol.is_namespace() else used).add(
                    symbol.get_name()
                )
            elif symbol.is_global():
                used.add(symbol.get_name())
        for child in table.get_children():
            walk(child)

    walk(symtable.symtable(text, "prelude", "exec"))
    return bound, used


def test_every_name_of_the_prelude_is_defined_once_and_private_or_public() -> None:
    bound, used = module_names(prelude_text())
    assert used - bound - set(dir(builtins)) == set()
    assert {name for name in bound if not name.startswith("_")} == public_names() | {"annotations"}
    tree = ast.parse(prelude_text())
    defined = [node.name for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))]
    assert len(defined) == len(set(defined))


def test_the_prelude_needs_nothing_of_the_package() -> None:
    tree = ast.parse(prelude_text())
    imports = [node for node in ast.walk(tree) if isinstance(node, (ast.Import, ast.ImportFrom))]
    assert not any(isinstance(node, ast.ImportFrom) and node.level for node in imports)
    assert "code_as_room." not in prelude_text()
    first = next(node for node in tree.body if not isinstance(node, ast.Expr))
    assert isinstance(first, ast.ImportFrom) and first.module == "__future__"


def test_the_prelude_stays_readable() -> None:
    text = prelude_text()
    assert max(map(len, text.splitlines())) <= 140
    assert "\n\n\n\n" not in text and MARKER not in text.splitlines()
    assert "GPL-3.0-or-later" in text and "blender --background --python room.py" in text


@given(st.text())
def test_the_room_comes_back_exactly(room: str) -> None:
    assert room_part(assemble(room)) == room


def test_line_numbers_can_be_carried_over() -> None:
    full = assemble("room()\nbuild()\n")
    before, room = split_room(full)
    assert full.split("\n")[before] == "room()" and room == "room()\nbuild()\n"
    assert split_room(full.replace("\n", "\r\n"))[0] == before


def test_a_missing_marker_is_said() -> None:
    with pytest.raises(ProgramError, match="is missing"):
        room_part("build()\n")


def test_names_are_renamed_by_scope(tmp_path) -> None:
    (tmp_path / "one.py").write_text(
        "import math\nfrom dataclasses import dataclass\nSIZE = 3\n_hidden = [SIZE for i in range(SIZE)]\n\n"
        "@dataclass\nclass Thing:\n    size: int = SIZE\n\n    def half(self, math=math):\n        return SIZE + math.pi\n\n"
        "def shown(SIZE=SIZE, thing=None):\n    return f'{SIZE} {half()} {{SIZE}}', [half for half in (1,)], Thing.half\n\n"
        "def half():\n    return lambda SIZE: (SIZE, Thing(size=_hidden))\n"
    )
    (tmp_path / "two.py").write_text(
        "from .one import half as quarter, shown\nSIZE = 4\n\ndef use():\n    return quarter() + SIZE, shown()\n"
    )
    text, names = join_modules([tmp_path / "two.py"], {("one", "shown")})
    assert names["one", "SIZE"] == "_SIZE" and names["two", "SIZE"] == "_two_SIZE"
    assert "_hidden = [_SIZE for i in range(_SIZE)]" in text
    assert "    size: int = _SIZE\n\n    def half(self, math=_math):\n        return _SIZE + math.pi" in text
    assert (
        "def shown(SIZE=_SIZE, thing=None):\n    return f'{SIZE} {_half()} {{SIZE}}', [half for half in (1,)]" in text
    )
    assert "return lambda SIZE: (SIZE, _Thing(size=_hidden))" in text
    assert "return _half() + _two_SIZE, shown()" in text
    bound, used = module_names(text)
    assert used - bound <= set(dir(builtins))


def test_what_cannot_be_joined_is_said(tmp_path) -> None:
    (tmp_path / "loop.py").write_text("for i in range(3):\n    pass\n")
    (tmp_path / "one.py").write_text("from .two import a\nb = 1\n")
    (tmp_path / "two.py").write_text("from .one import b\na = 1\n")
    (tmp_path / "whole.py").write_text("from . import one\n")
    for name, words in (("loop", "only definitions"), ("one", "circle"), ("whole", "not whole modules")):
        with pytest.raises(JoinError, match=words):
            join_modules([tmp_path / f"{name}.py"], set())
