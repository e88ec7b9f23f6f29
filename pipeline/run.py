# SPDX-License-Identifier: GPL-3.0-or-later
"""Performs what stages wish for, and keeps what they write.

One `Run` belongs to one picture, one memory and one scene. A `StageSession` is one stage on its way: its wishes are
performed one by one, `Ask` anywhere (it is pure data in and out, so it may run in a worker thread), everything else on
Blender's main thread. `Run.run_stage` is the blocking driver; the window has one of its own (`operators/driver.py`).
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from pydantic import BaseModel

from .artifacts.corrections import Corrections
from .artifacts.hand import HandEdits
from .artifacts.layout import LayoutEdit
from .ask import AskEvent, AskResult, perform_ask
from .backend import SceneBackend
from .errors import Cancelled, RoomError
from .memory import EntryMeta, Memory, content_hash, dump_memory, now
from .models.base import ModelClient, Prompt, Reply
from .picture import ReferencePicture
from .program.patch import patch_text
from .stages import all_stages
from .stages.base import Stage, View
from .stages.wishes import Ask, Build, Render, Tell, Wish

Status = Literal["not run", "done", "stale"]
Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class StageReport:
    """What one stage took: seconds in all and beside the model's answers, calls, bytes of prompt text, notes."""

    stage: str
    seconds: float
    own_seconds: float
    calls: int
    prompt_bytes: int
    largest_prompt: int
    notes: tuple[str, ...] = ()


@dataclass
class Run:
    """A picture on its way to a room.

    Attributes:
        progress: called with (what, step, steps) for the artist.
        cancel: set it to stop; the stage that runs ends with `Cancelled`.
    """

    picture: ReferencePicture
    memory: Memory
    client: ModelClient
    backend: SceneBackend
    progress: Progress = lambda what, step, steps: None
    cancel: threading.Event = field(default_factory=threading.Event)
    reports: list[StageReport] = field(default_factory=list)
    _standing: str = ""

    def __post_init__(self) -> None:
        if self.memory.picture_hash and self.memory.picture_hash != self.picture.sha256:
            raise RoomError(
                f"This room was begun with another picture ({self.memory.picture_name}).",
                "Load that picture again, or begin a new room.",
            )
        self.memory.picture_hash, self.memory.picture_name = self.picture.sha256, self.picture.name

    def inputs(self, stage: Stage) -> dict[str, str]:
        """Hashes of everything that a stage depends on, by name."""
        hashes = {"picture": self.picture.sha256[:20], "settings": content_hash(self.memory.settings)}
        for read in stage.reads:
            hashes[read.kind.__name__] = self.memory.hash_of(read.kind.__name__, read.stages or None)
        return hashes

    def status(self, stage: Stage) -> Status:
        """Whether a stage has run, and whether what it read has changed since."""
        entry = self.memory.latest_entry(stage.writes[0].__name__, (stage.id,))
        if entry is None:
            return "not run"
        return "done" if entry.meta.inputs == self.inputs(stage) else "stale"

    def view(self, stage: Stage, only: frozenset[str] | None = None) -> View:
        """The artifacts that a stage declared it reads.

        Args:
            only: ids of the objects that are to be done anew, None for all.
        """
        artifacts: dict[type[BaseModel], BaseModel] = {}
        for read in stage.reads:
            found = self.memory.latest(read.kind, read.stages or None)
            if found is not None:
                artifacts[read.kind] = found
        corrections = self.memory.latest(Corrections) or Corrections()
        return View(self.picture, artifacts, dict(self.memory.settings), tuple(self.hand_edits()), corrections, only)

    def hand_edits(self) -> list[LayoutEdit]:
        """All edits that the artist made by hand so far, oldest first."""
        kept: list[LayoutEdit] = []
        for entry in self.memory.entries:
            if entry.type == HandEdits.__name__:
                kept += HandEdits.model_validate(entry.output).edits
        return kept

    def take_over_edits(self) -> list[LayoutEdit]:
        """Read the scene back: what was changed by hand goes to memory and into the program. Main thread only."""
        edits = self.backend.read_back()
        self._standing = self.backend.program_text()
        if not edits:
            return []
        text, _ = patch_text(self.backend.program_text(), edits)
        self.memory.append("artist", HandEdits(edits=edits), EntryMeta(time=now(), model="artist"))
        self.backend.build(text)
        self._standing = text
        self.backend.save_memory(dump_memory(self.memory))
        return edits

    def put_back(self) -> None:
        """After a stage that did not end: the room that stood before it stands again. Main thread only.

        Where nothing stood, what the stage built so far stays to be looked at.
        """
        if self._standing and self.backend.program_text() != self._standing:
            self.backend.build(self._standing)

    def begin(self, stage: Stage, fresh: bool = False) -> StageSession:
        """Start a stage; hand edits are taken over first. Main thread only.

        Args:
            fresh: ask again even where memory holds an answer to the same question (the artist's "redo").
        """
        self.take_over_edits()
        self.cancel.clear()
        return StageSession(self, stage, fresh)

    def run_stage(self, stage: Stage) -> StageReport:
        """Run one stage to its end, blocking.

        Raises:
            RoomError: the stage failed; memory holds every answer that arrived, and the artifacts of earlier stages.
        """
        try:
            session = self.begin(stage)
            while not session.finished:
                session.step()
        except BaseException:
            self.put_back()
            raise
        return session.report()

    def run_all(self, stages: Sequence[Stage] | None = None) -> list[StageReport]:
        """Run every stage that is not done, in order.

        Raises:
            Cancelled: the run was stopped, also between two stages; else as `run_stage`.
        """
        done: list[StageReport] = []
        for stage in stages if stages is not None else all_stages():
            if self.status(stage) != "done":
                if done and self.cancel.is_set():
                    raise Cancelled
                done.append(self.run_stage(stage))
        return done


class StageSession:
    """One stage on its way. `wish` is what it waits for, None when it has finished."""

    def __init__(self, run: Run, stage: Stage, fresh: bool = False) -> None:
        self.run, self.stage, self._fresh = run, stage, fresh
        self._inputs = run.inputs(stage)
        self._started, self._asking = time.monotonic(), 0.0
        self._asked: list[AskResult] = []
        self._notes: list[str] = []
        self._generator = stage.run(run.view(stage))
        self.wish: Wish | None = None
        self.finished = False
        self._advance(lambda: next(self._generator))

    def step(self) -> None:
        """Perform the present wish here and now, and move on to the next."""
        wish = self.wish
        if wish is None:
            return
        if self.run.cancel.is_set():
            self.close()
            raise Cancelled
        try:
            result = self.ask(wish) if isinstance(wish, Ask) else self.act(wish)
        except BaseException:
            self.close()
            raise
        self.send(result)

    def ask(self, wish: Ask, on_event: Callable[[AskEvent], None] | None = None) -> list[BaseModel]:
        """Perform an `Ask`; may run in a worker thread while nothing else touches this session."""
        began = time.monotonic()
        run = self.run
        try:
            results = perform_ask(wish, self.stage.id, run.client, run.cancel, self._recall, self._keep, on_event)
        finally:
            self._asking += time.monotonic() - began
        for result in results:
            self._notes += [f"{result.key}: {note}" for note in result.notes]
        return [result.reply for result in results]

    def act(self, wish: Wish) -> Any:
        """Perform a wish that needs Blender's main thread."""
        if isinstance(wish, Tell):
            return self.run.progress(wish.what, wish.step, wish.steps)
        if isinstance(wish, Build):
            return self.run.backend.build(wish.text)
        if isinstance(wish, Render):
            return self.run.backend.render(wish.camera, wish.long_side, wish.labels)
        raise TypeError(f"a stage wished for {type(wish).__name__}")

    def send(self, result: Any) -> None:
        """Give the stage the result of its present wish."""
        self._advance(lambda: self._generator.send(result))

    def close(self) -> None:
        """End the stage without a result; answers that arrived stay in memory."""
        self._generator.close()
        self.wish, self.finished = None, True
        self.run.backend.save_memory(dump_memory(self.run.memory))

    def report(self) -> StageReport:
        """What the stage took so far."""
        seconds = time.monotonic() - self._started
        sizes = [r.prompt_bytes for r in self._asked]
        return StageReport(
            stage=self.stage.id,
            seconds=seconds,
            own_seconds=seconds - self._asking,
            calls=sum(r.tries for r in self._asked),
            prompt_bytes=sum(sizes),
            largest_prompt=max(sizes, default=0),
            notes=tuple(self._notes),
        )

    def _advance(self, move: Callable[[], Wish]) -> None:
        try:
            self.wish = move()
        except StopIteration as stop:
            self.wish, self.finished = None, True
            self._write(stop.value)
        except BaseException:
            self.wish, self.finished = None, True
            self.run.backend.save_memory(dump_memory(self.run.memory))
            raise

    def _write(self, artifacts: list[BaseModel]) -> None:
        """Append what the stage wrote, with what it was made from, and keep the memory's text."""
        meta = EntryMeta(
            time=now(),
            client=self.run.client.name,
            model=", ".join(sorted({r.model for r in self._asked})) or self.run.client.name,
            prompt_tokens=sum(r.prompt_tokens for r in self._asked),
            completion_tokens=sum(r.completion_tokens for r in self._asked),
            seconds=round(time.monotonic() - self._started, 3),
            inputs=self._inputs,
            notes=self._notes,
        )
        for artifact in artifacts:
            self.run.memory.append(self.stage.id, artifact, meta)
        self.run.reports.append(self.report())
        self.run.backend.save_memory(dump_memory(self.run.memory))

    def _recall(self, prompt: Prompt) -> Reply | None:
        kept = None if self._fresh else self.run.memory.answer(prompt.hash, self.run.client.name)
        if kept is None:
            return None
        return Reply(text=str(kept.output.get("text", "")), model=kept.meta.model)

    def _keep(self, result: AskResult) -> None:
        self._asked.append(result)
        meta = EntryMeta(
            time=now(),
            model=result.model,
            prompt_tokens=result.prompt_tokens,
            completion_tokens=result.completion_tokens,
            cost=result.cost,
            seconds=round(result.seconds, 3),
            prompt_hash=result.prompt_hash,
            client=self.run.client.name,
            notes=list(result.notes),
        )
        self.run.memory.keep_answer(self.stage.id, result.key, result.text, meta)
