# SPDX-License-Identifier: GPL-3.0-or-later
"""Any chat, by hand: questions wait one after the other, pictures lie beside them, and what is pasted is an answer like any."""

from __future__ import annotations

import io
import json
import threading
import time

import numpy as np
import pytest
from code_as_room.pipeline.ask import perform_ask
from code_as_room.pipeline.errors import Cancelled, ModelError, NotRecordedError, OutputError, RoomError
from code_as_room.pipeline.models.base import Prompt
from code_as_room.pipeline.models.manual import Desk, ManualClient
from code_as_room.pipeline.models.manual_pictures import TOGETHER, composite
from code_as_room.pipeline.models.registry import make_client, settings_from_environment
from code_as_room.pipeline.stages.wishes import Ask, Picture, Request
from PIL import Image
from pydantic import BaseModel

SCHEMA = {"type": "object", "properties": {"a": {"type": "number"}}, "required": ["a"], "additionalProperties": False}


class Answer(BaseModel):
    score: int


def picture(colour, size=(120, 80), form="PNG"):
    data = io.BytesIO()
    Image.new("RGB", size, colour).save(data, form)
    return data.getvalue()


def prompt(key="01_test", images=(), text="What is a?", repair=False):
    return Prompt("s01", key, text, tuple(images), "Answer", SCHEMA, key, repair=repair)


class Asked(threading.Thread):
    """A question that is being asked in a thread of its own."""

    def __init__(self, client, question):
        super().__init__(daemon=True)
        self.cancel, self.result, self.error = threading.Event(), None, None
        self._client, self._question = client, question
        self.start()

    def run(self):
        try:
            self.result = self._client.answer(self._question, self.cancel)
        except RoomError as error:
            self.error = error

    def ended(self):
        self.join(5)
        assert not self.is_alive()
        return self


def until(holds):
    end = time.monotonic() + 5
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.005)


@pytest.fixture
def desk():
    return Desk()


def test_a_question_waits_with_its_pictures_until_it_is_answered(desk, tmp_path):
    images = picture("red"), picture("blue", form="JPEG")
    asked = Asked(ManualClient(desk, tmp_path), prompt("05_descriptions/2", images))
    until(lambda: desk.waiting)
    question = desk.waiting[0]
    assert [f.name for f in question.saved.files] == ["picture_1.png", "picture_2.jpg", TOGETHER]
    assert [f.read_bytes() for f in question.saved.files[:2]] == list(images)
    assert "What is a?" in question.text and json.dumps(SCHEMA, separators=(",", ":")) in question.text
    assert "Pictures 1 to 2 are attached" in question.text
    desk.answer(question.number, 'Sure:\n```json\n{"a": 3}\n```')
    assert asked.ended().result.text.startswith("Sure") and not desk.waiting
    assert list(tmp_path.iterdir()) == []


def test_the_composite_shows_every_picture_at_one_scale_under_its_number():
    page = Image.open(io.BytesIO(composite([picture("red", (3000, 2000)), picture("lime", (1500, 1000))])))
    assert max(page.size) <= 2400
    high = np.asarray(page.convert("RGB")) > 128
    red, green, blue = high[..., 0], high[..., 1], high[..., 2]
    reds, limes = (red & ~green & ~blue).sum(), (green & ~red & ~blue).sum()
    assert reds == pytest.approx(4 * limes, rel=0.02) and reds > 500_000
    assert (~red & ~green & ~blue).sum() > 100  # the captions


def test_several_questions_are_shown_one_after_the_other_and_a_second_try_comes_next(desk, tmp_path):
    client = ManualClient(desk, tmp_path)
    asked = []
    for key in ("a", "b", "c"):
        asked.append(Asked(client, prompt(key)))
        until(lambda: len(desk.waiting) == len(asked))
    again = Asked(client, prompt("x", repair=True))
    until(lambda: len(desk.waiting) == 4)
    assert [q.prompt.key for q in desk.waiting] == ["a", "x", "b", "c"]
    for n, waiting in enumerate((asked[0], again, asked[1], asked[2])):
        desk.answer(desk.waiting[0].number, f'{{"a": {n}}}')
        assert waiting.ended().result.text == f'{{"a": {n}}}'


def test_stopping_ends_every_wait_at_once_and_leaves_nothing(desk, tmp_path):
    client = ManualClient(desk, tmp_path)
    asked = [Asked(client, prompt(key, [picture("red")])) for key in "abcd"]
    until(lambda: len(desk.waiting) == 4)
    for one in asked:
        one.cancel.set()
    assert all(isinstance(one.ended().error, Cancelled) for one in asked)
    assert desk.waiting == () and list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("pasted", "says"),
    [
        ("", "no text"),
        (" \n", "no text"),
        ("What is a?", "the prompt itself"),
        ("Sorry, I cannot see a picture.", "no readable JSON"),
        ('{"a": [1, 2', "ends in the middle"),
        ("x" * 2_000_001, "too long"),
    ],
)
def test_what_cannot_be_an_answer_is_refused_and_the_question_goes_on_waiting(pasted, says, desk, tmp_path):
    asked = Asked(ManualClient(desk, tmp_path), prompt())
    until(lambda: desk.waiting)
    with pytest.raises(RoomError, match=says):
        desk.answer(desk.waiting[0].number, pasted)
    assert len(desk.waiting) == 1
    desk.answer(desk.waiting[0].number, '{"a": 1}')
    assert asked.ended().result.text == '{"a": 1}'


def test_a_broken_answer_is_taken_when_the_artist_insists_and_the_last_one_is_not_taken_twice(desk, tmp_path):
    client = ManualClient(desk, tmp_path)
    first = Asked(client, prompt("a"))
    until(lambda: desk.waiting)
    with pytest.raises(RoomError, match="once more"):
        desk.answer(desk.waiting[0].number, '{"a": 1')
    desk.answer(desk.waiting[0].number, '{"a": 1')
    assert first.ended().result.text == '{"a": 1'
    second = Asked(client, prompt("b"))
    until(lambda: desk.waiting)
    with pytest.raises(RoomError, match="the question before"):
        desk.answer(desk.waiting[0].number, '{"a": 1')
    desk.answer(desk.waiting[0].number, '{"a": 1')
    assert second.ended().result.text == '{"a": 1'
    third = Asked(client, prompt("c"))
    until(lambda: desk.waiting)
    desk.skip(desk.waiting[0].number)
    assert isinstance(third.ended().error, NotRecordedError)
    with pytest.raises(RoomError, match="does not wait"):
        desk.answer(1, '{"a": 1}')


def test_a_folder_that_cannot_be_written_is_told(desk, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("x")
    with pytest.raises(OutputError, match="Choose another folder"):
        ManualClient(desk, blocked).answer(prompt(images=[picture("red")]), threading.Event())
    assert desk.waiting == ()


def answered_by(desk, replies, ask):
    """Perform an ask while somebody pastes these answers, each for the question whose text holds its key."""
    stop = threading.Event()

    def artist():
        while not stop.wait(0.005):
            for question in desk.waiting[:1]:
                answers = replies[question.prompt.key]
                text = answers.pop(0)
                desk.skip(question.number) if text is None else desk.answer(question.number, text)

    hand = threading.Thread(target=artist, daemon=True)
    hand.start()
    try:
        yield from perform_ask(*ask)
    finally:
        stop.set()
        hand.join(5)


def request(key):
    values = {"layout": "nothing", "known": ""}
    return Request(key, "03_critique", Answer, values, (Picture("p", picture("red")),))


def test_an_unusable_answer_is_asked_for_once_more_with_what_is_wrong(desk, tmp_path):
    client = ManualClient(desk, tmp_path)
    seen = []
    client_answer = client.answer
    client.answer = lambda p, *rest: seen.append(p) or client_answer(p, *rest)
    replies = {"k1": ['{"score": "high"}', 'Now:\n{"score": "7",}'], "k2": ['{"score": 5}']}
    ask = Ask((request("k1"), request("k2"))), "s03_layout", client, threading.Event()
    assert [r.reply.score for r in answered_by(desk, replies, ask)] == [7, 5]
    second = next(p for p in seen if p.repair)
    assert "high" in second.text and second.key == "k1" and len(seen) == 3


def test_a_skipped_question_is_done_without_where_that_is_possible(desk, tmp_path):
    replies = {"k1": [None], "k2": ['{"score": 5}']}
    requests = (request("k1"), request("k2"))
    ask = Ask(requests, optional=True), "s03_layout", ManualClient(desk, tmp_path), threading.Event()
    found = list(answered_by(desk, replies, ask))
    assert found[0] is None and found[1].reply.score == 5
    needed = Ask((request("k1"),)), "s03_layout", ManualClient(desk, tmp_path), threading.Event()
    with pytest.raises(NotRecordedError, match="skipped"):
        list(answered_by(desk, {"k1": [None]}, needed))


def test_without_a_window_nobody_can_copy_and_paste():
    with pytest.raises(ModelError, match="Blender's window"):
        make_client(settings_from_environment({"CODE_AS_ROOM_PROVIDER": "manual"}))
