# SPDX-License-Identifier: GPL-3.0-or-later
"""The interpreter gives what plain Python gives for the same text, or refuses it."""

from __future__ import annotations

import importlib.util
import math
import random
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.program.evaluate import Evaluation
from code_as_room.pipeline.program.prelude import registry
from code_as_room.pipeline.program.vocabulary import room_vocabulary
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

SPEC = importlib.util.spec_from_file_location(
    "programs_like_python", Path(__file__).with_name("programs_like_python.py")
)
assert SPEC and SPEC.loader
programs = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(programs)

OUR_LIMITS = (
    "2**63",
    "not a finite number",
    "not a real number",
    "a key of a dict must be",
    "only numbers, texts and lists",
    "only numbers can have the format",
    "% does not format text",
    "contains itself",
    "a text is longer than",
    "too many items",
    "more than 100,000 items",
    "steps",
)
"""Parts of the sentences with which the language refuses what Python allows."""


def python_names() -> dict[str, Any]:
    """What plain Python knows when it runs a room, without the lines."""
    return {
        **{name: getattr(math, name) for name in registry.MATH},
        **registry.CONSTRUCTORS,
        **registry.CONSTANTS,
    }


def by_python(text: str) -> tuple[Any, str]:
    """The result of plain Python, or the error's name."""
    names = python_names()
    try:
        exec(compile(text, "room", "exec"), names)  # noqa: S102  (a text of our own making, in a test)
        return names["result"](), ""
    except Exception as error:
        return None, f"{type(error).__name__}: {error}"


def by_us(text: str) -> tuple[Any, str]:
    """The result of the interpreter, or the refusal."""
    evaluation = Evaluation(room_vocabulary(), None)
    try:
        evaluation.feed(text)
        return evaluation.call("result"), ""
    except ProgramError as error:
        return None, str(error)


def compare(pieces: list[str]) -> int:
    """Run the pieces one after the other by both; assert equal results. Returns how many pieces ran without error.

    A piece that fails in Python must fail here; what it did before it failed is compared too.
    """
    names = python_names()
    evaluation = Evaluation(room_vocabulary(), None)
    ran = 0
    for piece in pieces:
        failed = refused = ""
        try:
            exec(compile(piece, "room", "exec"), names)  # noqa: S102  (a text of our own making, in a test)
        except Exception as error:
            failed = f"{type(error).__name__}: {error}"
        try:
            evaluation.feed(piece, complete=False)
        except ProgramError as error:
            refused = str(error)
        text = "\n".join(pieces)
        if any(part in refused for part in OUR_LIMITS):
            return ran
        assert not refused or failed, f"only we refuse: {refused}\n{piece}\n---\n{text}"
        assert not failed or refused, f"only Python refuses: {failed}\n{piece}\n---\n{text}"
        ran += not failed
    try:
        expected = repr(names["result"]())
    except RecursionError:
        return ran
    if " at 0x" not in expected:
        assert repr(evaluation.call("result")) == expected, text
    return ran


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.randoms(use_true_random=False))
def test_random_programs_mean_the_same(source: random.Random) -> None:
    compare(programs.Writer(source).pieces())


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
def test_random_programs_often_run() -> None:
    """The comparison above is worth something only if many of the pieces give results."""
    ran = [compare(programs.Writer(random.Random(seed)).pieces()) for seed in range(300)]
    assert sum(ran) > 5 * len(ran)


SAME = {
    "late_binding": "fs = [lambda: i for i in range(3)]\na = [f() for f in fs]",
    "late_binding_twice": "fs = []\nfor n in range(2):\n    fs += [lambda: (i, n) for i in range(2)]\na = [f() for f in fs]",
    "late_binding_def": "def outer():\n    x = 1\n    def inner():\n        return x\n    x = 2\n    return inner()\na = outer()",
    "closure_counts": "def make():\n    box_ = [0]\n    def step():\n        box_[0] += 1\n        return box_[0]\n    return step\n"
    "s = make()\nt = make()\na = [s(), s(), t()]",
    "mutable_default": "def f(x, seen=[]):\n    append(seen, x)\n    return seen\nf(1)\na = f(2)",
    "default_at_definition": "n = 1\ndef f(x=n):\n    return x\nn = 2\na = f()",
    "for_else": "a = []\nfor i in range(3):\n    if i == 5:\n        break\nelse:\n    a = 'none'",
    "for_break_else": "a = []\nfor i in range(3):\n    if i == 1:\n        break\nelse:\n    a = 'none'",
    "loop_variable_stays": "for i in range(3):\n    pass\na = i",
    "comprehension_variable_does_not": "i = 7\nb = [i for i in range(3)]\na = (i, b)",
    "return_from_loops": "def f():\n    for i in range(3):\n        for j in range(3):\n            if i * j == 2:\n"
    "                return (i, j)\na = f()",
    "return_nothing": "def f(x):\n    if x:\n        return\n    return 1\na = [f(0), f(1)]",
    "one_shot_zip": "z = zip([1, 2], [3, 4])\na = [list(z), list(z)]",
    "one_shot_enumerate": "z = enumerate('ab')\na = [list(z), list(z)]",
    "list_alias": "b = [1]\nc = b\nc += [2]\na = (b, c)",
    "list_not_alias": "b = [1]\nc = b\nc = c + [2]\na = (b, c)",
    "tuple_augmented": "b = (1,)\nc = b\nc += (2,)\na = (b, c)",
    "augmented_item_order": "log_ = []\ndef t(x):\n    append(log_, x)\n    return x\nc = [0, 0]\nc[t(1)] += t(5)\na = (c, log_)",
    "chain_evaluates_once": "log_ = []\ndef t(x):\n    append(log_, x)\n    return x\nb = t(1) < t(0) < t(5)\na = (b, log_)",
    "short_circuit": "a = [0 or 'x', 1 and 'y', 0 and 1 / 0, [] or (), not []]",
    "any_stops": "log_ = []\ndef t(x):\n    append(log_, x)\n    return x\na = [any(t(x) for x in [0, 1, 2]), log_]",
    "assignment_order": "c = [0, 1, 2]\ni = 0\ni, c[i] = 2, 9\na = (i, c)",
    "chained_targets": "b = c = [1]\nappend(b, 2)\na = (b, c)",
    "swap": "b, c = 1, 2\nb, c = c, b\na = (b, c)",
    "floor_signs": "a = [-7 // 2, -7 % 3, 7 % -3, -7.5 // 2, -7.5 % 2, 2 ** -1, -2 ** 2, 0.1 + 0.2]",
    "booleans_are_numbers": "a = [True + True, True * 2.5, sum([True, False, True]), True == 1, {1: 'x'}[True]]",
    "division": "a = [7 / 2, 6 / 3, 2 ** 62 / 3, 1 // 0.3]",
    "round_half_even": "a = [round(0.5), round(1.5), round(2.675, 2), round(1234, -2), round(-0.4)]",
    "sort_is_stable": "b = [(2, 'b'), (1, 'z'), (2, 'a')]\na = [sorted(b, key=lambda p: p[0]), "
    "sorted(b, key=lambda p: p[0], reverse=True), sorted(b)]",
    "min_first": "a = [min([(1, 'x'), (1, 'a')], key=lambda p: p[0]), max(3, 1, 2), max([], default=4)]",
    "slices": "b = [0, 1, 2, 3, 4]\na = [b[1:3], b[::-1], b[-2:], b[:10], 'hello'[1:4], (1, 2, 3)[::2], range(10)[2:4]]",
    "dict_order": "b = {'z': 1, 'a': 2}\nb['m'] = 3\nb['z'] = 9\na = [keys(b), values(b), items(b), 'a' in b, [k for k in b]]",
    "dict_keys_equal": "b = {1: 'int', 1.0: 'float', True: 'bool'}\na = b",
    "tuple_keys": "b = {(i, j): i * j for i in range(3) for j in range(2)}\na = [b[(2, 1)], (5, 5) in b, b]",
    "fstrings": "i = 3\nx = 2.5\na = [f'leg_{i}', f'{x:.2f}', f'{i:03d}', f'{x:g}', f'{i:5}', f'{{}}', f'{[1, x]}', f'{-x:08.3f}']",
    "text_of_floats": "a = [str(0.1), str(1e22), str(1e16), str(-0.0), str((1, [2.0, 'x'], {'k': None})), str(True)]",
    "texts": "a = ['ab' + 'cd', 'ab' * 3, 'b' in 'abc', 'abc'[1], len('é'), [c for c in 'xyz'], 'a' < 'b', min('hello')]",
    "keywords": "def f(x, y=2, z=3):\n    return (x, y, z)\na = [f(1), f(1, z=9), f(z=1, x=2), f(*[1, 2], z=4), f(*(1, 2, 3))]",
    "functions_as_values": "def twice(f, x):\n    return f(f(x))\n"
    "a = [twice(abs, -3), twice(lambda v: v * 2, 5), [g(4) for g in [sqrt, float]]]",
    "nested_unpacking": "a = [x + y * z for x, (y, z) in [(1, (2, 3)), (4, (5, 6))]]",
    "conditional_chain": "a = ['low' if x < 1 else 'mid' if x < 3 else 'high' for x in range(5)]",
    "elifs": "a = []\nfor i in range(5):\n    if i == 0:\n        append(a, 'zero')\n    elif i == 1:\n        append(a, 'one')\n"
    "    elif i % 2:\n        continue\n    else:\n        append(a, i)",
    "global_read_late": "def f():\n    return n * 2\nn = 4\na = f()",
    "inner_iterable_uses_outer": "a = [(i, j) for i in range(3) for j in range(i)]",
    "nested_comprehension": "a = [[i * j for j in range(3)] for i in range(2)]",
    "docstring": "def f():\n    '''Says nothing.'''\n    return 1\na = f()",
    "math": "a = [sin(1), cos(2), atan2(1, -1), hypot(3, 4), degrees(pi), radians(180), floor(-1.5), ceil(1.2), log(8, 2), tau]",
    "reversed_and_zip": "a = [list(reversed([1, 2])), list(zip('ab', range(5))), tuple(enumerate('ab', 5)), list(reversed(range(3)))]",
    "sum_start": "a = [sum([1, 2], 3), sum([[1], [2]], []), sum([0.1] * 10), sum(())]",
    "int_float": "a = [int('12'), int(-2.7), float('1.5'), float(3), int(True), bool([]), bool('x'), int(), str()]",
    "is_none": "b = None\na = [b is None, b is not None, [] is None]",
    "membership": "a = [1.0 in [1], 'x' in ('y',), 3 in range(5), 2.5 in range(5), None in [None], (1, 2) in [(1, 2)], [1] not in [[1]]]",
    "comparisons_of_lists": "a = [[1, 2] < [1, 3], (1,) == (1.0,), [] == (), {'x': [1]} == {'x': [1]}, 'a' == 1, 1 != 1.0]",
    "unary": "a = [-True, +3.5, not 0, - -2, -(2 ** 2), not not 'x']",
    "list_grows_while_read": "b = [1]\nfor x in b:\n    if len(b) < 5:\n        append(b, x + 1)\na = b",
    "line_joining": "a = [1,\n     2,  # two\n     3]\nb = 1 + \\\n    2\nc = 1; d = 2",
    "starred": "b = [1, 2]\na = [[*b, 3, *'xy'], (*b,), max(*b)]",
    "own_names_in_defs": "def f(wall, top=2):\n    camera = wall + top\n    def box(x):\n        return x * camera\n"
    "    return [box(room) for room in (1, 2)]\na = [f(1), f(1, top=5), abs(-1)]",
    "own_names_seen_from_inside": "def f():\n    max = 3\n    def g():\n        return max\n"
    "    h = lambda min: min + max\n    return [g(), h(4)]\na = [f(), max(1, 2)]",
    "own_names_in_comprehensions": "a = [[min for min in (3, 1)], {len: 1 for len in 'ab'}, min(3, 1), len('ab')]",
    "lambda_defaults": "n = 1\nfs = [lambda x, k=k, m=n: (x, k, m) for k in range(2)]\nn = 9\n"
    "a = [[f(0) for f in fs], [f(5, m=7) for f in fs]]",
    "pass_and_blank": "def f():\n    pass\nif True:\n    pass\na = f()",
}


@pytest.mark.parametrize("name", SAME)
def test_same_as_python(name: str) -> None:
    text = SAME[name] + "\ndef result():\n    return a\n"
    expected, error = by_python(text)
    assert not error
    found, refusal = by_us(text)
    assert not refusal
    assert repr(found) == repr(expected)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\r"),
        lambda text: "\ufeff" + text,
        lambda text: text.replace("    ", "\t"),
        lambda text: text.replace("\n", "\n\f", 1),
        lambda text: text.rstrip("\n"),
        lambda text: "# é 床\n" + text,
    ],
    ids=["crlf", "cr", "bom", "tabs", "form_feed", "no_last_newline", "comment"],
)
def test_ways_to_write_lines(change: Any) -> None:
    text = "a = 1\ndef result():\n    b = [a,\n        'x']\n    return b\n"
    assert by_us(change(text)) == ([1, "x"], "")
