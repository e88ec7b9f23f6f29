# SPDX-License-Identifier: GPL-3.0-or-later
"""Under a weak model the built-in analysis is a floor: stages end, and what did not come from the model is told."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from typing import Any

import pytest
from code_as_room.pipeline.ask_floor import FloorClient, with_floor
from code_as_room.pipeline.errors import ModelError, ReplyError
from code_as_room.pipeline.memory import Memory, dump_memory, load_memory
from code_as_room.pipeline.models.prices import Price, PriceList
from code_as_room.pipeline.models.registry import ClientSettings, make_client
from code_as_room.pipeline.models.strength import is_weak
from code_as_room.pipeline.picture import read_picture
from code_as_room.pipeline.report import all_findings, make_report
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.spending import Meter, begin_total, meter_of, metered
from code_as_room.pipeline.stages import all_stages
from fault_envelopes import OpenAI
from PIL import Image, ImageDraw

from benchmark.plain_backend import PlainBackend

WEAK, STRONG = "smollm2-135m", "some-strong-model"
NO_EYES = "image input is not supported - hint: if this is unexpected, you may need to provide the mmproj"
Peer = Any


def plan() -> Any:
    """A drawn plan of a room with a bed."""
    image = Image.new("RGB", (480, 420), "white")
    pen = ImageDraw.Draw(image)
    pen.rectangle((45, 38, 435, 382), fill=(210, 180, 140), outline=(40, 40, 40), width=11)
    pen.rectangle((170, 50, 315, 217), fill=(120, 140, 190), outline=(60, 60, 60), width=2)
    data = io.BytesIO()
    image.save(data, "PNG")
    return read_picture(data.getvalue(), "plan.png")


def run_of(peer: Peer, model: str, meter: Meter | None = None, **models: str) -> Run:
    settings = ClientSettings("openai", peer.url, model, models=models)
    prices = PriceList().with_price(peer.url, model, Price(1.0, 1.0))
    client = with_floor(metered(make_client(settings), settings, meter, prices), settings)
    return Run(plan(), Memory(settings={"iterations": "1"}), client, PlainBackend())


def saying(text: str) -> Callable[[Any], None]:
    return lambda received: received.reply(200, OpenAI.whole(text))


def blind(received: Any) -> None:
    """A llama.cpp server whose model is one for text only."""
    shown = any(
        part.get("type") == "image_url"
        for message in received.body["messages"]
        if isinstance(message["content"], list)
        for part in message["content"]
    )
    if shown:
        received.reply(500, {"error": {"code": 500, "message": NO_EYES, "type": "server_error"}})
    else:
        received.reply(200, OpenAI.whole("I do not know."))


def told(run: Run) -> list[str]:
    return [f"{finding.about}: {finding.message}" for finding in all_findings(run.memory)]


@pytest.mark.parametrize("script", [saying("Certainly! Here is a room."), saying('{"room": 1}'), blind])
def test_with_a_weak_model_every_stage_ends_and_says_which_answers_are_not_its_own(peer: Peer, script: Any) -> None:
    peer.script = script
    run = run_of(peer, WEAK)
    run.run_all()
    assert all(run.status(stage) == "done" for stage in all_stages())
    assert "proxy(" in run.backend.program_text()
    first = next(line for line in told(run) if "The built-in analysis answered" in line)
    assert first.startswith("Scene analysis:") and WEAK in first and "01_analysis" in first
    assert "The built-in analysis answered" in make_report(run.memory, {}, run.reports)
    # The same is told after a load.
    assert all_findings(load_memory(dump_memory(run.memory))) == all_findings(run.memory)


def test_a_model_without_eyes_is_shown_a_picture_once(peer: Peer) -> None:
    peer.script = blind
    run_of(peer, WEAK).run_all(all_stages()[:1])
    assert len(peer.received) == 1, "nor is it asked again and again for what it cannot do"


@pytest.mark.parametrize(("script", "error"), [(saying("Certainly!"), ReplyError), (blind, ModelError)])
def test_a_strong_models_failure_stays_an_error_with_the_next_step(peer: Peer, script: Any, error: Any) -> None:
    peer.script = script
    run = run_of(peer, STRONG)
    assert not isinstance(run.client, FloorClient)
    with pytest.raises(error) as caught:
        run.run_all(all_stages()[:1])
    assert caught.value.fix and len(peer.received) == (1 if script is blind else 2)


def test_a_refusal_of_the_service_stays_an_error_with_a_weak_model_too(peer: Peer) -> None:
    peer.script = lambda received: received.reply(401, {"error": {"message": "wrong key"}})
    with pytest.raises(ModelError) as caught:
        run_of(peer, WEAK).run_all(all_stages()[:1])
    assert "wrong key" in caught.value.message


def test_only_the_weak_ones_of_several_models_have_the_floor(peer: Peer) -> None:
    peer.script = saying("Certainly!")
    run = run_of(peer, STRONG, layout=WEAK)
    assert isinstance(run.client, FloorClient)
    with pytest.raises(ReplyError):
        run.run_all(all_stages()[:1])


def test_what_the_unusable_answers_cost_is_counted_once(peer: Peer) -> None:
    peer.script = lambda received: received.reply(
        200, {**OpenAI.whole("Certainly!"), "usage": {"prompt_tokens": 1_000_000, "completion_tokens": 0}}
    )
    meter = Meter()
    run = run_of(peer, WEAK, meter)
    assert meter_of(run.client) is meter
    begin_total(run.client, 5.0)
    run.run_all(all_stages()[:1])
    assert meter.spent == pytest.approx(5.0 + len(peer.received))
    assert run.memory.cost()[2] == pytest.approx(len(peer.received)), "memory knows the same"


def test_a_good_answer_of_a_weak_model_is_used(peer: Peer) -> None:
    seen = run_of(peer, WEAK)
    from code_as_room.pipeline.models.builtin.client import BuiltinClient

    seen.client = BuiltinClient()
    seen.run_all(all_stages()[:1])
    answers = {e.output["key"]: e.output["text"] for e in seen.memory.entries if e.type == "Answer"}
    texts = iter(answers.values())
    peer.script = lambda received: received.reply(200, OpenAI.whole(next(texts)))
    run = run_of(peer, WEAK)
    run.run_all(all_stages()[:1])
    assert len(peer.received) == len(answers) and not any("The built-in analysis" in line for line in told(run))
    assert json.loads(next(iter(answers.values())))


@pytest.mark.parametrize("name", ["openai:smollm2-135m", "openai:gemma-3-270m-it", "openai:smollm2:360m", "ollama:any"])
def test_small_models_are_known_by_their_names(name: str) -> None:
    assert is_weak(name)


@pytest.mark.parametrize("name", ["builtin", "openai:gpt-5", "anthropic:claude-opus-4-7", "openai:m1m"])
def test_others_are_not(name: str) -> None:
    assert not is_weak(name)
