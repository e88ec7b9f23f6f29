# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene keeps for the artist: `Scene.code_as_room`. Everything that stages write is in memory, not here."""

from __future__ import annotations

from typing import Any

import bpy

from . import view_state


def _changed(settings: Any, context: Any) -> None:
    """Settings are inputs of every stage, so what the panel says of the stages may change with them."""
    view_state.refresh(settings.id_data)


class CodeAsRoomSettings(bpy.types.PropertyGroup):
    """The reference image and the numbers that the artist knows."""

    picture: bpy.props.PointerProperty(  # type: ignore[valid-type]
        name="Reference image",
        description="The picture of the room, kept inside the .blend file",
        type=bpy.types.Image,
    )
    picture_name: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Picture", description="File name of the reference image"
    )
    use_known_width: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Known width",
        description="You know the room's inner width, left to right in the picture; every size follows from it",
        update=_changed,
    )
    known_width: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Known width",
        description="The room's inner width, left to right in the picture",
        subtype="DISTANCE",
        unit="LENGTH",
        default=4.0,
        min=0.5,
        max=100.0,
        precision=3,
        update=_changed,
    )
    use_wall_height: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Wall height", description="You know how high the walls are", update=_changed
    )
    wall_height: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Wall height",
        description="Height of the walls from floor to ceiling",
        subtype="DISTANCE",
        unit="LENGTH",
        default=2.6,
        min=1.0,
        max=20.0,
        precision=3,
        update=_changed,
    )
    notes: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Notes",
        description="A hint for the model, such as 'the bed is 1.4 m wide'. The built-in analysis cannot read it",
        maxlen=1000,
        update=_changed,
    )
    iterations: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Rounds",
        description="Most rounds of revising the layout; each may cost one question to the model",
        default=5,
        min=1,
        max=5,
        update=_changed,
    )


def memory_settings(settings: Any, earlier: dict[str, str]) -> dict[str, str]:
    """The settings as memory keeps them (see `View.settings`); names that are not the panel's stay as they were."""
    result = dict(earlier)
    values = {
        "known_width_m": f"{settings.known_width:.6g}" if settings.use_known_width else "",
        "wall_height_m": f"{settings.wall_height:.6g}" if settings.use_wall_height else "",
        "notes": settings.notes.strip(),
        "iterations": str(settings.iterations),
    }
    for name, value in values.items():
        if value:
            result[name] = value
        else:
            result.pop(name, None)
    return result


CLASSES = (CodeAsRoomSettings,)
