# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the preferences, in the order in which they are filled in. Reads only what was worked out before."""

from __future__ import annotations

from typing import Any

from ..operators import clients, connection, model_prices, view_state
from ..pipeline.models.presets import preset
from ..pipeline.models.registry import SERVICES
from ..pipeline.models.routing import GROUPS, TEXT
from .preferences_images import draw_image_preferences
from .preferences_service import Fields, draw_address, draw_cap, draw_fold, draw_privacy, draw_provider
from .sentences import draw_sentence

_MODELS = ("model", *(f"model_{group}" for group in (*GROUPS, TEXT)))
FIELDS = Fields("", "services", dict.fromkeys(("base_url", *_MODELS, "api_key", "key_variable"), ""))
SENT = "Each question sends the picture, crops of it and pictures of the layout to this service."
BY_HAND = (
    "Run the stages as usual. The sidebar then shows each prompt: copy it, attach its pictures, paste the chat's answer. "
    "What you send, you send yourself; what the chat keeps of it, its own terms say."
)
_ICONS = {"good": "CHECKMARK", "bad": "ERROR", "unsure": "INFO", "not tried": "BLANK1"}


def draw_preferences(preferences: Any, layout: Any, context: Any) -> None:
    """Everything."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    _draw_answers(preferences, layout, context)
    draw_image_preferences(preferences, layout, context)


def _draw_answers(preferences: Any, layout: Any, context: Any) -> None:
    """Who answers, and what that needs."""
    chosen = preset(preferences.provider)
    draw_provider(preferences, FIELDS, chosen, layout, context)
    if chosen.kind == "recorded":
        layout.prop(preferences, "replies_folder")
    if chosen.kind == "manual":
        layout.prop(preferences, "by_hand_folder", placeholder="The add-on's own")
        draw_sentence(layout, BY_HAND, context, icon="INFO")
    if chosen.kind not in SERVICES:
        _draw_problem(layout, context)
        return
    draw_address(preferences, FIELDS, chosen, clients.key_source(preferences), layout, context)
    _draw_models(preferences, layout, context)
    _draw_test(preferences, layout, context)
    _draw_spending(preferences, layout, context)
    _draw_network(preferences, layout, context)
    draw_privacy(preferences, FIELDS, SENT, layout, context)


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
    if draw_fold(preferences, column, "show_models"):
        for group, (_, numbers) in GROUPS.items():
            first, last = numbers[0], numbers[-1]
            stages = f"stage {first}" if first == last else f"stages {first} to {last}"
            hint = f"{preferences.model.strip() or 'The main model'} ({stages})"
            _draw_model(preferences, column, f"model_{group}", bool(listed), hint)
        hint = f"{preferences.model.strip() or 'The main model'} (any stage)"
        _draw_model(preferences, column, f"model_{TEXT}", bool(listed), hint)


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
    draw_cap(preferences, column)
    lines, missing = model_prices.lines()
    for line in lines:
        draw_sentence(column, line, context, icon="BLANK1")
    for model in missing:
        row = column.row()
        row.operator("code_as_room.set_price", text=f"Set the Price of {model}").model = model
    if missing and preferences.spending_cap > 0.0:
        text = "While a price is not known, the cap cannot be kept, so nothing is sent."
        draw_sentence(column, text, context, icon="ERROR", alert=True)


def _draw_network(preferences: Any, layout: Any, context: Any) -> None:
    """Time-out, questions side by side, proxy, certificates."""
    if not draw_fold(preferences, layout, "show_network"):
        return
    column = layout.column()
    column.prop(preferences, "timeout")
    column.prop(preferences, "at_once", text="Questions at Once (0: automatic)")
    column.prop(preferences, "proxy", placeholder="As the environment says")
    column.prop(preferences, "ca_bundle", placeholder="The usual certificates")
