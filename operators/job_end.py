# SPDX-License-Identifier: GPL-3.0-or-later
"""The end of a job, done or broken off: the room that stood before a stage that did not end stands again."""

from __future__ import annotations

import logging
import time

from ..pipeline.ask import AskEvent
from ..pipeline.errors import RoomError
from ..pipeline.memory import dump_memory
from .building import Building
from .job_worker import WorkerSide

log = logging.getLogger(__name__)


class Ending(WorkerSide):
    """Ends a job within a few ticks."""

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
