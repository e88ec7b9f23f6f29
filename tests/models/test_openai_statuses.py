# SPDX-License-Identifier: GPL-3.0-or-later
"""What the OpenAI-style client makes of each status: tried again, told at once, never tried again where it is money."""

import json
import threading

import pytest
from code_as_room.pipeline.models.exchange import Limits
from code_as_room.pipeline.models.faults import ServiceError, provider_sentence, redact, retry_after
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from code_as_room.pipeline.models.retry import RetryPolicy

KEY = "sk-test-0123456789abcdef"
QUICK = RetryPolicy(tries=3, first_pause=0.001)

pytestmark = pytest.mark.usefixtures("no_threads_left")


@pytest.fixture
def ask(peer, a_prompt):
    client = OpenAIStyleClient(peer.url, "some-model", KEY, Limits(total=20.0), QUICK)
    return lambda progress=None: client.answer(a_prompt, threading.Event(), progress)


@pytest.mark.parametrize("status", [408, 429, 500, 502, 503, 504, 529])
def test_what_may_pass_is_tried_again(peer, ask, wire, status):
    def script(received):
        if received.number < 2:
            received.reply(status, {"error": {"message": "busy"}})
        else:
            wire.stream(received, "{}")

    peer.script = script
    assert ask().text == "{}"
    assert len(peer.received) == 3


@pytest.mark.parametrize("status", [408, 429, 500, 502, 503, 504, 529])
def test_tries_are_limited_and_the_services_sentence_is_shown(peer, ask, status):
    peer.script = lambda received: received.reply(status, {"error": {"message": "we are busy"}})
    with pytest.raises(ServiceError, match="we are busy") as caught:
        ask()
    assert len(peer.received) == QUICK.tries
    assert caught.value.status == status and caught.value.fix


@pytest.mark.parametrize(
    "status, kind",
    [
        (400, "request"),
        (401, "key"),
        (402, "money"),
        (403, "key"),
        (404, "model"),
        (405, "model"),
        (413, "size"),
        (418, "request"),
        (422, "request"),
        (501, "request"),
    ],
)
def test_refusals_are_shown_at_once_and_not_tried_again(peer, ask, status, kind):
    peer.script = lambda received: received.reply(status, {"error": {"message": f"no, since {KEY} is odd"}})
    with pytest.raises(ServiceError, match="no, since") as caught:
        ask()
    assert len(peer.received) == 1
    assert caught.value.kind == kind and caught.value.fix
    assert KEY not in str(caught.value)


@pytest.mark.parametrize(
    "status, error",
    [
        (429, {"message": "You exceeded your current quota, please check your plan", "code": "insufficient_quota"}),
        (429, {"message": "limit", "type": "insufficient_quota"}),
        (403, {"message": "Your credit balance is too low"}),
        (400, {"message": "You have reached your specified API usage limits: spend limit"}),
        (402, {"message": "Insufficient Balance"}),
        (200, {"message": "Not enough credits", "code": 402}),
    ],
)
def test_money_is_never_tried_again(peer, ask, status, error):
    peer.script = lambda received: received.reply(status, {"error": error})
    with pytest.raises(ServiceError) as caught:
        ask()
    assert len(peer.received) == 1 and caught.value.kind == "money"


def test_a_longer_wait_than_our_patience_is_told_not_waited_for(peer, ask):
    peer.script = lambda received: received.reply(429, {"error": "slow down"}, {"Retry-After": "3600"})
    with pytest.raises(ServiceError, match="3600 s"):
        ask()
    assert len(peer.received) == 1


def test_the_asked_for_wait_is_a_minimum():
    assert retry_after("7") == 7 and retry_after("0.5") == 0.5
    assert retry_after(None) == retry_after("soon") == retry_after("-3") == retry_after("nan") == 0
    assert retry_after("Wed, 21 Oct 2015 07:28:00 GMT") == 0
    assert retry_after("Fri, 31 Dec 2999 23:59:59 GMT") == 86_400


def test_the_retry_waits_at_least_as_long_as_asked(monkeypatch):
    from code_as_room.pipeline.models import retry
    from code_as_room.pipeline.models.faults import Fault

    waited = []

    class Clock(threading.Event):
        def wait(self, timeout=None):
            waited.append(timeout)
            return False

    faults = [Fault(ServiceError("busy"), retry=True, after=after) for after in (5.0, 0.0)]

    def attempt():
        if faults:
            raise faults.pop(0)
        return "done"

    assert retry.with_retries(attempt, RetryPolicy(first_pause=1.0), float("inf"), Clock()) == "done"
    assert waited[0] == 5.0 and 1.0 <= waited[1] <= 3.0


@pytest.mark.parametrize(
    "body, expected",
    [
        ({"error": {"message": "one", "code": "x"}}, "one"),
        ({"error": "two"}, "two"),
        ({"message": "three"}, "three"),
        ({"detail": [{"loc": ["body"], "msg": "four"}]}, "four"),
        ([{"error": {"message": "five"}}], "five"),
        ({"error": {"message": "Provider error", "metadata": {"raw": "six"}}}, "Provider error: six"),
        (b"<html><head><title>502 Bad\nGateway</title></head></html>", "502 Bad Gateway"),
        (b"plain words", "plain words"),
        (b"\xff\x00\x01", "\ufffd"),
        (b"", ""),
        ({"other": 1}, ""),
        ({"error": {"message": "long " * 1000}}, None),
    ],
)
def test_the_services_sentence_is_found_in_any_shape(body, expected):
    data = body if isinstance(body, bytes) else json.dumps(body).encode()
    sentence = provider_sentence(data, KEY)
    assert len(sentence) <= 400
    assert expected is None or sentence == expected


@pytest.mark.parametrize(
    "text", [KEY, f"Bearer {KEY}", "sk-test-************cdef", "bearer abc.def", "sk-otherkey12345678"]
)
def test_keys_are_redacted_in_every_shape(text):
    told = redact(f"Incorrect API key provided: {text}, see the site", KEY)
    assert text not in told and "cdef" not in told and told.endswith("see the site")
