# SPDX-License-Identifier: GPL-3.0-or-later
"""A room that was built follows new metres: proxies move with the floor, walls and camera are those of the new fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..analysis.rescale import Similarity, rescaled_edit, rescaled_line, rescaled_text
from ..artifacts.analysis import Calibration, SceneAnalysis
from ..artifacts.layout import CameraLine, Layout, LayoutProgram, Line, ProxyLine, RoomLine
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import layout_statements, name_of
from ..program.parse_safe import parse
from ..program.rewrite import rewrite_lines
from .initial import empty_layout

UNTOUCHED = 0.002
"""Metres by which a line of the shell may differ from the fitted one and still not be a hand edit: rounding adds up."""

Follow = Callable[[str], str]


def follow_scale(change: Similarity) -> Follow:
    """For a change of scale alone: every line of a room text in the new metres."""
    return lambda text: rescaled_text(text, change)


def follow_shell(
    change: Similarity,
    old: tuple[SceneAnalysis, Calibration],
    new: tuple[SceneAnalysis, Calibration],
    locked: frozenset[str] = frozenset(),
) -> Follow:
    """For moved corners or another height: walls, doors and windows that nobody edited become those of the new fit.

    What was edited by hand moves with the floor. What hangs from the ceiling stays at it, unless it is locked.
    """
    before, after = _shell(*old), _shell(*new)
    rise = new[1].height - old[1].height * change.factor

    def follow(text: str) -> str:
        present = {_key(s.line) for s in layout_statements(parse(text.removeprefix("\ufeff"), FINISHED_ROOM_LIMITS))}
        added = [line for key, line in after.items() if key not in before and key not in present]

        def changed(line: Line) -> Line | None:
            key = _key(line)
            if isinstance(line, RoomLine) or key == ("camera", "reference"):
                return after.get(key, line)
            if key in before and _untouched(line, before[key]):
                return after.get(key)
            moved = rescaled_line(line, change)
            if isinstance(moved, ProxyLine) and moved.placement == "ceiling" and moved.id not in locked:
                x, y, z = moved.centre
                moved = moved.model_copy(update={"centre": (x, y, max(moved.size[2] / 2, z + rise))})
            return moved

        return rewrite_lines(text, changed, added)

    return follow


def moved_program(program: LayoutProgram, change: Similarity, follow: Follow | None = None) -> LayoutProgram:
    """What a stage wrote, in the new metres: its text, and those of its iterations."""
    if follow is None:
        follow = follow_scale(change)
    iterations = [
        i.model_copy(update={"program": follow(i.program), "edits": [rescaled_edit(e, change) for e in i.edits]})
        for i in program.iterations
    ]
    return program.model_copy(update={"text": follow(program.text), "iterations": iterations})


def _shell(analysis: SceneAnalysis, calibration: Calibration) -> Mapping[tuple[str, str], Line]:
    layout: Layout = empty_layout(analysis, calibration)[0]
    lines: list[Line] = [layout.room, *layout.walls, *layout.doors, *layout.windows, *layout.openings]
    cameras: list[CameraLine] = layout.cameras
    return {_key(line): line for line in [*lines, *cameras]}


def _key(line: Line) -> tuple[str, str]:
    return name_of(line), "" if isinstance(line, RoomLine) else line.id


def _untouched(line: Line, fitted: Line) -> bool:
    """Whether a line is the fitted one but for rounding."""
    a, b = line.model_dump(), fitted.model_dump()
    return all(_near(a[key], b[key]) for key in a)


def _near(a: Any, b: Any) -> bool:
    if isinstance(a, int | float) and isinstance(b, int | float):
        return abs(a - b) <= UNTOUCHED
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(_near(x, y) for x, y in zip(a, b, strict=True))
    return bool(a == b)
