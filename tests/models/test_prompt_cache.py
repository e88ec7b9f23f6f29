# SPDX-License-Identifier: GPL-3.0-or-later
"""What prompts share is sent first, marked, and priced as what it is; the prompt itself stays the same to the letter."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from code_as_room.pipeline.artifacts.objects import ProgramsReply
from code_as_room.pipeline.ask_shared import LEAST_BYTES, mark_shared
from code_as_room.pipeline.models.anthropic import AnthropicClient
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.gemini import GeminiClient
from code_as_room.pipeline.models.http_client import Habits
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from code_as_room.pipeline.models.prices import Price, bundled_prices
from code_as_room.pipeline.program.reference import reference
from code_as_room.pipeline.prompting import make_prompt, repair_prompt
from code_as_room.pipeline.spending import CappedClient, Meter
from code_as_room.pipeline.stages.wishes import Request

REFERENCE = "\n\n".join(f"Rule {n}: a sentence on the language, long enough to matter." for n in range(90))


def prompts(count=3, reference=REFERENCE, images=(b"\x89PNG fake",)):
    schema = {"type": "object", "properties": {}, "required": [], "additionalProperties": False}
    return [
        Prompt("s06", f"k{n}", f"{reference}\n\nObjects:\n{n} of them", images, "Answer", schema, f"hash {n}")
        for n in range(count)
    ]


def test_the_shared_beginning_is_found_and_nothing_else_is_changed():
    given = prompts()
    marked = mark_shared(given)
    assert [replace(p, shared=0) for p in marked] == given
    for prompt in marked:
        shared, rest = prompt.halves()
        assert shared == f"{REFERENCE}\n\n" and shared + rest == prompt.text and rest.startswith("Objects")
    # The second try of one begins with the same.
    assert repair_prompt(marked[0], ("wrong",), "{}").halves()[0] == f"{REFERENCE}\n\n"


def test_the_language_reference_is_in_what_real_prompts_for_programs_share():
    values = {"reference": reference(), "style": "plain"}
    real = [
        make_prompt(
            Request(
                f"06_programs/{n}",
                "06_programs",
                ProgramsReply,
                {**values, "objects": str(n), "crops": str(n), "examples": f"def a{n}"},
            ),
            "s06_geometry",
        )
        for n in range(3)
    ]
    shared = mark_shared(real)[0].halves()[0]
    assert reference() in shared and len(shared) > 0.9 * len(real[0].text)


@pytest.mark.parametrize(
    "given",
    [
        prompts(1),
        prompts(3, reference="x" * (LEAST_BYTES // 2)),
        [replace(p, schema_name=p.key) for p in prompts()],
        [replace(p, text=f"{n}{p.text}") for n, p in enumerate(prompts())],
    ],
    ids=["one alone", "too short", "of different kinds", "different from the start"],
)
def test_what_is_not_shared_is_not_marked(given):
    assert all(p.shared == 0 for p in mark_shared(given))


def texts(parts):
    return "".join(part.get("text", "") for part in parts)


def test_every_service_is_sent_the_shared_part_first_and_the_whole_text():
    marked = mark_shared(prompts())[1]
    claude = AnthropicClient("https://api.anthropic.com", "claude-sonnet-4-5").body(marked, Habits(most_tokens=10))
    system, content = claude["system"], claude["messages"][0]["content"]
    assert [block["type"] for block in content] == ["image", "text"] and texts([*system, *content]) == marked.text
    assert (
        len(system) == 1 and system[0]["cache_control"] == {"type": "ephemeral"} and "cache_control" not in content[1]
    )
    gemini = GeminiClient("https://g.example", "gemini-2.5-pro").body(marked, Habits())["contents"][0]["parts"]
    assert [list(part) for part in gemini] == [["text"], ["inline_data"], ["text"]] and texts(gemini) == marked.text
    openai = OpenAIStyleClient("https://api.openai.com/v1", "gpt-5").body(marked, Habits())["messages"][0]["content"]
    assert [part["type"] for part in openai] == ["text", "image_url", "text"] and texts(openai) == marked.text
    assert "cache_control" not in openai[0]
    router = OpenAIStyleClient("https://openrouter.ai/api/v1", "anthropic/claude-sonnet-4.5")
    assert router.body(marked, Habits())["messages"][0]["content"][0]["cache_control"] == {"type": "ephemeral"}
    alone = prompts(1)[0]
    body = AnthropicClient("https://a.example", "m").body(alone, Habits(most_tokens=1))
    assert [block["type"] for block in body["messages"][0]["content"]] == ["image", "text"] and "system" not in body


USAGE = {"input_tokens": 100, "cache_creation_input_tokens": 0, "cache_read_input_tokens": 900, "output_tokens": 10}


def message(usage):
    content = [{"type": "text", "text": "{}"}]
    return {"type": "message", "model": "c", "content": content, "stop_reason": "end_turn", "usage": usage}


def test_one_prompt_goes_ahead_and_the_others_find_its_beginning_kept(peer):
    began, open_at_first = [], []
    first_answers = threading.Event()

    def script(received):
        began.append(received.number)
        if received.number == 0:
            time.sleep(0.3)
            open_at_first.append(len(began))
            first_answers.set()
        received.reply(200, message(USAGE))

    peer.script = script
    client = AnthropicClient(peer.url, "claude-sonnet-4-5")
    with ThreadPoolExecutor(4) as pool:
        replies = list(pool.map(lambda p: client.answer(p, threading.Event()), mark_shared(prompts(4))))
    assert open_at_first == [1] and len(began) == 4
    assert {(r.prompt_tokens, r.cached_tokens) for r in replies} == {(1000, 900)}


def test_nobody_waits_for_a_prompt_that_failed_and_waiting_can_be_stopped(peer):
    gate, cancel = threading.Event(), threading.Event()

    def script(received):
        if received.number == 0:
            gate.wait(5)
        received.reply(400, {"error": {"message": "no"}})

    peer.script = script
    client = AnthropicClient(peer.url, "claude-sonnet-4-5")
    marked = mark_shared(prompts(3))
    with ThreadPoolExecutor(3) as pool:
        first = pool.submit(client.answer, marked[0], threading.Event())
        while not peer.received:
            time.sleep(0.01)
        stopped = pool.submit(client.answer, marked[1], cancel)
        cancel.set()
        assert type(stopped.exception(5)).__name__ == "Cancelled"
        third = pool.submit(client.answer, marked[2], threading.Event())
        gate.set()
        assert first.exception(5) and third.exception(5)
    assert len(peer.received) == 2


def test_a_service_that_does_not_know_the_mark_is_asked_without(peer):
    def script(received):
        if "cache_control" in str(received.body):
            received.reply(400, {"error": {"message": "cache_control: extra inputs are not permitted"}})
        else:
            received.reply(200, message({"input_tokens": 5, "output_tokens": 1}))

    peer.script = script
    client = AnthropicClient(peer.url, "claude-x")
    for prompt in mark_shared(prompts(2)):
        assert client.answer(prompt, threading.Event()).text == "{}"
    assert len(peer.received) == 3


def test_what_the_cache_gave_and_took_is_priced_as_such():
    price = Price(10.0, 50.0, cached=1.0, written=12.5)
    assert price.of(1000, 100) == pytest.approx(0.015)
    assert price.of(1000, 100, cached=900) == pytest.approx((100 * 10 + 900 * 1 + 100 * 50) / 1e6)
    assert price.of(1000, 100, written=900) == pytest.approx((100 * 10 + 900 * 12.5 + 100 * 50) / 1e6)
    assert Price(10.0, 50.0).of(1000, 100, cached=900) == pytest.approx(0.015)
    assert price.of(10, 0, cached=99, written=99) == pytest.approx(10 / 1e6)

    class Client:
        name, describes = "c", "a client"

        def answer(self, prompt, cancel, progress=None):
            return Reply("{}", "c", 1000, 100, cached_tokens=900)

    client = CappedClient(Client(), Meter(), lambda stage, pictures=1: ("c", price))
    reply = client.answer(prompts(1)[0], threading.Event())
    assert reply.cost == client.meter.spent == pytest.approx(0.0069) and client.meter.cached == 900


def test_bundled_prices_of_the_cache_are_plausible():
    entries = [e for e in bundled_prices().entries() if "cached" in e]
    assert len(entries) > 10 and all(0 < e["cached"] < e["input"] for e in entries)
    claude = [e for e in entries if e["host"] == "api.anthropic.com"]
    assert claude and all(e["written"] == pytest.approx(1.25 * e["input"]) for e in claude)


@pytest.mark.parametrize(
    ("client", "reply"),
    [
        (
            OpenAIStyleClient,
            {
                "choices": [{"index": 0, "message": {"content": "{}"}, "finish_reason": "stop"}],
                "usage": {
                    "prompt_tokens": 1000,
                    "completion_tokens": 10,
                    "prompt_tokens_details": {"cached_tokens": 900},
                },
            },
        ),
        (
            GeminiClient,
            {
                "candidates": [{"content": {"parts": [{"text": "{}"}]}, "finishReason": "STOP"}],
                "usageMetadata": {
                    "promptTokenCount": 1000,
                    "candidatesTokenCount": 10,
                    "cachedContentTokenCount": 900,
                },
            },
        ),
    ],
)
def test_cached_tokens_are_counted(client, reply, peer):
    peer.script = lambda received: received.reply(200, reply)
    got = client(peer.url, "m").answer(prompts(1)[0], threading.Event())
    assert (got.prompt_tokens, got.cached_tokens) == (1000, 900)
