# SPDX-License-Identifier: GPL-3.0-or-later
"""How many requests a service is sent side by side, against a real peer on loopback and with a clock of our own."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from code_as_room.pipeline.errors import Cancelled, ModelError
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from code_as_room.pipeline.models.pace import Pace
from code_as_room.pipeline.models.registry import ClientSettings, make_client, settings_from_environment
from code_as_room.pipeline.models.retry import RetryPolicy

QUICK = RetryPolicy(tries=6, first_pause=0.01, longest_pause=0.02)


class Clock:
    now = 100.0

    def __call__(self):
        return self.now


def side_by_side(client, prompt, count, cancel=None):
    with ThreadPoolExecutor(count) as pool:
        futures = [
            pool.submit(client.answer, replace(prompt, key=str(n)), cancel or threading.Event()) for n in range(count)
        ]
    return futures


def test_no_more_are_under_way_than_allowed(peer, wire, a_prompt):
    most = 0

    def script(received):
        nonlocal most
        most = max(most, peer.open_now)
        wire.stream(received, '{"a": 1}')

    peer.script = script
    client = OpenAIStyleClient(peer.url, "m", pace=Pace(2))
    assert all(f.result().text == '{"a": 1}' for f in side_by_side(client, a_prompt, 8))
    assert most <= 2 and len(peer.received) == 8


def test_being_asked_too_often_halves_it_once_for_all_that_were_under_way(peer, wire, a_prompt):
    together, all_told, allowed = threading.Barrier(4), threading.Event(), []

    def script(received):
        if received.number < 4:
            together.wait(5)
            received.reply(429, {"error": {"message": "slow down"}})
        else:
            # An answer makes it more again, so none comes before the last of the four has heard.
            all_told.wait(5)
            wire.stream(received, '{"a": 1}')

    peer.script = script
    pace = Pace(4)
    client = OpenAIStyleClient(peer.url, "m", retries=QUICK, pace=pace)
    told = pace.too_often

    def note(*args):
        told(*args)
        allowed.append(pace.allowed)
        if len(allowed) == 4:
            all_told.set()

    pace.too_often = note
    assert all(f.result() for f in side_by_side(client, a_prompt, 4))
    assert allowed == [2, 2, 2, 2] and len(peer.received) == 8


def test_it_recovers_slowly_and_never_beyond_what_is_set():
    pace = Pace(4, Clock())
    pace.too_often(began=99.0)
    pace.too_often(began=101.0)
    assert pace.allowed == 1
    allowed = []
    for _ in range(20):
        pace.went_well()
        allowed.append(pace.allowed)
    assert allowed[0] == 2 and allowed[1] == 2 and allowed[2] == 3 and allowed[-1] == 4


def test_nothing_new_is_sent_before_the_service_may_be_asked_again():
    clock = Clock()
    pace = Pace(4, clock)
    pace.too_often(began=clock(), after=30.0)
    cancel, told = threading.Event(), []
    waiting = ThreadPoolExecutor(1)

    def wait():
        with pace.turn(cancel, told.append):
            return "sent"

    future = waiting.submit(wait)
    with pytest.raises(TimeoutError):
        future.result(0.3)
    assert told == ["waiting for its turn"]
    clock.now += 31.0
    assert future.result(5) == "sent"
    clock.now -= 31.0
    future = waiting.submit(wait)
    cancel.set()
    with pytest.raises(Cancelled):
        future.result(5)
    waiting.shutdown()


def test_what_the_service_refuses_for_all_is_not_sent_by_those_that_wait():
    pace = Pace(1)
    entered, go_on = threading.Event(), threading.Event()

    def hold():
        with pace.turn(threading.Event()):
            entered.set()
            go_on.wait(5)
            pace.refused(ModelError("No credit."))

    with ThreadPoolExecutor(2) as pool:
        pool.submit(hold)
        entered.wait(5)
        told = threading.Event()

        def wait():
            with pace.turn(threading.Event(), lambda text: told.set()):
                return "sent"

        waits = pool.submit(wait)
        assert told.wait(5)
        go_on.set()
        with pytest.raises(ModelError, match="No credit"):
            waits.result(5)
    with pace.turn(threading.Event()):
        pass  # a new question is asked again: the artist may have mended it


def test_models_of_one_service_share_a_pace_and_a_computer_of_ones_own_gets_one_at_a_time():
    there = ClientSettings("openai", "https://api.example.com/v1", "m", models={"seeing": "n"})
    client = make_client(there)
    assert client.client_for("s01_a").pace is client.client_for("s02_b").pace
    assert client.main.pace.allowed == 4
    assert make_client(replace(there, base_url="http://192.168.1.5:1234/v1", models={})).pace.allowed == 1
    assert make_client(replace(there, base_url="http://localhost:1234/v1", models={}, at_once=3)).pace.allowed == 3
    told = {"CODE_AS_ROOM_PROVIDER": "vllm", "CODE_AS_ROOM_MODEL": "m"}
    assert make_client(settings_from_environment(told)).pace.allowed == 4
    assert make_client(settings_from_environment({**told, "CODE_AS_ROOM_AT_ONCE": "2"})).pace.allowed == 2
    with pytest.raises(ModelError, match="AT_ONCE"):
        settings_from_environment({**told, "CODE_AS_ROOM_AT_ONCE": "many"})
