# SPDX-License-Identifier: GPL-3.0-or-later
"""What a draft answers to the questions of stage 1 and of the layout stages, in those stages' own reply types."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from ..analysis.clean import FACING_YAW
from ..artifacts.replies import (
    AnalysisReply,
    ArchitectureReply,
    AuxiliaryPlacementReply,
    AuxiliaryReply,
    BoxReply,
    MetresReply,
    ObjectReply,
    SizeReply,
)
from .camera import points
from .layout import room_of
from .reading import Draft
from .things import Box, Fixed, RoomSaid, Thing

HIGH_DOOR, LEAF = 2.45, 2.05
"""Metres: what no door's leaf is higher than, and what it is then taken for."""
_LEAST = 4
"""Things with boxes from which the floor's corners in the picture are worked out where the draft does not say them."""


def analysis_reply(draft: Draft) -> AnalysisReply | None:
    """The answer to the first question of stage 1; None where the draft does not tell where the picture shows the floor."""
    room = draft.room or room_of(draft)
    if room is None:
        return None
    seen = room.seen if len(room.seen) >= 3 else corners_by_things(room, draft.things.values())
    if seen is None:
        return None
    middle = _middle(room)
    return AnalysisReply(
        view=room.view,
        room_type=room.kind,
        room_width_m=room.size[0],
        room_depth_m=room.size[1],
        wall_height_m=room.size[2],
        floor_polygon=points(tuple(seen)),
        wall_top_polygon=points(room.top) or None if len(room.seen) >= 3 else None,
        architecture=[_fixed(f, middle) for f in draft.fixed.values()],
        objects=[object_reply(t, middle) for t in draft.things.values()],
    )


def _middle(room: RoomSaid) -> tuple[float, float]:
    """The middle of the floor's bounding rectangle, where the analysis has its origin."""
    xs, ys = [p[0] for p in room.floor], [p[1] for p in room.floor]
    return (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2


def _metres(point: Sequence[float], middle: tuple[float, float]) -> MetresReply:
    return MetresReply(x_m=round(point[0] - middle[0], 4), y_m=round(point[1] - middle[1], 4))


def _box(seen: Box | None) -> BoxReply:
    """A box of nothing where it was not said: then only the metres are used."""
    x0, y0, x1, y1 = seen or (0.0, 0.0, 0.0, 0.0)
    return BoxReply(x_min=x0, y_min=y0, x_max=x1, y_max=y1)


def _fixed(item: Fixed, middle: tuple[float, float]) -> ArchitectureReply:
    # A door as high as a room is its hole, cut open to the wall's top; what is above the leaf is found in the picture.
    height = min(item.height, LEAF) if item.kind == "door" and item.height > HIGH_DOOR else item.height
    return ArchitectureReply(
        id=item.id,
        kind=item.kind,
        start=_metres(item.start, middle),
        end=_metres(item.end, middle),
        height_m=height,
        sill_m=item.sill,
        thickness_m=item.thickness,
        wall=item.wall,
        box=_box(item.seen) if item.seen else None,
        swing=item.swing,
    )


def object_reply(thing: Thing, middle: tuple[float, float] = (0.0, 0.0)) -> ObjectReply:
    """A thing as stage 1 is told of it, in metres from a middle."""
    fronted = bool(thing.front) and thing.shape != "round"
    return ObjectReply(
        id=thing.id,
        category=thing.category,
        label=thing.label,
        placement=thing.placement,
        parent=thing.parent,
        salience=thing.salience,
        shape=thing.shape,
        box=_box(thing.seen),
        centre_m=_metres(thing.at, middle),
        base_m=thing.at[2],
        size_m=SizeReply(width=thing.size[0], depth=thing.size[1], height=thing.size[2]),
        facing=_facing(thing.yaw) if fronted else "none",
        yaw_deg=thing.yaw,
        front=thing.front,
    )


def _facing(yaw: float) -> str:
    return min(FACING_YAW, key=lambda word: abs((FACING_YAW[word] - yaw + 180.0) % 360.0 - 180.0))


def corners_by_things(room: RoomSaid, things: Collection[Thing]) -> list[tuple[float, float]] | None:
    """Where the picture shows the floor's corners, by what stands on it; None where too little does."""
    known = [t for t in things if t.seen is not None and t.placement == "floor"]
    if len(known) < _LEAST:
        return None
    metres = np.array([[t.at[0], t.at[1], 1.0] for t in known])
    places = np.array([[(t.seen[0] + t.seen[2]) / 2, (t.seen[1] + t.seen[3]) / 2] for t in known if t.seen])
    if np.linalg.matrix_rank(metres - metres.mean(axis=0), tol=0.05) < 2:
        return None
    way, *_ = np.linalg.lstsq(metres, places, rcond=None)
    corners = np.array([[x, y, 1.0] for x, y in room.floor]) @ way
    if not np.isfinite(corners).all() or np.abs(corners).max() > 5000:
        return None
    return [(float(x), float(y)) for x, y in corners]


def auxiliary_reply(draft: Draft, ids: Collection[str]) -> AuxiliaryReply:
    """Where things stand whose carriers stage 4 asks for."""
    asked = [t for t in draft.things.values() if t.id in ids]
    placements = [
        AuxiliaryPlacementReply(
            id=t.id,
            placement=t.placement,
            parent=t.parent,
            base_m=t.at[2],
            height_m=t.size[2],
            reason="as in the draft",
        )
        for t in asked
    ]
    return AuxiliaryReply(placements=placements)
