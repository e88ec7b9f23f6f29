# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of the panel Stages: the way a room is made, its big button, and what is said of a draft."""

from __future__ import annotations

from typing import Any

from ..operators import ways
from ..operators.view_state import RoomState
from .sentences import draw_sentence


def draw_way(layout: Any, context: Any, state: RoomState, enabled: bool) -> None:
    """Draft or stages, where there is a choice."""
    if not state.offers_draft:
        return
    row = layout.row(align=True)
    row.enabled = enabled
    row.prop(context.scene.code_as_room, "way", expand=True)


def draw_button(big: Any, state: RoomState) -> None:
    """The one thing to do next."""
    draft = state.stage(ways.DRAFT)
    if draft is not None and not draft.is_done:
        big.operator("code_as_room.draft_room", icon="GREASEPENCIL")
    elif draft is not None and not state.left:
        big.operator("code_as_room.refine_all", icon="SHADERFX")
    else:
        big.operator("code_as_room.run_all", icon="PLAY")


def draw_verdict(layout: Any, context: Any, state: RoomState) -> None:
    """How good the draft is, and what can be done with it."""
    if not state.has_draft:
        return
    if state.verdict:
        draw_sentence(layout, state.verdict, context, icon="ERROR" if state.is_poor else "INFO", alert=state.is_poor)
    if state.way == "stages" and any(row.status == "drafted" for row in state.stages):
        draw_sentence(
            layout, "Drafted stages stand. Run one to have it asked on top of the draft.", context, icon="INFO"
        )
    elif state.is_poor and state.way == "draft":
        layout.operator("code_as_room.go_staged", icon="FORWARD")
