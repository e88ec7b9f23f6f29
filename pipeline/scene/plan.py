# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything about a build that needs no Blender: it is worked out in any thread, and Blender's main thread is quick."""

from __future__ import annotations

import functools
from dataclasses import dataclass

from ..program.assemble import assemble, prelude_text
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout
from .targets import Plan, plan_record
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


@functools.lru_cache(maxsize=8)
def line_ids(text: str) -> frozenset[str]:
    """The ids of all layout lines of a program. Raises ProgramError as `parse_layout`."""
    layout = parse_layout(text)
    lines = (layout.walls, layout.doors, layout.windows, layout.openings, layout.proxies, layout.lights)
    return frozenset(line.id for group in (*lines, layout.worlds, layout.views, layout.cameras) for line in group)


def warm_up() -> None:
    """Join the prelude's text: once a session, half a second."""
    prelude_text()
