# SPDX-License-Identifier: GPL-3.0-or-later
"""A panel's layout that only notes what it is told, so that a test can read what an artist would."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import bpy
from code_as_room.operators import view_state


class Lines:
    """A layout that only notes what it says; what it names must exist."""

    def __init__(self, said: list[str] | None = None) -> None:
        self.said: list[str] = [] if said is None else said

    def row(self, **_: Any) -> Lines:
        return Lines(self.said)

    column = box = split = row

    def label(self, text: str = "", icon: str = "NONE") -> None:
        self.said.append(text)

    def prop(self, owner: Any, name: str) -> None:
        assert hasattr(owner, name)
        self.said.append(name)

    def operator(self, name: str, text: str = "", icon: str = "NONE", emboss: bool = True) -> Any:
        self.said.append(f"[{icon}] {text or name}")
        return SimpleNamespace()

    def operator_menu_enum(self, name: str, prop: str, text: str = "", icon: str = "NONE") -> Any:
        assert prop in getattr(bpy.ops.code_as_room, name.partition(".")[2]).get_rna_type().properties
        self.said.append(text)
        return SimpleNamespace()


def drawn(panel: Any) -> str:
    """What a panel says of the present scene at the sidebar's default width, its pieces separated by bars."""
    state = view_state.refresh(bpy.context.scene)
    layout = Lines()
    region = SimpleNamespace(width=280)
    context = SimpleNamespace(scene=bpy.context.scene, region=region, preferences=bpy.context.preferences)
    panel.draw_state(SimpleNamespace(), layout, context, state)
    return " | ".join(layout.said)
