# SPDX-License-Identifier: GPL-3.0-or-later
"""Performing a stage's requests: validation, the repair round, side by side, keeping what was paid for."""

import json
import threading
import time

import pytest
from code_as_room.pipeline import prompting
from code_as_room.pipeline.ask import MOST_SIDE_BY_SIDE, perform_ask
from code_as_room.pipeline.errors import Cancelled, CutReplyError, ModelError, ReplyError, RoomError
from code_as_room.pipeline.models.base import Reply
from code_as_room.pipeline.stages.wishes import Ask, Picture, Request
from pydantic import BaseModel, ConfigDict


class Item(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    id: str
    size: tuple[float, float]


class Answer(BaseModel):
    items: list[Item]


GOOD = json.dumps({"items": [{"id": "a", "size": [1, 2]}]})
BAD = json.dumps({"items": [{"id": "a", "size": [1]}]})


class Oracle:
    """A client whose answers are given by a function of the prompt; remembers every prompt."""

    name = "oracle"
    describes = "An oracle"

    def __init__(self, answer):
        self._answer = answer
        self.prompts = []
        self._lock = threading.Lock()

    def answer(self, prompt, cancel, progress=None):
        with self._lock:
            self.prompts.append(prompt)
        if progress:
            progress("thinking")
        given = self._answer(prompt, cancel)
        if isinstance(given, Exception):
            raise given
        return Reply(given, "oracle-1", 10, 20, 0.5, notes=("from the oracle",))


@pytest.fixture(autouse=True)
def template(monkeypatch):
    monkeypatch.setattr(prompting, "load_template", lambda name: f"{name}: look for {{{{what}}}}.")


def request(key, what="beds", **extra):
    return Request(key, "template", Answer, {"what": what}, **extra)


def run(client, *keys, cancel=None, **callbacks):
    return perform_ask(
        Ask(tuple(request(key) for key in keys)), "s01", client, cancel or threading.Event(), **callbacks
    )


def test_a_good_answer_comes_back_validated_with_what_it_took():
    client = Oracle(lambda prompt, cancel: GOOD)
    wish = Ask((request("one", images=(Picture("reference", b"\x89PNG"),), facts={"x": 1}),))
    [result] = perform_ask(wish, "s01", client, threading.Event())
    assert result.reply == Answer(items=[Item(id="a", size=(1, 2))])
    assert (result.key, result.model, result.prompt_tokens, result.completion_tokens) == ("one", "oracle-1", 10, 20)
    assert (result.cost, result.tries, result.notes) == (0.5, 1, ("from the oracle",))
    [prompt] = client.prompts
    assert prompt.text == "template: look for beds." and prompt.images == (b"\x89PNG",) and prompt.facts == {"x": 1}
    assert prompt.schema["properties"]["items"] and prompt.schema_name == "Answer" and not prompt.repair
    assert result.prompt_bytes == len(prompt.text) and result.prompt_hash == prompt.hash


def test_corrections_are_reported():
    [result] = run(Oracle(lambda prompt, cancel: '{"items": {"id": "a", "size": ["1", 2]},}'), "one")
    assert result.reply.items[0].size == (1.0, 2.0)
    assert len(result.notes) == 4 and result.tries == 1


def test_the_repair_round_quotes_the_errors_and_the_answer():
    client = Oracle(lambda prompt, cancel: GOOD if prompt.repair else BAD)
    [result] = run(client, "one")
    assert result.tries == 2 and result.cost == 1.0 and result.prompt_tokens == 20
    first, second = client.prompts
    assert second.repair and second.text.startswith(first.text) and BAD in second.text
    assert "items[0].size" in second.text
    assert result.prompt_hash == first.hash
    assert any("first answer" in note for note in result.notes)


def test_there_is_only_one_repair_round():
    client = Oracle(lambda prompt, cancel: BAD)
    with pytest.raises(ReplyError) as caught:
        run(client, "one")
    assert len(client.prompts) == 2
    assert "items[0].size" in caught.value.problems[0]


def test_after_the_repair_round_single_bad_entries_are_left_out():
    items = [{"id": f"i{n}", "size": [1, 2]} for n in range(8)]
    items[2]["size"] = None
    [result] = run(Oracle(lambda prompt, cancel: json.dumps({"items": items})), "one")
    assert [item.id for item in result.reply.items] == ["i0", "i1", "i3", "i4", "i5", "i6", "i7"]
    assert any("i2" in note for note in result.notes) and result.tries == 2


def test_a_failing_repair_falls_back_on_what_is_usable_of_the_first_answer():
    items = [{"id": f"i{n}", "size": [1, 2]} for n in range(8)]
    items[2]["size"] = None
    first = json.dumps({"items": items})
    [result] = run(Oracle(lambda prompt, cancel: "Sorry." if prompt.repair else first), "one")
    assert len(result.reply.items) == 7


def test_a_cut_answer_gets_one_more_try_and_stays_a_cut_answer():
    client = Oracle(lambda prompt, cancel: GOOD[:-4])
    with pytest.raises(CutReplyError):
        run(client, "one")
    assert len(client.prompts) == 2


def test_a_failing_service_is_not_asked_again():
    client = Oracle(lambda prompt, cancel: ModelError("No credit.", "Buy some."))
    with pytest.raises(ModelError, match="No credit"):
        run(client, "one")
    assert len(client.prompts) == 1


def test_requests_run_side_by_side_but_not_too_many_and_keep_their_order():
    here, most, lock = 0, 0, threading.Lock()
    together = threading.Barrier(MOST_SIDE_BY_SIDE)

    def answer(prompt, cancel):
        nonlocal here, most
        with lock:
            here += 1
            most = max(most, here)
        together.wait(10)
        with lock:
            here -= 1
        return GOOD.replace('"a"', json.dumps(prompt.key))

    keys = [f"k{n}" for n in range(2 * MOST_SIDE_BY_SIDE)]
    results = run(Oracle(answer), *keys)
    assert [result.key for result in results] == keys
    assert [result.reply.items[0].id for result in results] == keys
    assert most == MOST_SIDE_BY_SIDE


def test_when_one_answer_is_unusable_the_others_are_kept():
    kept = []
    client = Oracle(lambda prompt, cancel: BAD if prompt.key == "b" else GOOD)
    with pytest.raises(ReplyError):
        run(client, "a", "b", "c", "d", "e", "f", keep=kept.append)
    assert sorted(result.key for result in kept) == ["a", "c", "d", "e", "f"]


def test_a_failing_service_gets_no_further_requests_but_running_ones_are_kept():
    kept, failed, begun = [], threading.Event(), threading.Barrier(MOST_SIDE_BY_SIDE)

    def answer(prompt, cancel):
        begun.wait(10)
        if prompt.key == "k1":
            failed.set()
            return ModelError("No credit.")
        failed.wait(10)
        time.sleep(0.2)
        return GOOD

    client = Oracle(answer)
    with pytest.raises(ModelError, match="No credit"):
        run(client, *[f"k{n}" for n in range(20)], keep=kept.append)
    assert {result.key for result in kept} == {"k0", "k2", "k3"}
    assert len(client.prompts) == 4


def test_earlier_answers_are_used_again_and_nothing_is_asked_twice():
    seen = {}
    first = Oracle(lambda prompt, cancel: GOOD)
    run(first, "a", "b", keep=lambda result: seen.setdefault(result.prompt_hash, Reply(result.text, result.model)))
    events = []
    second = Oracle(lambda prompt, cancel: GOOD)
    results = run(second, "a", "b", recall=lambda prompt: seen.get(prompt.hash), on_event=events.append)
    assert second.prompts == [] and [result.tries for result in results] == [0, 0]
    assert [event.kind for event in events] == ["recalled", "recalled"]
    assert results[0].reply.items


def test_an_earlier_answer_that_fits_no_more_is_asked_for_anew():
    client = Oracle(lambda prompt, cancel: GOOD)
    [result] = run(client, "a", recall=lambda prompt: Reply(BAD, "old"))
    assert result.tries == 1


def test_events_and_keep_come_on_the_calling_thread():
    threads, kinds = set(), []

    def note(event):
        threads.add(threading.current_thread())
        kinds.append(event.kind)

    run(
        Oracle(lambda prompt, cancel: GOOD),
        "a",
        on_event=note,
        keep=lambda result: threads.add(threading.current_thread()),
    )
    assert threads == {threading.current_thread()}
    assert kinds == ["asked", "progress", "answered"]


def test_stopping_keeps_what_has_arrived():
    kept, cancel = [], threading.Event()

    def answer(prompt, stop):
        if prompt.key == "quick":
            return GOOD
        stop.wait(10)
        return Cancelled()

    def keep(result):
        kept.append(result.key)
        cancel.set()

    with pytest.raises(Cancelled):
        run(Oracle(answer), "slow", "quick", cancel=cancel, keep=keep)
    assert kept == ["quick"]


def test_a_client_that_does_not_notice_the_stop_is_left_behind():
    cancel, leave = threading.Event(), threading.Event()
    client = Oracle(lambda prompt, stop: leave.wait(30) and GOOD)
    threading.Timer(0.1, cancel.set).start()
    try:
        with pytest.raises(Cancelled):
            run(client, "a", cancel=cancel)
        assert not leave.is_set()
    finally:
        leave.set()


def test_a_bug_in_a_client_reaches_the_artist_as_a_plain_error():
    with pytest.raises(ModelError, match="ZeroDivisionError"):
        run(Oracle(lambda prompt, cancel: str(1 // 0)), "a")


def test_values_that_do_not_fit_the_template_stop_before_anything_is_sent():
    client = Oracle(lambda prompt, cancel: GOOD)
    wish = Ask((request("a"), Request("b", "template", Answer, {"other": "x"})))
    with pytest.raises(RoomError):
        perform_ask(wish, "s01", client, threading.Event())
    assert client.prompts == []


def test_an_overlong_prompt_is_reported():
    client = Oracle(lambda prompt, cancel: GOOD)
    [result] = perform_ask(Ask((request("a", what="x" * 50_000),)), "s01", client, threading.Event())
    assert any("50 kB" in note for note in result.notes)


def test_an_empty_ask_gives_nothing():
    assert run(Oracle(lambda prompt, cancel: GOOD)) == []
