# SPDX-License-Identifier: GPL-3.0-or-later
"""The active object's asset: what it looks like, how well that fits, and what else was found."""

from __future__ import annotations

from typing import Any

from ..operators import asset_search
from ..operators.view_state import RoomState
from ..pipeline.retrieval.match import Match
from .sentences import draw_sentence, line_length

MOST = 5
_NAME = 16
"""Characters that the buttons and the score leave of a line."""


def draw_asset(layout: Any, context: Any, state: RoomState, name: str) -> None:
    """A box about the asset of one object of the layout; nothing for what does not stand there."""
    if not name or not state.has_layout:
        return
    choice = next((c for c in state.assets if c.id == name), None)
    found = asset_search.found_for(context.scene, name)
    box = layout.box().column(align=True)
    if choice is not None:
        draw_sentence(box, f"Looks like {choice.asset.name}", context, icon="ASSET_MANAGER")
        scores = f"{choice.score:.2f} = words {choice.words:.2f} x size {choice.fit:.2f}"
        draw_sentence(box, f"{choice.asset.library}, {scores}", context, icon="BLANK1")
        row = box.row(align=True)
        row.operator("code_as_room.turn_asset", text="Turn", icon="LOOP_FORWARDS").identifier = name
        row.operator("code_as_room.drop_assets", text="Without", icon="X").identifier = name
    text = "Searching" if asset_search.is_searching() else "Find Asset" if choice is None else "Find Another"
    box.operator("code_as_room.find_assets", text=text, icon="VIEWZOOM").identifier = name
    if found is None:
        return
    others = [m for m in found if choice is None or m.asset.ref.key != choice.asset.key]
    for match in others[:MOST]:
        _draw_match(box, context, name, match)
    if not others:
        draw_sentence(box, "Nothing else is near", context, icon="INFO")
    for sentence in asset_search.problems()[:3]:
        draw_sentence(box, sentence, context, icon="ERROR")


def _draw_match(layout: Any, context: Any, name: str, match: Match) -> None:
    """One runner-up: its score, its name, and a button."""
    row = layout.row(align=True)
    title = match.asset.ref.name
    most = max(8, line_length(context) - _NAME)
    row.label(text=f"{match.score:.2f}  {title if len(title) <= most else title[: most - 1] + '…'}")
    operator = row.operator("code_as_room.use_asset", text="Use")
    operator.identifier, operator.asset = name, match.asset.ref.key
