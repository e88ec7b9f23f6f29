# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's online access holds at every moment of a question: before it, while it waits for its turn, and during it."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest
from code_as_room.operators.guarded import GuardedClient, GuardedPainter
from code_as_room.pipeline.errors import Cancelled, ModelError
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.image_base import ImageRequest, PaintedImage
from code_as_room.pipeline.spending import Meter
from code_as_room.pipeline.spending_images import CappedPainter

PROMPT = Prompt("s01", "k", "What?", (), "A", {}, "h")


class Slow:
    """A client that waits until it is cancelled, as one on the network does."""

    name, describes = "slow", "a slow client"

    def __init__(self) -> None:
        self.asked = threading.Event()

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        self.asked.set()
        if cancel.wait(5):
            raise Cancelled
        return Reply("{}", "slow")


def ask(client: GuardedClient, cancel: threading.Event) -> tuple[threading.Thread, list[BaseException]]:
    errors: list[BaseException] = []

    def work() -> None:
        try:
            client.answer(PROMPT, cancel)
        except ModelError as error:
            errors.append(error)
        except Cancelled as error:
            errors.append(error)

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    return thread, errors


def test_switching_online_access_off_ends_a_question_that_is_under_way() -> None:
    inner = Slow()
    client = GuardedClient(inner)
    client.online = True
    thread, errors = ask(client, threading.Event())
    assert inner.asked.wait(5)
    client.online = False
    thread.join(5)
    assert isinstance(errors[0], ModelError) and "online access is off" in errors[0].message


def test_the_artists_stop_stays_a_stop() -> None:
    inner, cancel = Slow(), threading.Event()
    client = GuardedClient(inner)
    client.online = True
    thread, errors = ask(client, cancel)
    assert inner.asked.wait(5)
    cancel.set()
    thread.join(5)
    assert isinstance(errors[0], Cancelled)


def test_nothing_is_asked_while_it_is_off() -> None:
    inner = Slow()
    with pytest.raises(ModelError, match="online access is off"):
        GuardedClient(inner).answer(PROMPT, threading.Event())
    assert not inner.asked.is_set()


class SlowPainter:
    """An image client whose request has left, and that waits until it is cancelled."""

    name, describes = "slow", "a slow painter"

    def __init__(self) -> None:
        self.asked = threading.Event()

    def paint(
        self, request: ImageRequest, cancel: threading.Event, progress: Callable[[str], None] | None = None
    ) -> PaintedImage:
        if progress:
            progress("waiting for the model")
        self.asked.set()
        if cancel.wait(5):
            raise Cancelled
        return PaintedImage(b"", "slow")


def test_switching_it_off_ends_an_image_that_is_under_way_and_that_image_is_counted_as_paid_for() -> None:
    inner, meter, errors = SlowPainter(), Meter(cap=1.0), list[ModelError]()
    guarded = GuardedPainter(inner)
    guarded.online = True
    painter = CappedPainter(guarded, meter, price=0.04)

    def work() -> None:
        try:
            painter.paint(ImageRequest("oak"), threading.Event())
        except ModelError as error:
            errors.append(error)

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    assert inner.asked.wait(5)
    guarded.online = False
    thread.join(5)
    assert "image model" in errors[0].message and meter.spent == 0.04
    inner.asked.clear()
    work()
    assert not inner.asked.is_set() and meter.spent == 0.04
