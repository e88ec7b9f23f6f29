# SPDX-License-Identifier: GPL-3.0-or-later
"""What a room program says, as plain data: filled by the layout lines, read by whoever builds the scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .looks import Look
from .shape import Shape


@dataclass
class Record:
    """Everything one room program asked for, in the order of its lines.

    Each line is a dict whose keys are the fields of the line of the same name in `artifacts/layout.py`
    (`RoomLine`, `WallLine`, ...), with tuples for points and defaults filled in.

    Attributes:
        furnished: shapes in the proxy's local frame (origin at the centre of its base) by proxy id.
        plain: those of cloths before they were laid onto what carries them.
        finishes: looks by what they are for (a part's name, a material role, "" for all else), by the id or the name of
            the surfaces that `finish` named.
        built: whether `build()` was called.
    """

    room: dict[str, Any] | None = None
    walls: list[dict[str, Any]] = field(default_factory=list)
    doors: list[dict[str, Any]] = field(default_factory=list)
    windows: list[dict[str, Any]] = field(default_factory=list)
    openings: list[dict[str, Any]] = field(default_factory=list)
    proxies: list[dict[str, Any]] = field(default_factory=list)
    lights: list[dict[str, Any]] = field(default_factory=list)
    worlds: list[dict[str, Any]] = field(default_factory=list)
    views: list[dict[str, Any]] = field(default_factory=list)
    cameras: list[dict[str, Any]] = field(default_factory=list)
    furnished: dict[str, list[Shape]] = field(default_factory=dict)
    plain: dict[str, list[Shape]] = field(default_factory=dict)
    finishes: dict[str, dict[str, Look]] = field(default_factory=dict)
    built: bool = False
