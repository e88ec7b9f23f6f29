# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Detected Objects: a list of what was seen, what became of each thing, edits by hand, and findings."""

from __future__ import annotations

from typing import Any

import bpy

from ..operators import driver, object_list, view_state
from ..operators.view_state import RoomState
from ..pipeline.report_objects import ObjectRow
from ..pipeline.report_words import words
from .assets import draw_asset
from .base import RoomPanel, known_operator
from .sentences import draw_sentence, line_length, plural
from .through_camera import draw_boxes

SEVERITY_ICONS = {"error": "ERROR", "warning": "ERROR", "note": "INFO"}
STATE_ICONS = {
    "detected": "RADIOBUT_OFF",
    "placed": "CHECKMARK",
    "detailed": "MESH_MONKEY",
    "deferred": "TIME",
    "dropped": "X",
    "left out": "HIDE_ON",
}
PLACEMENT_ICONS = {"floor": "TRIA_DOWN_BAR", "wall": "TRIA_RIGHT_BAR", "ceiling": "TRIA_UP_BAR", "surface": "IMPORT"}
ROWS = 6
MOST_FINDINGS = 8
_WIDE, _MIDDLE = 34, 26
"""Characters from which the list has room for a second word, and for where a thing stands."""


class CODE_AS_ROOM_UL_objects(bpy.types.UIList):
    """The objects. Typing filters by name, category, state and placement."""

    bl_idname = "CODE_AS_ROOM_UL_objects"

    def draw_item(
        self,
        context: Any,
        layout: Any,
        data: Any,
        item: Any,
        icon: Any,
        active_data: Any,
        active_property: Any,
        index: Any = 0,
        flt_flag: Any = 0,
    ) -> None:
        """State, name, placement, lock and include."""
        row = object_list.row_of(item)
        if row is None:
            layout.label(text=item.name)
            return
        line = layout.row(align=True)
        name = line.row(align=True)
        name.active = row.included and row.state != "dropped"
        name.label(text=row.title, icon="GREASEPENCIL" if row.edited else STATE_ICONS[row.state])
        if line_length(context) >= _WIDE and _says_more(row):
            kind = name.row(align=True)
            kind.active = False
            kind.alignment = "RIGHT"
            kind.label(text=words(row.category))
        if line_length(context) >= _MIDDLE:
            line.label(text="", icon=PLACEMENT_ICONS.get(row.placement, "BLANK1"))
        switches = line.row(align=True)
        switches.enabled = not driver.is_running()
        switches.prop(item, "locked", text="", icon="LOCKED" if row.locked else "UNLOCKED", emboss=False)
        switches.prop(item, "include", text="", icon="CHECKBOX_HLT" if row.included else "CHECKBOX_DEHLT", emboss=False)

    def filter_items(self, context: Any, data: Any, propname: str) -> Any:
        """Blender's filter and sorting, over everything that a row says."""
        items = getattr(data, propname)
        state = view_state.peek(context.scene)
        rows = [state.by_id.get(item.name) if state is not None else None for item in items]
        wanted = self.filter_name.lower().split()
        flags: list[int] = []
        if wanted:
            shown = (_haystack(row, item.name) for row, item in zip(rows, items, strict=True))
            flags = [self.bitflag_filter_item if all(word in hay for word in wanted) else 0 for hay in shown]
        order: list[int] = []
        if self.use_filter_sort_alpha:
            titles = [row.title.lower() if row is not None else "" for row in rows]
            places = sorted(range(len(titles)), key=lambda place: titles[place])
            order = [0] * len(places)
            for new, old in enumerate(places):
                order[old] = new
        return flags, order


def _says_more(row: ObjectRow) -> bool:
    """Whether the category is not in the name already."""
    return not row.title.lower().startswith(row.category.lower())


def _haystack(row: ObjectRow | None, name: str) -> str:
    if row is None:
        return name.lower()
    marks = ("locked" if row.locked else "", "edited by hand" if row.edited else "")
    return " ".join((row.title, row.id, row.label, words(row.category), row.state, row.placement, *marks)).lower()


class CODE_AS_ROOM_MT_objects(bpy.types.Menu):
    """Verbs for several objects."""

    bl_idname = "CODE_AS_ROOM_MT_objects"
    bl_label = "Object Specials"

    def draw(self, context: bpy.types.Context) -> None:
        """Select, lock, leave out."""
        layout: Any = self.layout
        layout.operator_menu_enum("code_as_room.select_objects", "group", text="Select", icon="RESTRICT_SELECT_OFF")
        layout.separator()
        for text, icon, group, lock in (
            ("Lock Selected", "LOCKED", "SELECTED", True),
            ("Unlock Selected", "UNLOCKED", "SELECTED", False),
            ("Lock All", "LOCKED", "ALL", True),
            ("Unlock All", "UNLOCKED", "ALL", False),
        ):
            operator = layout.operator("code_as_room.lock_objects", text=text, icon=icon)
            operator.group, operator.lock, operator.identifier = group, lock, ""
        layout.separator()
        for text, icon, boxes in (("Show as Boxes", "MESH_CUBE", True), ("Show Modelled", "MESH_MONKEY", False)):
            layout.operator("code_as_room.show_boxes", text=text, icon=icon).boxes = boxes
        layout.operator("code_as_room.detail_again", icon="FILE_REFRESH")
        layout.operator("code_as_room.edit_function", icon="TEXT")
        layout.operator("code_as_room.find_assets", text="Find Assets", icon="ASSET_MANAGER")
        layout.operator("code_as_room.drop_assets", text="Without Assets", icon="X")
        layout.separator()
        operator = layout.operator("code_as_room.include_objects", text="Leave Out Selected", icon="CHECKBOX_DEHLT")
        operator.group, operator.include = "SELECTED", False
        operator = layout.operator("code_as_room.include_objects", text="Take In All", icon="CHECKBOX_HLT")
        operator.group, operator.include = "ALL", True


class CODE_AS_ROOM_PT_objects(RoomPanel):
    """What was seen in the picture."""

    bl_idname = "CODE_AS_ROOM_PT_objects"
    bl_label = "Detected Objects"
    bl_order = 2

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """The list, and the chosen object."""
        settings = context.scene.code_as_room
        if not state.objects:
            text = "What is seen in the picture is listed here after the scene analysis."
            draw_sentence(layout, text if state.picture_name else "Load a picture first.", context)
            return
        row = layout.row()
        row.template_list(
            "CODE_AS_ROOM_UL_objects", "", settings, "objects", settings, "active_object", rows=ROWS, sort_lock=True
        )
        side = row.column(align=True)
        if known_operator("code_as_room.add_missing"):
            side.operator("code_as_room.add_missing", text="", icon="ADD")
        if known_operator("code_as_room.delete_added"):
            side.operator("code_as_room.delete_added", text="", icon="REMOVE")
        side.separator()
        side.menu("CODE_AS_ROOM_MT_objects", text="", icon="DOWNARROW_HLT")
        column = layout.column(align=True)
        column.scale_y = 0.85
        column.label(text=", ".join(f"{count} {word}" for word, count in state.ledger))
        draw_boxes(layout, context)
        if len(settings.objects):
            draw_active(layout, context, state)


def draw_active(layout: Any, context: Any, state: RoomState) -> None:
    """The chosen object: what it is, and what became of it."""
    settings = context.scene.code_as_room
    row = object_list.active_row(context.scene)
    if row is None:
        return
    item = settings.objects[settings.active_object]
    column = layout.column()
    column.use_property_split = True
    column.use_property_decorate = False
    column.enabled = not driver.is_running()
    column.prop(item, "category")
    note = column.row()
    note.active = state.uses_model
    note.prop(item, "note", placeholder="Hint for the model")
    box = layout.box().column(align=True)
    draw_sentence(box, row.sentence, context, icon=STATE_ICONS[row.state])
    draw_sentence(box, row.stands, context, icon=PLACEMENT_ICONS.get(row.placement, "BLANK1"))
    if row.size is not None:
        draw_sentence(box, f"{' x '.join(f'{v:.2f}' for v in row.size)} m", context, icon="FIXED_SIZE")
    if row.seen_well:
        draw_sentence(box, row.seen_well.capitalize(), context, icon="VIEWZOOM")
    if row.locked:
        line = box.row()
        line.label(text="Edited by hand" if row.edited else "Locked", icon="LOCKED")
        operator = line.operator("code_as_room.lock_objects", text="Unlock")
        operator.group, operator.lock, operator.identifier = "SELECTED", False, row.id
    elif row.edited:
        draw_sentence(box, "Edited by hand, unlocked since", context, icon="UNLOCKED")
    draw_asset(layout, context, state, row.name)


class CODE_AS_ROOM_PT_hand_edits(RoomPanel):
    """What was edited by hand and taken over."""

    bl_idname = "CODE_AS_ROOM_PT_hand_edits"
    bl_label = "Hand Edits"
    bl_parent_id = "CODE_AS_ROOM_PT_objects"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 0

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only where something stands that can be edited."""
        state = view_state.peek(context.scene)
        return state is not None and state.has_layout

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """How many."""
        state, layout = view_state.peek(context.scene), self.layout
        if state is not None and state.last_count and layout is not None:
            layout.label(text=f"{state.last_count} taken over")

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """The edits that were taken over last, and the locks."""
        if not state.hand_edits:
            text = (
                "Move, turn, scale, rename, delete or add objects as you like: each run takes it over and locks them."
            )
            draw_sentence(layout, text, context)
        else:
            draw_sentence(layout, f"{plural(state.last_count, 'edit')} taken over last:", context, icon="GREASEPENCIL")
            for sentence in state.last_edits:
                draw_sentence(layout, sentence, context, icon="DOT")
            if state.last_count > len(state.last_edits):
                layout.label(text=f"and {state.last_count - len(state.last_edits)} before", icon="BLANK1")
            if state.hand_edits > state.last_count:
                layout.label(text=f"{plural(state.hand_edits, 'edit')} in all", icon="BLANK1")
        layout.operator("code_as_room.take_over", icon="FILE_REFRESH")
        layout.operator("code_as_room.add_to_room", icon="ADD")
        if state.locked:
            column = layout.column(align=True)
            for row in state.locked:
                line = column.row(align=True)
                line.label(text=row.title, icon="LOCKED")
                operator = line.operator("code_as_room.lock_objects", text="", icon="UNLOCKED", emboss=False)
                operator.group, operator.lock, operator.identifier = "SELECTED", False, row.id
            operator = layout.operator("code_as_room.lock_objects", text="Unlock All", icon="UNLOCKED")
            operator.group, operator.lock, operator.identifier = "LOCKED", False, ""


class CODE_AS_ROOM_PT_findings(RoomPanel):
    """What was repaired, left out or doubted."""

    bl_idname = "CODE_AS_ROOM_PT_findings"
    bl_label = "Findings"
    bl_parent_id = "CODE_AS_ROOM_PT_objects"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 1

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only where there is something."""
        state = view_state.peek(context.scene)
        return state is not None and bool(state.findings)

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """How many are worth a look."""
        state, layout = view_state.peek(context.scene), self.layout
        serious = sum(count for severity, count in state.severities if severity != "note") if state is not None else 0
        if serious and layout is not None:
            layout.label(text=str(serious), icon="ERROR")

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Errors first; the report has them all."""
        for finding in state.findings[:MOST_FINDINGS]:
            icon = SEVERITY_ICONS[finding.severity]
            draw_sentence(layout, f"{finding.about}: {finding.message}", context, icon=icon)
        more = len(state.findings) - MOST_FINDINGS
        if more > 0:
            draw_sentence(layout, f"{more} more are in the report.", context)


CLASSES = (CODE_AS_ROOM_PT_objects, CODE_AS_ROOM_PT_hand_edits, CODE_AS_ROOM_PT_findings)
PARTS = (CODE_AS_ROOM_UL_objects, CODE_AS_ROOM_MT_objects)
