# SPDX-License-Identifier: GPL-3.0-or-later
"""The connection test, the list of models and a whole run meet the same faults: a sentence each, and nothing is lost."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from pathlib import Path
from typing import Any

import fault_bodies
import fault_cases
import pytest
from code_as_room.pipeline.errors import ModelError, RoomError
from code_as_room.pipeline.memory import Memory, dump_memory, load_memory
from code_as_room.pipeline.models.builtin.empty import empty_value
from code_as_room.pipeline.models.connection import ConnectionReport, try_connection
from code_as_room.pipeline.models.listing import list_models
from code_as_room.pipeline.models.presets import preset
from code_as_room.pipeline.models.recorded import load_replies
from code_as_room.pipeline.models.registry import ClientSettings
from code_as_room.pipeline.models.retry import RetryPolicy
from code_as_room.pipeline.picture import load_picture
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages
from code_as_room.pipeline.stages.base import Stage
from fault_cases import Case
from fault_envelopes import CHATS, KEY, OpenAI, Vendor
from fault_server import Peer, Received
from test_fault_exchanges import clear

from benchmark.plain_backend import PlainBackend

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "bedroom"
QUICK = (
    fault_cases.statuses,
    fault_cases.errors_inside,
    fault_bodies.broken_off,
    fault_bodies.not_quite_http,
    fault_bodies.other_types,
    fault_bodies.other_values,
    fault_bodies.echoes,
)


def sampled(vendor: type[Vendor], step: int) -> Iterator[Case]:
    """Every so manyth case that ends by itself."""
    return islice((case for family in QUICK for case in family(vendor)), 0, None, step)


@pytest.mark.parametrize("vendor", CHATS, ids=lambda vendor: vendor.name)
def test_the_connection_test_and_the_list_of_models_end_with_words(vendor: type[Vendor], peer: Peer) -> None:
    kind: Any = vendor.name
    chosen = preset({"openai": "CUSTOM"}.get(vendor.name, vendor.name.upper()))

    def one(numbered: tuple[int, Case]) -> list[str]:
        number, case = numbered
        place = peer.place(f"trial-{vendor.name}-{number}", case.script)
        settings = ClientSettings(kind, f"{place.url}{vendor.base}", "some-model", KEY, read_timeout=20.0)
        report = try_connection(settings, chosen, threading.Event())
        problems = list(_unclear(report))
        try:
            listed = repr(list_models(settings, threading.Event()))
            problems += ["the key is listed"] if KEY in listed else []
        except ModelError as error:
            problems += clear(error)
        return [f"{case.family} {case.name}: {problem}" for problem in problems]

    with ThreadPoolExecutor(12) as pool:
        problems = [what for found in pool.map(one, enumerate(sampled(vendor, 9))) for what in found]
    assert not problems, "\n".join(problems)


def _unclear(report: ConnectionReport) -> Iterator[str]:
    if KEY in repr(report):
        yield "the key is shown"
    if not report.sentence.rstrip('"').endswith(".") or (report.level == "bad" and not report.fix):
        yield f"no sentence with a next step: {report.sentence!r} {report.fix!r}"
    if not any(step.state != "not tried" for step in report.steps):
        yield f"no step is named: {report.steps}"


class Service:
    """An OpenAI-style service for the sample's picture: the recorded analysis, and nothing to add to the rest."""

    def __init__(self, peer: Peer, name: str) -> None:
        self.analysis = json.dumps(load_replies(SAMPLE / "replies")["s01_analysis/01_analysis"]["reply"])
        self.broken: Any = None
        self.place = peer.place(name, self.answer)

    def answer(self, received: Received) -> None:
        if self.broken is not None:
            self.broken(received)
            return
        asked = received.body["response_format"]["json_schema"]
        text = self.analysis if asked["name"] == "AnalysisReply" else json.dumps(empty_value(asked["schema"]))
        received.reply(200, OpenAI.whole(text))


def test_a_fault_in_the_middle_of_a_run_costs_nothing_and_the_run_goes_on(peer: Peer) -> None:
    service = Service(peer, "run")
    client = OpenAI.make(service.place.url, limits=fault_cases.USUAL, retries=RetryPolicy(1))
    backend = PlainBackend()
    run = Run(load_picture(SAMPLE / "picture.png"), Memory(settings={"rounds": "1"}), client, backend)
    stages = [stage for stage in all_stages() if stage.id <= "s03_layout"]
    for stage in stages:
        run.run_stage(stage)
        before, standing = dump_memory(run.memory), backend.program_text()
        for case in sampled(OpenAI, 60 if stage.id == "s02_graph" else 250):
            if case.may != fault_cases.ERROR:
                continue
            service.broken = case.script
            with pytest.raises(RoomError) as caught:
                redo(run, stage)
            assert not list(clear(caught.value)), case.name
            assert dump_memory(run.memory) == before and backend.program_text() == standing
        service.broken = None
        redo(run, stage)
        assert run.status(stage) == "done"
    text = backend.load_memory()
    assert KEY not in text and dump_memory(load_memory(text)) == text


def redo(run: Run, stage: Stage) -> None:
    """A stage once more, everything asked anew; what stood stands again where it fails."""
    try:
        session = run.begin(stage, fresh=True)
        while not session.finished:
            session.step()
    except RoomError:
        run.put_back()
        raise
