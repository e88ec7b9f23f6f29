# SPDX-License-Identifier: GPL-3.0-or-later
"""What the critic asked for in earlier rounds of a loop: what became of it, and what it takes back again and again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ..artifacts.analysis import DetectedObject, Finding
from ..artifacts.common import ImageBox
from ..artifacts.layout import LayoutEdit

SAME_BOX = 0.85
"""Boxes that agree by so much are the same wish."""
SAME_YAW = 15.0
MOST_TOLD = 8
"""Edits of either kind that the critic is reminded of."""

Wish = ImageBox | float | str | bool
FIELDS = {
    "move": "place",
    "resize": "place",
    "turn": "yaw",
    "recategorise": "category",
    "remove": "there",
    "add": "there",
}


@dataclass
class Past:
    """The wishes of one loop so far, by object and field, the state before the first wish at the beginning."""

    wishes: dict[tuple[str, str], list[Wish]] = field(default_factory=dict)
    frozen: set[tuple[str, str]] = field(default_factory=set)
    kept: list[str] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)

    def is_back_and_forth(self, op: str, identifier: str, before: Wish, wanted: Wish) -> bool:
        """Whether a wish goes back to what was given up before; then, and from then on, this field of it stays."""
        key = (identifier, FIELDS[op])
        if key in self.frozen:
            return True
        had = self.wishes.setdefault(key, [before])
        returns = not _same(had[-1], wanted) and any(_same(earlier, wanted) for earlier in had[:-1])
        if returns:
            self.frozen.add(key)
        had.append(wanted)
        return returns

    def note(self, edits: Sequence[LayoutEdit], refused: Sequence[Finding]) -> None:
        """Remember what was done and what was not after a round."""
        self.kept += [f"{e.op} {e.id}" for e in edits]
        self.refused += [f"{f.about} ({f.message.rstrip('.').lower()})" for f in refused]

    def told(self) -> str:
        """Two short lines for the critic; "" in the first round."""
        lines = []
        if self.kept:
            lines.append(f"Done after your earlier rounds: {', '.join(self.kept[-MOST_TOLD:])}.")
        if self.refused:
            lines.append(f"Refused, do not ask again: {'; '.join(t[:90] for t in self.refused[-MOST_TOLD:])}.")
        return "\n".join(lines)


def state_of(op: str, item: DetectedObject) -> Wish:
    """What an edit of this kind would change of an object, as it is now."""
    name = FIELDS[op]
    if name == "yaw":
        return item.yaw
    if name == "category":
        return item.category
    return item.box if name == "place" and item.box is not None else True


def _same(a: Wish, b: Wish) -> bool:
    if isinstance(a, ImageBox) and isinstance(b, ImageBox):
        return a.iou(b) >= SAME_BOX
    if isinstance(a, str) and isinstance(b, str):
        return a.strip().lower() == b.strip().lower()
    if isinstance(a, bool) or isinstance(b, bool):
        return a is b
    if isinstance(a, float | int) and isinstance(b, float | int):
        return abs((a - b + 180.0) % 360.0 - 180.0) <= SAME_YAW
    return False
