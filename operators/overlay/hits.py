# SPDX-License-Identifier: GPL-3.0-or-later
"""What is under the pointer in a 3D view that looks through the room's camera."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...pipeline.geometry.handles import WHOLE, EdgeHit, Grip, grip_at, inside, nearest_edge, nearest_point
from .. import driver, fitted_view
from . import draft, shown
from .composing import Frame, Hot, Wanted, labels

REACH = 10.0
"""Pixels, at a scale of 1, from which a corner can be grabbed."""
EDGE_REACH = 6.0

_hot = Hot()


def hot() -> Hot:
    """What was under the pointer last."""
    return _hot


def heat(found: Hot) -> None:
    """Remember what is under the pointer, so that it is drawn brighter."""
    global _hot
    _hot = found


def frame_of(context: Any) -> Frame | None:
    """Where the picture is in the 3D view; None when the view does not look through the room's camera."""
    corners = fitted_view.picture_to_region(context, ((0.0, 0.0), (1000.0, 1000.0)))
    if corners is None:
        return None
    (x0, y0), (x1, y1) = corners.tolist()
    if x0 == x1 or y0 == y1:
        return None
    return Frame(x0, y0, (x1 - x0) / 1000.0, (y1 - y0) / 1000.0)


def has_handles(context: Any) -> bool:
    """Whether handles are drawn: not while a run is going on, in Edit mode, or with Blender's gizmos switched off."""
    return bool(not driver.is_running() and context.mode == "OBJECT" and context.space_data.show_gizmo)


def can_grab(context: Any) -> bool:
    """Whether handles can be grabbed: they are drawn, and nothing is being dragged or drawn already."""
    return has_handles(context) and draft.of(context.scene.session_uid) is None


def hit_at(wanted: Wanted, at: Sequence[float], edges: bool = False, measure: Any = len) -> Hot | None:
    """What is at a position of the region: a corner first, then the active box, other boxes' labels and edges.

    Args:
        edges: also the floor's edges, where a corner can be added.
        measure: gives a label's width in pixels.
    """
    reach, edge_reach = REACH * wanted.scale, EDGE_REACH * wanted.scale
    if wanted.corners and wanted.shown.corners:
        ring = [wanted.frame.point(p) for p in wanted.shown.corners]
        corner = nearest_point(ring, at, reach)
        if corner is not None:
            return Hot(corner=corner)
        edge: EdgeHit | None = nearest_edge(ring, at, edge_reach) if edges else None
        if edge is not None:
            return Hot(edge=edge)
    return _box_at(wanted, at, edge_reach, measure) if wanted.boxes else None


def _box_at(wanted: Wanted, at: Sequence[float], reach: float, measure: Any) -> Hot | None:
    """The active box's edges and corners come first; of the others the label, then the smallest box with an edge here."""
    boxes = {b.id: b for b in wanted.shown.boxes}
    active = boxes.get(wanted.active)
    if active is not None:
        grip = _grip(wanted, active, at, reach * 1.3)
        if grip is not None:
            return Hot(box=active.id, grip=grip)
    for identifier, spot in labels(wanted, measure).items():
        if inside(spot, at):
            return Hot(box=identifier, grip=WHOLE)
    for box in sorted(wanted.shown.boxes, key=lambda b: b.image_box.area):
        grip = _grip(wanted, box, at, reach)
        if grip is not None:
            return Hot(box=box.id, grip=grip)
    return None


def _grip(wanted: Wanted, box: shown.ShownBox, at: Sequence[float], reach: float) -> Grip | None:
    """As `grip_at`, with the picture's upper edge as "top": a region's y goes up."""
    x_min, y_min, x_max, y_max = wanted.frame.rectangle(box.box)
    return grip_at((x_min, -y_max, x_max, -y_min), (at[0], -at[1]), reach)
