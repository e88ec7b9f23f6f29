# SPDX-License-Identifier: GPL-3.0-or-later
"""The worker's side of a job: pure data only, in a thread that takes turns with Blender's main thread."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..pipeline.artifacts.layout import LayoutEdit
from ..pipeline.errors import Cancelled, ModelError
from ..pipeline.memory import dump_memory
from ..pipeline.models.base import name_of
from ..pipeline.run import StageSession
from ..pipeline.scene.plan import plan_build
from ..pipeline.stages.wishes import Ask, Build, FindAssets, Paint
from .growing import Growing
from .job_state import JobState
from .todo import apply_best
from .worker import Planned, Ready, Result


class WorkerSide(JobState):
    """What is handed over to the worker, each with a message that comes back."""

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
