# SPDX-License-Identifier: GPL-3.0-or-later
"""The worker thread of a job: pure data in, messages out. Nothing here touches bpy."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from dataclasses import dataclass

from ..pipeline.artifacts.analysis import Finding
from ..pipeline.artifacts.layout import LayoutEdit
from ..pipeline.ask import AskEvent
from ..pipeline.run import StageSession
from ..pipeline.scene.plan import BuildPlan


@dataclass(frozen=True)
class Failed:
    """Something was raised."""

    error: BaseException


@dataclass(frozen=True)
class Planned:
    """A build is worked out, with the artist's edits that were read back for it."""

    plan: BuildPlan
    edits: list[LayoutEdit]
    findings: list[Finding]


@dataclass(frozen=True)
class Ready:
    """The worker did what it was to do: "begin" a stage, or "applied" its result."""

    what: str


Result = StageSession | Failed | Planned | Ready
Message = AskEvent | Result


class Worker:
    """One thread at a time, and the queue in which its messages come to the main thread.

    Attributes:
        busy: whether something was handed over whose result was not taken yet.
    """

    def __init__(self) -> None:
        self._inbox: queue.SimpleQueue[Message] = queue.SimpleQueue()
        self._held: Result | None = None
        self._thread: threading.Thread | None = None
        self.busy = False

    def hand_over(self, move: Callable[[], Result]) -> None:
        """Do something in the thread; what it returns, or raises, comes back as a message."""
        self.busy = True

        def work() -> None:
            try:
                message = move()
            except BaseException as error:
                message = Failed(error)
            self._inbox.put(message)

        self._thread = threading.Thread(target=work, name="code-as-room", daemon=True)
        self._thread.start()

    def tell(self, event: AskEvent) -> None:
        """News from within the thread."""
        self._inbox.put(event)

    def take(self) -> Message | None:
        """The next message, None when there is none. A result that is taken ends `busy`."""
        message: Message | None = self._held
        self._held = None
        if message is None:
            try:
                message = self._inbox.get_nowait()
            except queue.Empty:
                return None
        if not isinstance(message, AskEvent):
            self.busy = False
        return message

    def hold(self, result: Result) -> None:
        """Give a result back that cannot be used yet."""
        self._held, self.busy = result, True

    def wait(self, seconds: float) -> None:
        """Block until there is a message, at most this long."""
        if self._held is None:
            try:
                self._inbox.put(self._inbox.get(timeout=seconds))
            except queue.Empty:
                return

    @property
    def is_alive(self) -> bool:
        """Whether the thread is still at it."""
        return self._thread is not None and self._thread.is_alive()
