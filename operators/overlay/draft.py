# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist is in the middle of: drawn over the picture until it is done or given up, and kept nowhere."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ...pipeline.geometry.handles import Rectangle
from ...pipeline.geometry.polygon import Point


@dataclass(frozen=True)
class Draft:
    """An unfinished action in one scene; positions in the picture, 0-1000.

    Attributes:
        outline: the floor's corners in the place of those that are known. faulty: no floor can have it.
        box: a box in the place of the known one of `box_id`, or a new one when that is "".
        line: the two ends of a length that is being measured; line_text beside it.
        pointer: where a first point would go.
    """

    scene_uid: int
    outline: tuple[Point, ...] = ()
    faulty: bool = False
    box: Rectangle | None = None
    box_id: str = ""
    line: tuple[Point, Point] | None = None
    line_text: str = ""
    pointer: Point | None = None


_draft: Draft | None = None


def of(scene_uid: int) -> Draft | None:
    """The unfinished action in this scene."""
    return _draft if _draft is not None and _draft.scene_uid == scene_uid else None


def show(draft: Draft) -> None:
    """Draw this from now on."""
    global _draft
    _draft = draft


def change(**changes: object) -> None:
    """The same action a little further on."""
    global _draft
    if _draft is not None:
        _draft = replace(_draft, **changes)  # type: ignore[arg-type]


def clear() -> None:
    """It was done or given up."""
    global _draft
    _draft = None
