# SPDX-License-Identifier: GPL-3.0-or-later
"""The preferences' part about the image model: its properties, and how they are drawn.

As with the models that answer, what is typed for one provider is kept apart from the others', keys above all.
"""

from __future__ import annotations

from typing import Any

import bpy

from ..operators import painters, view_state
from ..pipeline.models.addresses import is_local_url
from ..pipeline.models.image_registry import IMAGE_PRESETS, image_preset
from ..pipeline.models.presets import preset
from ..pipeline.models.registry import SERVICES
from .preferences_service import Fields, draw_address, draw_cap, draw_privacy, draw_provider, switch
from .sentences import draw_sentence

FIELDS = Fields(
    "image_", "image_services", {"base_url": "", "model": "", "api_key": "", "key_variable": "", "price": 0.0}
)
_SENT = "For each surface a few words and colours are sent to this service; never the picture itself."
_switching = False


def _changed(preferences: Any, context: Any) -> None:
    """The panel says where images come from; it may have changed."""
    if not _switching:
        view_state.refresh_all()


def _provider_changed(preferences: Any, context: Any) -> None:
    """Put aside what was typed for the earlier provider, and bring back what belongs to this one."""
    global _switching
    before, now = preferences.image_last_provider, preferences.image_provider
    if before != now and not _switching:
        _switching = True
        try:
            switch(preferences, FIELDS, before, now, image_preset(now).base_url)
            preferences.image_last_provider = now
        finally:
            _switching = False
    _changed(preferences, context)


class CodeAsRoomImageService(bpy.types.PropertyGroup):
    """What was typed for one provider of images, while another one is chosen. `name` is the provider's id."""

    base_url: bpy.props.StringProperty(name="Base URL", description="Address of the service")  # type: ignore[valid-type]
    model: bpy.props.StringProperty(name="Model", description="The image model's name")  # type: ignore[valid-type]
    api_key: bpy.props.StringProperty(name="API Key", description="The service's key", subtype="PASSWORD")  # type: ignore[valid-type]
    key_variable: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Key Variable", description="Name of the environment variable that holds the key"
    )
    price: bpy.props.FloatProperty(name="Price of an Image", description="US dollars")  # type: ignore[valid-type]


class ImagePreferences:
    """Which image model paints surfaces; a part of the add-on's preferences."""

    image_provider: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Image Model",
        description="Who paints images for floors, rugs and pictures, in stage 9",
        items=tuple((p.id, p.title, p.tooltip, "NONE", p.number) for p in IMAGE_PRESETS),
        default="NONE",
        update=_provider_changed,
    )
    image_last_provider: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Last Image Provider",
        description="Whose settings stand in the fields",
        default="NONE",
        options={"HIDDEN"},
    )
    image_services: bpy.props.CollectionProperty(  # type: ignore[valid-type]
        name="Image Services",
        description="What was typed for the other providers of images",
        type=CodeAsRoomImageService,
        options={"HIDDEN"},
    )
    image_base_url: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Base URL", description="Address of the image service, such as http://localhost:8080/v1", update=_changed
    )
    image_model: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Model", description="The image model's name as the service spells it", update=_changed
    )
    image_api_key: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="API Key",
        description="The image service's key; may stay empty for a service on this computer",
        subtype="PASSWORD",
        update=_changed,
    )
    image_key_variable: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Key Variable",
        description="Name of an environment variable that holds the key; it is used instead of the key above",
        update=_changed,
    )
    image_price: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Price of an Image",
        description="US dollars for one image, for the spending cap; 0 means that it is not known",
        min=0.0,
        max=1000.0,
        soft_max=1.0,
        step=1,
        precision=3,
        update=_changed,
    )


def draw_image_preferences(preferences: Any, layout: Any, context: Any) -> None:
    """Which image model paints, and what that needs."""
    layout.separator()
    chosen = image_preset(preferences.image_provider)
    draw_provider(preferences, FIELDS, chosen, layout, context)
    if chosen.kind == "builtin":
        return
    draw_address(preferences, FIELDS, chosen, painters.image_key_source(preferences), layout, context)
    layout.column().prop(preferences, "image_model", placeholder="The image model's name")
    if not is_local_url(preferences.image_base_url):
        _draw_price(preferences, layout, context)
    draw_privacy(preferences, FIELDS, _SENT, layout, context)


def _draw_price(preferences: Any, layout: Any, context: Any) -> None:
    """What an image costs, and the cap where it is not shown with the questions' service."""
    column = layout.column()
    column.prop(preferences, "image_price", text="Price of an Image ($)")
    if preset(preferences.provider).kind not in SERVICES:
        draw_cap(preferences, column)
    if not preferences.image_price and preferences.spending_cap > 0.0:
        text = "While the price is not known, the spending cap cannot be kept, so nothing is painted."
        draw_sentence(column, text, context, icon="ERROR", alert=True)


CLASSES = (CodeAsRoomImageService,)
