# SPDX-License-Identifier: GPL-3.0-or-later
"""What fills the holes of the walls: door frames with leaves, windows with panes, and the outline of plain openings.

A fitting's own frame: origin on the wall's segment at the end where its line starts (the hinge side of a door), x
along the line, z up. When the line runs against its wall, the room is at -y, otherwise at +y.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .pieces import Hole, ShellPiece, WallRun
from .shape import Shape

_FRAME = 0.05  # metres: width of a frame's members
_PROUD = 0.01  # metres that a frame stands out of the wall on both sides
_LEAF = 0.04  # metres: thickness of a door leaf
_SILL = 0.004  # metres that a threshold is higher than the floor; a leaf goes over it
_PANEL = 0.006  # metres that the panels of a leaf stand out
_PANE = 0.72  # metres: about how wide one pane of glass is


def fitting_pieces(run: WallRun, hole: Hole, holes: list[Hole]) -> list[ShellPiece]:
    """The pieces (`ShellPiece`) for one of a wall run's holes: a door and its leaf, a window, or an outline.

    Where an opening goes on above a door, its frame goes on with it and has no head.
    """
    dx, dy = run.direction
    x = hole.x[1] if hole.against else hole.x[0]
    origin = (run.start[0] + dx * x, run.start[1] + dy * x, 0.0)
    yaw = math.degrees(math.atan2(dy, dx)) + (180.0 if hole.against else 0.0)
    faces = (-run.left, -run.right) if hole.against else (run.right, run.left)
    room_side = -1.0 if hole.against else 1.0
    width = hole.x[1] - hole.x[0]
    common: dict[str, Any] = {"id": hole.line["id"], "kind": hole.kind, "origin": origin, "yaw": yaw, "parent": run.id}
    if hole.kind == "opening":
        return [ShellPiece(shapes=[_outline(width, hole.z, faces)], **common)]
    if hole.kind == "window":
        return [ShellPiece(shapes=_window(width, hole.z, faces, room_side), **common)]
    above = [h.z[1] for h in holes if h.x == hole.x and h.z[0] == hole.z[1]]
    top = max(above, default=hole.z[1])
    frame = _members(width, (hole.z[0], top), (min(faces) - _PROUD, max(faces) + _PROUD), sill=False)
    if above:
        frame.pop()
    member = min(_FRAME, width / 5)
    low, high = (member, min(faces), hole.z[0] - 0.01), (width - member, max(faces), hole.z[0] + _SILL)
    frame.append(_block(low, high, "threshold", "door"))
    opened = min(max(float(hole.line.get("open", 0.0)), -180.0), 180.0)
    # A leaf lies flush with the face that it opens towards, else it would turn within the wall.
    leaf_side = -room_side if opened < 0.0 else room_side
    hinge_y = max(faces) if leaf_side > 0 else min(faces)
    angle = math.radians(yaw)
    hinge = (
        origin[0] + math.cos(angle) * member - math.sin(angle) * hinge_y,
        origin[1] + math.sin(angle) * member + math.cos(angle) * hinge_y,
        0.0,
    )
    swing = opened * room_side
    leaf = _leaf(width - 2 * member, hole.z[1] - member, leaf_side)
    return [
        ShellPiece(shapes=frame, **common),
        ShellPiece(hole.line["id"], "door", leaf, origin=hinge, yaw=yaw + swing, parent=hole.line["id"], part="leaf"),
    ]


def _block(low: tuple[float, float, float], high: tuple[float, float, float], part: str, material: str) -> Shape:
    """An axis-aligned box between two corners."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    base = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    vertices = [(x, y, z) for z in (z0, z1) for x, y in base]
    faces = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    return Shape(np.array(vertices, dtype=float), faces, part, material)


def _members(width: float, z: tuple[float, float], y: tuple[float, float], sill: bool) -> list[Shape]:
    """A frame that fills the hole's rim: two jambs, a head and, for windows, a lower rail."""
    m = min(_FRAME, width / 5, (z[1] - z[0]) / 5)
    low = z[0] + m if sill else z[0]
    shapes = [
        _block((0.0, y[0], z[0]), (m, y[1], z[1]), "frame", "frame"),
        _block((width - m, y[0], z[0]), (width, y[1], z[1]), "frame", "frame"),
        _block((m, y[0], z[1] - m), (width - m, y[1], z[1]), "frame", "frame"),
    ]
    if sill:
        shapes.append(_block((m, y[0], z[0]), (width - m, y[1], low), "frame", "frame"))
    return shapes


def _window(width: float, z: tuple[float, float], faces: tuple[float, float], room_side: float) -> list[Shape]:
    """Frame, panes of glass with mullions between them, and an inner sill that stays within the hole's height."""
    middle = (faces[0] + faces[1]) / 2
    half = min(0.04, (max(faces) - min(faces)) / 2)
    shapes = _members(width, z, (middle - half, middle + half), sill=True)
    m = min(_FRAME, width / 5, (z[1] - z[0]) / 5)
    inner = width - 2 * m
    panes = max(1, round(inner / _PANE))
    for i in range(panes):
        left, right = m + inner * i / panes, m + inner * (i + 1) / panes
        glass_left, glass_right = left + (m / 2 if i else 0.0), right - (m / 2 if i < panes - 1 else 0.0)
        glass = ((glass_left, middle - 0.004, z[0] + m), (glass_right, middle + 0.004, z[1] - m))
        shapes.append(_block(*glass, "pane", "glass"))
        if i:
            mullion = ((left - m / 2, middle - half, z[0] + m), (left + m / 2, middle + half, z[1] - m))
            shapes.append(_block(*mullion, "mullion", "frame"))
    face = max(faces) if room_side > 0 else min(faces)
    near, far = middle + half * room_side, face + 0.04 * room_side
    board = _block((0.0, min(near, far), z[0]), (width, max(near, far), z[0] + min(0.025, m)), "sill", "frame")
    return [*shapes, board]


def _leaf(width: float, height: float, room_side: float) -> list[Shape]:
    """A door leaf with raised panels and two handles; its origin is the hinge, closed it lies along +x behind its face."""
    near, far = sorted((0.0, -_LEAF * room_side))
    gap = min(0.005, width / 20)
    leaf = _block((0.0, near, gap), (width - gap, far, height - gap), "leaf", "door")
    panels = [
        _block((0.14 * width, low, height * start), (0.86 * width, high, height * end), "panel", "door")
        for low, high in ((far, far + _PANEL), (near - _PANEL, near))
        for start, end in ((0.08, 0.44), (0.52, 0.94))
        if width > 0.5 and height > 1.2
    ]
    z = min(1.0, 0.5 * height)
    reach = min(0.12, width / 4)
    handles = [
        _block((width - 0.06 - reach, low, z), (width - 0.06, high, z + 0.02), "handle", "metal")
        for low, high in ((far + 0.02, far + 0.04), (near - 0.04, near - 0.02))
        if width > 0.3
    ]
    return [leaf, *panels, *handles]


def _outline(width: float, z: tuple[float, float], faces: tuple[float, float]) -> Shape:
    """The rim of an opening as one face-less loop's vertices, so that it can be seen and picked but hides nothing."""
    middle = (faces[0] + faces[1]) / 2
    corners = [(0.0, middle, z[0]), (width, middle, z[0]), (width, middle, z[1]), (0.0, middle, z[1])]
    return Shape(np.array(corners, dtype=float), (), "outline", "", extra={"edges": ((0, 1), (1, 2), (2, 3), (3, 0))})
