# SPDX-License-Identifier: GPL-3.0-or-later
"""Performs a stage's `Ask`: requests side by side, each validated, each with one repair round."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Literal

from pydantic import BaseModel

from .ask_plain import plain_reply, without_thoughts
from .ask_shared import mark_shared
from .ask_talk import TALK
from .errors import Cancelled, ModelError, NotRecordedError, ReplyError, RoomError
from .journal import KeptReply
from .models.base import ModelClient, Prompt, Reply, name_of
from .models.coordinates import as_asked
from .models.sight import sizes_seen
from .models.validate import validate_reply
from .prompting import PROMPT_LIMIT, make_prompt, repair_prompt
from .stages.wishes import Ask, Request

MOST_SIDE_BY_SIDE = 4
"""Requests that are begun at the same time; a client may let fewer of them through."""
_OWN_FAILURES = (ReplyError, NotRecordedError)
"""What concerns one request only."""
_PATIENCE = 2.0
"""Seconds that a stopped run waits for clients to notice, before it leaves them behind."""


@dataclass(frozen=True)
class AskResult:
    """One request's validated answer and what it took.

    Attributes:
        key: the request's key; reply: the validated answer; text: the answer as the model wrote it.
        model, prompt_tokens, completion_tokens, cost (US dollars or None), seconds: sums over all tries.
        notes: sentences for the report: what was forgiven, corrected, drifted, left out.
        prompt_bytes: bytes of prompt text sent, all tries; prompt_hash: of the first try's prompt.
        tries: calls of the client that were sent; 0 when the answer was recalled.
    """

    key: str
    reply: BaseModel
    text: str
    model: str
    prompt_tokens: int
    completion_tokens: int
    cost: float | None
    seconds: float
    notes: tuple[str, ...]
    prompt_bytes: int
    prompt_hash: str
    tries: int


@dataclass(frozen=True)
class AskEvent:
    """Something worth showing while requests run; `text` is for the artist.

    Of the kind "heard" it is all of a plain text that has arrived so far; each one may replace those before it.
    """

    key: str
    kind: Literal["asked", "progress", "repair", "answered", "recalled", "failed", "heard"]
    text: str


Recall = Callable[[Prompt], Reply | None]
Keep = Callable[[AskResult], None]
Refuse = Callable[[str], None]
OnEvent = Callable[[AskEvent], None]


def perform_ask(
    ask: Ask,
    stage: str,
    client: ModelClient,
    cancel: threading.Event,
    recall: Recall | None = None,
    keep: Keep | None = None,
    on_event: OnEvent | None = None,
    refuse: Refuse | None = None,
    room: str = "",
) -> list[AskResult | None]:
    """Answer every request, at most four at a time, and return the results in the order of the requests.

    With `ask.optional`, a request without a usable answer gives None, and others are not kept from being sent.

    `recall`, `keep`, `refuse` and `on_event` are called on the calling thread only. When one request fails, the others that are
    already running are let finish and handed to `keep` before the error is raised; those not begun are not sent.

    Args:
        recall: gives an earlier answer to the same prompt (same hash), so that nothing is paid for twice.
        keep: is handed each answer as soon as it is validated.
        refuse: is handed the key of each request whose answers stayed unusable.
        room: hash of the room's picture, under which prompts and answers are noted for the artist to look at.

    Raises:
        ReplyError: an answer stayed unusable after the repair round.
        ModelError: the service failed or refused.
        Cancelled: `cancel` was set; answers that had arrived were kept.
        RoomError: a prompt template does not fit its values.
    """
    prompts = [make_prompt(request, stage) for request in ask.requests]
    for prompt in prompts:
        TALK.note_prompt(room, prompt)
    tell = on_event or (lambda event: None)
    results: dict[int, AskResult] = {}
    for index, (request, prompt) in enumerate(zip(ask.requests, prompts, strict=True)):
        recalled = _recalled(request, prompt, recall)
        if recalled is not None:
            results[index] = recalled
            tell(AskEvent(request.key, "recalled", "the earlier answer is used again"))
    todo = [index for index in range(len(prompts)) if index not in results]
    for index, prompt in zip(todo, mark_shared([prompts[index] for index in todo]), strict=True):
        prompts[index] = prompt
    errors = _run(todo, ask, prompts, client, cancel, results, keep or (lambda result: None), tell)
    if refuse is not None:
        for index in (i for i, error in errors.items() if isinstance(error, ReplyError)):
            refuse(ask.requests[index].key)
    if cancel.is_set() or any(isinstance(error, Cancelled) for error in errors.values()):
        raise Cancelled
    fatal = [index for index in errors if not (ask.optional and isinstance(errors[index], _OWN_FAILURES))]
    if fatal:
        raise errors[min(fatal)]
    return [results.get(index) for index in range(len(prompts))]


def _run(
    todo: list[int],
    ask: Ask,
    prompts: list[Prompt],
    client: ModelClient,
    cancel: threading.Event,
    results: dict[int, AskResult],
    keep: Keep,
    tell: OnEvent,
) -> dict[int, RoomError]:
    """Run the requests in `todo`; fills `results`, returns the errors by index."""
    errors: dict[int, RoomError] = {}
    if not todo:
        return errors
    events: queue.SimpleQueue[AskEvent | tuple[int, Future[AskResult | None]]] = queue.SimpleQueue()
    give_up = threading.Event()
    newest: dict[str, AskEvent] = {}

    def put(event: AskEvent) -> None:
        if event.kind == "heard":
            # Texts are heard faster than they can be looked at: only the newest waits, and the queue just says so.
            newest[event.key], event = event, replace(event, text="")
        events.put(event)

    def work(index: int) -> AskResult | None:
        if give_up.is_set() or cancel.is_set():
            return None
        try:
            return _answer(ask.requests[index], prompts[index], client, cancel, put)
        except RoomError as error:
            # An unusable answer concerns its own request; a failing service concerns all of them.
            if not isinstance(error, _OWN_FAILURES if ask.optional else ReplyError):
                give_up.set()
            raise

    pool = ThreadPoolExecutor(min(MOST_SIDE_BY_SIDE, len(todo)), thread_name_prefix="code-as-room-ask")
    try:
        for index in todo:
            future = pool.submit(work, index)
            future.add_done_callback(lambda done, index=index: events.put((index, done)))  # type: ignore[misc]
        waiting, deadline = len(todo), float("inf")
        while waiting and time.monotonic() < deadline:
            if cancel.is_set():
                deadline = min(deadline, time.monotonic() + _PATIENCE)
            try:
                event = events.get(timeout=0.1)
            except queue.Empty:
                continue
            if isinstance(event, AskEvent):
                heard = newest.pop(event.key, None) if event.kind == "heard" else event
                if heard is not None:
                    tell(heard)
                continue
            waiting -= 1
            _collect(*event, ask, results, errors, keep, tell)
    finally:
        give_up.set()
        pool.shutdown(wait=False, cancel_futures=True)
    return errors


def _collect(
    index: int,
    future: Future[AskResult | None],
    ask: Ask,
    results: dict[int, AskResult],
    errors: dict[int, RoomError],
    keep: Keep,
    tell: OnEvent,
) -> None:
    """Take one finished request's outcome."""
    key = ask.requests[index].key
    error = future.exception()
    if error is None:
        result = future.result()
        if result is not None:
            results[index] = result
            keep(result)
            if result.tries:
                tell(AskEvent(key, "answered", f"answered by {result.model} in {result.seconds:.1f} s"))
        return
    if not isinstance(error, RoomError):
        problem = ModelError(f"The model client failed unexpectedly ({type(error).__name__}).", "Run the stage again.")
        problem.__cause__ = error
        error = problem
    errors[index] = error
    tell(AskEvent(key, "failed", str(error)))


def _recalled(request: Request, prompt: Prompt, recall: Recall | None) -> AskResult | None:
    """The earlier answer to this prompt, if there is one that still validates."""
    earlier = recall(prompt) if recall else None
    if earlier is None:
        return None
    try:
        reply, notes = _read(earlier.text, request, prompt, earlier.model, salvage=True)
    except ReplyError:
        return None
    return AskResult(
        key=request.key,
        reply=reply,
        text=earlier.text,
        model=earlier.model,
        prompt_tokens=0,
        completion_tokens=0,
        cost=None,
        seconds=0.0,
        notes=notes,
        prompt_bytes=0,
        prompt_hash=prompt.hash,
        tries=0,
    )


def _answer(request: Request, prompt: Prompt, client: ModelClient, cancel: threading.Event, put: OnEvent) -> AskResult:
    """Ask, validate, and on an unusable answer ask once more with the problems quoted back."""
    started = time.monotonic()
    said: list[tuple[Prompt, Reply]] = []

    def call(sent: Prompt) -> str:
        if sent.repair:
            TALK.note_repair(prompt, sent)
        heard = ""

        def hear(text: str) -> None:
            nonlocal heard
            heard = text
            put(AskEvent(request.key, "heard", without_thoughts(text)))

        if sent.plain:
            sent = replace(sent, hear=hear)
        reply = client.answer(sent, cancel, lambda text: put(AskEvent(request.key, "progress", text)))
        said.append((sent, reply))
        TALK.note_reply(sent, reply)
        if isinstance(reply, KeptReply):
            put(AskEvent(request.key, "recalled", "the earlier answer is used again"))
        if sent.plain and heard != reply.text:
            hear(reply.text)  # whoever answered: the last that is heard is the whole
        return reply.text

    put(AskEvent(request.key, "asked", f"asking {name_of(client, prompt.stage)}"))
    text = ""
    try:
        text = call(prompt)
        reply, notes = _read(text, request, prompt, said[-1][1].model)
        return _result(request.key, prompt, reply, text, notes, said, started)
    except ReplyError as error:
        first = error
    put(AskEvent(request.key, "repair", first.message))
    second = repair_prompt(prompt, first.problems or (first.message,), text)
    try:
        repaired = call(second)
        reply, notes = _read(repaired, request, prompt, said[-1][1].model, salvage=True)
        notes = (f"The first answer could not be used: {first.message}", *notes)
        return _result(request.key, prompt, reply, repaired, notes, said, started)
    except ReplyError as error:
        last = error
    try:
        reply, notes = _read(text, request, prompt, said[0][1].model if said else "", salvage=True)
    except ReplyError:
        raise last if last.problems else first from None
    return _result(
        request.key, prompt, reply, text, (f"The repair round failed: {last.message}", *notes), said, started
    )


def _read(
    text: str, request: Request, prompt: Prompt, model: str, salvage: bool = False
) -> tuple[BaseModel, tuple[str, ...]]:
    """An answer as the request's type, with places in the picture brought to what was asked for; see `validate_reply`."""
    if prompt.plain:
        return plain_reply(text), ()
    return validate_reply(
        text, request.reply, salvage, lambda data: as_asked(data, model, sizes_seen(prompt.images, model))
    )


def _result(
    key: str,
    prompt: Prompt,
    reply: BaseModel,
    text: str,
    notes: tuple[str, ...],
    said: list[tuple[Prompt, Reply]],
    started: float,
) -> AskResult:
    """Put the tries together into one result; a first try whose reply was cut is not among them."""
    largest = max(len(sent.text.encode()) for sent, _ in said)
    if largest > PROMPT_LIMIT:
        notes = (*notes, f"The prompt's text was {largest / 1000:.0f} kB long.")
    costs = [answer.cost for _, answer in said if answer.cost is not None]
    return AskResult(
        key=key,
        reply=reply,
        text=text,
        model=said[-1][1].model,
        prompt_tokens=sum(answer.prompt_tokens for _, answer in said),
        completion_tokens=sum(answer.completion_tokens for _, answer in said),
        cost=sum(costs) if costs else None,
        seconds=time.monotonic() - started + sum(r.seconds for _, r in said if isinstance(r, KeptReply)),
        notes=tuple(note for _, answer in said for note in answer.notes) + notes,
        prompt_bytes=sum(len(sent.text.encode()) for sent, _ in said),
        prompt_hash=prompt.hash,
        tries=sum(not isinstance(answer, KeptReply) for _, answer in said),
    )
