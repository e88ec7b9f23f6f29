# SPDX-License-Identifier: GPL-3.0-or-later
"""Stages that have just asked, and wait for one answer: what a stage makes of it can be tried again and again.

A room is run up to the stage that asks. There the process is copied (`fork`) for each answer, so that all which comes after
the question is done anew, and nothing which comes before it.
"""

from __future__ import annotations

import json
import os
import signal
import threading
import time
import traceback
import warnings
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cache
from typing import Any

import numpy as np
from code_as_room.pipeline.errors import NotRecordedError, RoomError
from code_as_room.pipeline.memory import dump_memory, load_memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.builtin.empty import empty_value
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.program.prelude.shape import Shape
from code_as_room.pipeline.run import Run, StageSession
from code_as_room.pipeline.stages import all_stages
from code_as_room.pipeline.stages.wishes import Ask
from pydantic import BaseModel

from .fuzz_replies import not_finite
from .fuzz_rooms import AGAIN, Room, rooms
from .plain_backend import PlainBackend

MOST_SECONDS = 120
"""What takes longer than this counts as wrong: an artist would take Blender for dead."""
MOST_MEMORY = 4 << 30
_ALONE = {"01_analysis": "01_second_look", "06_programs": "06_correct"}
"""What is asked after these has nothing to add, except in the whole sample's runs: it would take as long again."""


class Answers:
    """Answers a room's questions as it was recorded, and with nothing to add where nothing was."""

    name = "answers"
    describes = "Recorded answers"

    def __init__(self, replies: Mapping[str, Any]) -> None:
        self._replies = replies

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """What was recorded under the prompt's key; objects' programs and pieces are left open where nothing was."""
        data = self._replies.get(f"{prompt.stage}/{prompt.key}")
        if data is None and prompt.stage == "s06_geometry":
            raise NotRecordedError("Nothing was recorded.", "Go on without.")
        return Reply(text=json.dumps(empty_value(prompt.schema) if data is None else data), model=self.name)


class CheckedBackend(PlainBackend):
    """A scene without Blender that takes no number that is not finite."""

    def build(self, text: str) -> None:
        """As Blender's scene would: the text is read and evaluated.

        Raises:
            AssertionError: a number of a line or of a mesh is not finite.
        """
        super().build(text)
        record = evaluate(text, FINISHED_ROOM_LIMITS)
        lines = [getattr(record, f.name) for f in fields(record) if f.name not in ("furnished", "plain", "finishes")]
        assert not list(not_finite(lines)), "not finite in a line"
        looks = [look.inputs for by_use in record.finishes.values() for look in by_use.values()]
        assert not list(not_finite(looks)), "not finite in a look"
        for shapes in record.furnished.values():
            assert all(_is_finite(shape) for shape in shapes), "not finite in a mesh"


def _is_finite(shape: Shape) -> bool:
    return bool(np.isfinite(shape.vertices).all() and (shape.uvs is None or np.isfinite(shape.uvs).all()))


class Waiting:
    """A stage of a room that has just asked, and waits for the answer to one of its requests.

    Raises:
        LookupError: the stage never asks this.
    """

    @classmethod
    def warm(cls, room: Room, key: str, good: BaseModel) -> Waiting:
        """One that waits after another one has been given a good answer, so that whatever is kept between runs is there.

        Raises:
            AssertionError: the stage does not end well with the good answer.
        """
        end = cls(room, key).go_on(good)
        assert end == "done", f"{room.name}/{key} is stopped by its own recording"
        return cls(room, key)

    def __init__(self, room: Room, key: str) -> None:
        self.room, self.key = room, key
        modelling = "library" if key.startswith("06_pieces") else "programs"
        stage_id = next(
            (place.partition("/")[0] for place in room.replies if place.partition("/")[2] == key), "s01_analysis"
        )
        stage = next(stage for stage in all_stages() if stage.id == stage_id)
        memory, program = before(room.name, stage_id if key != AGAIN else "s02_graph", modelling)
        self.backend = CheckedBackend()
        if program:
            self.backend.build(program)
        later = _ALONE.get(key.partition("/")[0], "-")
        known = {place: data for place, data in room.replies.items() if later not in place}
        self.run = Run(room.picture, load_memory(memory), Answers(known), self.backend)
        only = frozenset({"bench_1", "table_lamp_upper"}) if key == AGAIN else None
        self.session: StageSession = self.run.begin(stage, fresh=True, only=only)
        while not self._asks():
            if self.session.finished:
                raise LookupError(f"{room.name} never asks {key}")
            self.session.step()
        wish = self.session.wish
        assert isinstance(wish, Ask)
        self._index = [request.key for request in wish.requests].index(key)
        self._replies = self.session.answer(wish)
        self._known = len(self.run.memory.entries)

    def _asks(self) -> bool:
        wish = self.session.wish
        return isinstance(wish, Ask) and any(request.key == self.key for request in wish.requests)

    def go_on(self, reply: BaseModel) -> str:
        """Give the stage this answer: "done", or "stopped" with an error in words. Can be done once.

        Raises:
            Exception: what is neither a result nor an error of ours; AssertionError where a number is not finite.
        """
        session, replies = self.session, self._replies
        assert isinstance(replies, list)
        replies[self._index] = reply  # type: ignore[call-overload]
        try:
            session.send(replies)
            while not session.finished:
                session.step()
        except RoomError as error:
            assert error.message and str(error).encode(), "an error in words"
            if isinstance(error.__cause__, Exception) and not isinstance(error.__cause__, RoomError):
                raise error.__cause__ from None
            return "stopped"
        for entry in self.run.memory.entries[self._known :]:
            assert not list(not_finite(entry.output)), f"not finite in {entry.type}"
        kept = load_memory(dump_memory(self.run.memory))
        assert len(kept.entries) == len(self.run.memory.entries), "memory is read back whole"
        return "done"

    def forked(self, reply: BaseModel) -> tuple[str, float]:
        """As `go_on`, in a copy of this process, so that it can be done again: how it ended, "wrong: ..." included; seconds."""
        reading, writing = os.pipe()
        with warnings.catch_warnings():
            # Newer versions of Python warn of threads; those that are there wait for a next question.
            warnings.simplefilter("ignore", DeprecationWarning)
            child = os.fork()
        if child == 0:
            self._as_copy(reply, writing)
        os.close(writing)
        with os.fdopen(reading, encoding="utf-8", errors="replace") as pipe:
            said = pipe.read()
        _, status = os.waitpid(child, 0)
        end, _, seconds = said.rpartition("\n")
        if not end:
            return (
                f"wrong: the process ended with {status} (signal {signal.SIGALRM:d} is more than {MOST_SECONDS} s)",
                0.0,
            )
        return end, float(seconds)

    def _as_copy(self, reply: BaseModel, writing: int) -> None:
        """The copy's part: does not return."""
        end, began = "wrong: it ended early", time.perf_counter()
        try:
            import resource  # not on Windows, as fork

            signal.alarm(MOST_SECONDS)
            resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
            end = self.go_on(reply)
        except BaseException:
            end = f"wrong: {traceback.format_exc(limit=-6)}"
        finally:
            os.write(writing, f"{end[:20_000]}\n{time.perf_counter() - began:.4f}".encode("utf-8", "replace"))
            os._exit(0)


@cache
def _runs(name: str, modelling: str) -> tuple[Run, dict[str, tuple[str, str]]]:
    room = rooms()[name]
    run = Run(room.picture, load_memory(""), Answers(room.replies), CheckedBackend())
    run.memory.settings |= {"iterations": "1", "objects": modelling}
    return run, {}


def before(name: str, stage_id: str, modelling: str) -> tuple[str, str]:
    """A room's memory and program as they are before a stage; the stages before it are run where they were not yet."""
    if modelling == "library" and stage_id != "s06_geometry":
        modelling = "programs"
    run, found = _runs(name, modelling)
    for stage in all_stages():
        if stage.id not in found:
            found[stage.id] = dump_memory(run.memory), run.backend.program_text()
        if stage.id == stage_id:
            return found[stage_id]
        if not any(stage.id == done.stage for done in run.reports):
            run.reports.append(run.run_stage(stage))
    raise KeyError(stage_id)
