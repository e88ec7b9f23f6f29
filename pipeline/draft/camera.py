# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera through which a draft is seen while it grows: fitted to the corners that its room line gives."""

from __future__ import annotations

from functools import lru_cache

from ..analysis.calibrate import calibrate
from ..analysis.clean import clean_analysis
from ..artifacts.layout import CameraLine
from ..artifacts.replies import AnalysisReply, PointReply
from ..errors import RoomError
from ..layout.initial import camera_line
from .things import RoomSaid


@lru_cache(maxsize=4)
def first_camera(room: RoomSaid, image_size: tuple[int, int]) -> CameraLine | None:
    """The line of the reference camera, None where the room's corners do not tell it. The stages fit a better one later."""
    if len(room.seen) < 3:
        return None
    reply = AnalysisReply.model_validate(
        {
            "view": room.view,
            "room_width_m": room.size[0],
            "room_depth_m": room.size[1],
            "wall_height_m": room.size[2],
            "floor_polygon": points(room.seen),
            "wall_top_polygon": points(room.top) or None,
        }
    )
    try:
        _, fitted = calibrate(clean_analysis(reply, image_size))
        return camera_line(fitted)
    except (RoomError, ValueError, ArithmeticError, LookupError):
        return None


def points(said: tuple[tuple[float, float], ...]) -> list[PointReply]:
    """Points of the picture as a reply has them."""
    return [PointReply(x=x, y=y) for x, y in said]
