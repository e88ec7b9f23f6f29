# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Textures: each surface, where its image came from and why, and the artist's choice."""

from __future__ import annotations

from typing import Any

from ..operators import view_state
from ..operators.texture_rows import SurfaceRow
from ..operators.view_state import RoomState
from .base import RoomPanel, base_package
from .sentences import draw_sentence, line_length

_ORDER = {
    "MODEL_FIRST": "Image model, then picture",
    "PICTURE_FIRST": "Picture, then image model",
    "PICTURE_ONLY": "Picture only",
    "MODEL_ONLY": "Image model only",
    "MADE": "Made materials",
}
_PICKED = {"model": "Image model", "picture": "The picture", "procedural": "Made"}


class CODE_AS_ROOM_PT_textures(RoomPanel):
    """Where the images on surfaces come from."""

    bl_idname = "CODE_AS_ROOM_PT_textures"
    bl_label = "Textures"
    bl_order = 4
    bl_options = {"DEFAULT_CLOSED"}

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """The order for all, a row a surface, and the button that makes them anew."""
        textures = state.textures
        if not textures.rows:
            draw_sentence(layout, "Floors, rugs and pictures are shown here once the stage Textures has run.", context)
            return
        layout.operator_menu_enum(
            "code_as_room.prefer_textures", "order", text=_ORDER.get(textures.order, "Own order"), icon="SORTSIZE"
        )
        column = layout.box().column(align=True)
        for row in textures.rows:
            draw_surface(column, context, row)
        draw_painter(layout, context, state)
        layout.operator("code_as_room.make_textures", icon="FILE_REFRESH")
        if textures.waits:
            draw_sentence(layout, "You have chosen other sources since these were made.", context, icon="INFO")
        if textures.paints:
            draw_sentence(layout, textures.paints, context, icon="BRUSH_DATA")


def draw_surface(column: Any, context: Any, row: SurfaceRow) -> None:
    """One surface: its name, and a menu with its source on it."""
    split = column.split(factor=0.45, align=True)
    most = max(8, int(0.45 * line_length(context)))
    split.label(text=row.title if len(row.title) <= most else f"{row.title[: most - 1]}…")
    text = _PICKED.get(row.wanted, "Best there is") if row.waits else row.source
    icon = "FILE_REFRESH" if row.waits else "PINNED" if row.wanted else "NONE"
    menu = split.operator_menu_enum("code_as_room.choose_texture_source", "source", text=text, icon=icon)
    menu.surface = row.surface


def draw_painter(layout: Any, context: Any, state: RoomState) -> None:
    """Which image model there is, and where it is chosen."""
    textures = state.textures
    row = layout.row()
    if textures.problem:
        draw_sentence(row, textures.problem, context, icon="ERROR", alert=True, beside=1)
    else:
        draw_sentence(row, textures.painter or "No image model is chosen", context, icon="BRUSH_DATA", beside=1)
    package = base_package()
    if package in context.preferences.addons:
        row.operator("preferences.addon_show", text="", icon="PREFERENCES").module = package


class CODE_AS_ROOM_PT_texture_reasons(RoomPanel):
    """Why surfaces have what they have."""

    bl_idname = "CODE_AS_ROOM_PT_texture_reasons"
    bl_label = "Why These Sources"
    bl_parent_id = "CODE_AS_ROOM_PT_textures"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Only where there are surfaces."""
        state = view_state.peek(context.scene)
        return state is not None and bool(state.textures.rows)

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """A few sentences for each reason and image."""
        reasons: dict[str, list[str]] = {}
        for row in state.textures.rows:
            if row.note:
                reasons.setdefault(row.note, []).append(row.title)
        for note, titles in reasons.items():
            draw_sentence(layout, f"{', '.join(titles)}: {note}", context, icon="INFO")
        for row in state.textures.rows:
            if row.detail:
                draw_sentence(layout, f"{row.title}: {row.detail}", context, icon="TEXTURE")
        if not reasons and not any(row.detail for row in state.textures.rows):
            draw_sentence(layout, "No images are used.", context)


CLASSES = (CODE_AS_ROOM_PT_textures, CODE_AS_ROOM_PT_texture_reasons)
