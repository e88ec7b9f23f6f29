# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain answers that are heard while they are written: every envelope over loopback, every wrapper, tries, stops, cuts."""

import json
import threading
from dataclasses import replace

import pytest
from code_as_room.pipeline import prompting
from code_as_room.pipeline.artifacts.replies import PlainReply
from code_as_room.pipeline.ask import perform_ask
from code_as_room.pipeline.ask_floor import FloorClient
from code_as_room.pipeline.errors import Cancelled, ModelError
from code_as_room.pipeline.journal import Journal, JournalledClient
from code_as_room.pipeline.models.base import Reply
from code_as_room.pipeline.models.exchange import Limits
from code_as_room.pipeline.models.hearing import PAUSE, Hearing
from code_as_room.pipeline.models.manual import Desk, ManualClient, question_text
from code_as_room.pipeline.models.recorded import FILE_NAME, RecordedClient, Recorder
from code_as_room.pipeline.models.retry import RetryPolicy
from code_as_room.pipeline.models.routing import RoutingClient
from code_as_room.pipeline.prompting import make_prompt
from code_as_room.pipeline.spending import CappedClient, Meter
from code_as_room.pipeline.stages.wishes import Ask, Request
from fault_envelopes import KEY, Anthropic, Gemini, Ollama, OpenAI

pytestmark = pytest.mark.usefixtures("no_threads_left")

PARTS = ["room((4, 3, 2.6))\n", f'wall("größer {KEY}")\n', "bed 😀\n", "build()\n"]
WHOLE = "".join(PARTS)
SHOWN = WHOLE.replace(KEY, "[key]")
REQUEST = Request("00_draft", "template", PlainReply, {"what": "beds"})
STRUCTURE = ("response_format", "output_config", "generationConfig", "format", "JSON", "json")
VENDORS = pytest.mark.parametrize("vendor", [OpenAI, Anthropic, Gemini, Ollama])


@pytest.fixture(autouse=True)
def template(monkeypatch):
    monkeypatch.setattr(prompting, "load_template", lambda name: "Write a room with {{what}}.")


def make(vendor, peer, tries=1, **options):
    retries = RetryPolicy(tries=tries, first_pause=0.001)
    return vendor.client(
        f"http://127.0.0.1:{peer.port}{vendor.base}", "some-model", KEY, Limits(total=20.0), retries, **options
    )


class Ear:
    """Remembers what was heard, in which thread; an event tells that something was."""

    def __init__(self):
        self.texts, self.threads, self.something = [], set(), threading.Event()

    def __call__(self, text):
        self.texts.append(text)
        self.threads.add(threading.current_thread())
        self.something.set()


def head(vendor):
    return f"HTTP/1.1 200 OK\r\nContent-Type: {vendor.kind}\r\nConnection: close\r\n\r\n".encode()


def pieces(vendor, parts=PARTS, ending=None):
    """A stream's bytes in blocks, the first up to where the first part was written, the rest after it."""
    raw = vendor.stream(parts) if ending is None else vendor.stream(parts, ending)
    first = raw.index(json.dumps(parts[1])[1:-1].encode())
    cut = raw.rindex(b"\n", 0, first) + 1
    return raw[:cut], raw[cut:]


@VENDORS
def test_a_stream_is_heard_as_it_is_written(vendor, peer):
    """The first part is heard while the service still holds the rest back."""
    ear = Ear()
    first, rest = pieces(vendor)

    def script(received):
        received.send(head(vendor) + first)
        assert ear.something.wait(10)
        received.send(rest)

    peer.script = script
    prompt = replace(make_prompt(REQUEST, "s00_draft"), hear=ear)
    reply = make(vendor, peer).answer(prompt, threading.Event())
    assert reply.text == SHOWN and ear.texts[-1] == SHOWN
    assert ear.texts[0] == PARTS[0] and all(SHOWN.startswith(text) for text in ear.texts)
    assert ear.threads == {threading.current_thread()}


@VENDORS
def test_a_reply_in_one_piece_is_heard_once(vendor, peer):
    ear = Ear()
    peer.script = lambda received: received.reply(200, vendor.whole(WHOLE))
    client = make(vendor, peer)
    client._habits = replace(client._habits, stream=False)
    client.answer(replace(make_prompt(REQUEST, "s00_draft"), hear=ear), threading.Event())
    assert ear.texts == [SHOWN]


@VENDORS
def test_a_plain_prompt_asks_for_no_structure(vendor, peer):
    peer.script = lambda received: received.send(head(vendor) + vendor.stream(PARTS))
    prompt = make_prompt(REQUEST, "s00_draft")
    make(vendor, peer).answer(prompt, threading.Event())
    sent = json.dumps(peer.received[0].body)
    assert prompt.plain and "Write a room with beds." in sent
    assert not [word for word in STRUCTURE if f'"{word}"' in sent or (word == "JSON" and word in sent)]


@VENDORS
def test_another_try_is_heard_from_its_beginning(vendor, peer):
    ear = Ear()
    first, _ = pieces(vendor, ["wall(1)\n", "wall(2)\n"])

    def script(received):
        received.send(head(vendor))
        if received.number == 0:
            ear.something.clear()
            received.send(first)
            ear.something.wait(10)
            received.reset()
        else:
            received.send(vendor.stream(PARTS))

    peer.script = script
    reply = make(vendor, peer, tries=2).answer(replace(make_prompt(REQUEST, "s00_draft"), hear=ear), threading.Event())
    assert reply.text == SHOWN and len(peer.received) == 2
    assert ear.texts[0] == "wall(1)\n" and ear.texts[-1] == SHOWN


@VENDORS
def test_a_stop_in_the_middle_keeps_quiet_from_then_on(vendor, peer):
    ear, cancel, gone = Ear(), threading.Event(), threading.Event()
    first, rest = pieces(vendor)

    def script(received):
        received.send(head(vendor) + first)
        ear.something.wait(10)
        cancel.set()
        received.gone(5)
        gone.set()

    peer.script = script
    with pytest.raises(Cancelled):
        make(vendor, peer).answer(replace(make_prompt(REQUEST, "s00_draft"), hear=ear), cancel)
    assert gone.wait(5) and ear.texts == [PARTS[0]]


@VENDORS
def test_a_draft_that_hits_the_length_limit_is_of_use(vendor, peer):
    peer.script = lambda received: received.send(head(vendor) + vendor.stream(PARTS[:3], vendor.cut))
    reply = make(vendor, peer).answer(make_prompt(REQUEST, "s00_draft"), threading.Event())
    assert reply.text == SHOWN.removesuffix("build()\n") and "length limit" in reply.notes[0]


@VENDORS
def test_a_refusal_that_speaks_of_formats_costs_no_structure(vendor, peer):
    """What a plain prompt never asked for was not refused: the next structured prompt is asked with a schema."""
    said = "json schema in response_format, output_config and format not supported"
    peer.script = lambda received: received.reply(400, vendor.error("bad_request", said))
    client = make(vendor, peer)
    with pytest.raises(ModelError):
        client.answer(make_prompt(REQUEST, "s00_draft"), threading.Event())
    assert client.structure == "schema" and len(peer.received) == 1


def perform(client, cancel=None, reply=PlainReply, on_heard=lambda text: None):
    heard = []

    def tell(event):
        if event.kind == "heard":
            heard.append(event.text)
            on_heard(event.text)

    wish = Ask((replace(REQUEST, reply=reply),))
    [result] = perform_ask(wish, "s00_draft", client, cancel or threading.Event(), on_event=tell)
    return result, heard


def test_it_is_heard_through_every_wrapper(peer, tmp_path):
    go = threading.Event()
    first, rest = pieces(OpenAI)

    def script(received):
        received.send(head(OpenAI) + first)
        assert go.wait(10)
        received.send(rest)

    peer.script = script
    client = Recorder(RoutingClient(make(OpenAI, peer), {}), tmp_path)
    client = FloorClient(CappedClient(client, Meter(), lambda stage, pictures=1: ("some-model", None)))
    client = JournalledClient(client, Journal(tmp_path / "journal.jsonl"), {})
    result, heard = perform(client, on_heard=lambda text: go.set())
    assert result.reply == PlainReply(text=SHOWN) and result.tries == 1 and result.notes == ()
    assert heard[0] == PARTS[0] and heard[-1] == SHOWN

    again, heard = perform(client)
    assert again.reply == result.reply and again.tries == 0 and heard == [SHOWN]
    played, heard = perform(RecordedClient(tmp_path))
    assert played.reply == result.reply and heard == [SHOWN]


def test_a_recording_is_played_in_pieces_where_it_says_so(tmp_path):
    class Speaker:
        name = describes = "speaker"

        def answer(self, prompt, cancel, progress=None):
            return Reply('["JSON?"]\n' + WHOLE * 20, "speaker-1")

    perform(Recorder(Speaker(), tmp_path))
    file = tmp_path / FILE_NAME
    kept = json.loads(file.read_text(encoding="utf-8"))
    kept["replies"]["s00_draft/00_draft"]["characters_a_second"] = 4000
    file.write_text(json.dumps(kept), encoding="utf-8")
    result, heard = perform(RecordedClient(tmp_path))
    assert result.reply.text == '["JSON?"]\n' + WHOLE * 20
    assert len(heard) > 2 and heard[-1] == result.reply.text
    assert all(result.reply.text.startswith(text) for text in heard)

    cancel = threading.Event()
    with pytest.raises(Cancelled):
        perform(RecordedClient(tmp_path), cancel, on_heard=lambda text: cancel.set())


def test_a_chat_by_hand_may_answer_with_any_text(tmp_path):
    desk = Desk()
    asked = []
    thread = threading.Thread(target=lambda: asked.append(perform(ManualClient(desk, tmp_path))))
    thread.start()
    while not desk.waiting:
        pass
    [question] = desk.waiting
    assert "JSON" not in question_text(question.prompt)
    desk.answer(question.number, WHOLE)
    thread.join(10)
    result, heard = asked[0]
    assert result.reply.text == WHOLE.strip() and heard == [WHOLE.strip()]


def test_only_the_newest_is_heard_by_a_slow_listener():
    class Fast:
        name = describes = "fast"

        def answer(self, prompt, cancel, progress=None):
            for length in range(1, 501):
                prompt.hear("x" * length)
                if length == 1:
                    begun.wait(10)
            written.set()
            return Reply("x" * 500, "fast-1")

    begun, written = threading.Event(), threading.Event()

    def slow(text):
        begun.set()
        written.wait(10)

    _, heard = perform(Fast(), on_heard=slow)
    assert [len(text) for text in heard] == [1, 500]


def test_thoughts_are_neither_heard_nor_kept():
    class Thinker:
        name = describes = "thinker"

        def answer(self, prompt, cancel, progress=None):
            prompt.hear("<think>wall(")
            return Reply("<think>wall(1)?</think>\nwall(2)\n", "thinker-1")

    result, heard = perform(Thinker())
    assert result.reply.text == "\nwall(2)\n" and heard[-1] == "\nwall(2)\n" and "wall(" not in heard[:-1]


def test_an_empty_answer_is_asked_for_once_more_without_a_word_of_json():
    class Silent:
        name = describes = "silent"

        def answer(self, prompt, cancel, progress=None):
            prompts.append(prompt.text)
            return Reply(" \n" if len(prompts) == 1 else "wall(1)", "silent-1")

    prompts = []
    result, _ = perform(Silent())
    assert result.reply.text == "wall(1)" and len(prompts) == 2 and "JSON" not in prompts[1]


def test_the_listener_is_told_ten_times_a_second_at_most():
    ear, now = Ear(), [10.0]
    hearing = Hearing(replace(make_prompt(REQUEST, "s00_draft"), hear=ear), lambda: now[0])
    for length in range(1, 101):
        hearing.so_far(lambda length=length: "x" * length)
        now[0] += PAUSE / 10
    hearing.whole("x" * 100)
    hearing.whole("x" * 100)
    assert len(ear.texts) <= 12 and ear.texts[-1] == "x" * 100
