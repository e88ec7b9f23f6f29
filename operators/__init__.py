# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist can do: thin verbs over the pipeline, and the two commands.

Nothing is imported here until `register` is called, so that `operators.command` works without Blender's window.
"""

from __future__ import annotations

from typing import Any

COMMAND = "code_as_room"
_command: Any = None


def _classes() -> tuple[type, ...]:
    from . import (
        asset_ops,
        by_hand,
        connection_ops,
        consent,
        detail_ops,
        draft_ops,
        export_ops,
        finish_ops,
        fitted_view,
        hand_ops,
        journal_ops,
        object_ops,
        overlay,
        picture_ops,
        picture_sources,
        program_ops,
        properties,
        render_ops,
        result_ops,
        rounds,
        stage_ops,
        talk_ops,
        texture_ops,
    )

    modules = (
        properties,
        picture_ops,
        picture_sources,
        fitted_view,
        stage_ops,
        draft_ops,
        consent,
        object_ops,
        rounds,
        result_ops,
        export_ops,
        render_ops,
        texture_ops,
        finish_ops,
        program_ops,
        detail_ops,
        asset_ops,
        hand_ops,
        journal_ops,
        overlay,
        connection_ops,
        by_hand,
        talk_ops,
    )
    return tuple(cls for module in modules for cls in module.CLASSES)


def _run_command(argv: list[str]) -> int:
    """`blender --command code_as_room PICTURE --out DIR`."""
    from .command import cli_main

    return cli_main(argv)


def register() -> None:
    """Register classes, the scene's settings, handlers and the command."""
    global _command
    import bpy

    from . import handlers, keymaps, object_list, overlay, properties, render_ops, rounds

    utils: Any = bpy.utils
    scene_type: Any = bpy.types.Scene
    pointer: Any = bpy.props.PointerProperty

    for cls in _classes():
        bpy.utils.register_class(cls)
    scene_type.code_as_room = pointer(type=properties.CodeAsRoomSettings, name="Code-as-Room")
    object_list.register()
    rounds.register()
    render_ops.register()
    overlay.register()
    handlers.register()
    keymaps.register()
    _command = utils.register_cli_command(COMMAND, _run_command)


def unregister() -> None:
    """Undo `register`, in the reverse order."""
    global _command
    import bpy

    from . import by_hand, connection, handlers, keymaps, object_list, overlay, render_ops, rounds

    connection.forget()
    by_hand.forget()
    if _command is not None:
        bpy.utils.unregister_cli_command(_command)
        _command = None
    keymaps.unregister()
    handlers.unregister()
    overlay.unregister()
    render_ops.unregister()
    rounds.unregister()
    object_list.unregister()
    scene_type: Any = bpy.types.Scene
    del scene_type.code_as_room
    for cls in reversed(_classes()):
        bpy.utils.unregister_class(cls)
