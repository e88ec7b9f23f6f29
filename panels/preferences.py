# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences: who answers, where its key is, what may be spent, and the way to it.

What is typed for one provider is kept when another one is chosen and comes back with it. So a key that belongs to one
service is never sent to another.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from .. import __package__ as base_package
from ..operators import clients, connection, view_state
from ..pipeline.models.presets import PRESETS, preset
from . import preferences_images
from .preferences_draw import FIELDS, draw_preferences
from .preferences_service import KEY_WARNING, switch

__all__ = ["KEY_WARNING", "CodeAsRoomPreferences", "classes"]
_switching = False
_MOST_SUGGESTIONS = 400


def _changed(preferences: Any, context: Any) -> None:
    """The panel says what answers; it may have changed."""
    if _switching:
        return
    connection.settings_changed()
    view_state.refresh_all()


def _provider_changed(preferences: Any, context: Any) -> None:
    """Put aside what was typed for the earlier provider, and bring back what belongs to this one."""
    global _switching
    before, now = preferences.last_provider, preferences.provider
    if before != now and not _switching:
        _switching = True
        try:
            switch(preferences, FIELDS, before, now, preset(now).base_url)
            preferences.last_provider = now
        finally:
            _switching = False
    _changed(preferences, context)


def _cap_changed(preferences: Any, context: Any) -> None:
    clients.take_over_cap()


def _suggest_models(preferences: Any, context: Any, text: str) -> Iterator[tuple[str, str]]:
    """What the service listed, for the model's field. No request is made here."""
    words = text.lower().split()
    fitting = (i for i in connection.models_of(preferences) if all(word in i.id.lower() for word in words))
    for number, info in enumerate(fitting):
        if number >= _MOST_SUGGESTIONS:
            return
        yield info.id, info.hint()


def _model(title: str, description: str) -> Any:
    return bpy.props.StringProperty(
        name=title,
        description=description,
        update=_changed,
        search=_suggest_models,
        search_options={"SUGGESTION"},
    )


class CodeAsRoomService(bpy.types.PropertyGroup):
    """What was typed for one provider, while another one is chosen. `name` is the provider's id."""

    base_url: bpy.props.StringProperty(name="Base URL", description="Address of the service")  # type: ignore[valid-type]
    model: bpy.props.StringProperty(name="Model", description="The model's name")  # type: ignore[valid-type]
    model_seeing: bpy.props.StringProperty(name="Seeing", description="The model for stage 1")  # type: ignore[valid-type]
    model_layout: bpy.props.StringProperty(name="Layout", description="The model for stages 2 to 4")  # type: ignore[valid-type]
    model_modelling: bpy.props.StringProperty(name="Modelling", description="The model for stages 5 to 7")  # type: ignore[valid-type]
    model_surfaces: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Surfaces and Light", description="The model for stages 8 to 10"
    )
    model_text: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Without Pictures", description="The model for questions without pictures"
    )
    api_key: bpy.props.StringProperty(name="API Key", description="The service's key", subtype="PASSWORD")  # type: ignore[valid-type]
    key_variable: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Key Variable", description="Name of the environment variable that holds the key"
    )


class CodeAsRoomPreferences(preferences_images.ImagePreferences, bpy.types.AddonPreferences):
    """Which model answers, and which one paints."""

    bl_idname = base_package or "code_as_room"

    provider: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Answers From",
        description="Who looks at the picture",
        items=tuple((p.id, p.title, p.tooltip, "NONE", p.number) for p in PRESETS),
        default="BUILTIN",
        update=_provider_changed,
    )
    last_provider: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Last Provider", description="Whose settings stand in the fields", default="BUILTIN", options={"HIDDEN"}
    )
    services: bpy.props.CollectionProperty(  # type: ignore[valid-type]
        name="Services",
        description="What was typed for the other providers",
        type=CodeAsRoomService,
        options={"HIDDEN"},
    )
    base_url: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Base URL",
        description="Address of the service, such as http://localhost:1234/v1",
        default="http://localhost:1234/v1",
        update=_changed,
    )
    model: _model(  # type: ignore[valid-type]
        "Model", "The model's name as the service spells it; it must understand pictures"
    )
    model_seeing: _model(  # type: ignore[valid-type]
        "Seeing", "Another model for stage 1, which finds everything in the picture. Empty: the main model"
    )
    model_layout: _model(  # type: ignore[valid-type]
        "Layout", "Another model for stages 2 to 4, which place and compare. Empty: the main model"
    )
    model_modelling: _model(  # type: ignore[valid-type]
        "Modelling", "Another model for stages 5 to 7, which shape the objects. Empty: the main model"
    )
    model_surfaces: _model(  # type: ignore[valid-type]
        "Surfaces and Light", "Another model for stages 8 to 10. Empty: the main model"
    )
    model_text: _model(  # type: ignore[valid-type]
        "Without Pictures",
        "Another model for questions without pictures, which needs no eyes. Empty: the stage's model",
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
    spending_cap: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Spending Cap",
        description="Most US dollars for one room; a question that would pass it is not sent. 0 means no cap",
        min=0.0,
        max=10_000.0,
        soft_max=20.0,
        step=50,
        precision=2,
        update=_cap_changed,
    )
    timeout: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Time-out",
        description="Seconds that the service may be silent for before the run gives up",
        default=120,
        min=5,
        max=3600,
        subtype="TIME_ABSOLUTE",
        update=_changed,
    )
    at_once: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Questions at Once",
        description="Most questions that are sent side by side. 0: four, and one to a service on this computer or its "
        "own network. A service that says it is asked too often gets fewer by itself",
        default=0,
        min=0,
        max=4,
        update=_changed,
    )
    proxy: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Proxy",
        description="HTTP proxy on the way to the internet, such as http://proxy:8080. Empty: what the system's "
        "environment says. Services on this computer are always asked directly",
        update=_changed,
    )
    ca_bundle: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="CA Bundle",
        description="PEM file with the certificates to trust, such as a company proxy's. Empty: the usual ones. "
        "Certificates are always checked",
        subtype="FILE_PATH",
        update=_changed,
    )
    replies_folder: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Folder",
        description="Folder with recorded answers (replies.json)",
        subtype="DIR_PATH",
        update=_changed,
    )
    by_hand_folder: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Pictures Folder",
        description="Where a prompt's pictures are saved while it waits for the chat's answer. Empty: the add-on's own",
        subtype="DIR_PATH",
        update=_changed,
    )
    show_models: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Models by Stage", description="Choose another model for some of the stages", options={"SKIP_SAVE"}
    )
    show_network: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Network", description="Time-out, questions at once, proxy and certificates", options={"SKIP_SAVE"}
    )

    def draw(self, context: bpy.types.Context) -> None:
        """The settings of the chosen provider, and what they mean."""
        draw_preferences(self, self.layout, context)


def classes() -> tuple[type, ...]:
    """The preferences' classes."""
    return (CodeAsRoomService, *preferences_images.CLASSES, CodeAsRoomPreferences)
