# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws over the picture in 3D views that look through the room's camera.

The draw handler reads plain values and draws batches that are made anew only when something is to look different, so a
redraw of a still view costs next to nothing. An error in here is logged once and never reaches Blender's drawing.
"""

from __future__ import annotations

import logging
from functools import lru_cache
from typing import Any

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from . import draft, hits, selection, shown
from .composing import Composition, Hot, Text, Wanted, compose
from .hits import frame_of

log = logging.getLogger(__name__)
FONT = 0
TEXT_SIZE = 11.0
_MOST_VIEWS = 8


class _Prepared:
    """Batches for the graphics card, and the texts, of one composition."""

    def __init__(self, made: Composition) -> None:
        lines = gpu.shader.from_builtin("POLYLINE_FLAT_COLOR")
        areas = gpu.shader.from_builtin("FLAT_COLOR")
        self.lines = [
            (width, _batch(lines, "LINES", [(p, s.colour) for s in strokes for p in (s.start, s.end)]))
            for width, strokes in made.lines.items()
        ]
        rims = [(p, s.colour) for s in made.rims for p in (s.start, s.end)]
        self.rims = _batch(lines, "LINES", rims) if rims else None
        self.areas = _batch(areas, "TRIS", made.triangles) if made.triangles else None
        self.texts: list[Text] = made.texts

    def draw(self, size: tuple[int, int], scale: float) -> None:
        """Draw into the present region of this size."""
        gpu.state.blend_set("ALPHA")
        lines = gpu.shader.from_builtin("POLYLINE_FLAT_COLOR")
        lines.bind()
        lines.uniform_float("viewportSize", size)
        for width, batch in self.lines:
            lines.uniform_float("lineWidth", width)
            batch.draw(lines)
        if self.areas is not None:
            areas = gpu.shader.from_builtin("FLAT_COLOR")
            areas.bind()
            self.areas.draw(areas)
        if self.rims is not None:
            lines.bind()
            lines.uniform_float("viewportSize", size)
            lines.uniform_float("lineWidth", 1.5 * scale)
            self.rims.draw(lines)
        if self.texts:
            blf.size(FONT, TEXT_SIZE * scale)
            for text in self.texts:
                blf.color(FONT, *text.colour)
                blf.position(FONT, text.x, text.y, 0.0)
                blf.draw(FONT, text.text)
        gpu.state.blend_set("NONE")


_prepared: dict[int, tuple[Wanted, _Prepared]] = {}
_handle: Any = None
_failed = False


def register() -> None:
    """Begin to draw; nothing to do without a window."""
    global _handle, _failed
    _failed = False
    if _handle is None and not bpy.app.background:
        space: Any = bpy.types.SpaceView3D
        _handle = space.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")


def unregister() -> None:
    """Draw no more, and free what was made."""
    global _handle
    if _handle is not None:
        space: Any = bpy.types.SpaceView3D
        space.draw_handler_remove(_handle, "WINDOW")
        _handle = None
    forget_all()


def forget_all() -> None:
    """Free what was made for the graphics card."""
    _prepared.clear()


def ui_scale() -> float:
    """Blender's resolution scale; 2 on a screen with small pixels."""
    preferences = bpy.context.preferences
    return float(preferences.system.ui_scale) if preferences is not None else 1.0


@lru_cache(maxsize=2000)
def _width(text: str, scale: float) -> float:
    blf.size(FONT, TEXT_SIZE * scale)
    return float(blf.dimensions(FONT, text)[0])


def text_width(text: str) -> float:
    """Width of a text as it is drawn, pixels."""
    return _width(text, ui_scale())


def wanted_in(context: Any) -> Wanted | None:
    """What is to be drawn in this 3D view; None where nothing is."""
    scene = context.scene
    if scene is None or not hasattr(scene, "code_as_room"):
        return None
    settings, unfinished = scene.code_as_room, draft.of(scene.session_uid)
    if not (settings.show_corners or settings.show_boxes or unfinished is not None):
        return None
    space = context.space_data
    if not space.overlay.show_overlays and unfinished is None:
        return None
    frame = frame_of(context)
    if frame is None:
        return None
    handles = hits.has_handles(context)
    return Wanted(
        shown=shown.peek(scene),
        frame=frame,
        draft=unfinished,
        hot=hits.hot() if handles else Hot(),
        active=selection.active_id(scene),
        corners=settings.show_corners,
        boxes=settings.show_boxes,
        handles=handles,
        scale=ui_scale(),
    )


def _draw() -> None:
    """The draw handler."""
    global _failed
    if _failed:
        return
    try:
        _draw_view(bpy.context)
    except Exception:
        _failed = True
        log.exception("Drawing over the picture failed; it stays off until the add-on is enabled again")


def _draw_view(context: Any) -> None:
    region = context.region
    if region is None or region.data is None:
        return
    wanted = wanted_in(context)
    if wanted is None:
        return
    key = region.as_pointer()
    known = _prepared.get(key)
    if known is None or known[0] != wanted:
        if known is None and len(_prepared) >= _MOST_VIEWS:
            _prepared.clear()
        known = _prepared[key] = (wanted, _Prepared(compose(wanted, text_width)))
    known[1].draw((region.width, region.height), wanted.scale)


def _batch(shader: Any, kind: str, points: list[tuple[Any, Any]]) -> Any:
    places = np.zeros((len(points), 3), dtype=np.float32)
    places[:, :2] = [p for p, _ in points]
    colours = np.array([c for _, c in points], dtype=np.float32)
    make: Any = batch_for_shader  # it takes arrays, whatever the stubs say
    return make(shader, kind, {"pos": places, "color": colours})
