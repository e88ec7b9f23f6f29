# SPDX-License-Identifier: GPL-3.0-or-later
"""What the preferences' buttons do: test the connection, fetch and choose models, set prices."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.models.routing import GROUPS, TEXT
from . import clients, connection, model_prices
from .base import allow, manager


class _ConnectionOperator(bpy.types.Operator):
    """Base of the operators that ask a service. Called from the window they return at once, from a script they block."""

    def begin(self) -> None:
        """Start; raises RoomError."""
        raise NotImplementedError

    def tell(self) -> set[Any]:
        """Report the result of a blocking call."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Says why nothing can be asked."""
        return allow(cls, connection.blocker(clients.add_on_preferences()))

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """From the window."""
        if bpy.app.background:
            return self.execute(context)
        try:
            self.begin()
        except RoomError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        connection.run_in_window()
        return {"FINISHED"}

    def execute(self, context: bpy.types.Context) -> set[Any]:
        """From a script."""
        try:
            self.begin()
        except RoomError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        connection.run_blocking()
        return self.tell()


class CODE_AS_ROOM_OT_test_connection(_ConnectionOperator):
    """Ask the service a tiny question and show it a small test picture of our own; says exactly what does not work"""

    bl_idname = "code_as_room.test_connection"
    bl_label = "Test Connection"
    bl_options = {"REGISTER"}

    def begin(self) -> None:
        """Start."""
        connection.start_test()

    def tell(self) -> set[Any]:
        """Report what was found."""
        found = connection.report()
        if found is None:
            return {"CANCELLED"}
        bad = found.level == "bad"
        self.report({"ERROR" if bad else "INFO"}, f"{found.sentence} {found.fix}".strip())
        return {"CANCELLED"} if bad else {"FINISHED"}


class CODE_AS_ROOM_OT_fetch_models(_ConnectionOperator):
    """Ask the service which models it offers; then they can be searched in the model's field"""

    bl_idname = "code_as_room.fetch_models"
    bl_label = "Fetch Models"
    bl_options = {"REGISTER"}

    def begin(self) -> None:
        """Start."""
        connection.start_listing()

    def tell(self) -> set[Any]:
        """Report what was found."""
        problem = connection.problem()
        if problem is not None:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{len(connection.models_of(clients.add_on_preferences()))} models found")
        return {"FINISHED"}


class CODE_AS_ROOM_OT_stop_connection(bpy.types.Operator):
    """Stop asking the service"""

    bl_idname = "code_as_room.stop_connection"
    bl_label = "Stop Asking"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Something must be asked."""
        return allow(cls, "" if connection.activity() is not None else "Nothing is being asked")

    def execute(self, context: bpy.types.Context) -> set[Any]:
        """Stop."""
        connection.stop()
        return {"FINISHED"}


_items: list[tuple[str, str, str]] = []
"""Blender keeps no copy of an enum's strings."""


def _listed(operator: Any, context: Any) -> list[tuple[str, str, str]]:
    global _items
    preferences = clients.add_on_preferences()
    found = connection.models_of(preferences) if preferences is not None else ()
    _items = [(i.id, f"{i.id}   ({i.hint()})" if i.hint() else i.id, "Take this model") for i in found]
    return _items


class CODE_AS_ROOM_OT_choose_model(bpy.types.Operator):
    """Search the models that the service offers, and take one"""

    bl_idname = "code_as_room.choose_model"
    bl_label = "Choose Model"
    bl_options = {"REGISTER"}
    bl_property = "model"

    model: bpy.props.EnumProperty(name="Model", description="A model that the service offers", items=_listed)  # type: ignore[valid-type]
    target: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Setting", description="The setting that the model is for", default="model", options={"HIDDEN"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a list."""
        preferences = clients.add_on_preferences()
        there = preferences is not None and bool(connection.models_of(preferences))
        return allow(cls, "" if there else "Fetch the service's models first")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Show the search."""
        manager(context).invoke_search_popup(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[Any]:
        """Take the model."""
        preferences = clients.add_on_preferences()
        if preferences is None or self.target not in ("model", *(f"model_{g}" for g in (*GROUPS, TEXT))):
            return {"CANCELLED"}
        setattr(preferences, self.target, self.model)
        connection.redraw()
        return {"FINISHED"}


class CODE_AS_ROOM_OT_set_price(bpy.types.Operator):
    """Tell what a model costs, so that costs can be shown and the spending cap can hold"""

    bl_idname = "code_as_room.set_price"
    bl_label = "Set Price"
    bl_options = {"REGISTER"}

    model: bpy.props.StringProperty(name="Model", description="The model's name as the service spells it")  # type: ignore[valid-type]
    sent: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Sent",
        description="US dollars for a million tokens that are sent (input)",
        min=0.0,
        max=10_000.0,
        precision=3,
    )
    answered: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Answered",
        description="US dollars for a million tokens that are answered (output)",
        min=0.0,
        max=10_000.0,
        precision=3,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be preferences."""
        return allow(cls, "" if clients.add_on_preferences() is not None else "The add-on's preferences are not there")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Ask for the two numbers; those that are known stand there already."""
        preferences = clients.add_on_preferences()
        self.model = self.model or preferences.model
        try:
            known = clients.prices().find(preferences.base_url, self.model)
        except RoomError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.sent, self.answered = (known.input, known.output) if known is not None else (0.0, 0.0)
        result: set[Any] = manager(context).invoke_props_dialog(self, width=360)
        return result

    def draw(self, context: bpy.types.Context) -> None:
        """The dialog."""
        layout: Any = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "model")
        layout.label(text="US dollars for a million tokens:")
        layout.prop(self, "sent")
        layout.prop(self, "answered")

    def execute(self, context: bpy.types.Context) -> set[Any]:
        """Keep the price."""
        from ..pipeline.models.prices import Price

        preferences = clients.add_on_preferences()
        price = Price(self.sent, self.answered, datetime.now(UTC).date().isoformat(), own=True)
        try:
            if not self.model.strip():
                raise RoomError("No model is named.", "Type its name.")
            clients.keep_price(preferences.base_url, self.model.strip(), price)
        except RoomError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        model_prices.look_up()
        connection.redraw()
        return {"FINISHED"}


CLASSES = (
    CODE_AS_ROOM_OT_test_connection,
    CODE_AS_ROOM_OT_fetch_models,
    CODE_AS_ROOM_OT_stop_connection,
    CODE_AS_ROOM_OT_choose_model,
    CODE_AS_ROOM_OT_set_price,
)
