# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender makes ready when it draws its first picture of a session, step by step.

It compiles shaders then, within one call: with OpenGL on a processor that holds the window for more than half a second. A few
pixels drawn with less and less left out have it compile them one after the other, and the window goes on in between.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any

from ..artifacts.camera import CameraModel
from .studio import studio, visible_objects
from .tags import KIND, find_room_collection
from .viewport import draw_in_view, open_view

_SIDE = 64


@dataclass(frozen=True)
class _Step:
    """How many objects are drawn, and whether with outlines and cavities, and in the screen's colours."""

    objects: int
    lines: bool
    managed: bool


_STEPS = (_Step(0, False, False), _Step(0, False, True), _Step(1, False, True), _Step(1, True, True))
_left = list(_STEPS)


def prepare_drawing(scene: Any, camera: CameraModel) -> bool:
    """Do one step; False where none is left, or no picture is drawn in a window."""
    room, view = find_room_collection(scene), open_view()
    if not _left or view is None or room is None:
        return False
    step = _left.pop(0)
    shown = [obj for obj in visible_objects(room) if obj.get(KIND) in ("floor", "proxy")][: step.objects]
    # Where it cannot be drawn, the picture itself will tell.
    with contextlib.suppress(RuntimeError, SystemError, ValueError, TypeError), studio(shown, camera, _SIDE) as stage:
        shading = stage.display.shading
        shading.show_cavity = shading.show_object_outline = step.lines
        draw_in_view(view, stage, camera, fine=False, managed=step.managed)
    return True
