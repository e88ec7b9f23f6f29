# SPDX-License-Identifier: GPL-3.0-or-later
"""A real llama.cpp server on loopback: our client speaks with it, and a room comes of the weakest of models."""

from __future__ import annotations

import io
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import pytest
from code_as_room.pipeline.ask_floor import FloorClient
from code_as_room.pipeline.errors import Cancelled, CutReplyError
from code_as_room.pipeline.memory import Memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.connection import try_connection
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.limits import Limits
from code_as_room.pipeline.models.listing import list_models
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from code_as_room.pipeline.models.presets import preset
from code_as_room.pipeline.models.registry import ClientSettings
from code_as_room.pipeline.models.retry import RetryPolicy
from code_as_room.pipeline.models.tolerant import read_json
from code_as_room.pipeline.picture import read_picture
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages
from fault_cases import PICTURE
from llama import start_llama
from PIL import Image, ImageDraw

from benchmark.plain_backend import PlainBackend

MODEL = "smollm2-135m"
LONGEST = 80
PATIENT = Limits(read=600.0, total=600.0)
SCHEMA = {
    "type": "object",
    "properties": {"answer": {"type": "number"}, "colour": {"type": "string", "enum": ["red", "blue"]}},
    "required": ["answer", "colour"],
    "additionalProperties": False,
}
QUESTION = Prompt(
    "s01", "x", "What is two plus three, and what colour is the sky? JSON.", (), "Answer", SCHEMA, "0" * 64
)


@pytest.fixture(scope="module")
def llama() -> Iterator[str]:
    """The server's base URL."""
    server = start_llama(LONGEST)
    yield f"{server.listening_address}/v1"
    del server


def client(url: str) -> OpenAIStyleClient:
    return OpenAIStyleClient(url, MODEL, "", PATIENT, RetryPolicy(1))


def test_a_schema_is_kept_to_streamed_and_in_one_piece(llama: str) -> None:
    for streams in (True, False):
        asking = client(llama)
        asking._habits = replace(asking._habits, stream=streams)
        told: list[str] = []
        reply = asking.answer(QUESTION, threading.Event(), told.append)
        answer = read_json(reply.text)
        assert set(answer) == {"answer", "colour"} and answer["colour"] in ("red", "blue")
        assert isinstance(answer["answer"], (int, float)) and asking.structure == "schema"
        assert reply.prompt_tokens > 10 and 0 < reply.completion_tokens <= LONGEST and told
        assert asking._habits.stream is streams, "nothing was refused"


def test_an_answer_over_its_limit_is_cut(llama: str) -> None:
    long = replace(QUESTION, text="Count.", schema={"type": "array", "items": {"type": "number"}, "minItems": 200})
    with pytest.raises(CutReplyError):
        client(llama).answer(long, threading.Event())


def test_a_text_model_says_that_it_takes_no_pictures(llama: str) -> None:
    with pytest.raises(ServiceError) as caught:
        client(llama).answer(replace(QUESTION, images=(PICTURE,)), threading.Event())
    assert "image" in caught.value.message and "sees pictures" in caught.value.fix
    assert caught.value.kind == "pictures", "told apart from a server in trouble, and not tried again"


def test_the_connection_test_and_the_list_know_the_model(llama: str) -> None:
    settings = ClientSettings("openai", llama, MODEL)
    assert [info.id for info in list_models(settings, threading.Event())] == [MODEL]
    report = try_connection(settings, preset("LLAMACPP"), threading.Event())
    states = {step.title: step.state for step in report.steps}
    assert states == {
        "Connection": "good",
        "Key": "good",
        "Model": "good",
        "Structured answers": "good",
        "Pictures": "bad",
    }


def test_it_stops_in_the_middle_and_the_server_answers_the_next(llama: str) -> None:
    cancel = threading.Event()

    def stop(text: str) -> None:
        if text.startswith("received"):
            cancel.set()

    long = replace(QUESTION, schema={"type": "array", "items": {"type": "number"}, "minItems": 200})
    with pytest.raises(Cancelled):
        client(llama).answer(long, cancel, stop)
    assert client(llama).answer(QUESTION, threading.Event()).text


class Blind:
    """A text model: it is asked without pictures, one question at a time, as the server answers them."""

    def __init__(self, below: OpenAIStyleClient) -> None:
        self.below, self.name, self.describes = below, below.name, below.describes
        self.lock, self.asked = threading.Lock(), 0

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        with self.lock:
            self.asked += 1
            return self.below.answer(replace(prompt, images=()), cancel, progress)


def small_room() -> Any:
    """A drawn plan of a room with a bed and a wardrobe."""
    image = Image.new("RGB", (640, 560), "white")
    pen = ImageDraw.Draw(image)
    pen.rectangle((60, 50, 580, 510), fill=(210, 180, 140), outline=(40, 40, 40), width=14)
    pen.rectangle((230, 66, 420, 290), fill=(120, 140, 190), outline=(60, 60, 60), width=2)
    pen.rectangle((90, 430, 300, 494), fill=(120, 80, 50), outline=(60, 60, 60), width=2)
    data = io.BytesIO()
    image.save(data, "PNG")
    return read_picture(data.getvalue(), "small_room.png")


def test_every_stage_ends_with_the_weakest_model(llama: str) -> None:
    blind = Blind(client(llama))
    # The artist's choice for weak models: pieces of the library. What writes programs needs a longer context.
    memory = Memory(settings={"iterations": "1", "objects": "library"})
    run = Run(small_room(), memory, FloorClient(blind), PlainBackend())
    began = time.monotonic()
    reports = run.run_all()
    print(f"{blind.asked} questions in {time.monotonic() - began:.0f} s")
    assert [report.stage for report in reports] == [stage.id for stage in all_stages()]
    assert all(run.status(stage) == "done" for stage in all_stages())
    assert blind.asked >= 8, "the model was really asked"
    assert "proxy(" in run.backend.program_text()
