# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the preferences, in the order in which they are filled in. Reads only what was worked out before."""

from __future__ import annotations

from typing import Any

from ..operators import clients, connection, view_state
from ..pipeline.models.addresses import is_local_url
from ..pipeline.models.presets import Preset, preset
from ..pipeline.models.routing import GROUPS
from .preferences_images import draw_image_preferences
from .sentences import draw_sentence

KEY_WARNING = (
    "The key is kept unencrypted in Blender's own preferences file (userpref.blend). "
    "It never goes into a scene, a .blend, memory, a log or a report. "
    "Safer: leave it empty, and name an environment variable that holds it."
)
SENT = "Each question sends the picture, crops of it and pictures of the layout to this service."
_ICONS = {"good": "CHECKMARK", "bad": "ERROR", "unsure": "INFO", "not tried": "BLANK1"}


def draw_preferences(preferences: Any, layout: Any, context: Any) -> None:
    """Everything."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    _draw_answers(preferences, layout, context)
    draw_image_preferences(preferences, layout, context, KEY_WARNING)


def _draw_answers(preferences: Any, layout: Any, context: Any) -> None:
    """Who answers, and what that needs."""
    chosen = preset(preferences.provider)
    layout.prop(preferences, "provider")
    draw_sentence(layout, chosen.note, context, icon="INFO")
    if chosen.kind == "recorded":
        layout.prop(preferences, "replies_folder")
    if chosen.kind in ("builtin", "recorded"):
        _draw_problem(layout, context)
        return
    _draw_service(preferences, chosen, layout, context)
    _draw_models(preferences, layout, context)
    _draw_test(preferences, layout, context)
    _draw_spending(preferences, layout, context)
    _draw_network(preferences, layout, context)
    if not is_local_url(preferences.base_url):
        draw_sentence(layout, SENT, context, icon="INFO")
    if preferences.api_key and not preferences.key_variable.strip():
        draw_sentence(layout, KEY_WARNING, context, icon="UNLOCKED")


def _draw_service(preferences: Any, chosen: Preset, layout: Any, context: Any) -> None:
    """Address and key."""
    column = layout.column(align=False)
    column.prop(preferences, "base_url")
    if chosen.key == "none":
        return
    row = column.row(align=True)
    row.active = not preferences.key_variable.strip()
    row.prop(preferences, "api_key", placeholder="" if chosen.key == "needed" else "Only where the service wants one")
    if chosen.key_page:
        row.operator("wm.url_open", text="", icon="URL").url = chosen.key_page
    column.prop(preferences, "key_variable", placeholder="Instead of the key")
    source = clients.key_source(preferences)
    if source:
        draw_sentence(column, f"The key is taken from the environment variable {source}.", context, icon="LOCKED")
    elif chosen.key == "needed" and not preferences.api_key:
        page = chosen.key_page.removeprefix("https://")
        draw_sentence(column, f"There is no key yet. Get one at {page}.", context, icon="KEY_HLT")


def _draw_models(preferences: Any, layout: Any, context: Any) -> None:
    """The main model, and others for some of the stages."""
    column = layout.column()
    listed = connection.models_of(preferences)
    _draw_model(preferences, column, "model", bool(listed), "Type its name, or fetch the list")
    problem = connection.problem()
    if problem is not None:
        draw_sentence(column, str(problem), context, icon="ERROR", alert=True)
    elif listed and not preferences.model.strip():
        draw_sentence(column, f"{len(listed)} models found: click the lens to search them.", context, icon="INFO")
    if _fold(preferences, column, "show_models"):
        for group, (_, numbers) in GROUPS.items():
            first, last = numbers[0], numbers[-1]
            stages = f"stage {first}" if first == last else f"stages {first} to {last}"
            hint = f"{preferences.model.strip() or 'The main model'} ({stages})"
            _draw_model(preferences, column, f"model_{group}", bool(listed), hint)


def _draw_model(preferences: Any, column: Any, name: str, listed: bool, hint: str) -> None:
    row = column.row(align=True)
    row.prop(preferences, name, placeholder=hint)
    if listed:
        row.operator("code_as_room.choose_model", text="", icon="VIEWZOOM").target = name
    if name == "model":
        row.operator("code_as_room.fetch_models", text="", icon="FILE_REFRESH")


def _draw_test(preferences: Any, layout: Any, context: Any) -> None:
    """The connection test: its button, its progress, what it found."""
    column = layout.column()
    task = connection.activity()
    if task is not None:
        row = column.row(align=True)
        row.label(text=f"{task.what} ({task.seconds} s)", icon="SORTTIME")
        row.operator("code_as_room.stop_connection", text="Stop", icon="X")
        draw_sentence(column, task.progress, context, icon="BLANK1")
        return
    row = column.row()
    row.operator("code_as_room.test_connection", icon="LINKED")
    blocker = connection.blocker(preferences)
    found = connection.report()
    if blocker:
        draw_sentence(column, f"{blocker}.", context, icon="ERROR", alert=True)
    elif found is not None:
        text = f"{found.sentence} {found.fix}".strip()
        draw_sentence(column, text, context, icon=_ICONS[found.level], alert=found.level == "bad")
        steps = column.column(align=True)
        for step in found.steps:
            if step.state != "not tried":
                # The sentence above has the reason in full.
                extra = f": {step.text}" if step.text and step.state != "bad" else ""
                draw_sentence(steps, f"{step.title}{extra}", context, icon=_ICONS[step.state])
    else:
        _draw_problem(column, context)


def _draw_problem(layout: Any, context: Any) -> None:
    state = view_state.peek(context.scene) if context.scene else None
    problem = state.client_problem if state is not None else None
    if problem is not None:
        draw_sentence(layout, f"{problem.message} {problem.fix}".strip(), context, icon="ERROR", alert=True)


def _draw_spending(preferences: Any, layout: Any, context: Any) -> None:
    """The cap, and what the models cost."""
    column = layout.column()
    column.prop(preferences, "spending_cap", text="Spending Cap per Room ($)")
    lines, missing = connection.price_lines()
    for line in lines:
        draw_sentence(column, line, context, icon="BLANK1")
    for model in missing:
        row = column.row()
        row.operator("code_as_room.set_price", text=f"Set the Price of {model}").model = model
    if missing and preferences.spending_cap > 0.0:
        text = "While a price is not known, the cap cannot be kept, so nothing is sent."
        draw_sentence(column, text, context, icon="ERROR", alert=True)


def _draw_network(preferences: Any, layout: Any, context: Any) -> None:
    """Time-out, proxy, certificates."""
    if not _fold(preferences, layout, "show_network"):
        return
    column = layout.column()
    column.prop(preferences, "timeout")
    column.prop(preferences, "proxy", placeholder="As the environment says")
    column.prop(preferences, "ca_bundle", placeholder="The usual certificates")


def _fold(preferences: Any, layout: Any, name: str) -> bool:
    """A line that opens and closes what follows; whether it is open."""
    is_open = bool(getattr(preferences, name))
    row = layout.row()
    row.use_property_split = False
    row.alignment = "LEFT"
    row.prop(preferences, name, icon="DOWNARROW_HLT" if is_open else "RIGHTARROW", emboss=False)
    return is_open
