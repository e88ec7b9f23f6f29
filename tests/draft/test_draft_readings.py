# SPDX-License-Identifier: GPL-3.0-or-later
"""Each statement of a draft is read once, and costs a growing room one part, however much stands already."""

from __future__ import annotations

import io
import threading
from collections import Counter

import pytest
from code_as_room.benchmark.plain_backend import PlainBackend
from code_as_room.pipeline.artifacts.draft import DraftProgram
from code_as_room.pipeline.draft import record as records
from code_as_room.pipeline.draft import text as room_texts
from code_as_room.pipeline.draft.artifact import read_again
from code_as_room.pipeline.draft.camera import first_camera
from code_as_room.pipeline.draft.client import DraftedClient
from code_as_room.pipeline.draft.growing import DraftGrowth
from code_as_room.pipeline.draft.prompt import EXAMPLE
from code_as_room.pipeline.draft.reading import Draft
from code_as_room.pipeline.draft.statements import Statement, split
from code_as_room.pipeline.draft.text import room_text
from code_as_room.pipeline.memory import Memory, dump_memory, load_memory
from code_as_room.pipeline.picture import read_picture
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.scene.targets import plan_record
from code_as_room.pipeline.stages import s00_draft
from PIL import Image

from .drafts import ROOM, TABLE, Scripted

BED = (
    "proxy('bed_1', 'bed', at=(0, 0, 0), size=(1.6, 2, 0.5))\n"
    "def bed_1(size):\n    w, d, h = size\n"
    "    return [part('frame', rounded_box((w, d, h / 2), 0.02, at=(0, 0, h / 4)), material='wood'),\n"
    "            part('mattress', rounded_box((w, d, h / 2), 0.1, at=(0, 0, h * 0.75)), material='linen')]\n"
    "proxy('throw_1', 'throw', at=(0, -0.6, 0.3), size=(1.9, 0.6, 0.22), placement='surface', parent='bed_1')\n"
    "def throw_1(size):\n    w, d, h = size\n"
    "    return [part('throw', drape((w - 0.3, d), hang=(0, 0, 0.15, 0.15), at=(0, 0, h)), material='wool')]\n"
)
TWINS = (
    "proxy('table_2', 'table', at=(1, 1, 0), size=(1, 0.8, 0.7), like='table_1')\n"
    "proxy('table_3', 'table', at=(-1, 1, 0), size=(1.2, 0.8, 0.7), like='table_1')\n"
    "proxy('table_4', 'table', at=(-1, -1, 0), size=(1, 0.8, 0.7), like='table_1', colors={'wood': '#223344'})\n"
    "proxy('mug-1', 'mug', at=(0, 0, 0.7), size=(0.1, 0.1, 0.1), parent='table_1', piece='mug')\n"
)
BROKEN = TABLE.replace("table_1", "table_9").replace("at=(0, 0, 0)", "at=(1, -1, 0)").replace("box((w", "boxes((w", 1)
CLASH = (
    "def leg(h):\n    return box((0.05, 0.05, h), at=(0, 0, h / 2))\n"
    "proxy('post_1', 'post', at=(1, -1, 0), size=(0.05, 0.05, 0.5))\n"
    "def post_1(size):\n    return [part('post', [leg(size[2]), leg(size[2])], material='wood')]\n"
    "def leg(h):\n    return cylinder(0.025, h, at=(0, 0, h / 2))\n"
    "proxy('post_2', 'post', at=(1, -1.2, 0), size=(0.05, 0.05, 0.5))\n"
    "def post_2(size):\n    return [part('post', [leg(size[2]), leg(size[2])], material='wood')]\n"
)


def chairs(count: int) -> str:
    """So many things, each with a def of its own."""
    return "".join(
        TABLE.replace("table_1", f"table_{n}").replace("at=(0, 0, 0)", f"at=({n % 8}, {n // 8}, 0)")
        for n in range(1, count + 1)
    )


@pytest.fixture
def taken(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often each statement was read."""
    counted: Counter[str] = Counter()
    take = Draft.take

    def counting(self: Draft, statement: Statement) -> bool:
        counted[statement.text] += 1
        return take(self, statement)

    monkeypatch.setattr(Draft, "take", counting)
    return counted


def run_of(answer: str, memory: Memory | None = None) -> Run:
    data = io.BytesIO()
    Image.new("RGB", (400, 400), "tan").save(data, "PNG")
    memory = memory or Memory()
    return Run(
        read_picture(data.getvalue(), "room.png"), memory, DraftedClient(Scripted(answer), memory), PlainBackend()
    )


def drafted(run: Run) -> DraftProgram:
    run.run_all([s00_draft.STAGE])
    found = run.memory.latest(DraftProgram)
    assert found is not None
    return found


def grow(growth: DraftGrowth, text: str, step: int = 150) -> list[str]:
    return [room for end in range(step, len(text) + step, step) if (room := growth.hear(text[:end])) is not None]


def test_what_grew_is_read_once_by_all(taken: Counter[str]) -> None:
    answer = f"Here it is, as you asked.\n```python\n{EXAMPLE}```\n"
    run = run_of(answer)
    growth = DraftGrowth((400, 400))
    grow(growth, answer)
    program = drafted(run)
    draft, _ = read_again(program)
    assert draft is growth.draft and set(taken) == {s.text for s in split(answer).statements}
    assert set(taken.values()) == {1}
    alone = drafted(run_of(answer))
    assert alone == program and set(taken.values()) == {2}


def test_a_stage_that_was_stopped_reads_on_where_its_room_had_come(taken: Counter[str]) -> None:
    whole = f"```python\n{EXAMPLE}```\n"
    heard = whole[: whole.index('proxy("pouf_1"') + 30]
    growth = DraftGrowth((400, 400))
    grow(growth, heard[:1500])
    program = drafted(run_of(heard))
    assert set(taken.values()) == {1} and not program.whole
    assert program == drafted(run_of(heard))


def test_an_answer_that_is_not_what_was_heard_is_read_for_itself() -> None:
    growth = DraftGrowth((400, 400))
    grow(growth, f"```python\n{ROOM}{TABLE}build()\n```")
    program = drafted(run_of(f"```python\n{ROOM}{BED}build()\n```"))
    assert "bed_1" in program.room_text and "table_1" not in program.room_text
    assert set(growth.draft.things) == {"table_1"}


def test_a_draft_that_was_taken_is_nobody_elses(taken: Counter[str]) -> None:
    answer = f"```python\n{ROOM}{BROKEN}build()\n```"
    growth = DraftGrowth((400, 400))
    grow(growth, answer)
    run = run_of(answer)
    first = drafted(run)
    again = drafted(run_of(answer, load_memory(dump_memory(run.memory))))
    assert len(again.statements) == len(first.statements) and [s.kind for s in first.statements].count("def") == 1
    assert drafted(run_of(answer)) == first


def test_a_stage_and_its_room_read_side_by_side(taken: Counter[str]) -> None:
    answer = f"```python\n{ROOM}{chairs(12)}{BED}build()\n```"
    growth = DraftGrowth((400, 400))
    growth.hear(answer[:700])
    rooms: list[str] = []
    thread = threading.Thread(target=lambda: rooms.extend(grow(growth, answer[: len(answer) - 20], 2000)))
    thread.start()
    program = drafted(run_of(answer))
    thread.join()
    assert set(taken.values()) == {1} and program == drafted(run_of(answer))
    assert all(evaluate(room, FINISHED_ROOM_LIMITS).built for room in rooms)


@pytest.mark.parametrize(
    "answer",
    [EXAMPLE, ROOM + TABLE + TWINS + "build()\n", ROOM + BED + TABLE + BROKEN + "finish('floor', planks('#A87C52'))\n"],
)
def test_the_record_of_a_growing_room_is_what_its_text_means(answer: str) -> None:
    """Both are made of parts; a room that is put together and evaluated as a whole is the same."""
    growth = DraftGrowth((800, 800))
    shown = 0
    for end in range(60, len(answer) + 60, 60):
        text = growth.hear(answer[:end])
        if text is None:
            continue
        shown += 1
        assert growth.record is not None and growth.draft.room is not None
        record = evaluate(text, FINISHED_ROOM_LIMITS)
        mine, whole = plan_record(growth.record), plan_record(record)
        assert mine.digests == whole.digests and mine.looks == whole.looks and mine.notes == whole.notes
        assert growth.record.finishes == record.finishes and growth.record.plain.keys() == record.plain.keys()
        assert text == room_text(growth.draft, first_camera(growth.draft.room, (800, 800)))
    assert shown > 4


def test_parts_that_do_not_go_together_are_evaluated_as_one_room() -> None:
    growth = DraftGrowth()
    rooms = grow(growth, ROOM + CLASH + "build()\n", 40)
    assert growth.record is None and "post_2" in rooms[-1]
    assert evaluate(rooms[-1], FINISHED_ROOM_LIMITS).furnished["post_2"]


def test_another_statement_costs_its_own_part_only(monkeypatch: pytest.MonkeyPatch) -> None:
    evaluated: list[str] = []
    monkeypatch.setattr(room_texts, "evaluate", lambda text, limits: evaluated.append(text) or evaluate(text, limits))
    made = []
    answer = ROOM + chairs(30)
    growth = DraftGrowth()
    for end in range(100, len(answer) + 100, 100):
        if growth.hear(answer[:end]) is not None:
            made.append(len(growth.parts.made))
    assert len(growth.draft.things) == 30 and len(made) > 40
    assert sum(made) <= 60 and made[-1] <= 2 and not evaluated


def test_a_cloth_is_laid_anew_only_where_something_near_it_is_another(monkeypatch: pytest.MonkeyPatch) -> None:
    laid: list[int] = []
    lay = records.lay_covers
    monkeypatch.setattr(records, "lay_covers", lambda record, names: laid.append(1) or lay(record, names))
    growth = DraftGrowth()
    far = [f"proxy('box_{n}', 'box', at=({20 + n}, 5, 0), size=(0.3, 0.3, 0.3))\n" for n in range(6)]
    near = "proxy('stool_1', 'stool', at=(0.9, -0.6, 0), size=(0.3, 0.3, 0.4))\n"
    grow(growth, ROOM + BED + far[0])
    assert growth.record is not None and growth.record.plain.keys() == {"throw_1"}
    before = len(laid)
    text = ROOM + BED + "".join(far)
    growth.hear(text)
    assert len(growth.record.proxies) == 8 and len(laid) == before
    growth.hear(text + near)
    assert len(growth.record.proxies) == 9 and len(laid) == before + 1
