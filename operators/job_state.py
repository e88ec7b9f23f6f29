# SPDX-License-Identifier: GPL-3.0-or-later
"""What a job knows, whatever it is doing: its run, its worker, the stage that runs, and what was built of it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from ..pipeline.run import Run, StageSession
from ..pipeline.scene.plan import warm_up
from .building import Building
from .growing import Growing
from .meanwhile import Meanwhile, in_hand
from .progress import Durations, Progress
from .scene_backend import ResolvedScene
from .todo import Todo
from .worker import Planned, Ready, Worker


class JobState:
    """The state of a job.

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

    @property
    def _is_stopped(self) -> bool:
        """Whether the artist stopped the job, and no stage is being ended with what was heard."""
        return self.run.cancel.is_set() and self.cut is None

    def _must_wait(self) -> bool:
        """Whether the artist is in the middle of something that a build would break into, such as Edit mode."""
        note = in_hand()
        if note:
            self.progress.note = self.phase = note
        return bool(note)

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


def _warm() -> Ready:
    warm_up()
    return Ready("begin")
