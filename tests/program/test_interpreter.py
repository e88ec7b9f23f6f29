# SPDX-License-Identifier: GPL-3.0-or-later
"""What the interpreter promises besides Python's results: sentences, limits, independence of other evaluations."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.program.evaluate import DEFAULT_LIMITS, Evaluation, call_function, evaluate, evaluate_object
from code_as_room.pipeline.program.refusals import ProgramProblems
from code_as_room.pipeline.program.vocabulary import Vocabulary, room_vocabulary

ROOM = """room(size=(4, 3, 2.6), floor=[(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)])
wall("wall_s", (-2, -1.5), (2, -1.5), height=2.6)
proxy("bed_1", "double bed", centre=(0, 0, 0.5), size=(1.7, 2.1, 1.0))
build()
"""


def refusal(text: str) -> ProgramError:
    """The error that a program ends with."""
    with pytest.raises(ProgramError) as caught:
        evaluate(text)
    return caught.value


def test_a_room_fills_the_record() -> None:
    record = evaluate(ROOM)
    assert record.built
    assert [line["id"] for line in record.walls + record.proxies] == ["wall_s", "bed_1"]
    assert record.proxies[0]["size"] == (1.7, 2.1, 1.0)


def test_all_problems_are_reported_in_the_order_of_lines() -> None:
    text = "import os\nx = 1\ny = x.real\ndef f(a: int):\n    while a:\n        pass\n"
    problems = refusal(text)
    assert isinstance(problems, ProgramProblems)
    assert [problem.line for problem in problems.problems] == [1, 3, 4, 5]
    assert problems.line == 1
    assert str(problems).count("line ") == 4


def test_at_most_ten_problems() -> None:
    problems = refusal("import os\n" * 50)
    assert isinstance(problems, ProgramProblems)
    assert [problem.line for problem in problems.problems] == list(range(1, 11))


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("points = []\npoints.append(1)", 2, "Use append(points, value) instead of points.append(value)."),
        ("d = {}\nfor k, v in d.items():\n    pass", 2, "Use items(d) instead of d.items()."),
        ("x = math.sin(1)", 1, "Write sin(...) without math"),
        ("def chair():\n    return 1\nx = chiar()", 3, "Did you mean chair?"),
        ("x = smothstep(0, 1, 2)", 1, "Did you mean smoothstep?"),
        ("x = 1\n\ny = 1 / (x - 1)", 3, "division by zero"),
        ("def f(width, depth):\n    return width\nx = f(1)", 3, "f() takes width, depth: depth is missing"),
        ("def f(width):\n    return width\nx = f(height=1)", 3, "height is not one of them"),
        ("def f():\n    y = x0\n    x0 = 1\n    return y\nz = f()", 2, "x0 is used before it is set"),
        ("x = [1, 2]\ny = x[2]", 2, "list index out of range"),
        ("x = {'a': 1}\ny = x['b']", 2, "the dict has no key 'b'"),
        ("x = [\n  1,\n  sqrt(-1),\n]", 3, "not defined for this number"),
        ("print('x')", 1, "Leave it out"),
        ("max = 1", 1, "max belongs to the room language"),
        (
            "def f():\n    box = box((1, 1, 1))\n    return box\nx = f()",
            2,
            "Call the variable something else, such as box_1.",
        ),
        ("x = '\u0430'\n\u0430 = 1", 2, "CYRILLIC SMALL LETTER A"),
        ("def f(n):\n    return f(n - 1)", 1, "f calls itself"),
        ("x = '%d' % 3", 1, "f-string"),
        ("proxy('a', 'bed', centre=(0, 0, 1 + 1), size=(1, 1, 1))", 1, "plain numbers"),
        ("proxy('a', 'bed', centre=(0, 0, 1), size=(1, 1, -1))", 1, "size must be three positive numbers"),
        ("x = (1\ny = 2", 1, "this is not Python"),
        ("x = 5\nx()", 2, "x is not a function"),
        ("a, b = (1, 2, 3)", 1, "too many values to unpack (expected 2)"),
        ("x = noise('a')", 1, "str"),
    ],
)
def test_sentences(text: str, line: int, words: str) -> None:
    error = refusal(text)
    assert error.line == line
    assert words in str(error)


def test_the_innermost_line_is_named() -> None:
    text = "def inner(x):\n    y = 1\n    return y / x\ndef outer():\n    return [\n        inner(0),\n    ]\na = outer()\n"
    assert refusal(text).line == 3


def test_errors_in_functions_that_constructors_call_have_their_line() -> None:
    vocabulary = Vocabulary({"grid": lambda height, n: [height(i, 0.5) for i in range(n)]})
    with pytest.raises(ProgramError) as caught:
        Evaluation(vocabulary, None).feed("def h(u, v):\n    w = u\n    return v / w\nx = grid(h, 3)\n")
    assert caught.value.line == 3


def test_functions_that_constructors_call_are_counted() -> None:
    vocabulary = Vocabulary({"grid": lambda height, n: [height(i, 0.5) for i in range(n)]})
    used = []
    for n in (10, 1010):
        evaluation = Evaluation(vocabulary, None)
        evaluation.feed(f"def h(u, v):\n    w = u * v\n    return w + 1\nx = grid(h, {n})\n")
        used.append(evaluation.meter.used)
    assert used[1] - used[0] >= 3 * 1000
    with pytest.raises(ProgramError, match="steps"):
        Evaluation(vocabulary, None).feed("def h(u, v):\n    return sum(range(1000))\nx = grid(h, 90000)\n")


def test_numbers_of_numpy_become_plain() -> None:
    import numpy as np

    vocabulary = Vocabulary({"grid": lambda height: height(np.float64(2.0)), "one": lambda: np.float64(1.5)})
    evaluation = Evaluation(vocabulary, None)
    evaluation.feed(
        "def h(u):\n    return f'{u}' + str(u / 4)\nx = grid(h)\ndef result():\n    return [x, str(one())]\n"
    )
    assert evaluation.call("result") == ["2.00.5", "1.5"]


def test_steps_do_not_depend_on_the_machine() -> None:
    text = "def f(x):\n    y = [i * x for i in range(50) if i % 2]\n    return sum(y)\na = [f(i) for i in range(20)]\n"
    used = set()
    for _ in range(3):
        evaluation = Evaluation(room_vocabulary(), None)
        evaluation.feed(text)
        used.add(evaluation.meter.used)
    assert len(used) == 1


@pytest.mark.parametrize(
    ("limit", "text", "words"),
    [
        ({"steps": 1000}, "for i in range(2000):\n    x = i", "steps"),
        ({"depth": 3}, "def f():\n    return 1\ndef g():\n    return f()\ndef h():\n    return g()\ndef k():\n    return h()\nk()",
         "calls inside each other"),
        ({"list_items": 10}, "x = [i for i in range(11)]", "items"),
        ({"range_items": 10}, "x = range(11)", "range"),
        ({"string_chars": 10}, "x = 'abc' * 4", "longer"),
        ({"text_bytes": 10}, "x = 1\ny = 2\n", "bytes"),
        ({"text_bytes": 10}, "x = 'éééé'", "bytes"),
        ({"nesting": 3}, "x = [[[[1]]]]", "brackets"),
        ({"operators": 3}, "x = 1 + 2 + 3 + 4", "too long"),
        ({"blocks": 1}, "for i in range(2):\n    for j in range(2):\n        pass", "blocks"),
        ({"tree_depth": 6}, "x = 1 + 2 + 3 + 4 + 5 + 6", "nested"),
        ({"seconds": -1.0}, "x = 1\n", "seconds"),
    ],
)  # fmt: skip
def test_limits(limit: dict[str, Any], text: str, words: str) -> None:
    with pytest.raises(ProgramError, match=words):
        evaluate(text, replace(DEFAULT_LIMITS, **limit))
    evaluate("x = 1")


def test_what_is_just_within_the_limits_runs() -> None:
    limits = replace(DEFAULT_LIMITS, list_items=10, range_items=10, string_chars=10, nesting=3, operators=4)
    evaluate("x = [i for i in range(10)]\ny = 'ab' * 5\nz = [[[1]]]\nw = 1 + 2 + 3 + 4\n", limits)


def test_long_programs_of_simple_lines_are_fine() -> None:
    lines = [f"p{i} = ({i}, {i * 0.5}, -{i})" for i in range(2000)]
    table = "points = [\n" + ",\n".join(f"  (-{i}.5, {i} + 1, -2)" for i in range(2000)) + "]\n"
    elifs = "if p1 == 0:\n    q = 0\n" + "".join(f"elif p1 == {i}:\n    q = {i}\n" for i in range(300))
    evaluate("\n".join(lines) + "\n" + table + elifs)


def test_evaluations_do_not_see_each_other() -> None:
    evaluate("x = 1\nshared = [1]\n")
    assert "shared is not known" in str(refusal("y = shared"))


def test_evaluations_inside_each_other() -> None:
    """A constructor may evaluate another program."""
    inner = "def f(x):\n    return x * 2\n"
    vocabulary = Vocabulary({"library": lambda n: call_function(inner, "f", [n])})
    evaluation = Evaluation(vocabulary, None)
    evaluation.feed("def f(x):\n    return library(x) + 1\na = [f(i) for i in range(3)]\ndef result():\n    return a\n")
    assert evaluation.call("result") == [1, 3, 5]


def test_threads() -> None:
    text = "def run(n):\n    total = 0\n    for i in range(2000):\n        total += i * n\n    return total\n"
    found: dict[int, Any] = {}
    work = [threading.Thread(target=lambda n=n: found.update({n: call_function(text, "run", [n])})) for n in range(8)]
    for thread in work:
        thread.start()
    for thread in work:
        thread.join()
    assert found == {n: n * 1999 * 1000 for n in range(8)}


def test_no_global_state_changes() -> None:
    before = (sys.getrecursionlimit(), sys.getswitchinterval(), threading.active_count(), sys.gettrace())
    evaluate(ROOM)
    refusal("x = " + "(" * 500)
    assert before == (sys.getrecursionlimit(), sys.getswitchinterval(), threading.active_count(), sys.gettrace())


@pytest.mark.parametrize("text", [ROOM, "x = 1 / 0", "x = " + "-" * 90 + "1"])
def test_a_caller_with_little_stack_left_gets_no_recursion_error(text: str) -> None:
    def deep(frames: int) -> str:
        if frames:
            return deep(frames - 1)
        try:
            evaluate(text)
        except ProgramError:
            return "refused"
        return "done"

    room_left = sys.getrecursionlimit()
    outcomes = set()
    for frames in range(room_left - 320, room_left - 120, 7):
        try:
            outcomes.add(deep(frames))
        except RecursionError:
            # The frames of this test alone were too many.
            break
    assert outcomes <= {"done", "refused"} and outcomes


def test_object_programs() -> None:
    vertices = "[(0, 0, 0), (1, 0, 0), (0, 1, 0)]"
    text = (
        f"def table_1():\n    top = mesh({vertices}, [(0, 1, 2)])\n    return [part('top', top), [part('leg', top)]]\n"
    )
    shapes = evaluate_object(text, "table_1")
    assert [shape.part for shape in shapes] == ["top", "leg"]
    assert shapes[0].vertex_count == 3


@pytest.mark.parametrize(
    ("text", "name", "words"),
    [
        ("def a():\n    return 1\n", "a", "expected a shape"),
        ("def a():\n    x = []\n    append(x, x)\n    return x\n", "a", "contains itself"),
        ("def a():\n    return []\n", "b", "not known"),
        ("a = 1\n", "a", "not a def"),
        (ROOM, "a", "is a line of the room"),
        ("def a(x):\n    return x\n", "a", "x is missing"),
    ],
)
def test_object_programs_that_are_none(text: str, name: str, words: str) -> None:
    with pytest.raises(ProgramError) as caught:
        evaluate_object(text, name)
    assert words in str(caught.value)


def test_vertices_are_counted_over_the_whole_evaluation() -> None:
    text = "def a():\n    return [mesh([(0, 0, i), (1, 0, i), (0, 1, i)], [(0, 1, 2)]) for i in range(50)]\n"
    assert len(evaluate_object(text, "a")) == 50
    with pytest.raises(ProgramError, match="vertices"):
        evaluate_object(text, "a", replace(DEFAULT_LIMITS, vertices=100))


def test_feeding_pieces() -> None:
    evaluation = Evaluation(room_vocabulary(), None)
    evaluation.feed("def f(x):\n    return g(x) + n\n", complete=False)
    evaluation.feed("n = 10\n", complete=False)
    with pytest.raises(ProgramError, match="g is used before it is set"):
        evaluation.feed("a = f(1)\n", complete=False)
    evaluation.feed("def g(x):\n    return x * 2\n", complete=False)
    evaluation.feed("a = f(1)\n", complete=False)
    evaluation.feed("def result():\n    return a\n")
    assert evaluation.call("result") == 12


def test_steps_of_all_pieces_count_together() -> None:
    evaluation = Evaluation(room_vocabulary(), None, replace(DEFAULT_LIMITS, steps=3000))
    with pytest.raises(ProgramError, match="steps"):
        for _ in range(100):
            evaluation.feed("for i in range(100):\n    x = i\n", complete=False)


@pytest.mark.parametrize(
    "make",
    [lambda: None, lambda: 3, lambda: b"x = 1"],
)
def test_what_is_no_text(make: Callable[[], Any]) -> None:
    with pytest.raises(ProgramError):
        evaluate(make())
