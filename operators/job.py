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

from ..pipeline.ask import AskEvent
from ..pipeline.errors import Cancelled, RoomError
from ..pipeline.memory import dump_memory
from ..pipeline.models.base import name_of
from ..pipeline.run import StageSession
from ..pipeline.stages.wishes import Render, Tell
from . import clients
from .building import Building
from .growing import PATIENCE as GROWN
from .job_end import Ending
from .meanwhile import outdated
from .progress import Progress
from .todo import Todo
from .worker import Failed, Planned, Ready, Result

__all__ = ["Job", "Progress"]

log = logging.getLogger(__name__)
PATIENCE = 0.3
"""Seconds that a stopped job waits for its worker, before it leaves the worker behind."""


class Job(Ending):
    """Runs stages one after the other; see `JobState` for what it is given and what can be seen of it."""

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
            if self.backend.prepare_drawing(session.wish.camera):
                self._worker.hold(session)  # the picture itself comes in a later tick
                return
            if self._built and self.backend.program_text() != self._built:
                self.backend.build(self._built)  # an undo took the layout away that the stage speaks of
        self._answer(session, session.act(session.wish))

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


def _touches(message: Result) -> bool:
    """Whether what follows a message changes the scene, or makes an undo step."""
    tells = isinstance(message, StageSession) and isinstance(message.wish, Tell)
    return not tells and not isinstance(message, Failed)
