# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything about a build that needs no Blender: it is worked out in any thread, and Blender's main thread is quick."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

from ..program.assemble import assemble, prelude_text
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout
from ..program.prelude.record import Record
from .targets import Plan, Target, plan_record
from .texts import check_lines


@dataclass(frozen=True)
class BuildPlan:
    """A room program, ready to be built.

    Attributes:
        text: the program (after the prelude); full_text: the whole room.py.
        room: what is to stand in the scene.
    """

    text: str
    full_text: str
    room: Plan


def plan_known(text: str, record: Record, former: BuildPlan | None = None) -> BuildPlan:
    """As `plan_build` without meshes, for a text whose record is known: it is not evaluated.

    Args:
        former: the plan of a room that is much the same.

    Raises:
        SceneError: a line of it is too long for Blender.
    """
    room = plan_record(record, _known_digests(former.room) if former is not None else None)
    full = assemble(text)
    groups = (record.walls, record.doors, record.windows, record.openings, record.proxies, record.lights)
    lines = (line["id"] for group in (*groups, record.worlds, record.views, record.cameras) for line in group)
    _IDS.keep(text, frozenset(lines))
    check_lines("room.py", full)
    return BuildPlan(text, full, room)


def plan_build(text: str, meshes: bool = True) -> BuildPlan:
    """Work a build out.

    Args:
        meshes: work out all meshes too, whether the scene will lack them or not.

    Raises:
        ProgramError: the text is outside the room language.
        SceneError: a line of it is too long for Blender.
    """
    room = plan_record(evaluate(text, FINISHED_ROOM_LIMITS))
    full = assemble(text)
    line_ids(text)  # the next reading back asks for them
    check_lines("room.py", full)
    if meshes:
        for target in room.targets:
            room.mesh(target)
    return BuildPlan(text, full, room)


def _known_digests(former: Plan) -> Callable[[Target], str | None]:
    """The digests of what has the very same shapes and finishes as in a former plan."""
    before = {target.key: target for target in former.targets}

    def known(target: Target) -> str | None:
        other = before.get(target.key)
        if other is None or (other.family, other.finishes) != (target.family, target.finishes):
            return None
        same = len(other.shapes) == len(target.shapes)
        same = same and all(a is b for a, b in zip(other.shapes, target.shapes, strict=True))
        return former.digests[target.key][1] if same else None

    return known


class _Ids:
    """The ids of all layout lines by the program's text; of the last few texts."""

    def __init__(self, most: int) -> None:
        self._most, self._lock = most, threading.Lock()
        self._held: OrderedDict[str, frozenset[str]] = OrderedDict()

    def find(self, text: str) -> frozenset[str] | None:
        """Those of a text that was kept."""
        with self._lock:
            if text in self._held:
                self._held.move_to_end(text)
            return self._held.get(text)

    def keep(self, text: str, ids: frozenset[str]) -> None:
        """Remember those of a text."""
        with self._lock:
            self._held[text] = ids
            while len(self._held) > self._most:
                self._held.popitem(last=False)


_IDS = _Ids(8)


def line_ids(text: str) -> frozenset[str]:
    """The ids of all layout lines of a program. Raises ProgramError as `parse_layout`."""
    found = _IDS.find(text)
    if found is None:
        layout = parse_layout(text)
        lines = (layout.walls, layout.doors, layout.windows, layout.openings, layout.proxies, layout.lights)
        found = frozenset(line.id for group in (*lines, layout.worlds, layout.views, layout.cameras) for line in group)
        _IDS.keep(text, found)
    return found


def warm_up(large: bool = False) -> None:
    """Join the prelude's text, for large rooms or for others: once a session, half a second."""
    prelude_text(docs=not large)
