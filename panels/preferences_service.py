# SPDX-License-Identifier: GPL-3.0-or-later
"""What both parts of the preferences share: the fields of one service, kept apart from those of others, and how they look.

Questions and images may come from different services, so each part has fields of its own; `Fields` names them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..pipeline.models.addresses import is_local_url
from ..pipeline.models.presets import Preset
from .sentences import draw_sentence

KEY_WARNING = (
    "The key is kept unencrypted in Blender's own preferences file (userpref.blend). "
    "It never goes into a scene, a .blend, memory, a log or a report. "
    "Safer: leave it empty, and name an environment variable that holds it."
)


@dataclass(frozen=True)
class Fields:
    """The preferences' properties of one part.

    Attributes:
        prefix: with which their names begin; services: the collection in which other providers' values are put aside.
        empty: what is kept for each provider, and its value where nothing was typed yet.
    """

    prefix: str
    services: str
    empty: Mapping[str, Any]

    def of(self, preferences: Any, name: str) -> Any:
        """A property's value."""
        return getattr(preferences, self.prefix + name)


def switch(preferences: Any, fields: Fields, before: str, now: str, base_url: str) -> None:
    """Put aside what was typed for one provider, and bring back what belongs to another.

    So a key that belongs to one service is never sent to another.

    Args:
        base_url: the other provider's own address, where none was typed for it.
    """
    services = getattr(preferences, fields.services)
    kept = services.get(before)
    if kept is None:
        kept = services.add()
        kept.name = before
    for name in fields.empty:
        setattr(kept, name, fields.of(preferences, name))
    found = services.get(now)
    for name, empty in fields.empty.items():
        setattr(preferences, fields.prefix + name, empty if found is None else getattr(found, name))
    if not fields.of(preferences, "base_url").strip():
        setattr(preferences, fields.prefix + "base_url", base_url)


def draw_provider(preferences: Any, fields: Fields, chosen: Preset, layout: Any, context: Any) -> None:
    """Which service, and what it is."""
    layout.prop(preferences, f"{fields.prefix}provider")
    draw_sentence(layout, chosen.note, context, icon="INFO")


def draw_address(preferences: Any, fields: Fields, chosen: Preset, source: str, layout: Any, context: Any) -> None:
    """Address and key.

    Args:
        source: the environment variable that the key comes from, "" for none.
    """
    column = layout.column(align=False)
    column.prop(preferences, f"{fields.prefix}base_url")
    if chosen.key == "none":
        return
    needed = chosen.key == "needed"
    row = column.row(align=True)
    row.active = not fields.of(preferences, "key_variable").strip()
    row.prop(preferences, f"{fields.prefix}api_key", placeholder="" if needed else "Only where the service wants one")
    if chosen.key_page:
        row.operator("wm.url_open", text="", icon="URL").url = chosen.key_page
    column.prop(preferences, f"{fields.prefix}key_variable", placeholder="Instead of the key")
    if source:
        draw_sentence(column, f"The key is taken from the environment variable {source}.", context, icon="LOCKED")
    elif needed and not fields.of(preferences, "api_key"):
        page = chosen.key_page.removeprefix("https://")
        draw_sentence(column, f"There is no key yet. Get one at {page}.", context, icon="KEY_HLT")


def draw_cap(preferences: Any, layout: Any) -> None:
    """The spending cap, which holds for questions and images together."""
    layout.prop(preferences, "spending_cap", text="Spending Cap per Room ($)")


def draw_privacy(preferences: Any, fields: Fields, sent: str, layout: Any, context: Any) -> None:
    """What leaves this computer, and where the key lies.

    Args:
        sent: the sentence on what is sent.
    """
    if not is_local_url(fields.of(preferences, "base_url")):
        draw_sentence(layout, sent, context, icon="INFO")
    if fields.of(preferences, "api_key") and not fields.of(preferences, "key_variable").strip():
        draw_sentence(layout, KEY_WARNING, context, icon="UNLOCKED")


def draw_fold(preferences: Any, layout: Any, name: str) -> bool:
    """A line that opens and closes what follows; whether it is open."""
    is_open = bool(getattr(preferences, name))
    row = layout.row()
    row.use_property_split = False
    row.alignment = "LEFT"
    row.prop(preferences, name, icon="DOWNARROW_HLT" if is_open else "RIGHTARROW", emboss=False)
    return is_open
