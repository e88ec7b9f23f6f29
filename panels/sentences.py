# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences in a panel. Blender cuts labels that are too long, so they are broken into lines that fit the region."""

from __future__ import annotations

import textwrap
from typing import Any

_CHARACTER = 6.6
"""Width of an average character at a scale of 1, pixels; a little generous, so that nothing is cut."""
_MARGIN = 62.0
_NARROWEST, _WIDEST = 18, 110


def line_length(context: Any, icon: bool = False) -> int:
    """How many characters fit on a line of the present region."""
    region = getattr(context, "region", None)
    preferences = getattr(context, "preferences", None)
    scale = preferences.system.ui_scale if preferences is not None else 1.0
    width = (region.width if region is not None else 300) / max(0.1, scale)
    return int(min(_WIDEST, max(_NARROWEST, (width - _MARGIN - (20.0 if icon else 0.0)) / _CHARACTER)))


def draw_sentence(
    layout: Any, text: str, context: Any, icon: str = "NONE", alert: bool = False, beside: int = 0
) -> None:
    """A sentence over as many lines as it needs.

    Args:
        beside: how many small buttons stand beside it on the same row.
    """
    lines = textwrap.wrap(text, max(_NARROWEST - 4, line_length(context, icon != "NONE") - 4 * beside))
    column = layout.column(align=True)
    column.alert = alert
    column.scale_y = 0.85
    for number, line in enumerate(lines):
        column.label(text=line, icon=icon if number == 0 else "BLANK1" if icon != "NONE" else "NONE")


def plural(count: int, thing: str) -> str:
    """A count and its noun."""
    return f"{count} {thing}{'' if count == 1 else 's'}"
