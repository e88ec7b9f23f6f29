# SPDX-License-Identifier: GPL-3.0-or-later
"""Enabling, disabling and enabling again leaves nothing behind and loses nothing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import properties

OPERATORS = (
    "load_picture", "use_image", "new_room", "run_stage", "run_all", "stop", "write_outputs", "open_report", "open_text",
    "run_to", "redo_from", "open_results", "select_objects", "lock_objects", "include_objects", "take_over",
    "show_round", "take_round", "draw_rounds", "compare_round",
)  # fmt: skip
PANELS = ("reference", "calibration", "stages", "objects", "rounds", "output")


@pytest.fixture(autouse=True)
def empty_blender() -> Iterator[None]:
    """An empty file, and an add-on that is not enabled, before and after."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    yield
    if hasattr(bpy.types.Scene, "code_as_room"):
        code_as_room.unregister()


def ours() -> dict[str, Any]:
    """Everything of ours that Blender knows."""
    handlers = {
        name: [f.__module__ for f in getattr(bpy.app.handlers, name) if "code_as_room" in f.__module__]
        for name in (
            "load_pre",
            "load_post",
            "undo_post",
            "redo_post",
            "save_pre",
            "save_post",
            "depsgraph_update_post",
        )
    }
    return {
        "types": sorted(name for name in dir(bpy.types) if name.startswith(("CODE_AS_ROOM", "CodeAsRoom"))),
        "operators": sorted(dir(bpy.ops.code_as_room)),
        "scene": hasattr(bpy.types.Scene, "code_as_room"),
        "handlers": {name: found for name, found in handlers.items() if found},
    }


def test_nothing_is_left_after_disabling_and_all_is_back_after_enabling() -> None:
    before = ours()
    code_as_room.register()
    enabled = ours()
    assert set(OPERATORS) <= set(enabled["operators"])
    assert {f"CODE_AS_ROOM_PT_{name}" for name in PANELS} <= set(enabled["types"])
    assert enabled["scene"] and enabled["handlers"]
    code_as_room.unregister()
    assert ours() == before
    code_as_room.register()
    assert ours() == enabled


def test_nothing_waits_in_blenders_timers_after_disabling() -> None:
    from code_as_room.operators import driver, handlers

    code_as_room.register()
    handlers.look_soon()
    driver.run_in_window()
    code_as_room.unregister()
    assert not bpy.app.timers.is_registered(handlers._first_look)
    assert not bpy.app.timers.is_registered(driver._tick)


def test_every_operator_and_property_has_a_tooltip() -> None:
    code_as_room.register()
    for name in OPERATORS:
        kind = getattr(bpy.ops.code_as_room, name).get_rna_type()
        assert kind.description.strip() not in ("", "(undocumented operator)"), name
        assert not kind.description.rstrip().endswith("."), "Blender adds the full stop itself"
        hidden = ("rna_type", "filepath", "directory", "filter_image", "filter_folder")
        for prop in kind.properties:
            if prop.identifier not in hidden and not prop.is_hidden:
                assert prop.description or prop.type == "ENUM", f"{name}.{prop.identifier}"
    settings = properties.CodeAsRoomSettings.bl_rna.properties
    assert all(p.description for p in settings if p.identifier not in ("rna_type", "name"))


def test_no_secret_can_reach_an_operator_or_a_scene() -> None:
    code_as_room.register()
    names = {p.identifier for p in properties.CodeAsRoomSettings.bl_rna.properties}
    for operator in OPERATORS:
        names |= set(getattr(bpy.ops.code_as_room, operator).get_rna_type().properties.keys())
    assert not {n for n in names if "key" in n.lower() or "token" in n.lower() or "secret" in n.lower()}


def test_the_key_is_a_password_field_and_its_warning_is_shown() -> None:
    code_as_room.register()
    from code_as_room.panels import preferences

    key = preferences.CodeAsRoomPreferences.bl_rna.properties["api_key"]
    assert key.subtype == "PASSWORD"
    assert "userpref.blend" in preferences.KEY_WARNING
