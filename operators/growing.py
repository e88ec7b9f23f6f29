# SPDX-License-Identifier: GPL-3.0-or-later
"""A room that grows in the window while a model writes its draft.

A thread of its own turns what was heard into room programs and works them out; only the newest waits to be built, so a
fast model is never behind. The main thread builds in slices, as any build (`building.py`). What the artist moves meanwhile
is read back before every commit and goes into all that is built afterwards; memory gets it at the end, since the job's
worker has the memory while it asks.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pydantic import BaseModel

from ..pipeline.artifacts.layout import LayoutEdit
from ..pipeline.artifacts.replies import PlainReply
from ..pipeline.ask import AskEvent
from ..pipeline.errors import RoomError
from ..pipeline.program.prelude.record import Record
from ..pipeline.scene.arrays import MeshArrays
from ..pipeline.scene.plan import BuildPlan, plan_build, plan_known, warm_up
from ..pipeline.stages.base import Growth
from ..pipeline.stages.wishes import Ask, Wish
from .building import Building
from .meanwhile import Meanwhile
from .scene_backend import ResolvedScene

log = logging.getLogger(__name__)
_BITE, _BITES = 2000, 10
"""Characters that are looked at in one go at least, and in how many goes at most."""
PATIENCE = 6.0
"""Seconds that a stopped job waits until its worker has made a draft of what stands."""


@dataclass(frozen=True)
class _Room:
    """A program that was worked out, the artist's edits that are in it, and what to say of it once it stands."""

    plan: BuildPlan
    edits: list[LayoutEdit]
    words: str


class Growing:
    """One draft on its way. Main thread only, but for `hear` and `instead`.

    Attributes:
        heard: the answer so far; built: the program that was built last; words: what stands, for the artist.
    """

    def __init__(self, growth: Growth, backend: ResolvedScene, meanwhile: Meanwhile) -> None:
        self.heard = self.built = self.words = ""
        self._growth, self._backend, self._meanwhile = growth, backend, meanwhile
        self._lock = threading.Lock()
        self._waiting: str | None = None
        self._arrays: dict[str, MeshArrays] = {}
        self._thread: threading.Thread | None = None
        self._program = self._taken = ""
        self._planned: tuple[str, list[LayoutEdit]] = "", []
        self._known: BuildPlan | None = None
        self._ready: _Room | None = None
        self._building: tuple[Building, _Room] | None = None
        self._edits: list[LayoutEdit] = []  # in the program that stands
        self._found: list[LayoutEdit] = []  # in the scene only
        self._over = self._quiet = False
        self._waiting = ""
        self._begin()

    @property
    def stands(self) -> bool:
        """Whether there is a room in what was heard."""
        return bool(self._program)

    @property
    def has_news(self) -> bool:
        """Whether something waits for the main thread."""
        return not self._over and (self._ready is not None or self._building is not None)

    # ---- the worker's side ----

    def listening(self, tell: Callable[[AskEvent], None]) -> Callable[[AskEvent], None]:
        """Takes what is heard out of the events that are told."""
        return lambda event: self.hear(event.text) if event.kind == "heard" else tell(event)

    def hear(self, text: str) -> None:
        """All of the answer that has arrived so far; after another try it may begin again."""
        with self._lock:
            self.heard = self._waiting = text
            self._begin()

    def instead(self, wish: Wish, error: BaseException) -> Sequence[BaseModel | None]:
        """What is taken for the answers where these do not come any more, since the artist stopped or the service failed.

        Raises:
            BaseException: `error`, where nothing was heard that could stand for them.
        """
        if not isinstance(wish, Ask):
            raise error
        with self._lock:
            self._quiet, self._waiting = True, None  # the stage's own reading of it comes next, and needs the time
        if wish.optional:
            return [None] * len(wish.requests)
        if not self.stands or [request.reply for request in wish.requests] != [PlainReply]:
            raise error
        return [PlainReply(text=self.heard)]

    # ---- the thread's side: pure data only ----

    def _begin(self) -> None:
        """Work on what waits; the lock is held."""
        if self._thread is None and not (self._over or self._quiet):
            self._thread = threading.Thread(target=self._work, name="code-as-room-growing", daemon=True)
            self._thread.start()

    def _work(self) -> None:
        while True:
            with self._lock:
                text, self._waiting = self._waiting, None
                if text is None or self._over:
                    self._thread = None
                    return
            try:
                if text:
                    self._grow(self._bite(text))
                elif (warm := getattr(self._growth, "warm", None)) is not None:
                    warm()  # while the model is still thinking
                    warm_up(large=True)
            except RoomError as error:
                log.info("What was heard so far makes no room: %s", error)
            except Exception:
                log.exception("What was heard so far could not be worked out")

    def _bite(self, text: str) -> str:
        """What is looked at next of what was heard. Much at once, as from a service that does not stream, is taken in parts,
        so that the room still grows before the artist's eyes.
        """
        begin = len(self._taken) if text.startswith(self._taken) else 0
        end = begin + max(_BITE, len(text) // _BITES)
        end = text.find("\n", end) + 1 or len(text)
        self._taken = text[:end]
        if end < len(text):
            with self._lock:
                self._waiting = None if self._quiet else self._waiting or text
        return self._taken

    def _grow(self, text: str) -> None:
        self._program = self._growth.hear(text) or self._program
        edits = [*self._edits, *self._found]
        if not self._program or (self._program, edits) == self._planned:
            return
        self._planned = self._program, edits
        patched, _ = self._meanwhile.patched(self._program, edits)
        record = getattr(self._growth, "record", None)
        if record is not None and patched == self._program:
            plan = plan_known(patched, record, self._known)
        else:
            plan = plan_build(patched, meshes=False)
        self._known = plan
        plan.room.arrays = self._arrays  # each mesh is worked out once for all the rooms of this draft
        for target in plan.room.targets:
            plan.room.mesh(target)
        words = str(getattr(self._growth, "latest", "")) or standing_words(plan.room.record)
        self._ready = _Room(plan, edits, words)

    # ---- the main thread's side ----

    def go_on(self, deadline: float, must_wait: bool) -> bool:
        """Build slices of the newest room until the deadline; True when one was put in place.

        Raises:
            RoomError: the scene is gone.
        """
        if self._building is None:
            ready, self._ready = self._ready, None
            if ready is None:
                return False
            self._building = Building(self._backend, ready.plan), ready
        building, room = self._building
        while building.step():
            if time.monotonic() >= deadline:
                return False
        if must_wait:
            return False
        self._building = None
        self._found = self._backend.read_back()
        edits = [*self._edits, *self._found]
        if edits != room.edits:
            building.drop()
            self._again()
            return False
        building.commit()
        self._edits, self._found = edits, []
        self.built, self.words = room.plan.text, room.words
        return True

    def _again(self) -> None:
        """The newest room is worked out once more, with what the artist edited."""
        with self._lock:
            self._waiting = self._waiting or self.heard
            self._begin()

    def leave(self) -> None:
        """Nothing more is built; Blender is not touched."""
        with self._lock:
            self._over = True

    def end(self) -> bool:
        """Nothing more is built, and nothing stays of what was only prepared. What the artist edited goes to memory; True
        when there was something.
        """
        if self._over:
            return False
        with self._lock:
            self._over = True
        if self._building is not None:
            self._building[0].drop()
            self._building = None
        edits, self._edits = self._edits, []
        if edits:
            self._meanwhile.take_over(edits, [])
        return bool(edits)


def standing_words(record: Record) -> str:
    """What stands of a draft, in a sentence."""
    count = len(record.proxies)
    if not count:
        return "The walls stand" if record.walls else "The floor lies"
    return f"{record.proxies[-1]['id']} stands: {count} object{'' if count == 1 else 's'} so far"
