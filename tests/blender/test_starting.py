# SPDX-License-Identifier: GPL-3.0-or-later
"""Enabling where packages are missing, and disabling before everything is there."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import bpy
import code_as_room
import pytest
from code_as_room.operators import starting


@pytest.fixture(autouse=True)
def clean() -> Iterator[None]:
    yield
    if starting._start.complete or hasattr(bpy.types, "CODE_AS_ROOM_PT_starting"):
        code_as_room.unregister()


def test_where_a_package_is_missing_the_tab_says_which_and_what_to_do(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(starting, "NEEDED", ("numpy", "PIL_that_is_not_there"))
    code_as_room.register()
    assert hasattr(bpy.types, "CODE_AS_ROOM_PT_starting") and not hasattr(bpy.types.Scene, "code_as_room")
    said = capsys.readouterr().err
    assert "PIL_that_is_not_there cannot be imported" in said and "zip" in said and "Traceback" not in said
    code_as_room.unregister()
    assert not hasattr(bpy.types, "CODE_AS_ROOM_PT_starting")


def test_in_a_window_enabling_returns_before_the_imports_are_done(monkeypatch: pytest.MonkeyPatch) -> None:
    going, imported = threading.Event(), []

    def slow(start: object) -> None:
        going.wait(20)
        imported.append(start)

    monkeypatch.setattr(starting, "_import", slow)
    monkeypatch.setattr(starting, "in_background", lambda: False)
    code_as_room.register()
    assert not imported and not hasattr(bpy.types.Scene, "code_as_room")
    assert starting.sentence() == "Starting."
    going.set()
    starting.finish()
    assert imported and hasattr(bpy.types.Scene, "code_as_room")
    assert not hasattr(bpy.types, "CODE_AS_ROOM_PT_starting")


def test_disabling_while_it_starts_leaves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(starting, "in_background", lambda: False)
    code_as_room.register()
    code_as_room.unregister()
    assert not hasattr(bpy.types, "CODE_AS_ROOM_PT_starting") and not hasattr(bpy.types.Scene, "code_as_room")
    assert not bpy.app.timers.is_registered(starting._look)
    assert not [t for t in threading.enumerate() if t.name == "code-as-room-imports"]


def test_an_error_while_registering_is_said_in_the_tab(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(missing: object) -> None:
        raise RuntimeError("broken on purpose")

    monkeypatch.setattr(starting, "in_background", lambda: False)
    monkeypatch.setattr(starting, "_complete", broken)
    code_as_room.register()
    starting.finish()
    assert "could not start" in starting.sentence()
