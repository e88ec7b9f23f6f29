# SPDX-License-Identifier: GPL-3.0-or-later
"""What was asked and answered can be read: whole prompts, every answer, pictures by their hashes, and nothing else of them."""

from __future__ import annotations

import base64
import hashlib
import io
import threading

import pytest
from code_as_room.pipeline.ask import perform_ask
from code_as_room.pipeline.ask_talk import TALK, Talk, talk_text
from code_as_room.pipeline.errors import ReplyError
from code_as_room.pipeline.memory import EntryMeta, Memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.stages.wishes import Ask, Picture, Request
from PIL import Image
from pydantic import BaseModel


class Answer(BaseModel):
    score: int


def picture():
    data = io.BytesIO()
    Image.new("RGB", (64, 48), "red").save(data, "PNG")
    return data.getvalue()


class Client:
    name, describes = "fake:m", "a client"

    def __init__(self, *texts):
        self.texts = list(texts)

    def answer(self, prompt, cancel, progress=None):
        return Reply(self.texts.pop(0), "served-m", 10, 5)


@pytest.fixture(autouse=True)
def nothing_noted():
    TALK.forget()
    yield
    TALK.forget()


def ask(client, room="room", recall=None, keep=None):
    request = Request(
        "03_critique/1", "03_critique", Answer, {"layout": "a bed", "known": ""}, (Picture("p", picture()),)
    )
    return perform_ask(Ask((request,)), "s03_layout", client, threading.Event(), recall, keep, room=room)


def test_a_prompt_and_all_its_answers_can_be_read_and_of_pictures_only_the_hash():
    image = picture()
    ask(Client('{"score": "high"}', '{"score": 7}'))
    text = talk_text(TALK.of_room("room"), [])
    flat = text.replace("\n", " ")
    assert "You see" in flat or "Picture 1 is a room" in flat
    assert "a bed" in text and '{"score": "high"}' in text and '{"score": 7}' in text
    assert "asked once more" in text and "answer of served-m" in text
    assert f"sha256 {hashlib.sha256(image).hexdigest()[:16]}, 64 x 48 pixels" in text
    assert base64.b64encode(image).decode()[:24] not in text
    assert TALK.of_room("another") == []


def test_an_answer_that_stayed_unusable_can_be_read_too():
    with pytest.raises(ReplyError):
        ask(Client("I am sorry", "Sorry again"))
    text = talk_text(TALK.of_room("room"), [])
    assert "I am sorry" in text and "Sorry again" in text


def test_earlier_answers_are_shown_with_their_prompt_where_it_is_known():
    memory = Memory()
    meta = EntryMeta(time="t", model="old-m", prompt_tokens=9, completion_tokens=4, cost=0.01, prompt_hash="f" * 64)
    memory.keep_answer("s01_analysis", "01_analysis", '{"old": 1}', meta)
    kept = []
    ask(Client('{"score": 7}'), keep=kept.append)
    memory.keep_answer(
        "s03_layout", kept[0].key, kept[0].text, EntryMeta(time="t", model="served-m", prompt_hash=kept[0].prompt_hash)
    )
    TALK.forget()
    ask(Client(), recall=lambda prompt: Reply(kept[0].text, "served-m"))
    text = talk_text(TALK.of_room("room"), memory.entries)
    assert f"prompt {'f' * 16} of an earlier session" in text and '{"old": 1}' in text and "$0.0100" in text
    assert "a bed" in text and "used again" in text and text.count('{"score": 7}') == 1


def test_long_lines_are_broken_and_old_prompts_forgotten():
    talk = Talk(most_bytes=50_000)
    for n in range(20):
        prompt = Prompt("s01", f"k{n}", f"{n} " + "x" * 10_000, (), "A", {}, f"hash {n}")
        talk.note_prompt("room", prompt)
        talk.note_reply(prompt, Reply(f"answer {n}", "m"))
    left = talk.of_room("room")
    assert [e.key for e in left] == ["k16", "k17", "k18", "k19"] and left[-1].replies == [("m", "answer 19")]
    assert max(map(len, talk_text(left, []).splitlines())) <= 1000
