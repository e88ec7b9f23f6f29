# SPDX-License-Identifier: GPL-3.0-or-later
"""Good Python that is not the room language is rewritten where it has one meaning, and only there."""

from __future__ import annotations

import numpy as np
import pytest
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.objects.mending import mended
from code_as_room.pipeline.program.evaluate import evaluate_object

WRITTEN = {
    "import math\nx = box((math.pi, math.sin(1), math.hypot(3, 4)))": "box((pi, sin(1), 5))",
    "x = cylinder(r=0.1, h=1, pos=(0, 0, 1))": "cylinder(0.1, 1, at=(0, 0, 1))",
    "x = box(1, 2, 3)": "box((1, 2, 3))",
    "x = rounded_box(width=1, depth=2, height=3, radius=0.1)": "rounded_box((1, 2, 3), 0.1)",
    "x = box((1, 1, 1), material='wood', name='leg')": "part('leg', box((1, 1, 1)), material='wood')",
    "x = part(box((1, 1, 1)), 'leg', material='wood', color='#AABBCC')": "part('leg', box((1, 1, 1)), material='wood #AABBCC')",
    "x = []\nx.append(box((1, 1, 1)))\nx.extend([box((1, 1, 2))])": "[box((1, 1, 1)), box((1, 1, 2))]",
    "x = [box((v, 1, 1)) for k, v in {'a': 1}.items()]": "box((1, 1, 1))",
    "w: float = 2\nx = box((w, 1, 1))": "box((2, 1, 1))",
    "cushion = cushion((1, 1, 0.2))\nx = [cushion, move(cushion, 0, 0, 1)]": "[cushion((1, 1, 0.2)), cushion((1, 1, 0.2), at=(0, 0, 1))]",
    "x = part('leg', (box((i, 1, 1)) for i in (1, 2)), material='wood')": "part('leg', [box((1, 1, 1)), box((2, 1, 1))], material='wood')",
    "x = translate(union(box((1, 1, 1)), box((2, 1, 1))), (0, 0, 1))": "[box((1, 1, 1), at=(0, 0, 1)), box((2, 1, 1), at=(0, 0, 1))]",
    "assert size\nprint(size)\nx = box((pow(2, 2), 1, 1))": "box((4, 1, 1))",
    "def leg(a: float, *, b: float = 2) -> list:\n    return box((a, b, 1))\nx = leg(1)": "box((1, 2, 1))",
    "x = [box((v, 1, 1)) for v in [1, 2] + reversed([3, 4]) + range(5, 6)]": "[box((v, 1, 1)) for v in (1, 2, 4, 3, 5)]",
}  # fmt: skip


def program(body: str) -> str:
    lines = "\n".join(f"    {line}" for line in body.split("\n"))
    return f"def thing(size):\n{lines}\n    return x\n"


@pytest.mark.parametrize("body", WRITTEN)
def test_it_makes_what_was_meant(body: str) -> None:
    text = mended(program(body))
    assert text is not None
    found = evaluate_object(text, "thing", args=[(1.0, 1.0, 1.0)])
    wanted = evaluate_object(f"def thing(size):\n    return {WRITTEN[body]}\n", "thing", args=[(1.0, 1.0, 1.0)])
    assert [(s.part, s.material) for s in found] == [(s.part, s.material) for s in wanted]
    for a, b in zip(found, wanted, strict=True):
        np.testing.assert_allclose(a.vertices, b.vertices, atol=1e-9)


@pytest.mark.parametrize(
    "body",
    ["x = [box((1, 1, 1), at=(0, 0, 1))]", "box_1 = 2\nx = box((box_1, 1, 1))", "x = max(i for i in (1, 2))"],
)
def test_the_room_language_is_left_alone(body: str) -> None:
    assert mended(program(body)) is None


@pytest.mark.parametrize(
    "body",
    [
        "x = ().__class__.__base__",
        "x = open('a')",
        "import os\nx = os.system('ls')",
        "while True:\n    x = 1",
        "x = eval('1')",
    ],
)
def test_nothing_else_gets_in_that_way(body: str) -> None:
    text = mended(program(body)) or program(body)
    with pytest.raises(ProgramError):
        evaluate_object(text, "thing", args=[(1.0, 1.0, 1.0)])


def test_what_is_not_python_is_refused_with_its_line() -> None:
    with pytest.raises(ProgramError) as caught:
        mended("def thing(size):\n    x = (1\n    return x\n")
    assert caught.value.line
