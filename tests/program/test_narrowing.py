# SPDX-License-Identifier: GPL-3.0-or-later
"""A room text in fewer words makes the same shapes, and lines are broken where a person would."""

from __future__ import annotations

import ast

import numpy as np
import pytest
from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.finished import finished
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.program.narrowing import narrowed
from code_as_room.pipeline.program.wrapping import wrapped, written

HEAD = "room(size=(4, 3, 2.6), floor=[(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)])\n"
GROUPS = sorted({piece.group for piece in catalogue.pieces().values()})


def narrow(text: str) -> str:
    tree = ast.parse(text)
    narrowed(tree)
    return ast.unparse(tree)


@pytest.mark.parametrize("group", GROUPS)
def test_every_piece_of_the_library_makes_the_same_shapes(group: str) -> None:
    pieces = [piece for piece in catalogue.pieces().values() if piece.group == group]
    lines, furnish, defs = [HEAD], [], []
    for piece in pieces:
        size = ", ".join(map(str, piece.typical))
        lines.append(f'proxy("{piece.name}", "thing", centre=(0, 0, 1), size=({size}))\n')
        furnish.append(f'furnish("{piece.name}", {piece.name})\n')
        if len(piece.parameters) and len(piece.name) % 2:  # some in two ways
            lines.append(f'proxy("{piece.name}_2", "thing", centre=(0, 0, 1), size=({size}))\n')
            defs.append(f"def {piece.name}_2(size):\n    return {piece.name}(size)\n")
            furnish.append(f'furnish("{piece.name}_2", {piece.name}_2)\n')
    source = catalogue.source(sorted(piece.name for piece in pieces))
    text = "\n\n".join(["".join(lines), source, *defs, "".join(furnish), "build()\n"])
    short = finished(text)
    assert len(short) < len(text)
    before, after = (evaluate(t, FINISHED_ROOM_LIMITS).furnished for t in (text, short))
    assert before.keys() == after.keys()
    for name, shapes in before.items():
        for one, other in zip(shapes, after[name], strict=True):
            assert np.array_equal(one.vertices, other.vertices) and one.faces == other.faces
            assert (one.part, one.material, one.smooth) == (other.part, other.material, other.smooth)
    assert finished(short) == short


def test_what_is_always_the_same_is_worked_out() -> None:
    text = narrow(
        'def lamp(size, style="round", count=1):\n'
        '    """A lamp."""\n'
        '    side, spare = size[0], size[1]\n'
        '    if style == "round" and count < 3:\n'
        "        return ball(side)\n"
        '    elif style in ("a", "b"):\n'
        "        return cube(side)\n"
        "    return [ball(side) for i in range(count)]\n\n"
        "def ball(r):\n    return sphere(r)\n\n"
        "def cube(r):\n    return box((r, r, r))\n\n"
        'furnish("x", lamp)\nfurnish("y", lamp)\n'
    )  # fmt: skip
    assert "def cube" not in text and "style" not in text and "if " not in text and "range" not in text
    assert "def lamp(size):" in text and "    side = size[0]\n    return ball(side)" in text and "spare" not in text


@pytest.mark.parametrize(
    "body",
    [
        'def f(a, b=1):\n    return g(b)\n\n\ndef g(b):\n    return b\n\n\nh = f\nx = [f(1), h(1, 2)]\n',
        "def f(a=1):\n    a = a + 1\n    return a\n\n\nx = f(1)\n",
        "def f(a):\n    return lambda a: a\n\n\nx = f(1)(2)\n",
        "def f(a, b):\n    return a + b\n\n\nx = f(*[1, 2])\n",
        "def f(made, n=2):\n    k = append(made, n)\n    return made\n\n\nx = f([1])\n",
        "def f(n=2):\n    return f(n - 1) if n > 0 else 7\n\n\nx = f(2)\n",
        "def f(a, b=0):\n    return a and b\n\n\nx = [f(0), f(3)]\n",
        "def f(n=0):\n    total = 0\n    for i in range(3):\n        if n:\n            total = total + i\n    return total\n\n\nx = f()\n",
        'def f(kind="a"):\n    return {"a": 1, "b": 2}[kind] + {"a": 3}["a"]\n\n\nx = f("b")\n',
        'def f(x, y=None):\n    while y is not None:\n        return 1\n    return 2 if not y else 3\n\n\nx = f(1)\n',
    ],
)  # fmt: skip
def test_programs_give_what_they_gave(body: str) -> None:
    def result(text: str) -> object:
        names: dict[str, object] = {"append": lambda made, value: made.append(value)}
        exec(compile(text, "room", "exec"), names)  # noqa: S102
        return names["x"]

    assert result(narrow(body)) == result(body)


def test_long_lines_are_broken_and_mean_the_same() -> None:
    items = ", ".join(
        f'part("piece {n}", move(box((0.1, 0.2, {n})), (0, 0, {n})), material="wood #8A5F3C")' for n in range(6)
    )
    lines = [
        f"    made = [{items}]",
        f"    return [{items[:240]}) for i in range(3) for j in range(4) if i]".replace("), part", ") + part"),
    ]
    text = (
        "def f(size, b, c):\n"
        + "\n".join(lines[:1])
        + "\n"
        + "    return f("
        + " + ".join(["size"] * 40)
        + ", lambda a, b: a, c=[])\n"
    )
    text += "\n\ndef g():\n    total = " + " + ".join(f"value({n})" for n in range(30)) + "\n    return total\n"
    short = wrapped(text)
    assert max(map(len, short.split("\n"))) <= 120
    assert ast.dump(ast.parse(short)) == ast.dump(ast.parse(text))


def test_statements_are_written_as_a_person_would() -> None:
    code = "x = sum((f(a) for a in b)) + tuple(((1, 2), 3))[0] + len('a\"b') + len('c')"
    assert written(ast.parse(code)) == 'x = sum(f(a) for a in b) + tuple(((1, 2), 3))[0] + len("a\\"b") + len("c")'


def test_texts_with_values_in_them_can_be_read_by_every_python() -> None:
    code = 'x = f\'{a["b"]:.2f} {{c}} "d" {e!r:>{w}} { {1: 2}[f] }\''
    short = written(ast.parse(code))
    assert short == 'x = f"{a[\'b\']:.2f} {{c}} \\"d\\" {e!r:>{w}} { {1: 2}[f]}"'
    assert ast.dump(ast.parse(short)) == ast.dump(ast.parse(code))
    text = narrow('def f(size, kind="round", n=3):\n    return part(f"{kind} leg {n}", box(1))\n\n\nfurnish("a", f)\n')
    assert "part('round leg 3', box(1))" in text


def test_layout_lines_say_no_defaults() -> None:
    text = (
        HEAD
        + 'proxy("a", "b", centre=(0, 0, 1), size=(1, 1, 2), yaw=0, placement="floor", salience="minor", label="")\nbuild()\n'
    )
    assert 'proxy("a", "b", centre=(0, 0, 1), size=(1, 1, 2), salience="minor")\n' in finished(text)


def test_a_text_that_is_not_python_stays() -> None:
    assert finished("room(\n") == "room(\n"


def test_what_somebody_says_in_comments_stays() -> None:
    text = HEAD + 'proxy("a", "b", centre=(0, 0, 1), size=(1, 1, 2), yaw=0)  # by the window\n\n\n'
    text += "def legs(size, count=4):\n    return [box(size)] * count\n\n\n"
    text += "def table(size):\n    # three, since the fourth is broken\n    return legs(size, count=3)\n\n\n"
    text += 'furnish("a", table)\nbuild()\n'
    assert finished(text) == text


def test_statements_that_share_a_line_stay() -> None:
    text = HEAD + 'proxy("a", "b", centre=(0, 0, 1), size=(1, 1, 2), yaw=0); build()\n'
    assert finished(text) == text


def test_long_statements_of_the_room_are_broken_too() -> None:
    look = 'look = principled(base=ramp(noise_map(0.1), [(0, "#101010"), (0.5, "#808080"), (1, "#F0F0F0")]), '
    look += "roughness=0.5, coat=0.2, sheen=0.1, specular=0.4)"
    text = HEAD + look + '\nfinish("floor", look)\n'
    text += f'finish("walls", {{\n    "": {look[7:]},\n    "wood": look,\n}})\nbuild()\n'
    short = finished(text)
    assert max(map(len, short.split("\n"))) <= 120 < len(look)
    one, other = (evaluate(t, FINISHED_ROOM_LIMITS).finishes["floor"][""] for t in (text, short))
    assert one.key == other.key
