# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the images on surfaces come from: chosen for one surface or for all, and made anew."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

from ..pipeline.artifacts.textures import TextureSource
from ..pipeline.memory import Memory
from ..pipeline.run_textures import ORDERS, choose_source, prefer
from ..pipeline.stages import all_stages
from . import driver, own_room, room_memory, view_state, ways
from .base import RoomOperator, allow, busy_blocker, stage_blocker
from .stage_ops import StageOperator

TEXTURES = "s09_textures"
BEST = "BEST"
SOURCES: dict[str, TextureSource | None] = {
    BEST: None,
    "MODEL": "model",
    "PICTURE": "picture",
    "PROCEDURAL": "procedural",
}


def _blocker(context: Any) -> str:
    state = view_state.peek(context.scene)
    if state is None or not state.textures.rows:
        return "Run the stage Textures first"
    return busy_blocker(context)


def _words(operator: Any, name: str) -> str:
    """What the artist has chosen, as the menu says it."""
    items: Any = operator.properties.bl_rna.properties[name]
    return str(items.enum_items[getattr(operator, name)].name)


class ChoiceOperator(RoomOperator):
    """Base of the operators that note a choice. Nothing is made or sent until the textures are made anew."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be surfaces, and nothing going on."""
        return allow(cls, _blocker(context))

    def note(self, scene: Any, change: Callable[[Memory], bool], said: str) -> None:
        """Write a choice into memory, and say what is next."""
        own_room.prepare(scene)
        run = room_memory.run_of(scene)
        if change(run.memory):
            room_memory.keep(run)
        state = view_state.refresh(scene)
        waits = state.textures.waits
        driver.note_outcome(scene, f"{said}. Make Textures Anew shows it" if waits else said)
        self.report({"INFO"}, said)


class CODE_AS_ROOM_OT_choose_texture_source(ChoiceOperator):
    """Where the image on this surface comes from. Choose for as many as you like, then make the textures anew"""

    bl_idname = "code_as_room.choose_texture_source"
    bl_label = "Choose Texture Source"

    surface: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Surface", description="Floor, or the object's id", options={"SKIP_SAVE"}
    )
    source: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Source",
        description="Where the image comes from",
        items=(
            (BEST, "Best There Is", "Go by the order that holds for all surfaces", "SORTSIZE", 0),
            ("MODEL", "Image Model", "Painted by the image model of the preferences", "BRUSH_DATA", 1),
            (
                "PICTURE",
                "The Picture",
                "Taken out of the reference picture, where it can be seen there",
                "IMAGE_DATA",
                2,
            ),
            ("PROCEDURAL", "Made Material", "No image: the material of the stage Materials", "MATERIAL", 3),
        ),
        options={"SKIP_SAVE"},
    )

    def perform(self, context: bpy.types.Context) -> None:
        """Note it."""
        source, surface = SOURCES[self.source], self.surface
        words = _words(self, "source")
        state = view_state.peek(context.scene)
        rows = state.textures.rows if state is not None else ()
        title = next((row.title for row in rows if row.surface == surface), surface)
        self.note(context.scene, lambda memory: choose_source(memory, surface, source), f"{title}: {words}")


class CODE_AS_ROOM_OT_prefer_textures(ChoiceOperator):
    """Which sources are tried, in which order, for every surface that has no choice of its own"""

    bl_idname = "code_as_room.prefer_textures"
    bl_label = "Prefer Texture Sources"

    order: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Order",
        description="The sources, best first",
        items=(
            (
                "MODEL_FIRST",
                "Image Model, then Picture",
                "Painted where there is an image model, else from the picture",
            ),
            ("PICTURE_FIRST", "Picture, then Image Model", "From the picture where it shows enough, else painted"),
            ("PICTURE_ONLY", "Picture Only", "From the picture where it shows enough, else a made material"),
            ("MODEL_ONLY", "Image Model Only", "Painted where there is an image model, else a made material"),
            ("MADE", "Made Materials", "No images at all"),
        ),
        options={"SKIP_SAVE"},
    )

    def perform(self, context: bpy.types.Context) -> None:
        """Note it."""
        order, words = ORDERS[self.order], _words(self, "order")
        self.note(context.scene, lambda memory: prefer(memory, order), f"Texture sources: {words}")


class CODE_AS_ROOM_OT_make_textures(StageOperator):
    """Make the images of the surfaces from the chosen sources; what was painted before is not painted again"""

    bl_idname = "code_as_room.make_textures"
    bl_label = "Make Textures Anew"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be surfaces, and nothing going on."""
        return allow(cls, stage_blocker(context) or _blocker(context))

    def begin(self, context: bpy.types.Context) -> None:
        """Start the stage, and those after it that were done: they go on from its program."""
        state, stages = view_state.peek(context.scene), all_stages()
        place = next(n for n, stage in enumerate(stages) if stage.id == TEXTURES)
        done = (
            {row.id for row in state.stages if row.status in ("done", "drafted", "stale")}
            if state is not None
            else set()
        )
        todo = [stages[place], *(s for s in stages[place + 1 :] if s.id in done)]
        driver.start(context.scene, todo, again=True, step=self.bl_label, derived=ways.derived(context.scene, todo))


CLASSES = (
    CODE_AS_ROOM_OT_choose_texture_source,
    CODE_AS_ROOM_OT_prefer_textures,
    CODE_AS_ROOM_OT_make_textures,
)
