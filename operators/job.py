# SPDX-License-Identifier: GPL-3.0-or-later
"""One run on its way, as a state machine that is ticked on Blender's main thread.

Rules:

- A worker thread does everything that is pure data: it starts the stage, asks the model, lets the stage compute between
  its wishes, and works builds out. It never touches bpy.
- The main thread performs what needs Blender, builds in slices (`building.py`), and writes memory.
- Worker and main thread take turns with a session; they meet in one queue.
- Before a result is applied it is checked that what it was made from still holds. What does not fit any more is kept as
  answers, told, and never applied. What the artist does meanwhile is kept too (`meanwhile.py`).
- A job that was dropped (another file was loaded) never touches Blender again, whatever its worker still answers. One
  that was stopped is over within a second; what its worker still answers is taken by `late_answers`.
- A stage with `growth` builds while it is answered (`growing.py`). Stopped, or left by its service, it ends with what was
  heard until then, and the job after it.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from typing import Any

from ..pipeline.artifacts.layout import LayoutEdit
from ..pipeline.ask import AskEvent
from ..pipeline.errors import Cancelled, ModelError, RoomError
from ..pipeline.memory import dump_memory
from ..pipeline.models.base import name_of
from ..pipeline.run import Run, StageSession
from ..pipeline.scene.plan import plan_build, warm_up
from ..pipeline.stages.wishes import Ask, Build, FindAssets, Paint, Render, Tell
from . import clients
from .building import Building
from .growing import PATIENCE as GROWN
from .growing import Growing
from .meanwhile import Meanwhile, in_hand, outdated
from .progress import Durations, Progress
from .scene_backend import ResolvedScene
from .todo import Todo, apply_best
from .worker import Failed, Planned, Ready, Result, Worker

__all__ = ["Job", "Progress"]

log = logging.getLogger(__name__)
PATIENCE = 0.3
"""Seconds that a stopped job waits for its worker, before it leaves the worker behind."""


class Job:
    """Runs stages one after the other.

    Args:
        run: its backend is a `ResolvedScene`.
        todo: stages in their order; those that are done when their turn comes are left out, unless `again`.
        on_stage_done: called on the main thread after each stage, with its title.

    Attributes:
        phase: what the job is waiting for or doing, in a few words.
        wrote: whether something was written into the file since the last stage was done.
        must_put_back: whether the room that stood before still has to be put back.
        cut: why a stage that grows was ended early with what was heard, None when none was.
    """

    def __init__(
        self,
        run: Run,
        backend: ResolvedScene,
        todo: Sequence[Todo],
        on_stage_done: Callable[[str], None] = lambda title: None,
        durations: Durations | None = None,
    ) -> None:
        self.run, self.backend, self.scene_uid = run, backend, backend.uid
        self._todo, self._present = list(todo), todo[0] if todo else None
        self._on_stage_done = on_stage_done
        self._durations = durations or Durations(None)
        self._worker = Worker()
        self._session: StageSession | None = None
        self._building: tuple[Building, Planned] | None = None
        self._ending: tuple[BaseException, Building] | None = None
        self._restoring: Building | None = None
        self._meanwhile = Meanwhile(run, backend)
        self._built = ""
        self._applied = False
        self._stopped_at = float("inf")
        self._growing: Growing | None = None
        self.cut: BaseException | None = None
        self.over = self.must_put_back = False
        self.error: BaseException | None = None
        self.stages_done = 0
        self.phase = "starting"
        self.progress = Progress(began=time.monotonic(), total=len(self._todo))
        self.progress.count(run.memory)
        self.wrote = False
        run.progress = self._tell
        run.cancel.clear()
        self._worker.hand_over(_warm)

    # ---- from outside ----

    def stop(self) -> None:
        """Ask the job to end; what was answered is kept."""
        self.progress.stopping = True
        self._stopped_at = min(self._stopped_at, time.monotonic())
        self.run.cancel.set()

    def drop(self) -> None:
        """End the job at once without touching Blender any more, as when another file is loaded."""
        self.over = True
        self.run.cancel.set()
        if self._growing is not None:
            self._growing.leave()

    def tick(self, budget: float) -> bool:
        """Do what is waiting for the main thread, for at most about `budget` seconds; True while the job goes on."""
        deadline = time.monotonic() + budget
        try:
            clients.watch_online_access(self.run.client)
            clients.watch_online_access(self.run.painter)
            if self._ending is not None:
                self._go_on_ending(deadline)
                return not self.over
            if self._worker.busy and self._is_left():
                self._end(Cancelled())
            while not self.over and self._ending is None:
                if self._restoring is not None:
                    self._go_on_restoring(deadline)
                    break
                if self._building is not None:
                    if not self._go_on_building(deadline):
                        break
                elif not self._take_message() and not self._grow(deadline):
                    break
                if time.monotonic() >= deadline:
                    break
            if not self.over and self._ending is None:
                self._flush()
        except Exception as error:
            self._end(error)
        return not self.over

    def keep_answers(self) -> None:
        """Write into the file what was answered so far; never raises."""
        try:
            if not self.over:
                self._flush()
        except RoomError as error:
            log.info("Answers could not be kept in the file: %s", error)

    def wait(self, seconds: float) -> None:
        """Block until the worker has something, at most this long (for runs without a window)."""
        news = self._growing is not None and self._growing.has_news
        if self._building is None and self._ending is None and not news:
            self._worker.wait(seconds)

    @property
    def leaves_worker(self) -> bool:
        """Whether the worker of a job that is over is still at it."""
        return self._worker.is_alive

    def put_back(self) -> bool:
        """Put the room back that stood before a stage that did not end; False when that has to wait. Main thread only.

        Raises:
            RoomError: the scene is gone.
        """
        if not self.must_put_back:
            return True
        if self._must_wait():
            return False
        self.must_put_back = False
        if not self._built or self.backend.program_text() == self._built:
            self._meanwhile.put_back(self._ending[1] if self._ending is not None else None)
            self.backend.save_memory(dump_memory(self.run.memory))
        return True

    def settle(self) -> bool:
        """What is left to do once the job is over and its worker gone; False when that has to wait. Main thread only.

        The worker may have left a memory behind that others have written on since: only its answers count, which the
        caller adds to the file's memory.

        Raises:
            RoomError: the scene is gone.
        """
        self.backend.discard()
        if not self.must_put_back:
            return True
        if not self._built:
            self.must_put_back = False  # it built nothing, so what stands is others' work
            return True
        self._meanwhile.agree()
        if not self.put_back():
            return False
        self.backend.flush()
        return True

    # ---- the worker's side: pure data only ----

    def _go_on(self, move: Callable[[], StageSession]) -> None:
        """Let the worker move the session on, answer its questions, and work out what it wants to build."""
        session = self._session

        def work() -> Result:
            nonlocal session
            try:
                session = self._session = move()
                while isinstance(session.wish, Ask | FindAssets | Paint):
                    if self._is_stopped and self._growing is None:
                        raise Cancelled
                    if isinstance(session.wish, FindAssets):  # reads files, which may take a while
                        session.send(session.act(session.wish))
                        continue
                    self.phase = "waiting for the model"
                    replies = self._answered(session)
                    self.phase = "computing"
                    self.backend.save_memory(dump_memory(self.run.memory))
                    session.send(replies)
                return self._plan(session, []) if isinstance(session.wish, Build) else session
            except BaseException:
                if session is not None and not session.finished:
                    session.close()
                raise

        self.phase = "computing"
        self._worker.hand_over(work)

    def _answered(self, session: StageSession) -> Any:
        """What is answered to the session's wish; in a stage that grows, what was heard when no more comes."""
        wish, make = session.wish, session.stage.growth
        assert isinstance(wish, Ask | Paint)
        if make is None:
            return session.answer(wish, self._worker.tell)
        if self._growing is None:
            self._growing = Growing(make(self.run.view(session.stage)), self.backend, self._meanwhile)
        try:
            if self.cut is not None or self.run.cancel.is_set():
                raise self.cut or Cancelled()
            return session.answer(wish, self._growing.listening(self._worker.tell))
        except (Cancelled, ModelError) as error:
            replies = self._growing.instead(wish, error)
            self.cut = session.cut = error
            return replies

    def _plan(self, session: StageSession, edits: list[LayoutEdit]) -> Planned:
        """Work the session's build out, with what the artist edited."""
        assert isinstance(session.wish, Build)
        text, findings = self._meanwhile.patched(session.wish.text, edits)
        return Planned(plan_build(text), edits, findings)

    def _plan_again(self, edits: list[LayoutEdit]) -> None:
        """Let the worker work the present build out once more: the artist edited something meanwhile."""
        session = self._session
        assert session is not None
        self.phase = "computing"
        self._worker.hand_over(lambda: self._plan(session, edits))

    # ---- the main thread's side ----

    def _take_message(self) -> bool:
        """Handle the next message of the worker; False when there is none, or it has to wait."""
        message = self._worker.take()
        if message is None:
            return False
        if isinstance(message, AskEvent):
            self.progress.take(message)
            if message.kind in ("answered", "recalled"):
                self.progress.count(self.run.memory)
            return True
        if _touches(message) and not self._is_stopped and self._must_wait():
            self._worker.hold(message)
            return False
        if self._growing is not None and _touches(message) and self._growing.end() and isinstance(message, Planned):
            self._plan_again([])
        else:
            self._handle(message)
        return True

    def _handle(self, message: Result) -> None:
        if isinstance(message, Failed):
            return self._end(message.error)
        self._meanwhile.check_scene()
        if message == Ready("applied"):
            return self._stage_is_done()
        if message == Ready("taken back"):
            return self._take_back()
        if self._is_stopped:
            return self._end(Cancelled())
        self._meanwhile.agree()
        if isinstance(message, Ready):
            return self._begin_next()
        self._meanwhile.check_inputs(self._session)
        if isinstance(message, Planned):
            self.phase = "building"
            self._building = (Building(self.backend, message.plan), message)
        elif message.finished:
            self._apply(message)
        else:
            self._perform(message)

    def _begin_next(self) -> None:
        """Start the next stage that has to run, or end."""
        if self.cut is not None:
            return self._end(self.cut)
        self._growing = None
        self._session, self._applied = None, False
        while self._todo and not self._todo[0].again and self.run.status(self._todo[0].stage) == "done":
            self._todo.pop(0)
            self.progress.number += 1
        if not self._todo:
            return self._end(None)
        self._meanwhile.check_inputs(None)
        self._present = present = self._todo.pop(0)
        self.run.client, stage = present.client, present.stage
        self._expect(present)
        self.run.take_over_edits()
        self._meanwhile.begin_stage()
        self._built = ""
        fresh, only = present.scope
        self._go_on(lambda: StageSession(self.run, stage, fresh, only, waits=True))

    @property
    def is_last(self) -> bool:
        """Whether nothing is left to do after the present stage."""
        return not any(item.again or self.run.status(item.stage) != "done" for item in self._todo)

    def _expect(self, present: Todo) -> None:
        """Tell which stage begins, and how long it and those after it took before."""
        progress, now, stage = self.progress, time.monotonic(), present.stage
        progress.number += 1
        progress.stage, progress.title, progress.stage_began = stage.id, stage.title, now
        progress.what, progress.step, progress.steps, progress.note = "Starting", 0, 0, ""
        names = {item.stage.id: name_of(item.client, item.stage.id) for item in (present, *self._todo)}
        progress.stage_expected = self._durations.expected(self.run.memory, stage.id, names[stage.id])
        rest = self._durations.expected_all(self.run.memory, list(names), names)
        progress.expected = None if rest is None else now - progress.began + rest

    def _must_wait(self) -> bool:
        """Whether the artist is in the middle of something that a build would break into, such as Edit mode."""
        note = in_hand()
        if note:
            self.progress.note = self.phase = note
        return bool(note)

    def _grow(self, deadline: float) -> bool:
        """Build what was heard of a stage that grows; False when there is nothing new."""
        growing = self._growing
        if growing is None or self._is_stopped or not growing.has_news:
            return False
        self._meanwhile.check_scene()
        if not growing.go_on(deadline, self._must_wait()):
            return False
        self._built = growing.built
        self._tell(growing.words, 0, 0)
        return True

    @property
    def _is_stopped(self) -> bool:
        """Whether the artist stopped the job, and no stage is being ended with what was heard."""
        return self.run.cancel.is_set() and self.cut is None

    def _is_left(self) -> bool:
        """Whether the worker of a stopped job takes too long to notice."""
        grows = self._growing is not None and self._growing.stands
        return self._is_stopped and time.monotonic() > self._stopped_at + (GROWN if grows else PATIENCE)

    def _go_on_building(self, deadline: float) -> bool:
        """Do slices of the build until the deadline; False when it has to wait."""
        assert self._building is not None
        building, planned = self._building
        if self._is_stopped:
            building.drop()
            self._building = None
            self._end(Cancelled())
            return False
        while building.step():
            if time.monotonic() >= deadline:
                return False
        if self._must_wait():
            return False
        self._meanwhile.check_inputs(self._session)
        session, self._building = self._session, None
        assert session is not None
        edits = self.backend.read_back()
        if edits != planned.edits:
            building.drop()
            self._plan_again(edits)
            return False
        if edits:
            self._meanwhile.take_over(edits, planned.findings)
        building.commit()
        self._built = planned.plan.text
        if edits:
            self.backend.save_memory(dump_memory(self.run.memory))
        self._answer(session, None)
        return False

    def _perform(self, session: StageSession) -> None:
        """Perform a wish that needs the main thread, and let the worker go on with its result."""
        assert session.wish is not None
        if isinstance(session.wish, Render):
            self.phase = "rendering"
            if self._built and self.backend.program_text() != self._built:
                self.backend.build(self._built)  # an undo took the layout away that the stage speaks of
        self._answer(session, session.act(session.wish))

    def _answer(self, session: StageSession, result: Any) -> None:
        def go_on() -> StageSession:
            session.send(result)
            return session

        self._go_on(go_on)

    def _apply(self, session: StageSession) -> None:
        """The stage's result is still good: let the worker write it."""

        def write() -> Result:
            if self._present is not None and self._present.keeps_best:
                if not apply_best(self.run, session):
                    self.backend.save_memory(dump_memory(self.run.memory))
                    return Ready("taken back")
            else:
                session.apply()
            report = session.report()
            if report.calls:
                self._durations.note(report.stage, name_of(self.run.client, report.stage), report.seconds)
            return Ready("applied")

        self.phase = "finishing"
        self._worker.hand_over(write)

    def _stage_is_done(self) -> None:
        if not self._flush():  # an undo in the last moment
            raise outdated(self.progress.title)
        self._applied, self.wrote = True, False
        self.progress.count(self.run.memory)
        self.stages_done += 1
        self._on_stage_done(self.progress.title)
        self._worker.hand_over(lambda: Ready("begin"))

    def _take_back(self) -> None:
        """The present stage made nothing better: the room that stood before it stands again, and the job goes on."""
        self.backend.notices.append(f"{self.progress.title}: no better than before, so it was taken back.")
        self._applied = True
        self._restoring = self._meanwhile.former_room()
        if self._restoring is None:
            self._worker.hand_over(lambda: Ready("begin"))

    def _go_on_restoring(self, deadline: float) -> None:
        """Prepare the former room in slices, then put it in place."""
        former = self._restoring
        assert former is not None
        while former.step():
            if time.monotonic() >= deadline:
                return
        if self._must_wait():
            return
        self._restoring = None
        self._meanwhile.put_back(former)
        former.drop()
        self.backend.save_memory(dump_memory(self.run.memory))
        self._flush()
        self._worker.hand_over(lambda: Ready("begin"))

    def _flush(self) -> bool:
        """Write the memory's text that waits; False when the file's memory was changed behind our back."""
        if not self.backend.has_unsaved:
            return True
        if not self._meanwhile.flush(is_whole=not self._worker.busy):
            return False
        self.wrote = True
        return True

    def _tell(self, what: str, step: int, steps: int) -> None:
        self.progress.what, self.progress.step, self.progress.steps = what, step, steps
        self.progress.note = ""

    def _end(self, error: BaseException | None) -> None:
        """The job is over, once the room that stood before is ready to be put back."""
        if self.over or self._ending is not None:
            return
        former = self._former_room() if error is not None else None
        if error is None or former is None:
            return self._be_over(error)
        self.phase, self._ending = "putting the room back", (error, former)

    def _former_room(self) -> Building | None:
        """What has to be built before this job is over, None when nothing has."""
        try:
            if self._growing is not None:
                self._growing.end()
            if self._building is not None:
                self._building[0].drop()
                self._building = None
            if self._session is None or self._applied or not self._built or self._must_wait():
                return None
            return self._meanwhile.former_room() if self.backend.program_text() == self._built else None
        except RoomError:
            return None  # told when it is put back

    def _go_on_ending(self, deadline: float) -> None:
        """Prepare the former room in slices, so that Blender goes on meanwhile; then be over."""
        assert self._ending is not None
        error, former = self._ending
        try:
            while former.step():
                if time.monotonic() >= deadline:
                    return
        except Exception:
            log.exception("The former room could not be prepared")
        while self._worker.busy and (message := self._worker.take()) is not None:
            if isinstance(message, AskEvent):  # the worker noticed the stop meanwhile
                self.progress.take(message)
        self._be_over(error)
        former.drop()

    def _be_over(self, error: BaseException | None) -> None:
        """The job is over; what was answered so far is in memory."""
        if self.over:
            return
        self.over, self.error = True, error
        session, busy = self._session, self._worker.busy
        if session is not None and not busy and not session.finished:
            session.close()
        if error is not None and not isinstance(error, RoomError):
            log.error("A stage failed unexpectedly", exc_info=error)
        try:
            if self._building is not None:
                self._building[0].drop()
            self._meanwhile.check_scene()
            if not busy:
                self._meanwhile.agree()
            self.must_put_back = error is not None and session is not None and not self._applied
            self.put_back()
            wrote = self.wrote
            self.backend.save_memory(dump_memory(self.run.memory))
            self._flush()
            if error is None:
                self.wrote = wrote  # a stage that was done has written all there is, in its own undo step
        except RoomError as problem:
            self.error = self.error or problem


def _touches(message: Result) -> bool:
    """Whether what follows a message changes the scene, or makes an undo step."""
    tells = isinstance(message, StageSession) and isinstance(message.wish, Tell)
    return not tells and not isinstance(message, Failed)


def _warm() -> Ready:
    warm_up()
    return Ready("begin")
