# SPDX-License-Identifier: GPL-3.0-or-later
"""The connection test names exactly what does not work, and the list of models is read in every service's shape."""

import json
import socket
import threading
import time

import pytest
from code_as_room.pipeline.errors import Cancelled
from code_as_room.pipeline.models import connection
from code_as_room.pipeline.models.connection import try_connection
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.listing import close_names, list_models
from code_as_room.pipeline.models.presets import preset
from code_as_room.pipeline.models.registry import ClientSettings

KEY = "sk-test-0123456789abcdef"
MODELS = {"object": "list", "data": [{"id": name} for name in ("qwen-vl-8b", "qwen-vl-30b", "other")]}

pytestmark = pytest.mark.usefixtures("no_threads_left")


def settings_for(peer, model="qwen-vl-8b", kind="openai", **more):
    base = "" if kind == "ollama" else "/v1"
    return ClientSettings(kind=kind, base_url=f"http://127.0.0.1:{peer.port}{base}", model=model, api_key=KEY, **more)


def tried(settings, provider="CUSTOM", cancel=None):
    report = try_connection(settings, preset(provider), cancel or threading.Event())
    assert report.sentence and KEY not in repr(report)
    assert (report.level == "good") or report.fix
    return report


def states(report):
    return {step.title: step.state for step in report.steps}


def has_picture(received):
    return "image_url" in json.dumps(received.body) or "images" in json.dumps(received.body)


def service(wire, answers=None, pictures=None, models=MODELS):
    """A service; `answers` and `pictures` are (status, body) instead of a good answer."""

    def script(received):
        if received.line.startswith("GET"):
            received.reply(*((200, models) if models is not None else (404, {"error": "not found"})))
        elif has_picture(received):
            received.reply(*(pictures or (200, wire.chat('{"colour": "Red"}'))))
        else:
            received.reply(*(answers or (200, wire.chat('{"answer": 5}'))))

    return script


def test_when_all_is_well_it_says_model_time_structure_and_pictures(peer, wire):
    peer.script = service(wire)
    report = tried(settings_for(peer))
    assert report.level == "good" and report.kind == "" and set(states(report).values()) == {"good"}
    assert "served-model" in report.sentence and " s;" in report.sentence and "sees pictures" in report.sentence


def error(message, code=""):
    return {"error": {"message": message, "code": code}}


@pytest.mark.parametrize(
    "status, body, kind, step, words",
    [
        (401, error(f"Incorrect API key provided: {KEY}"), "key", "Key", "does not accept the API key"),
        (403, error("Country not supported"), "key", "Key", "does not allow"),
        (402, error("Insufficient credits"), "money", "Key", "no credit"),
        (429, error("You exceeded your current quota", "insufficient_quota"), "money", "Key", "no credit"),
        (429, error("Rate limit reached"), "rate", "Model", "asked too often"),
        (500, error("boom"), "server", "Model", "boom"),
        (503, error("Loading model"), "server", "Model", "Loading model"),
        (400, error("max_tokens is required"), "request", "Model", "max_tokens is required"),
        (200, b"<html><title>Sign in</title></html>", "shape", "Connection", "web page"),
        (200, {"hello": 1}, "shape", "Connection", "not a chat reply"),
    ],
)
def test_each_fault_is_named_at_its_step(peer, wire, status, body, kind, step, words):
    peer.script = service(wire, (status, body))
    report = tried(settings_for(peer))
    assert (report.level, report.kind) == ("bad", kind) and words in report.sentence
    assert [title for title, state in states(report).items() if state == "bad"] == [step]
    asked = [received for received in peer.received if received.line.startswith("POST")]
    assert len(asked) == 1, "a test tries once"


def test_a_model_that_is_not_there_brings_suggestions(peer, wire):
    peer.script = service(wire, (404, error("The model does not exist", "model_not_found")))
    report = tried(settings_for(peer, "qwen-vl"))
    assert "no model named 'qwen-vl'" in report.sentence and set(report.suggestions) == {"qwen-vl-8b", "qwen-vl-30b"}
    assert states(report)["Model"] == "bad" and states(report)["Key"] == "good"


def test_a_wrong_address_is_told_apart_from_a_wrong_model(peer, wire):
    peer.script = service(wire, (404, error("Not Found")), models=None)
    report = tried(settings_for(peer), "OPENROUTER")
    assert "no model service at this base URL" in report.sentence and "https://openrouter.ai/api/v1" in report.fix
    assert states(report)["Connection"] == "bad"
    peer.script = service(wire, (404, error("Not allowed for this model")))
    assert "Not allowed for this model" in tried(settings_for(peer)).sentence


def test_nothing_there_and_no_such_name_say_so():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    report = tried(ClientSettings(kind="openai", base_url=f"http://127.0.0.1:{port}/v1", model="m"), "LMSTUDIO")
    assert report.kind == "refused" and "nothing answers" in report.sentence and "Start LM Studio" in report.fix
    report = tried(ClientSettings(kind="openai", base_url="http://no-such-host.invalid/v1", model="m"))
    assert report.kind in ("name", "proxy") and states(report)["Connection"] == "bad"


def test_silence_is_told_as_a_time_out(peer):
    leave = threading.Event()
    peer.script = lambda received: leave.wait(10)
    report = tried(settings_for(peer, read_timeout=0.3))
    leave.set()
    assert report.kind == "timeout" and "silent for 0.3 s" in report.sentence


def test_incomplete_settings_are_told_without_asking_anyone(peer):
    assert tried(settings_for(peer, "")).kind == "settings" and peer.received == []


def test_a_model_without_eyes_is_found(peer, wire):
    peer.script = service(wire, pictures=(400, error("This model does not support image input")))
    report = tried(settings_for(peer))
    assert (report.level, report.kind) == ("bad", "pictures") and "does not support image input" in report.sentence
    peer.script = service(wire, pictures=(200, wire.chat('{"colour": "blue"}')))
    assert tried(settings_for(peer)).kind == "pictures"


def test_a_model_without_eyes_may_answer_what_has_no_pictures(peer, wire):
    def script(received):
        if has_picture(received) and received.body["model"] == "blind":
            received.reply(400, error("no images"))
        else:
            service(wire)(received)

    peer.script = script
    report = tried(settings_for(peer, models={"text": "blind"}))
    assert report.level == "good" and "2 models" in report.sentence
    # Every group of stages shows pictures.
    for group in ("seeing", "layout", "modelling", "surfaces"):
        assert tried(settings_for(peer, models={group: "blind"})).kind == "pictures"


def test_what_ollama_says_of_a_model_is_believed(peer):
    def script(received):
        if "/api/show" in received.line:
            received.reply(200, {"capabilities": ["completion"]})
        else:
            message = {"role": "assistant", "content": '{"answer": 5}'}
            received.reply(200, {"model": "m", "message": message, "done": True, "done_reason": "stop"})

    peer.script = script
    report = tried(settings_for(peer, kind="ollama"), "OLLAMA")
    assert report.kind == "pictures" and "says the service" in report.sentence


def test_structured_answers_are_told_as_they_are(peer, wire):
    def no_schema(received):
        if "response_format" in received.body:
            received.reply(400, error("response_format is not supported"))
        else:
            service(wire)(received)

    peer.script = no_schema
    report = tried(settings_for(peer))
    assert report.level == "good" and states(report)["Structured answers"] == "unsure"
    peer.script = service(wire, (200, wire.chat("Five, of course!")))
    report = tried(settings_for(peer))
    assert (report.level, report.kind) == ("unsure", "structure")


def test_a_slow_service_is_told(peer, wire, monkeypatch):
    monkeypatch.setattr(connection, "SLOW", 0.0)
    peer.script = service(wire)
    report = tried(settings_for(peer))
    assert (report.level, report.kind) == ("unsure", "slow") and "took" in report.sentence


def test_the_test_can_be_stopped(peer):
    leave, cancel = threading.Event(), threading.Event()
    peer.script = lambda received: leave.wait(10)
    threading.Timer(0.2, cancel.set).start()
    began = time.monotonic()
    with pytest.raises(Cancelled):
        tried(settings_for(peer), cancel=cancel)
    assert time.monotonic() - began < 3
    leave.set()


def test_nothing_of_the_artists_is_sent(peer, wire):
    peer.script = service(wire)
    tried(settings_for(peer))
    assert max(len(json.dumps(received.body)) for received in peer.received) < 3000


# Lists of models ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "kind, data, expected",
    [
        ("openai", MODELS, ["other", "qwen-vl-30b", "qwen-vl-8b"]),
        ("openai", [{"id": "together/a"}], ["together/a"]),
        (
            "anthropic",
            {"data": [{"type": "model", "id": "claude-x", "display_name": "X"}], "has_more": False},
            ["claude-x"],
        ),
        (
            "gemini",
            {
                "models": [
                    {"name": "models/gemini-x", "supportedGenerationMethods": ["generateContent"]},
                    {"name": "models/embed", "supportedGenerationMethods": ["embedContent"]},
                ]
            },
            ["gemini-x"],
        ),
        ("ollama", {"models": [{"name": "llava:7b", "model": "llava:7b", "size": 1}]}, ["llava:7b"]),
    ],
)
def test_lists_are_read_in_every_shape(peer, kind, data, expected):
    peer.script = lambda received: received.reply(200, data)
    assert [info.id for info in list_models(settings_for(peer, "", kind), threading.Event())] == expected
    [received] = peer.received
    assert received.line.startswith("GET ") and KEY in str(received.headers) and KEY not in received.line


def test_prices_and_eyes_are_read_where_the_service_tells_them(peer):
    rows = [
        {
            "id": "a/blind",
            "architecture": {"input_modalities": ["text"]},
            "pricing": {"prompt": "0", "completion": "0"},
        },
        {
            "id": "b/eyes",
            "architecture": {"input_modalities": ["text", "image"]},
            "pricing": {"prompt": "0.000002", "completion": "0.00001"},
        },
        {"id": "c/odd", "architecture": 3, "pricing": {"prompt": "-1", "completion": "x"}},
    ]
    peer.script = lambda received: received.reply(200, {"data": rows})
    eyes, odd, blind = list_models(settings_for(peer), threading.Event())
    assert (eyes.id, eyes.pictures, eyes.price.input, eyes.price.output) == ("b/eyes", True, 2.0, 10.0)
    assert (odd.id, odd.pictures, odd.price) == ("c/odd", None, None)
    assert blind.pictures is False and blind.price.is_free and "no pictures" in blind.hint()


@pytest.mark.parametrize(
    "status, body, kind",
    [
        (404, {}, "model"),
        (401, {}, "key"),
        (200, b"<html>", "shape"),
        (200, {"data": []}, "shape"),
        (200, b"7", "shape"),
    ],
)
def test_a_service_without_a_list_says_so(peer, status, body, kind):
    peer.script = lambda received: received.reply(status, body)
    with pytest.raises(ServiceError) as caught:
        list_models(settings_for(peer), threading.Event())
    assert caught.value.kind == kind and caught.value.fix


def test_a_list_of_nonsense_brings_no_nonsense(peer):
    rows = [
        None,
        3,
        {},
        {"id": 5},
        {"id": ""},
        {"id": "x" * 999},
        {"id": "line\nbreak"},
        {"id": f"echo-{KEY}"},
        {"id": "good"},
    ]
    peer.script = lambda received: received.reply(200, {"data": rows})
    assert [info.id for info in list_models(settings_for(peer), threading.Event())] == ["good"]


def test_suggestions_are_alike_or_at_least_something(peer):
    from code_as_room.pipeline.models.listing import ModelInfo

    offered = [ModelInfo("gpt-5"), ModelInfo("gpt-5-mini"), ModelInfo("blind-gpt-5", pictures=False)]
    assert close_names("gpt5", offered)[0] == "gpt-5" and "blind-gpt-5" not in close_names("gpt-5", offered)
    assert close_names("zzz", offered) == ("gpt-5", "gpt-5-mini")
