# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn over the picture, as plain values: worked out once when something changed, never while drawing.

Handles, clicks and drawing all read the same `Shown`, so that what is seen is what can be grabbed. Positions are those of
the picture, 0-1000 of its width (x, right) and height (y, down).
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import bpy

from ...pipeline.artifacts.analysis import Calibration, SceneAnalysis
from ...pipeline.artifacts.camera import CameraModel
from ...pipeline.artifacts.common import ImageBox
from ...pipeline.artifacts.corrections import Corrections
from ...pipeline.errors import RoomError
from ...pipeline.geometry.handles import Rectangle
from ...pipeline.geometry.polygon import Point
from ...pipeline.memory import Memory
from ...pipeline.report_objects import ObjectRow
from ...pipeline.run_corrections import corrections_of, found_of
from .. import room_memory, view_state

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ShownBox:
    """One object's box: x_min, y_min, x_max, y_max in the picture.

    Attributes:
        state: "detected", "placed", "detailed", "deferred", "dropped" or "left out" (by the artist).
        added: drawn in by the artist; locked: kept from automatic changes.
    """

    id: str
    category: str
    box: Rectangle
    state: str = "detected"
    added: bool = False
    locked: bool = False

    @property
    def image_box(self) -> ImageBox:
        """The box as memory keeps it."""
        return ImageBox(x_min=self.box[0], y_min=self.box[1], x_max=self.box[2], y_max=self.box[3])


@dataclass(frozen=True)
class KnownMark:
    """The known length: its ends in the picture, and metres."""

    start: Point
    end: Point
    metres: float


@dataclass(frozen=True)
class Shown:
    """All that is drawn of one room.

    Attributes:
        corners: the floor's corners; moved: the artist moved some of them.
    """

    corners: tuple[Point, ...] = ()
    boxes: tuple[ShownBox, ...] = ()
    known: KnownMark | None = None
    camera: CameraModel | None = None
    moved: bool = False

    def box_of(self, identifier: str) -> ShownBox | None:
        """One object's box, None when it has none."""
        return next((b for b in self.boxes if b.id == identifier), None)


NOTHING = Shown()
_shown: dict[int, tuple[Any, Shown]] = {}
_wanted: set[int] = set()


def peek(scene: Any) -> Shown:
    """What to draw; when the room has changed since, the earlier one until Blender is idle for a moment."""
    uid = scene.session_uid
    state, shown = _shown.get(uid, (None, NOTHING))
    if state is None or state is not view_state.peek(scene):
        _look_soon(uid)
    return shown


def refresh(scene: Any) -> Shown:
    """Work it out now; never raises. Main thread only."""
    state = view_state.peek(scene)
    try:
        rows = state.by_id if state is not None else {}
        shown = shown_of(room_memory.memory_of(scene), rows)
    except RoomError:
        shown = NOTHING  # the panel says what is wrong with memory
    except Exception:
        log.exception("What is drawn over the picture could not be worked out")
        shown = NOTHING
    # Without a state there is nothing to compare with; any object that is not None will do.
    _shown[scene.session_uid] = (state if state is not None else NOTHING, shown)
    return shown


def forget_all() -> None:
    """Another file is opened, or the add-on is disabled."""
    _shown.clear()
    _wanted.clear()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)


def forget_states() -> None:
    """Undo or redo changed the file: work everything out anew, and draw the earlier until then."""
    for uid, (_, shown) in list(_shown.items()):
        _shown[uid] = (None, shown)


def redraw() -> None:
    """Redraw all 3D views: pictures and sidebars."""
    manager = bpy.context.window_manager
    for window in manager.windows if manager else ():
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _look_soon(uid: int) -> None:
    _wanted.add(uid)
    if not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=0.0)


def _look() -> None:
    """The timer behind `peek`."""
    wanted = set(_wanted)
    _wanted.clear()
    for scene in bpy.data.scenes:
        if scene.session_uid in wanted:
            refresh(scene)
    redraw()


def shown_of(memory: Memory, rows: Mapping[str, ObjectRow]) -> Shown:
    """What is drawn of a room with this memory; the rows say what became of each object, by its id."""
    analysis = memory.latest(SceneAnalysis)
    if analysis is None:
        return NOTHING
    corrections, calibration = corrections_of(memory), memory.latest(Calibration)
    known = corrections.known_length
    return Shown(
        corners=tuple((p.x, p.y) for p in analysis.floor_polygon),
        boxes=tuple(_boxes(memory, analysis, corrections, rows)),
        known=KnownMark((known.start.x, known.start.y), (known.end.x, known.end.y), known.metres) if known else None,
        camera=calibration.camera if calibration is not None else None,
        moved=corrections.floor_polygon is not None,
    )


def _boxes(
    memory: Memory, analysis: SceneAnalysis, corrections: Corrections, rows: Mapping[str, ObjectRow]
) -> Iterator[ShownBox]:
    """The boxes of all that is in the room, then of what the artist left out."""
    added = {a.id for a in corrections.added}
    present = {o.id for o in analysis.objects}
    out = {c.id for c in corrections.objects if c.include is False} - present
    found = found_of(memory) if out else None
    left_out = [o for o in found.analysis.objects if o.id in out] if found is not None else []
    for item in [*analysis.objects, *left_out]:
        said, row = corrections.of(item.id), rows.get(item.id)
        box = item.box if item.id in present else said.box or item.box
        if box is not None:
            state = row.state if row is not None else "detected" if item.id in present else "left out"
            locked = row.locked if row is not None else bool(said.locked)
            yield ShownBox(item.id, said.category or item.category, _sides(box), state, item.id in added, locked)
    for drawn in corrections.added:
        if drawn.id in out:
            yield ShownBox(drawn.id, drawn.category, _sides(drawn.box), "left out", added=True)


def _sides(box: ImageBox) -> Rectangle:
    return box.x_min, box.y_min, box.x_max, box.y_max
