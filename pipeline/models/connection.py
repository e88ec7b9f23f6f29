# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the connection to a model service with tiny questions, and names exactly what does not work.

Nothing of the artist's is sent: the picture is a red square on white that is made here. Every distinct model of the
settings is asked. One try each: what the retries of a run would hide is told.
"""

from __future__ import annotations

import io
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

from PIL import Image, ImageDraw

from ..errors import Cancelled, ModelError, ReplyError
from .addresses import is_local_url
from .base import Prompt, Reply
from .faults import ServiceError
from .http_client import HttpClient
from .listing import ModelInfo, close_names, list_models, takes_pictures
from .presets import Preset
from .registry import ClientSettings, service_client
from .retry import RetryPolicy
from .routing import TEXT
from .tolerant import read_json

State = Literal["good", "bad", "unsure", "not tried"]
SLOW = 20.0
"""Seconds for a tiny question from which on a service counts as slow."""
_LONGEST = 120.0
_STEPS = ("Connection", "Key", "Model", "Structured answers", "Pictures")
_STEP_OF = {"key": 1, "money": 1, "model": 2, "request": 2, "refusal": 2, "rate": 2, "server": 2, "size": 2}
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Step:
    """One thing that was tested."""

    title: str
    state: State = "not tried"
    text: str = ""


@dataclass(frozen=True)
class ConnectionReport:
    """What the test found.

    Attributes:
        level: "good", "unsure" (it works, but something is worth knowing) or "bad"; kind: as `ServiceError.kind`,
            "settings" or "reply", "" when all is well. sentence, fix: for the artist.
        seconds: of the first tiny question; suggestions: names of models to choose instead.
    """

    level: State
    kind: str
    sentence: str
    fix: str = ""
    model: str = ""
    seconds: float = 0.0
    steps: tuple[Step, ...] = ()
    suggestions: tuple[str, ...] = ()


def try_connection(
    settings: ClientSettings, chosen: Preset, cancel: threading.Event, progress: Progress | None = None
) -> ConnectionReport:
    """Ask every distinct model of the settings a tiny question or two. Never raises but `Cancelled`."""
    names = list(dict.fromkeys([settings.model.strip(), *(m.strip() for m in settings.models.values())]))
    first: ConnectionReport | None = None
    for name in names:
        # Every group of stages shows pictures; only what answers questions without them needs no eyes.
        groups = {group for group, model in settings.models.items() if model.strip() == name}
        eyes = name == settings.model.strip() or bool(groups - {TEXT})
        report = _Trial(replace(settings, model=name), chosen, eyes, cancel, progress or (lambda text: None)).run()
        if report.level == "bad":
            return report
        if first is None or (first.level == "good" and report.level != "good"):
            first = report
    assert first is not None
    if len(names) > 1 and first.level == "good":
        return replace(first, sentence=f"{first.sentence} All {len(names)} models answer.")
    return first


class _Trial:
    """The test of one model."""

    def __init__(
        self, settings: ClientSettings, chosen: Preset, eyes: bool, cancel: threading.Event, progress: Progress
    ) -> None:
        longest = min(_LONGEST, settings.total_timeout)
        self._settings = replace(settings, read_timeout=min(longest, settings.read_timeout), total_timeout=longest)
        self._chosen, self._eyes, self._cancel, self._progress = chosen, eyes, cancel, progress
        self._steps = [Step(title) for title in _STEPS]

    def run(self) -> ConnectionReport:
        """All questions."""
        try:
            client = service_client(self._settings, retries=RetryPolicy(tries=1))
        except ModelError as error:
            return self._report("bad", "settings", error.message, error.fix)
        self._progress(f"Asking {client.model} a tiny question")
        try:
            reply = client.answer(_WORDS, self._cancel, self._progress)
        except Cancelled:
            raise
        except ServiceError as error:
            return self._failed(error)
        except ModelError as error:
            self._reach(2)
            self._step(2, "bad", error.message)
            return self._report("bad", "reply", error.message, error.fix)
        self._reach(3)
        structured = self._structured(client, reply)
        pictures = self._pictures(client) if self._eyes else self._step(4, "not tried", "it is asked without")
        return self._verdict(client, reply, structured, pictures)

    def _structured(self, client: HttpClient, reply: Reply) -> State:
        fits = _answer_in(reply.text, "answer") is not None
        ways = {
            "schema": "kept to a schema",
            "older": "kept to a schema",
            "object": "any JSON; the shape is checked here",
        }
        text = ways.get(client.structure, "asked for in words; the shape is checked here")
        if not fits:
            return self._step(3, "bad", "the answer was no JSON of the asked-for shape")
        return self._step(3, "good" if client.structure in ("schema", "older") else "unsure", text)

    def _pictures(self, client: HttpClient) -> State:
        self._progress(f"Showing {client.model} a small test picture")
        try:
            said = takes_pictures(self._settings, self._cancel)
            if said is False:
                return self._step(4, "bad", "this model takes no pictures, says the service")
            reply = client.answer(_looking(), self._cancel, self._progress)
        except Cancelled:
            raise
        except ReplyError as error:
            return self._step(4, "unsure", error.message)
        except ServiceError as error:
            if error.kind in ("pictures", "request", "model", "shape", "server", "size"):
                return self._step(4, "bad", error.message)
            return self._step(4, "unsure", error.message)
        colour = _answer_in(reply.text, "colour")
        if isinstance(colour, str) and "red" in colour.lower():
            return self._step(4, "good", "it saw the test picture")
        return self._step(4, "bad", "it did not see what the test picture shows")

    def _verdict(self, client: HttpClient, reply: Reply, structured: State, pictures: State) -> ConnectionReport:
        name = reply.model if reply.model else client.model
        took = f"{reply.seconds:.1f} s"
        if pictures == "bad":
            what = f"{name} answers, but takes no pictures: {self._steps[4].text}."
            return self._report("bad", "pictures", what.replace("..", "."), "Choose a model that sees pictures.", reply)
        if structured == "bad":
            what = f"{name} answers in {took}, but not in the asked-for shape."
            return self._report("unsure", "structure", what, "Stages may fail; a larger model is safer.", reply)
        if reply.seconds >= SLOW:
            what = f"{name} answers, but took {reply.seconds:.0f} s for a tiny question."
            return self._report(
                "unsure", "slow", what, "A room may take long; a smaller or warm model is quicker.", reply
            )
        if pictures == "unsure":
            what = f"{name} answers in {took}, but the test picture could not be tried: {self._steps[4].text}"
            return self._report("unsure", "pictures", what, "Test again in a while.", reply)
        works = "structured answers work" if structured == "good" else "structured answers work with help"
        seen = ", and it sees pictures" if pictures == "good" else ""
        return self._report("good", "", f"{name} answers in {took}; {works}{seen}.", "", reply)

    def _failed(self, error: ServiceError) -> ConnectionReport:
        """Name the fault; the list of models helps where the address or the model's name may be wrong."""
        broken = _STEP_OF.get(error.kind, 0)
        if error.kind == "timeout" and "reached" not in error.message:
            broken = 2
        self._reach(broken)
        suggestions: tuple[str, ...] = ()
        message, fix = error.message, error.fix
        if error.kind in ("model", "request"):
            message, fix, suggestions, broken = self._about_model(error, broken)
        elif error.kind in ("refused", "name") and is_local_url(self._settings.base_url):
            fix = f"Start {self._chosen.title} and its server, and check the port in the base URL."
        elif error.kind == "shape" and self._chosen.base_url:
            fix = f"Check the base URL; {self._chosen.title} usually has {self._chosen.base_url}."
        self._step(broken, "bad", message)
        return replace(self._report("bad", error.kind, message, fix), suggestions=suggestions)

    def _about_model(self, error: ServiceError, broken: int) -> tuple[str, str, tuple[str, ...], int]:
        """Whether the address or the model's name is wrong: message, fix, suggestions, and which step failed."""
        offered: tuple[ModelInfo, ...] = ()
        wrong_place = False
        try:
            offered = list_models(self._settings, self._cancel)
        except Cancelled:
            raise
        except ServiceError as other:
            wrong_place = error.status in (404, 405) and (other.status in (404, 405) or other.kind == "shape")
        except ModelError:
            pass
        name = self._settings.model.removeprefix("models/")
        if wrong_place:
            self._steps = [Step(title) for title in _STEPS]
            usual = f"; {self._chosen.title} usually has {self._chosen.base_url}" if self._chosen.base_url else ""
            return "There is no model service at this base URL.", f"Check the base URL{usual}.", (), 0
        if offered and name not in {info.id for info in offered} and f"{name}:latest" not in {i.id for i in offered}:
            close = close_names(name, offered)
            return f"The service has no model named {name!r}.", f"It has {', '.join(close)}.", close, 2
        return error.message, error.fix, (), broken

    def _reach(self, number: int) -> None:
        """Everything before this step works."""
        for index in range(number):
            text = "none is needed" if index == 1 and not self._settings.api_key else ""
            self._step(index, "good", text)

    def _step(self, number: int, state: State, text: str = "") -> State:
        self._steps[number] = Step(_STEPS[number], state, text)
        return state

    def _report(self, level: State, kind: str, sentence: str, fix: str, reply: Reply | None = None) -> ConnectionReport:
        model = (reply.model if reply else "") or self._settings.model
        seconds = reply.seconds if reply else 0.0
        return ConnectionReport(level, kind, sentence, fix, model, seconds, tuple(self._steps))


def _schema(name: str, kind: str) -> dict[str, Any]:
    return {"type": "object", "properties": {name: {"type": kind}}, "required": [name], "additionalProperties": False}


_WORDS = Prompt(
    "connection",
    "test",
    'What is two plus three? Answer with a JSON object of one field, "answer", which is the number.',
    (),
    "Answer",
    _schema("answer", "number"),
    "",
)


def _looking() -> Prompt:
    """The question about the test picture."""
    picture = Image.new("RGB", (128, 128), "white")
    ImageDraw.Draw(picture).rectangle((32, 32, 96, 96), fill=(220, 20, 20))
    data = io.BytesIO()
    picture.save(data, "PNG")
    text = (
        'What colour is the square in the picture? Answer with a JSON object of one field, "colour", one English word.'
    )
    return Prompt("connection", "picture", text, (data.getvalue(),), "Colour", _schema("colour", "string"), "")


def _answer_in(text: str, name: str) -> Any:
    try:
        data = read_json(text)
    except ReplyError:
        return None
    return data.get(name) if isinstance(data, dict) else None
