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
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel

from .artifacts.corrections import Found
from .artifacts.hand import HandEdits
from .artifacts.layout import LayoutEdit, LayoutProgram
from .artifacts.objects import Furnishing
from .ask import AskEvent, AskResult, perform_ask
from .backend import HandScene, SceneBackend, Studio
from .draft.kept import DRAFTED, LOOKED, is_before_draft, is_drafted, is_looked_at
from .errors import Cancelled, RoomError
from .journal import AnswerJournal, JournalledClient, KeptAnswer
from .memory import EntryMeta, Memory, dump_memory, now
from .models.base import ModelClient, Prompt, Reply, name_of
from .models.strength import modelling_of
from .picture import ReferencePicture
from .program.differences import merged
from .program.patch import patch_text
from .retrieval.index import Shelf
from .run_assets import dress, find, prepare
from .run_corrections import bring_up_to_date, corrections_of, edits_of, found_of, inputs_of, program_of
from .run_finishes import note_own_finishes, with_own_finishes
from .run_images import find_images, keep_images, lacks_images, note_painting
from .run_modelling import note_own_functions
from .run_partial import inputs_after
from .stages import all_stages
from .stages.base import Stage, View
from .stages.texture_wishes import Painting
from .stages.wishes import (
    Ask,
    Build,
    Dress,
    FindAssets,
    FindImages,
    KeepImages,
    Paint,
    Portrait,
    PrepareAsset,
    Render,
    Tell,
    Wish,
)
from .textures.kept import KeptImages

if TYPE_CHECKING:  # image services bring a lot along
    from .models.image_base import ImageClient

Status = Literal["not run", "answered", "done", "stale"]
"""What became of a stage: "answered" when every question was answered but the result is not there, as after undo;
running it again asks nothing. "stale" when what it was made from has changed since."""
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
        journal: where answers are kept as they arrive, whatever becomes of the scene; None for none.
        shelf: the artist's asset libraries, None for none.
        painter: the image model, None for none; painted: where what it painted is kept on disk, None for nowhere.
    """

    picture: ReferencePicture
    memory: Memory
    client: ModelClient
    backend: SceneBackend
    progress: Progress = lambda what, step, steps: None
    cancel: threading.Event = field(default_factory=threading.Event)
    reports: list[StageReport] = field(default_factory=list)
    journal: AnswerJournal | None = None
    shelf: Shelf | None = None
    painter: ImageClient | None = None
    painted: KeptImages | None = None
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
        return inputs_of(self.memory, stage)

    def status(self, stage: Stage) -> Status:
        """What became of a stage; cheap, and without knowing which questions it would ask now."""
        entry = self.memory.latest_entry(stage.writes[0].__name__, (stage.id,))
        inputs = self.inputs(stage)
        if entry is not None and entry.meta.inputs == inputs:
            return "stale" if lacks_images(self, stage) or is_before_draft(self.memory, stage.id, entry) else "done"
        if self.journal is not None and self.journal.has_finished(stage.id, name_of(self.client, stage.id), inputs):
            return "answered"
        return "not run" if entry is None else "stale"

    def view(self, stage: Stage, only: frozenset[str] | None = None) -> View:
        """The artifacts that a stage declared it reads.

        Args:
            only: ids of the objects that are to be done anew, None for all.
        """
        artifacts: dict[type[BaseModel], BaseModel] = {}
        for read in stage.reads:
            found = _current(self.memory, read.kind, read.stages)
            if found is not None:
                artifacts[read.kind] = found
        recalled: dict[type[BaseModel], BaseModel] = {}
        for read in stage.recalls:
            found = _current(self.memory, read.kind, read.stages)
            if found is not None:
                recalled[read.kind] = found
        corrections = corrections_of(self.memory)
        settings, edits = dict(self.memory.settings), tuple(self.hand_edits())
        client = name_of(self.client, stage.id)
        if is_drafted(client):
            settings["objects"] = DRAFTED
        elif is_looked_at(client):
            settings["objects"] = LOOKED
        elif settings.get("objects", "auto") not in ("programs", "library"):
            settings["objects"] = modelling_of(client)
        return View(self.picture, artifacts, settings, edits, corrections, only, recalled)

    def hand_edits(self) -> list[LayoutEdit]:
        """All edits that the artist made by hand so far, oldest first, in the metres that hold now."""
        return edits_of(self.memory)

    def take_over_edits(self) -> list[LayoutEdit]:
        """What was changed by hand, in the scene or in the program's text, goes to memory and into the program.

        Main thread only. Where both changed one object the text counts; memory keeps the findings with the edits.

        Raises:
            ProgramError: the artist's text is outside the room language; nothing is changed.
        """
        backend = self.backend
        hand = backend if isinstance(backend, HandScene) else None
        typed = hand.text_edits() if hand is not None else None
        if typed is not None:
            note_own_functions(self.memory, backend.program_text())
            note_own_finishes(self.memory, backend.program_text())
        seen = backend.read_back()
        self._standing = backend.program_text()
        if hand is not None and self._standing:
            hand.hold(self._locked())
        if typed is None and not seen:
            return []
        kept, findings = merged(typed or [], seen)
        text, notes = patch_text(self._standing, kept)
        if hand is not None and typed is not None:
            hand.accept_text(renamed={e.id: e.new_id for e in typed if e.op == "rename" and e.new_id})
        try:
            backend.build(text)
        except BaseException:
            if hand is not None and typed is not None:
                hand.accept_text(False)
            raise
        self._standing = text
        edits = [*(typed or []), *kept]
        if edits or findings or notes:
            entry = HandEdits(edits=edits, findings=[*findings, *notes])
            self.memory.append("artist", entry, EntryMeta(time=now(), model="artist"))
        if hand is not None:
            hand.forget({edit.id for edit in edits if edit.op == "remove"})
        backend.save_memory(dump_memory(self.memory))
        return edits

    def _locked(self) -> frozenset[str]:
        """Ids of the objects that no automatic step may change."""
        edits = tuple(self.hand_edits())
        return View(self.picture, hand_edits=edits, corrections=corrections_of(self.memory)).locked

    def put_back(self) -> None:
        """After a stage that did not end: the room that stood before it stands again. Main thread only.

        Where nothing stood, what the stage built so far stays to be looked at.
        """
        if self._standing and self.backend.program_text() != self._standing:
            self.backend.build(self._standing)

    def begin(self, stage: Stage, fresh: bool = False, only: frozenset[str] | None = None) -> StageSession:
        """Start a stage; hand edits are taken over first. Main thread only.

        Args:
            fresh: ask again even where memory holds an answer to the same question (the artist's "redo").
            only: ids of the objects that are to be done anew, None for all.
        """
        self.take_over_edits()
        self.cancel.clear()
        return StageSession(self, stage, fresh, only)

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
        bring_up_to_date(self)
        done: list[StageReport] = []
        for stage in stages if stages is not None else all_stages():
            if self.status(stage) != "done":
                if done and self.cancel.is_set():
                    raise Cancelled
                done.append(self.run_stage(stage))
        return done


def _current(memory: Memory, kind: type[BaseModel], stages: tuple[str, ...] = ()) -> BaseModel | None:
    """The artifact of this type as it counts now; a layout program in the metres that hold since."""
    if kind is Found:
        return found_of(memory)
    if kind is Furnishing:
        program = program_of(memory, stages)
        return None if program is None else Furnishing(text=program.text, hand_edits=program.hand_edits)
    return program_of(memory, stages) if kind is LayoutProgram else memory.latest(kind, stages or None)


class StageSession:
    """One stage on its way. `wish` is what it waits for, None when it has finished.

    Args:
        waits: keep the result back until `apply`.

    Attributes:
        cut: why the stage was ended early with what was heard until then, None when it was not; its driver says so.
    """

    def __init__(
        self,
        run: Run,
        stage: Stage,
        fresh: bool = False,
        only: frozenset[str] | None = None,
        waits: bool = False,
    ) -> None:
        self.run, self.stage, self._fresh, self._only = run, stage, fresh, only
        self._inputs = run.inputs(stage)
        self._waits, self._written = waits, list[BaseModel]()
        self._asks = name_of(run.client, stage.id)
        self._client = run.client
        if run.journal is not None:
            self._client = JournalledClient(run.client, run.journal, self._inputs, fresh)
        self._started, self._asking = time.monotonic(), 0.0
        self._asked: list[AskResult] = []
        self._rounds = self._images = 0
        self._notes: list[str] = []
        self.cut: BaseException | None = None
        self._generator = stage.run(run.view(stage, only))
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
            result = self.answer(wish) if isinstance(wish, Ask | Paint) else self.act(wish)
        except BaseException:
            self.close()
            raise
        self.send(result)

    def answer(
        self, wish: Ask | Paint, on_event: Callable[[AskEvent], None] | None = None
    ) -> list[BaseModel | None] | list[Painting] | None:
        """Perform a wish that a service answers; may run in a worker thread while nothing else touches this session."""
        return self.ask(wish, on_event) if isinstance(wish, Ask) else self.paint(wish, on_event)

    def ask(self, wish: Ask, on_event: Callable[[AskEvent], None] | None = None) -> list[BaseModel | None]:
        """Perform an `Ask`; may run in a worker thread while nothing else touches this session."""
        began = time.monotonic()
        run = self.run
        self._rounds += 1
        try:
            results = perform_ask(
                wish,
                self.stage.id,
                self._client,
                run.cancel,
                self._recall,
                self._keep,
                on_event,
                self._refuse,
                room=run.picture.sha256,
            )
        finally:
            self._asking += time.monotonic() - began
        for result in results:
            if result is not None:
                self._notes += [f"{result.key}: {note}" for note in result.notes]
        return [None if result is None else result.reply for result in results]

    def paint(self, wish: Paint, on_event: Callable[[AskEvent], None] | None = None) -> list[Painting] | None:
        """Perform a `Paint`, as `ask`; None where there is no image model. What it cost goes to memory."""
        from .ask_images import paint

        began, run = time.monotonic(), self.run
        self._rounds += 1
        try:
            found = paint(wish, run.painter, run.painted, run.cancel, on_event, self._fresh)
        finally:
            self._asking += time.monotonic() - began
        for request, painting in zip(wish.requests, found or (), strict=False):
            if painting.data and painting.tries:
                self._images += painting.tries
                note_painting(run, self.stage.id, request, painting, self._rounds, self._inputs)
        return found

    def act(self, wish: Wish) -> Any:
        """Perform a wish that needs Blender's main thread; `FindAssets` may be performed in any."""
        if isinstance(wish, Tell):
            return self.run.progress(wish.what, wish.step, wish.steps)
        if isinstance(wish, Build):
            return self.run.backend.build(wish.text)
        if isinstance(wish, Render):
            return self.run.backend.render(wish.camera, wish.long_side, wish.labels)
        if isinstance(wish, FindAssets):
            return find(self.run, wish)
        if isinstance(wish, PrepareAsset):
            return prepare(self.run, wish)
        if isinstance(wish, Dress):
            return dress(self.run, wish)
        if isinstance(wish, KeepImages):
            return keep_images(self.run, wish)
        if isinstance(wish, FindImages):
            return find_images(self.run, wish)
        if isinstance(wish, Portrait):
            backend = self.run.backend
            return backend.portrait(wish.shapes, wish.family, wish.cameras) if isinstance(backend, Studio) else b""
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
            calls=sum(r.tries for r in self._asked) + self._images,
            prompt_bytes=sum(sizes),
            largest_prompt=max(sizes, default=0),
            notes=tuple(self._notes),
        )

    def _advance(self, move: Callable[[], Wish]) -> None:
        try:
            self.wish = move()
            if isinstance(self.wish, Build):
                self.wish = Build(with_own_finishes(self.run.memory, self.wish.text))
        except StopIteration as stop:
            self.wish, self.finished = None, True
            self._written = stop.value
            if self.run.journal is not None and self._only is None and self.cut is None:
                self.run.journal.finish(self.stage.id, self._asks, self._inputs)
            if not self._waits:
                self.apply()
        except BaseException:
            self.wish, self.finished = None, True
            self.run.backend.save_memory(dump_memory(self.run.memory))
            raise

    @property
    def is_outdated(self) -> bool:
        """Whether what the stage was made from is not what the run has now."""
        return self.run.inputs(self.stage) != self._inputs

    def apply(self) -> None:
        """Append what the stage wrote, with what it was made from, and keep the memory's text.

        A session that `waits` is applied by its driver, which looks first whether it is outdated; others apply themselves.
        """
        inputs = self._inputs if self._only is None else inputs_after(self.run.memory, self.stage, self._only)
        meta = EntryMeta(
            time=now(),
            client=self._asks,
            model=", ".join(sorted({r.model for r in self._asked})) or self._asks,
            prompt_tokens=sum(r.prompt_tokens for r in self._asked),
            completion_tokens=sum(r.completion_tokens for r in self._asked),
            seconds=round(time.monotonic() - self._started, 3),
            inputs=inputs,
            notes=self._notes if self.cut is None else [*self._notes, f"Ended early, with what was heard: {self.cut}"],
        )
        for artifact in self._written:
            self.run.memory.append(self.stage.id, artifact, meta)
        self.run.reports.append(self.report())
        self.run.backend.save_memory(dump_memory(self.run.memory))

    def _recall(self, prompt: Prompt) -> Reply | None:
        kept = None if self._fresh else self.run.memory.answer(prompt.hash, self._asks)
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
            prompt_bytes=result.prompt_bytes,
            tries=result.tries,
            round=self._rounds,
            client=self._asks,
            inputs=self._inputs,
            notes=list(result.notes),
        )
        self.run.memory.keep_answer(self.stage.id, result.key, result.text, meta)
        self._settle(result)

    def _settle(self, result: AskResult) -> None:
        """See to it that the journal holds this answer too where the first try's reply was cut and kept by nobody."""
        journal, client = self.run.journal, self._asks
        if journal is None or journal.answer(result.prompt_hash, client) is not None:
            return
        journal.keep(
            KeptAnswer(
                stage=self.stage.id,
                key=result.key,
                client=client,
                prompt_hash=result.prompt_hash,
                text=result.text,
                model=result.model,
                prompt_tokens=result.prompt_tokens,
                completion_tokens=result.completion_tokens,
                cost=result.cost,
                seconds=round(result.seconds, 3),
                time=now(),
                notes=result.notes,
                inputs=self._inputs,
            )
        )

    def _refuse(self, key: str) -> None:
        """The answers to this request stayed unusable."""
        if self.run.journal is not None:
            self.run.journal.refuse(self.stage.id, key, self._asks, self._inputs)
