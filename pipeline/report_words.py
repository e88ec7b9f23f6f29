# SPDX-License-Identifier: GPL-3.0-or-later
"""What the report, and the tab in the window, call things."""

from __future__ import annotations

from collections.abc import Sequence

from .artifacts.layout import LayoutEdit

PARTS = {
    "coverage": "All there",
    "overlap": "Nothing overlaps",
    "bounds": "Inside the room",
    "relations": "Relations hold",
    "boxes": "Matches the picture",
    "clear": "Doors and windows free",
    "support": "All is carried",
}
"""The measured parts of a layout's score."""


def edit_words(edit: LayoutEdit) -> str:
    """A typed edit in plain words."""
    done = {
        "move": f"moved to {numbers(edit.centre)} m",
        "resize": f"made {numbers(edit.size)} m",
        "turn": f"turned to {edit.yaw or 0:.0f} degrees",
        "add": f"added as {edit.category or 'an object'}",
        "remove": "taken out",
        "recategorise": f"called {edit.category or 'something else'}",
        "rename": f"renamed to {edit.new_id or '?'}",
        "line": "changed",
        "reparent": f"put on {edit.parent or 'the ' + (edit.placement or 'floor')}",
    }[edit.op]
    resized = edit.op == "move" and edit.size is not None
    return done + (f", made {numbers(edit.size)} m" if resized else "") + (f": {edit.reason}" if edit.reason else "")


def numbers(values: Sequence[float] | None, between: str = ", ") -> str:
    """Metres with two digits; "?" for what is not known."""
    return between.join(f"{v:.2f}" for v in values) if values else "?"


def words(category: str) -> str:
    """A category as an artist reads it."""
    return category.replace("_", " ")


def seconds(value: float) -> str:
    """How long something took."""
    return f"{int(value // 60)} min {value % 60:.0f} s" if value >= 60 else f"{value:.1f} s"
