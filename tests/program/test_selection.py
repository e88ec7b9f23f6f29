# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a module some names need, and what of its text only its authors need."""

from __future__ import annotations

import ast

import pytest
from code_as_room.pipeline.program.assemble import assemble, is_assembled
from code_as_room.pipeline.program.prelude import registry
from code_as_room.pipeline.program.selection import Pieces, global_names
from code_as_room.pipeline.program.trimming import trimmed, with_short_docs

TEXT = '''import math as _math
import json as _json

# ---- first ----------------------------------------------------------------------
# What comes first.

_SIZES = [1]
_SIZES += [2]
_OTHER = 3


# Why there is one.
def one():
    """One."""
    return _Thing().half(_SIZES)


# ---- second ---------------------------------------------------------------------


class _Thing:
    """A thing."""

    count = 1

    def __init__(self):
        self.all = two

    # Why halves.
    def half(self, value):
        return [getattr(self, name) for name in ()] and value

    def never(self):
        return _json


def two():
    return _Open().run("a")


class _Open:
    def run(self, name):
        return getattr(self, f"_{name}")

    def _a(self):
        return _math


# ---- third ----


def three():
    return _OTHER
'''


def selected(*names: str) -> str:
    pieces = Pieces.of(TEXT)
    return pieces.text(pieces.needed(names))


def test_names_are_followed_to_all_that_they_need() -> None:
    text = selected("one")
    bound = {n.name for n in ast.parse(text).body if isinstance(n, (ast.FunctionDef, ast.ClassDef))}
    assert bound == {"one", "_Thing", "two", "_Open"}
    assert "_SIZES = [1]\n_SIZES += [2]" in text and "_OTHER" not in text
    assert "import math" in text, "a method that is called by a name worked out stays, with what it uses"
    assert "third" not in text and "# ---- first" in text and "# What comes first." in text


def test_methods_that_nothing_asks_for_go() -> None:
    text = selected("two")
    assert "def _a(" in text and "class _Thing" not in text and "first" not in text and "second" in text
    whole = selected("one")
    assert "def never" in whole, "its class looks attributes up by names worked out"
    plain = Pieces.of(TEXT.replace("getattr(self, name)", "name"))
    assert "never" not in plain.text(plain.needed(["one"])) and "_json" not in plain.text(plain.needed(["one"]))


def test_comments_and_blank_lines_stay_with_what_they_are_about() -> None:
    text = selected("one")
    assert "# Why there is one.\ndef one():" in text and "    # Why halves.\n    def half(" in text
    assert "\n\n\n\n" not in text and "_SIZES += [2]\n\n\n# Why" in text


def test_names_of_a_room_are_found_by_pythons_rules_of_scope() -> None:
    text = 'proxy("rug", "box")\n\ndef made(size, box=3):\n    wall = lambda u: wall + sphere(u)\n    return box, wall, pi\n'
    assert global_names(text) == {"proxy", "sphere", "pi"}


def test_words_in_texts_and_local_names_bring_nothing_along() -> None:
    room = "room(size=(4, 3, 2.6), floor=[(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)])\n"
    room += 'proxy("rug", "torus", (0, 0, 1), (1, 1, 2))\nbuild()\n'
    text = assemble(room)
    assert "def rug(" not in text and "def torus(" not in text and "def light(" not in text
    assert "def wall(" not in text and "def proxy(" in text
    assert "def torus(" in assemble(room.replace("build()", "def f():\n    return torus(1, 0.1)\n\n\nbuild()"))


def test_a_room_that_is_not_python_gets_the_whole_prelude() -> None:
    text = assemble("room(\n")
    assert all(f"def {name}(" in text for name in registry.CONSTRUCTORS)


@pytest.mark.parametrize("docs", [True, False])
def test_trimmed_text_means_the_same(docs: bool) -> None:
    text = '''_A: dict[str, int] = {
    'a': 1,
}


def one(
    a: int,
    *,
    b: str = "x, (y",
    **more: dict[str, int],
) -> dict[str, int]:
    """One.

    More."""
    c: int = 2
    return dict(
        a=a,
        b=b,
    )


def _two(x: int = 1) -> None:
    """Two.

    Args:
        x: it.
    """
    assert x


class _Three:
    """Three.

    Attributes:
        a: it.
    """

    a: int = 1

    def b(self: "_Three") -> int:
        """B.

        C."""
        return self.a
'''
    short = with_short_docs(trimmed(text), {"one"}, docs)
    assert 'def one(a, *, b="x, (y", **more):' in short and '_A = {"a": 1}' in short
    assert "    a: int = 1" in short, "a class's fields are read at run time"
    assert ("More." in short) == docs and ('"""Two."""' in short) == docs and "Args" not in short
    assert "c = 2" in short and "return dict(a=a, b=b)" in short and "def _two(x=1):" in short
    compile(short, "short", "exec")


def test_a_prelude_that_somebody_changed_is_seen() -> None:
    text = assemble("room(size=(4, 3, 2.6), floor=[])\nbox((1, 1, 1))\n")
    assert is_assembled(text) and is_assembled(text + "sphere(1)\n")
    assert not is_assembled(text.replace("def box(", "def box(a, ", 1)) and not is_assembled("\n" + text)


def test_names_are_found_where_a_text_goes_on_past_what_begins_like_a_function() -> None:
    text = 'said = """\ndef box(size):\n"""\n\n\ndef made(size):\n    return sphere(size)\n\n\nfurnish("a", made)\n'
    assert global_names(text) == {"sphere", "furnish", "made"}
    with pytest.raises(SyntaxError):
        global_names("def made(size):\n    return box(size\n")
