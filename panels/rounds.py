# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Layout Loop: its rounds with their pictures, what the critic asked for, and taking any of them."""

from __future__ import annotations

from typing import Any

from ..operators import round_pictures, rounds, view_state
from ..operators.view_state import RoomState
from ..pipeline.report_rounds import RoundRow
from .base import RoomPanel, known_operator, region_width
from .sentences import draw_sentence

COLUMNS = 3
MOST_ASKED = 8
_UNIT = 20.0
"""Pixels of one unit of an icon's scale."""
_MARGIN = 58.0
_WIDE = 250.0
"""Pixels from which three scores fit beside each other."""


class CODE_AS_ROOM_PT_rounds(RoomPanel):
    """The rounds of the layout loop."""

    bl_idname = "CODE_AS_ROOM_PT_rounds"
    bl_label = "Layout Loop"
    bl_order = 4
    bl_options = {"DEFAULT_CLOSED"}

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """All rounds, and the one that is shown."""
        shown = rounds.shown_round(context.scene)
        if shown is None:
            draw_sentence(layout, "The rounds of the major layout are shown here once it has run.", context)
            return
        draw_pictures(layout, context, state, shown)
        said = f"{shown.title}, score {shown.score:.2f}"
        draw_sentence(layout, f"{said}: this is the layout" if shown.kept else said, context)
        take = layout.row()
        take.enabled = not shown.kept
        take.operator("code_as_room.take_round", icon="CHECKMARK").number = shown.number + 1
        row = layout.row(align=True)
        if known_operator("code_as_room.look_through"):
            row.operator("code_as_room.look_through", text="Overlay", icon="IMAGE_REFERENCE")
        row.operator("code_as_room.compare_round", text="Side by Side", icon="IMAGE_DATA").number = shown.number + 1


def draw_pictures(layout: Any, context: Any, state: RoomState, shown: RoundRow) -> None:
    """A picture of each round over a button with its score."""
    width = region_width(context)
    columns = COLUMNS if width >= _WIDE else COLUMNS - 1
    scale = max(2.0, min(8.0, (width - _MARGIN) / columns / _UNIT))
    grid = layout.grid_flow(row_major=True, columns=min(columns, len(state.rounds)), even_columns=True)
    missing = False
    for row in state.rounds:
        cell = grid.column(align=True)
        icon = round_pictures.icon(row.picture)
        missing = missing or not icon
        if icon:
            cell.template_icon(icon_value=icon, scale=scale)
        else:
            cell.label(text="No picture")
        text = f"{row.number + 1}:  {row.score:.2f}"
        mark = "CHECKMARK" if row.kept else "NONE"
        active = row.number == shown.number
        cell.operator("code_as_room.show_round", text=text, icon=mark, depress=active).number = row.number + 1
    if missing:
        layout.operator("code_as_room.draw_rounds", text="Draw Missing Pictures", icon="RENDER_STILL")


class CODE_AS_ROOM_PT_critic(RoomPanel):
    """What the critic asked for."""

    bl_idname = "CODE_AS_ROOM_PT_critic"
    bl_label = "What the Critic Asked"
    bl_parent_id = "CODE_AS_ROOM_PT_rounds"
    bl_order = 0

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Only where there are rounds."""
        state = view_state.peek(context.scene)
        return state is not None and bool(state.rounds)

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """The edits of the shown round, in words."""
        shown = rounds.shown_round(context.scene)
        if shown is None:
            return
        if shown.remarks:
            draw_sentence(layout, f"\u201c{shown.remarks}\u201d", context)
        for text in shown.asked[:MOST_ASKED]:
            draw_sentence(layout, text, context, icon="DOT")
        for text in shown.refused[: max(0, MOST_ASKED - len(shown.asked))]:
            draw_sentence(layout, f"Refused: {text}", context, icon="X")
        more = len(shown.asked) + len(shown.refused) - MOST_ASKED
        if more > 0:
            draw_sentence(layout, f"{more} more are in the report.", context)
        if not (shown.remarks or shown.asked or shown.refused):
            draw_sentence(layout, "Nothing was asked for after this round.", context)


class CODE_AS_ROOM_PT_score(RoomPanel):
    """What the score is made of."""

    bl_idname = "CODE_AS_ROOM_PT_score"
    bl_label = "Score"
    bl_parent_id = "CODE_AS_ROOM_PT_rounds"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 1

    poll = CODE_AS_ROOM_PT_critic.poll

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """A bar a part, 1 is best."""
        shown = rounds.shown_round(context.scene)
        column = layout.column(align=True)
        for title, value in shown.parts if shown is not None else ():
            column.progress(factor=min(1.0, max(0.0, value)), text=f"{title}  {value:.2f}", type="BAR")


CLASSES = (CODE_AS_ROOM_PT_rounds, CODE_AS_ROOM_PT_critic, CODE_AS_ROOM_PT_score)
