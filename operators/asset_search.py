# SPDX-License-Identifier: GPL-3.0-or-later
"""A search for assets on its way: a thread reads and compares, the main thread fetches one asset a tick, then dresses.

Nothing of the room is changed before everything is at hand. Then it is one named undo step.
"""

from __future__ import annotations

import logging
import threading
from dataclasses import dataclass, field
from typing import Any

import bpy

from ..pipeline.errors import Cancelled, RoomError
from ..pipeline.retrieval.match import Match, Wanted
from ..pipeline.run import Run
from ..pipeline.run_assets import NO_SHELF, find, prepare, wanted_of, wear
from ..pipeline.stages.wishes import FindAssets, FoundAssets, PrepareAsset
from . import driver, own_room, room_memory, view_state
from .meanwhile import in_hand
from .scene_backend import ResolvedScene, scene_by_uid
from .view_state import Problem

log = logging.getLogger(__name__)
_INTERVAL = 0.05
_found: dict[tuple[int, str], tuple[Match, ...]] = {}
_problems: tuple[str, ...] = ()
_search: Search | None = None


def found_for(scene: Any, name: str) -> tuple[Match, ...] | None:
    """What the last search of this session found for an object, best first; None when there was none."""
    return _found.get((scene.session_uid, name))


def problems() -> tuple[str, ...]:
    """What the last search had to leave out, in sentences."""
    return _problems


def is_searching() -> bool:
    """Whether a search is on its way."""
    return _search is not None


@dataclass
class Search:
    """One search; no Blender data is kept between its steps."""

    uid: int
    run: Run
    wanted: list[Wanted]
    result: FoundAssets | None = None
    error: Exception | None = None
    todo: list[tuple[Wanted, Match]] = field(default_factory=list)
    ready: list[tuple[Wanted, Match]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    thread: threading.Thread | None = None

    def look(self) -> None:
        """Read the libraries and compare; any thread."""
        try:
            self.result = find(self.run, FindAssets(tuple(self.wanted)))
        except Exception as error:
            self.error = error

    def take(self) -> None:
        """What was found is shown from now on; what is good enough is fetched."""
        global _problems
        if self.error is not None:
            raise self.error
        assert self.result is not None
        _problems = self.result.problems
        for item in self.wanted:
            matches = tuple(self.result.matches.get(item.id, ()))
            _found[(self.uid, item.id)] = matches
            if matches and matches[0].is_good:
                self.todo.append((item, matches[0]))

    def fetch(self) -> None:
        """Have one more asset at hand, or the next best."""
        item, match = self.todo.pop()
        answer = prepare(self.run, PrepareAsset(match.asset.ref))
        if not isinstance(answer, str):
            self.ready.append((item, match))
            return
        self.notes.append(f"{item.id}: {answer}")
        matches = [m for m in _found[(self.uid, item.id)] if m.asset.ref.key != match.asset.ref.key]
        _found[(self.uid, item.id)] = tuple(matches)
        if matches and matches[0].is_good:
            self.todo.append((item, matches[0]))

    def finish(self, scene: Any) -> str:
        """Dress the objects; returns a sentence on what came of it."""
        if not self.ready:
            return self._nothing()
        own_room.prepare(scene)
        run = room_memory.run_of(scene)
        run.take_over_edits()
        now = {item.id: item for item in wanted_of(run, {item.id for item, _ in self.ready})}
        pairs = [(now[item.id], match) for item, match in self.ready if item.id in now]
        done = wear(run, pairs)
        if isinstance(run.backend, ResolvedScene):
            run.backend.flush()
            self.notes += run.backend.notices
        if len(done) == 1:
            choice = done[0]
            return f'{choice.id} looks like "{choice.asset.name}" now, score {choice.score:.2f}'
        return f"{len(done)} of {len(self.wanted)} objects look like assets now"

    def _nothing(self) -> str:
        assert self.result is not None
        if not self.result.searched:
            return "There are no marked objects or collections in your asset libraries"
        if len(self.wanted) > 1:
            return "No asset fits these objects well enough; they stay as they are"
        matches = _found.get((self.uid, self.wanted[0].id), ())
        if not matches:
            return f"No asset comes near {self.wanted[0].category} in name and size; it stays as it is"
        return f'No asset fits well enough; the nearest is "{matches[0].asset.ref.name}", {matches[0].score:.2f}'


def start(scene: Any, names: frozenset[str]) -> None:
    """Look for assets for these objects; in the background at once, in a window while the artist works on.

    Raises:
        RoomError: no library is set up, another search is on its way, or the objects are not in the program.
    """
    global _search
    if _search is not None:
        raise RoomError("A search for assets is going on.", "Wait for it.")
    own_room.prepare(scene)
    run = room_memory.run_of(scene)
    if run.shelf is None:
        raise NO_SHELF
    wanted = wanted_of(run, names)
    if not wanted:
        raise RoomError("These objects are not in the room's program yet.", "Use Take Over Hand Edits first.")
    search = Search(scene.session_uid, run, wanted)
    if bpy.app.background:
        search.look()
        _complete(search, scene)
        return
    _search = search
    search.thread = threading.Thread(target=search.look, name="code-as-room assets", daemon=True)
    search.thread.start()
    bpy.app.timers.register(_tick, first_interval=_INTERVAL)


def cancel() -> None:
    """Drop the search, and all that was found: another file is opened, or the add-on goes."""
    global _search, _problems
    if _search is not None:
        _search.run.cancel.set()
    _search, _problems = None, ()
    _found.clear()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)


def _tick() -> float | None:
    """The timer; nothing may be raised here."""
    global _search
    search = _search
    if search is None:
        return None
    if search.thread is not None and search.thread.is_alive():
        return _INTERVAL
    scene = scene_by_uid(search.uid)
    if scene is not None and (driver.is_running() or in_hand()):
        return 0.3  # what the artist, or a run, is in the middle of comes first
    try:
        if scene is None:
            _search = None
        elif _step(search, scene):
            return 0.0
        else:
            _search = None
    except Exception as error:
        _search = None
        _tell(scene, error)
    driver.redraw()
    return None


def _step(search: Search, scene: Any) -> bool:
    """One slice; False when the search is over."""
    if search.thread is not None:
        search.thread = None
        search.take()
        return True
    if search.todo:
        search.fetch()
        return True
    _end(search, scene)
    return False


def _complete(search: Search, scene: Any) -> None:
    search.take()
    while search.todo:
        search.fetch()
    _end(search, scene)


def _end(search: Search, scene: Any) -> None:
    said = search.finish(scene)
    view_state.refresh(scene)
    driver.note_outcome(scene, said, notices=tuple(search.notes))
    if search.ready and not bpy.app.background:
        bpy.ops.ed.undo_push(message="Room: Find Asset")


def _tell(scene: Any, error: Exception) -> None:
    if not isinstance(error, RoomError):
        log.error("The search for assets failed unexpectedly", exc_info=error)
    if scene is not None and not isinstance(error, Cancelled):
        driver.note_outcome(scene, "", Problem.of(error))
