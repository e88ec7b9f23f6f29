# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences: who answers, and where its key is."""

from __future__ import annotations

from typing import Any

import bpy

from .. import __package__ as base_package
from ..operators import view_state
from .sentences import draw_sentence

KEY_WARNING = (
    "The key is kept unencrypted in Blender's own preferences file (userpref.blend). "
    "It never goes into a scene, a .blend, memory, a log or a report. "
    "Safer: leave it empty, and name an environment variable that holds it."
)


def _changed(preferences: Any, context: Any) -> None:
    """The panel says what answers; it may have changed."""
    view_state.refresh_all()


class CodeAsRoomPreferences(bpy.types.AddonPreferences):
    """Which model answers."""

    bl_idname = base_package or "code_as_room"

    provider: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Answers From",
        description="Who looks at the picture",
        items=(
            ("BUILTIN", "Built-in analysis", "No model and no network: the picture is measured on this computer"),
            (
                "OPENAI",
                "Model service",
                "Any service with an OpenAI-style address, on this computer or on the internet",
            ),
            ("RECORDED", "Recorded answers", "Play back answers that were recorded in a folder, as with the samples"),
        ),
        default="BUILTIN",
        update=_changed,
    )
    base_url: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Base URL",
        description="Address of the service, such as http://localhost:1234/v1",
        default="http://localhost:1234/v1",
        update=_changed,
    )
    model: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Model",
        description="The model's name as the service spells it; it must understand pictures",
        update=_changed,
    )
    api_key: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="API Key",
        description="The service's key; may stay empty for a service on this computer",
        subtype="PASSWORD",
        update=_changed,
    )
    key_variable: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Key Variable",
        description="Name of an environment variable that holds the key; it is used instead of the key above",
        update=_changed,
    )
    timeout: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Time-out",
        description="Seconds that the service may be silent for before the run gives up",
        default=120,
        min=5,
        max=3600,
        subtype="TIME_ABSOLUTE",
    )
    replies_folder: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Folder",
        description="Folder with recorded answers (replies.json)",
        subtype="DIR_PATH",
        update=_changed,
    )

    def draw(self, context: bpy.types.Context) -> None:
        """The settings of the chosen provider, and what they mean."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "provider")
        if self.provider == "BUILTIN":
            text = "No model is used: walls, floor and furniture are measured in the picture. Works best on clean pictures."
            draw_sentence(layout, text, context)
        elif self.provider == "RECORDED":
            layout.prop(self, "replies_folder")
        else:
            self._draw_service(layout, context)

    def _draw_service(self, layout: Any, context: Any) -> None:
        layout.prop(self, "base_url")
        layout.prop(self, "model")
        row = layout.row()
        row.enabled = not self.key_variable.strip()
        row.prop(self, "api_key")
        layout.prop(self, "key_variable")
        layout.prop(self, "timeout")
        text = "Each question sends the picture, crops of it and pictures of the layout to this service."
        draw_sentence(layout, text, context)
        draw_sentence(layout, KEY_WARNING, context)
        state = view_state.peek(context.scene) if context.scene else None
        if state is not None and state.client_problem is not None:
            problem = state.client_problem
            draw_sentence(layout, f"{problem.message} {problem.fix}".strip(), context, icon="ERROR", alert=True)


def classes() -> tuple[type, ...]:
    """The preferences' class."""
    return (CodeAsRoomPreferences,)
