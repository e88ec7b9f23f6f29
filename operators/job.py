# SPDX-License-Identifier: GPL-3.0-or-later
"""One run on its way, as a state machine that is ticked on Blender's main thread.

Rules:

- A worker thread does everything that is pure data: it starts the stage, asks the model, and lets the stage compute
  between its wishes. It never touches bpy.
- The main thread performs the wishes that need Blender (build, render, tell) and writes memory.
- Worker and main thread take turns with a session; they meet in one queue.
- A job that was dropped (another file was loaded) never touches Blender again, whatever its worker still answers.
"""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import bpy

from ..pipeline.ask import AskEvent
from ..pipeline.errors import Cancelled, RoomError
from ..pipeline.memory import dump_memory
from ..pipeline.run import Run, StageSession
from ..pipeline.stages.base import Stage
from ..pipeline.stages.wishes import Ask
from . import clients, reference
from .scene_backend import ResolvedScene, scene_by_uid

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Failed:
    """The worker's message that something was raised."""

    error: BaseException


@dataclass
class Progress:
    """What the panel shows while the job runs; plain values."""

    stage: str = ""
    title: str = ""
    what: str = ""
    step: int = 0
    steps: int = 0
    note: str = ""
    began: float = 0.0
    number: int = 0
    total: int = 1
    stopping: bool = False

    @property
    def fraction(self) -> float:
        """How much of the job is done, 0..1, going by stages and the steps that they tell."""
        inside = max(0, self.step - 1) / self.steps if self.steps else 0.0
        return min(1.0, (max(0, self.number - 1) + inside) / max(1, self.total))


class Job:
    """Runs stages one after the other.

    Args:
        run: its backend is a `ResolvedScene`.
        stages: in their order; those that are done when their turn comes are left out, unless `again`.
        again: run the stages even where they are done.
        fresh: ask again even where memory holds an answer.
        on_stage_done: called on the main thread after each stage, with its title.
    """

    def __init__(
        self,
        run: Run,
        backend: ResolvedScene,
        stages: Sequence[Stage],
        again: bool = False,
        fresh: bool = False,
        on_stage_done: Callable[[str], None] = lambda title: None,
    ) -> None:
        self.run, self.backend, self.scene_uid = run, backend, backend.uid
        self._todo, self._again, self._fresh = list(stages), again, fresh
        self._on_stage_done = on_stage_done
        self._inbox: queue.SimpleQueue[AskEvent | StageSession | Failed] = queue.SimpleQueue()
        self._session: StageSession | None = None
        self._busy = self._dropped = False
        self.over = False
        self.error: BaseException | None = None
        self.stages_done = 0
        self.progress = Progress(began=time.monotonic(), total=len(self._todo))
        run.progress = self._tell
        run.cancel.clear()

    def stop(self) -> None:
        """Ask the job to end; what was answered is kept."""
        self.progress.stopping = True
        self.run.cancel.set()

    def drop(self) -> None:
        """End the job at once without touching Blender any more, as when another file is loaded."""
        self._dropped = self.over = True
        self.run.cancel.set()

    def tick(self, budget: float) -> bool:
        """Do what is waiting for the main thread, for at most about `budget` seconds; True while the job goes on."""
        deadline = time.monotonic() + budget
        try:
            clients.watch_online_access(self.run.client)
            for _ in range(self._inbox.qsize() + 1):
                if not self._busy and not self.over:
                    self._begin_next()
                if self.over or time.monotonic() >= deadline:
                    break
                try:
                    message = self._inbox.get_nowait()
                except queue.Empty:
                    break
                self._handle(message)
        except Exception as error:
            self._end(error)
        return not self.over

    def wait(self, seconds: float) -> None:
        """Block until the worker has something, at most this long (for runs without a window)."""
        try:
            self._inbox.put(self._inbox.get(timeout=seconds))
        except queue.Empty:
            return

    def _begin_next(self) -> None:
        """Start the next stage that has to run, or end."""
        if self.run.cancel.is_set():
            return self._end(Cancelled())
        self._check_inputs()
        while self._todo and not self._again and self.run.status(self._todo[0]) == "done":
            self._todo.pop(0)
            self.progress.number += 1
        if not self._todo:
            return self._end(None)
        stage = self._todo.pop(0)
        progress = self.progress
        progress.number += 1
        progress.stage, progress.title = stage.id, stage.title
        progress.what, progress.step, progress.steps, progress.note = "Starting", 0, 0, ""
        self.run.take_over_edits()
        self.backend.flush()
        self._hand_over(lambda: StageSession(self.run, stage, self._fresh))

    def _check_inputs(self) -> None:
        """The scene and its picture must still be those that the run began with."""
        scene = scene_by_uid(self.scene_uid)
        if scene is None or reference.picture_mark(scene) != self.run.picture.sha256:
            raise RoomError(
                "The scene or its picture was changed while a stage was running.",
                "What was answered is kept; run the stage again.",
            )

    def _hand_over(self, move: Callable[[], StageSession]) -> None:
        """Let the worker go on: `move` first, then every question that follows."""
        self._busy = True
        threading.Thread(target=self._work, args=(move,), name="code-as-room", daemon=True).start()

    def _work(self, move: Callable[[], StageSession]) -> None:
        """The worker's side: pure data only."""
        session = self._session
        try:
            session = self._session = move()
            while isinstance(session.wish, Ask):
                if self.run.cancel.is_set():
                    raise Cancelled
                replies = session.ask(session.wish, self._inbox.put)
                self.backend.save_memory(dump_memory(self.run.memory))
                session.send(replies)
        except BaseException as error:
            if session is not None and not session.finished:
                session.close()
            self._inbox.put(Failed(error))
        else:
            self._inbox.put(session)

    def _handle(self, message: AskEvent | StageSession | Failed) -> None:
        if isinstance(message, AskEvent):
            self.progress.note = message.text
            return
        self._busy = False
        self.backend.flush()
        if isinstance(message, Failed):
            self._end(message.error)
        elif message.finished:
            self._session = None
            self.stages_done += 1
            self._on_stage_done(message.stage.title)
        elif self.run.cancel.is_set():
            message.close()
            self._end(Cancelled())
        elif self._must_wait():
            self._busy = True
            self._inbox.put(message)
        else:
            self._perform(message)

    def _must_wait(self) -> bool:
        """Whether the artist is in the middle of something that a build would break into, such as Edit mode."""
        if bpy.app.background or bpy.context.mode in ("OBJECT", ""):
            return False
        self.progress.note = "Waiting until you are back in Object mode"
        return True

    def _perform(self, session: StageSession) -> None:
        """Perform a wish that needs the main thread, and let the worker go on with its result."""
        assert session.wish is not None
        self._check_inputs()
        try:
            result: Any = session.act(session.wish)
        except BaseException:
            session.close()
            raise

        def go_on() -> StageSession:
            session.send(result)
            return session

        self._hand_over(go_on)

    def _tell(self, what: str, step: int, steps: int) -> None:
        self.progress.what, self.progress.step, self.progress.steps = what, step, steps
        self.progress.note = ""

    def _end(self, error: BaseException | None) -> None:
        """The job is over; what was answered so far is in memory."""
        if self.over:
            return
        self.over, self.error = True, error
        if self._session is not None and not self._busy and not self._session.finished:
            self._session.close()
        if error is not None and not isinstance(error, RoomError):
            log.error("A stage failed unexpectedly", exc_info=error)
        try:
            if error is not None and not self._must_wait():
                self.run.put_back()
            self.backend.flush()
        except RoomError as problem:
            self.error = self.error or problem
