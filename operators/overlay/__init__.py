# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn over the picture in the viewport, and grabbed there: the floor's corners, boxes, the known length.

`shown.py` says what there is, `composing.py` how it looks, `drawing.py` draws it, `hits.py` finds what is under the pointer;
`gizmos.py` and the operators let the artist change it. All corrections go through `operators/correcting.py`.
"""

from __future__ import annotations

from typing import Any

import bpy
from bpy.app.handlers import persistent

from . import adding, corner_ops, draft, dragging, drawing, gizmos, hits, knowing_length, length_field, shown
from .composing import Hot

CLASSES = (
    *dragging.CLASSES,
    *knowing_length.CLASSES,
    *adding.CLASSES,
    *corner_ops.CLASSES,
    *gizmos.CLASSES,
)


@persistent  # type: ignore[untyped-decorator]
def _before_load(*_: Any) -> None:
    """What was drawn belongs to the file that is open."""
    draft.clear()
    hits.heat(Hot())
    shown.forget_all()
    drawing.forget_all()


@persistent  # type: ignore[untyped-decorator]
def _after_change(*_: Any) -> None:
    """Undo and redo put corrections back without telling anybody."""
    shown.forget_states()


def _lists() -> tuple[tuple[Any, Any], ...]:
    handlers = bpy.app.handlers
    return (
        (handlers.load_pre, _before_load),
        (handlers.undo_post, _after_change),
        (handlers.redo_post, _after_change),
    )


def register() -> None:
    """Begin to draw. The classes are registered with the other operators'."""
    length_field.register()
    drawing.register()
    for handlers, function in _lists():
        handlers.append(function)


def unregister() -> None:
    """Undo `register`."""
    for handlers, function in reversed(_lists()):
        if function in handlers:
            handlers.remove(function)
    drawing.unregister()
    length_field.unregister()
    _before_load()
