# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever a model writes, a draft is read without an exception, and what comes of it can be built."""

from __future__ import annotations

import random

import pytest
from code_as_room.pipeline.draft.growing import DraftGrowth
from code_as_room.pipeline.draft.prompt import EXAMPLE
from code_as_room.pipeline.draft.reading import Draft
from code_as_room.pipeline.draft.statements import split
from code_as_room.pipeline.draft.text import room_text
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS

from .drafts import ROOM, TABLE, read_text

PIECES = (
    "(", ")", "[", "]", ",", "=", "\n", "\n\n", "    ", '"', "'", '"""', "#", "```", "```python\n", "0", "-1", "1e308", "1e999",
    "nan", "None", "True", "{}", "lambda x: x", "x.y", "proxy(", "def f(size):\n", "room(size=(1, 1, 1), floor=[])\n", "\\",
    "\x00", "\u2028", "é", "like='pouf_1'", "parent='mug_1'", "seen=(0, 0, 0, 0)", "size=(1, 1)", "build()\n", "for i in range(9**9): ",
    "finish('floor', {})\n", "lighting()\n", "oak", "size", "a = a\n", "import os\n", "*", "**", "colors=5", "placement='x'",
)  # fmt: skip


def mutated(text: str, chances: random.Random) -> str:
    for _ in range(chances.choice((1, 2, 3, 8, 30))):
        a, b = sorted(chances.randrange(len(text) + 1) for _ in range(2))
        b = min(b, a + chances.choice((1, 3, 20, 300)))
        way = chances.randrange(5)
        if way == 0:
            text = text[:a] + text[b:]
        elif way == 1:
            text = text[:a] + chances.choice(PIECES) + text[a:]
        elif way == 2:
            text = text[:a] + chances.choice(PIECES) + text[b:]
        elif way == 3:
            at = chances.randrange(len(text) + 1)
            text = text[:at] + text[a:b] + text[at:]
        else:
            text = text[: max(a, 40)]
    return text


def sound(draft: Draft) -> None:
    text = room_text(draft)
    if text:
        record = evaluate(text, FINISHED_ROOM_LIMITS)
        assert record.built and len(record.proxies) <= len(draft.things)
    assert all(s.sentence for s in draft.statements if s.verdict != "ok")


@pytest.mark.parametrize("seed", range(40))
def test_damaged_drafts_are_read(seed: int) -> None:
    chances = random.Random(seed)
    text = mutated(ROOM + TABLE + "build()\n" if seed % 2 else EXAMPLE, chances)
    sound(read_text(text))
    growth = DraftGrowth()
    for end in sorted(chances.randrange(len(text) + 1) for _ in range(3)):
        room = growth.hear(text[:end])
        assert room is None or evaluate(room, FINISHED_ROOM_LIMITS).built


@pytest.mark.parametrize(
    "text",
    [
        "x = 1\n" * 3000,
        "proxy('a', 'b', at=(0,0,0), size=(1,1,1))\n" * 2500,
        "(" * 5000,
        "def f(size):\n    return f(size)\nproxy('f', 'chair', at=(0, 0, 0), size=(1, 1, 1))\n",
        "a = [0] * 10**9\n",
        "for i in range(10**9):\n    proxy(str(i), 'b', at=(i, 0, 0), size=(1, 1, 1))\n",
        "proxy('a', 'b', at=(0, 0, 0), size=(1, 1, 1), like='a')\nproxy('b', 'c', at=(0, 0, 0), size=(1, 1, 1), like='b')\n",
        "oak = wood(oak)\nproxy('wall_n', 'chair', at=(0, 0, 0), size=(1, 1, 1))\nproxy('1', '', at=(0, 0, 0), size=(1, 1, 1))\n",
        "room(size=(1e9, 1e9, 1e9), floor=[(0, 0), (1e9, 0), (1e9, 1e9)], seen=[(1, 1)] * 99)\n",
        "room(size=(3, 3, 2), floor=[(0, 0), (0, 0), (0, 0)])\nroom(3)\n",
        "wall('w', (0, 0), (0, 0))\ndoor('w', wall='w', start=(0, 0), end=(1, 0))\nwindow('w')\n",
        "{\"program\": [1, 2, {\"a\": null}]}",
        "```\n```\n```python\n",
        "\ud800 room(",
    ],
)  # fmt: skip
def test_odd_answers_are_read(text: str) -> None:
    sound(read_text(text))
    sound(Draft())
    assert split(text, whole=False) is not None
    DraftGrowth().hear(text)
