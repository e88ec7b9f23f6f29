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
from .sentences import draw_sentence

_OF_SERVICE = ("base_url", "model", "api_key", "key_variable", "price")
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
            _switch(preferences, before, now)
            preferences.image_last_provider = now
        finally:
            _switching = False
    _changed(preferences, context)


def _switch(preferences: Any, before: str, now: str) -> None:
    kept = preferences.image_services.get(before)
    if kept is None:
        kept = preferences.image_services.add()
        kept.name = before
    for name in _OF_SERVICE:
        setattr(kept, name, getattr(preferences, f"image_{name}"))
    found = preferences.image_services.get(now)
    for name in _OF_SERVICE:
        empty: Any = 0.0 if name == "price" else ""
        setattr(preferences, f"image_{name}", getattr(found, name) if found is not None else empty)
    if not preferences.image_base_url.strip():
        preferences.image_base_url = image_preset(now).base_url


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


def draw_image_preferences(preferences: Any, layout: Any, context: Any, key_warning: str) -> None:
    """Which image model paints, and what that needs."""
    layout.separator()
    column = layout.column()
    column.prop(preferences, "image_provider")
    chosen = image_preset(preferences.image_provider)
    draw_sentence(column, chosen.note, context, icon="INFO")
    if chosen.kind == "builtin":
        return
    column.prop(preferences, "image_base_url")
    row = column.row(align=True)
    row.active = not preferences.image_key_variable.strip()
    needed = chosen.key == "needed"
    row.prop(preferences, "image_api_key", placeholder="" if needed else "Only where the service wants one")
    if chosen.key_page:
        row.operator("wm.url_open", text="", icon="URL").url = chosen.key_page
    column.prop(preferences, "image_key_variable", placeholder="Instead of the key")
    source = painters.image_key_source(preferences)
    if source:
        draw_sentence(column, f"The key is taken from the environment variable {source}.", context, icon="LOCKED")
    elif needed and not preferences.image_api_key:
        page = chosen.key_page.removeprefix("https://")
        draw_sentence(column, f"There is no key yet. Get one at {page}.", context, icon="KEY_HLT")
    column.prop(preferences, "image_model", placeholder="The image model's name")
    local = is_local_url(preferences.image_base_url)
    if not local:
        column.prop(preferences, "image_price", text="Price of an Image ($)")
        if preset(preferences.provider).kind in ("builtin", "recorded"):  # else it is shown above
            column.prop(preferences, "spending_cap", text="Spending Cap per Room ($)")
        if not preferences.image_price and preferences.spending_cap > 0.0:
            text = "While the price is not known, the spending cap cannot be kept, so nothing is painted."
            draw_sentence(column, text, context, icon="ERROR", alert=True)
        draw_sentence(column, _SENT, context, icon="INFO")
    if preferences.image_api_key and not preferences.image_key_variable.strip():
        draw_sentence(column, key_warning, context, icon="UNLOCKED")


CLASSES = (CodeAsRoomImageService,)
