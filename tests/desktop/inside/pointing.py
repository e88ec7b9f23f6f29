# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done with the pointer in the picture: corners, a known length, boxes. Each is undone again.

The pointer and the keys are simulated, so that Blender's own handling of gizmos, dialogs and modal operators is tried.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from typing import Any

import bpy
from window import PAUSE, call, check, part, results, shoot, statuses, until, view

_at: list[int] = [0, 0]
Point = Sequence[float]


def _event(kind: str, value: str = "PRESS", **options: Any) -> None:
    view()[0].event_simulate(type=kind, value=value, x=_at[0], y=_at[1], **options)


def _scene() -> Any:
    return bpy.context.scene


def _shown() -> Any:
    return part("operators.overlay.shown").refresh(_scene())


def _corrections() -> Any:
    return part("pipeline.run_corrections").corrections_of(part("operators.room_memory").memory_of(_scene()))


def _room_size() -> tuple[float, ...]:
    return tuple(part("operators.view_state").peek(_scene()).room_size)


def _draft() -> Any:
    return part("operators.overlay.draft").of(_scene().session_uid)


def _hot() -> Any:
    return part("operators.overlay.hits").hot()


def _frame() -> tuple[Any, Any]:
    """The region with the picture, and where the picture is in it."""
    window, area, _ = view()
    region = next(r for r in area.regions if r.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        return region, part("operators.overlay.hits").frame_of(bpy.context)


def _move(point: Point, **options: Any) -> None:
    """Move the pointer to a point of the picture."""
    region, frame = _frame()
    x, y = frame.point(point)
    _at[:] = [round(region.x + x), round(region.y + y)]
    _event("MOUSEMOVE", "NOTHING", **options)


def _key(kind: str, letter: str = "") -> None:
    _event(kind, "PRESS", **({"unicode": letter} if letter else {}))
    _event(kind, "RELEASE")


def _hover(point: Point) -> Iterator[float]:
    """Move there, and wait until what is there is bright."""
    _move((point[0] + 25, point[1] + 25))
    yield 0.1
    _move(point)
    cold = part("operators.overlay.composing").Hot()
    yield from until("what is under the pointer is bright", lambda: _hot() != cold)


def _drag(start: Point, end: Point, shot: str = "") -> Iterator[float]:
    """Press on a handle, drag it, release."""
    yield from _hover(start)
    _event("LEFTMOUSE", "PRESS")
    yield from until("the drag begins", lambda: _draft() is not None)
    for step in range(1, 5):
        _move([a + (b - a) * step / 4 for a, b in zip(start, end, strict=True)])
        yield 0.05
    yield PAUSE
    if shot:
        shoot(shot)
    _event("LEFTMOUSE", "RELEASE")
    yield from until("the drag ends", lambda: _draft() is None)


def _undo(name: str, holds: Any) -> Iterator[float]:
    call(bpy.ops.ed.undo)
    yield PAUSE
    check(f"undo takes {name} back", holds())


def look_through() -> Iterator[float]:
    """The view through the fitted camera shows the corners."""
    call(bpy.ops.code_as_room.look_through)
    yield PAUSE
    check("the corners of the floor are shown", len(_shown().corners) >= 4)


def corners() -> Iterator[float]:
    """A corner is dragged, put back with Esc, and undone."""
    corner, size = _shown().corners[0], _room_size()
    yield from _hover(corner)
    _event("LEFTMOUSE", "PRESS")
    yield from until("the drag begins", lambda: _draft() is not None)
    _move((corner[0] + 40, corner[1] - 40))
    yield 0.1
    _key("ESC")
    yield from until("Esc ends the drag", lambda: _draft() is None)
    _event("LEFTMOUSE", "RELEASE")
    check("Esc puts the corner back", _corrections().floor_polygon is None)
    yield from _drag(corner, (corner[0] + 12, corner[1] - 9), "p1_corner")
    yield from until("the camera is fitted anew", lambda: _corrections().floor_polygon is not None)
    moved = _shown().corners[0]
    check("the corner is where it was dragged to", math.dist(moved, (corner[0] + 12, corner[1] - 9)) < 2.5)
    check("the room's size follows", _room_size() != size)
    yield from _undo("a corner", lambda: _corrections().floor_polygon is None and _room_size() == size)


def known_length() -> Iterator[float]:
    """Two clicks and a number scale the room."""
    size = _room_size()
    call(bpy.ops.code_as_room.known_length, "INVOKE_DEFAULT")
    yield PAUSE
    for point in ((350.0, 400.0), (650.0, 600.0)):
        _move(point)
        yield 0.1
        _event("LEFTMOUSE", "PRESS")
        _event("LEFTMOUSE", "RELEASE")
        yield 0.1
    for kind, letter in (("FOUR", "4"), ("PERIOD", "."), ("TWO", "2")):
        _key(kind, letter)
        yield 0.05
    yield PAUSE
    shoot("p2_known_length")
    _key("RET")
    yield from until("the length is known", lambda: _corrections().known_length is not None)
    shown = _shown()
    measured = part("pipeline.geometry.measuring").floor_distance(shown.camera, shown.known.start, shown.known.end)
    check("the known length is as it was typed", abs(measured - 4.2) < 1e-6)
    yield from _undo("the known length", lambda: _corrections().known_length is None and _room_size() == size)


def boxes() -> Iterator[float]:
    """A click on a box's name makes it active, a drag on its corner corrects it, a missing one is drawn and named."""
    _scene().code_as_room.show_boxes = True
    call(bpy.ops.ed.undo_push, message="Show Boxes")
    box = next(b for b in _shown().boxes if b.id.startswith("armchair"))
    part("operators.overlay.selection").activate(_scene(), box.id)
    yield PAUSE
    corner, to = box.box[:2], (box.box[0] - 20, box.box[1] - 20)
    yield from _drag(corner, to, "p3_box")
    yield from until("the box is corrected", lambda: _corrections().of(box.id).box is not None)
    new = _corrections().of(box.id).box
    check("the box is as it was dragged", math.dist((new.x_min, new.y_min), to) < 2.5 and new.x_max == box.box[2])
    yield from _undo("the box", lambda: _corrections().of(box.id).box is None)
    call(bpy.ops.code_as_room.add_missing, "INVOKE_DEFAULT")
    yield PAUSE
    _move((560.0, 700.0))
    yield 0.1
    _event("LEFTMOUSE", "PRESS")
    yield 0.1
    for step in range(1, 5):
        _move((560.0 + 20 * step, 700.0 + 20 * step))
        yield 0.05
    _event("LEFTMOUSE", "RELEASE")
    yield 1.0
    for letter in "stool":
        _key(letter.upper(), letter)
        yield 0.05
    yield PAUSE
    shoot("p4_add_missing")
    _key("RET")
    yield PAUSE
    _key("RET")
    yield from until("what was missed is added", lambda: bool(_corrections().added))
    check("it is a stool", _corrections().added[0].category == "stool")
    yield PAUSE
    shoot("p5_added")
    yield from _undo("the added object", lambda: not _corrections().added)


def cost() -> Iterator[float]:
    """How long a redraw takes our drawing with a hundred boxes; printed, not judged."""
    drawing = part("operators.overlay.drawing")
    took: list[float] = []
    draw = drawing._draw_view

    def timed(context: Any) -> None:
        began = time.thread_time()
        draw(context)
        took.append((time.thread_time() - began) * 1000)

    shown = part("operators.overlay.shown")
    known = _shown()
    many = tuple(
        shown.ShownBox(
            f"thing_{i}", "coffee_table", (i % 10 * 95.0, i // 10 * 95.0, i % 10 * 95.0 + 80, i // 10 * 95.0 + 70)
        )
        for i in range(100)
    )
    state = part("operators.view_state").peek(_scene())
    shown._shown[_scene().session_uid] = (state, shown.Shown(known.corners, many, known.known, known.camera))
    drawing._draw_view = timed
    try:
        for _ in range(12):
            view()[1].tag_redraw()
            yield 0.1
        shoot("p6_hundred_boxes")
    finally:
        drawing._draw_view = draw
        _shown()
    if took:
        results["numbers"]["drawing 100 boxes, ms of the processor: first, then"] = [
            round(took[0], 2), round(sorted(took[1:])[len(took[1:]) // 2], 2) if took[1:] else 0.0,
        ]  # fmt: skip


def correct_in_the_picture() -> Iterator[float]:
    """All of the above; afterwards everything is as it was."""
    for step in (look_through, corners, known_length, boxes, cost):
        yield from step()
    _scene().code_as_room.show_boxes = False
    call(bpy.ops.code_as_room.look_through)
    yield PAUSE
    check("after all is undone, every stage is still done", set(statuses()) == {"done"})
