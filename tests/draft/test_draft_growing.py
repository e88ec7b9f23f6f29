# SPDX-License-Identifier: GPL-3.0-or-later
"""A room grows statement by statement, starts over with another try, and never shows what cannot be built."""

from __future__ import annotations

from code_as_room.pipeline.draft.growing import DraftGrowth
from code_as_room.pipeline.draft.prompt import EXAMPLE
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.program.lines import parse_layout

from .drafts import ROOM, TABLE


def grown(growth: DraftGrowth, text: str, step: int = 90) -> list[str]:
    found = (growth.hear(text[:end]) for end in range(step, len(text) + step, step))
    return [room for room in found if room is not None]


def test_walls_rise_then_things_appear_one_by_one() -> None:
    rooms = grown(DraftGrowth((1000, 800)), f"```python\n{EXAMPLE}```\n")
    counts = []
    for room in rooms:
        record = evaluate(room, FINISHED_ROOM_LIMITS)
        assert record.built
        counts.append((len(parse_layout(room).proxies), len(record.furnished)))
    assert counts[0] == (0, 0) and counts[-1] == (5, 5) and counts == sorted(counts)
    assert (1, 0) in counts and (1, 1) in counts
    assert parse_layout(rooms[0]).cameras[0].image_size == (1000, 800)


def test_another_try_begins_anew_and_what_is_refused_changes_nothing() -> None:
    growth = DraftGrowth()
    first = growth.hear(f"```python\n{ROOM}{TABLE}build()\n")
    assert first is not None and "table_1" in first and "1 object so far" in growth.latest
    assert growth.hear(f"```python\n{ROOM}") is None
    again = growth.hear(f"```python\n{ROOM}proxy('sofa_1', 'sofa', at=(0, 0, 0), size=(2, 0.9, 0.8))\n")
    assert again is not None and "sofa_1" in again and "table_1" not in again
    more = f"```python\n{ROOM}proxy('sofa_1', 'sofa', at=(0, 0, 0), size=(2, 0.9, 0.8))\nproxy('x', 'y')\nbuild()\n"
    assert growth.hear(more) is None


def test_nothing_is_shown_of_an_answer_without_a_room() -> None:
    growth = DraftGrowth()
    assert growth.hear("") is None
    assert growth.hear("I am sorry, but (as you see) = nothing\n\n") is None
    assert growth.hear(f"```python\n{TABLE}build()\n```") is None
