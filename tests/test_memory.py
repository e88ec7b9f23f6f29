"""Memory must survive every trip through a text datablock, and say where it broke."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.artifacts.layout import LayoutProgram, Score
from code_as_room.pipeline.errors import MemoryFormatError
from code_as_room.pipeline.memory import EntryMeta, Memory, dump_memory, load_memory
from hypothesis import given
from hypothesis import strategies as st

SCORE = Score(total=0.5, measured=0.5, coverage=1, overlap=1, bounds=1, relations=1, boxes=0.1)
texts = st.text(max_size=2000).filter(lambda t: "\x00" not in t)


def program(text: str) -> LayoutProgram:
    return LayoutProgram(text=text, stage="s03_layout", score=SCORE)


@given(texts, texts)
def test_any_text_survives_a_round_trip(body: str, answer: str) -> None:
    memory = Memory("room.png", "abc", {"notes": body[:50]})
    memory.append("s03_layout", program(body), EntryMeta(time="t", inputs={"picture": "abc"}))
    memory.keep_answer("s01_analysis", "01", answer, EntryMeta(time="t", client="c", prompt_hash="h"))
    again = load_memory(dump_memory(memory))
    assert again == memory
    latest = again.latest(LayoutProgram)
    assert latest is not None and latest.text == body


@given(texts)
def test_lines_stay_short(body: str) -> None:
    memory = Memory("room.png", "abc")
    memory.append("s03_layout", program(body * 20), EntryMeta(time="t"))
    assert max(len(line) for line in dump_memory(memory).split("\n")) < 1200


def test_latest_entry_wins_and_earlier_ones_stay() -> None:
    memory = Memory()
    for text in ("one", "two"):
        memory.append("s03_layout", program(text), EntryMeta(time="t"))
    memory.append("s04_auxiliary", program("three"), EntryMeta(time="t"))
    assert memory.latest(LayoutProgram).text == "three"  # type: ignore[union-attr]
    assert memory.latest(LayoutProgram, ("s03_layout",)).text == "two"  # type: ignore[union-attr]
    assert len(memory.entries) == 3


def test_an_answer_is_found_only_for_the_client_that_gave_it() -> None:
    memory = Memory()
    memory.keep_answer("s01_analysis", "01", "{}", EntryMeta(time="t", client="builtin", prompt_hash="h"))
    assert memory.answer("h", "builtin") is not None
    assert memory.answer("h", "openai:x") is None
    assert memory.answer("other", "builtin") is None


def test_broken_json_is_located() -> None:
    text = dump_memory(Memory("room.png", "abc")).replace('"settings": {}', '"settings": {')
    with pytest.raises(MemoryFormatError, match=r"line \d+, column \d+"):
        load_memory(text)


@pytest.mark.parametrize(
    "text",
    ["[]", "{}", '{"format": "code-as-room/memory/9"}', '{"format": "code-as-room/memory/1", "entries": [{"stage": 1}]}',
     '{"format": "code-as-room/memory/1", "entries": 7}', '{"format": "code-as-room/memory/1", "settings": NaN}', "[" * 100_000],
)  # fmt: skip
def test_foreign_or_damaged_memory_is_refused_in_words(text: str) -> None:
    with pytest.raises(MemoryFormatError) as caught:
        load_memory(text)
    assert caught.value.message.endswith(".")


def test_an_empty_text_is_an_empty_memory() -> None:
    assert load_memory("  \n") == Memory()
