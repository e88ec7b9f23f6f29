# SPDX-License-Identifier: GPL-3.0-or-later
"""To the millimetre: rays against meshes, rows of books between two boards, cushions that are no tablecloths."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.analysis import Calibration, DetectedObject
from code_as_room.pipeline.artifacts.layout import ProxyLine
from code_as_room.pipeline.geometry.camera import camera_looking_at
from code_as_room.pipeline.program.prelude.shape import Shape
from code_as_room.pipeline.program.prelude.solids import box, sphere
from code_as_room.pipeline.surfaces.choose import Carriers
from code_as_room.pipeline.surfaces.rays import faces_of, hits, room_beside

CASE = [
    *(box((0.022, 0.3, 2.0), at=(x, 0, 0)) for x in (-0.489, 0.489)),
    *(box((1.0, 0.3, 0.02), at=(0, 0, z)) for z in (0.5, 0.86)),
]
SHELF = ProxyLine(id="bookcase_1", category="bookcase", centre=(0.4, 0.1, 1.0), size=(1.0, 0.3, 2.0), yaw=270.0)
OVER = camera_looking_at("perspective", (0, 0, 6), (0, 0, 0), 45.0, (800, 800))
SEEN = Calibration(camera=OVER, floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)], height=2.5, error_px=0.0,
                   scale_source="truth")  # fmt: skip


def seat(item: DetectedObject, own: list[Shape], carrier: ProxyLine, of: list[Shape]) -> ProxyLine:
    carriers = Carriers({carrier.id: of, item.id: own})
    carriers.add(carrier)
    found = carriers.seat(item, SEEN, carrier.id)
    assert found is not None
    return found.proxy


def test_rays_meet_faces_where_they_are() -> None:
    ball = faces_of([sphere(0.5)])
    way = np.array((1.0, 0.0, 0.0))
    near, far = hits(ball, np.array((-2.0, 0.01, 0.013)), way)
    assert near == pytest.approx(1.5, abs=0.01) and far == pytest.approx(2.5, abs=0.01)
    assert not len(hits(ball, np.array((-2.0, 0.6, 0.0)), way)) and not len(hits(ball, np.array((2.0, 0.0, 0.0)), way))
    assert not len(hits(faces_of([]), np.zeros(3), way))


@pytest.mark.parametrize("turn", [0.0, 37.0, 180.0])
def test_room_beside_is_measured_in_the_things_own_directions(turn: float) -> None:
    angle = math.radians(turn)
    walls = [box((0.02, 2.0, 1.0), at=(-0.71, 0, 0)), box((0.02, 2.0, 1.0), at=(0.31, 0, 0))]
    turned = [
        Shape(w.vertices @ np.array(((math.cos(angle), math.sin(angle), 0), (-math.sin(angle), math.cos(angle), 0), (0, 0, 1))), w.faces)
        for w in walls
    ]  # fmt: skip
    before, after = room_beside(turned, np.array((0.0, 0.0, 0.5)), np.array((0.5, 0.3, 0.4)), angle, 0)
    assert (before, after) == (pytest.approx(0.7, abs=1e-6), pytest.approx(0.3, abs=1e-6))
    assert room_beside(turned, np.array((0.0, 0.0, 0.5)), np.array((0.5, 0.3, 0.4)), angle, 1) == (math.inf, math.inf)


@pytest.mark.parametrize("width", [0.9, 0.972, 1.01])
def test_a_row_of_books_never_reaches_into_the_sides_of_its_shelf(width: float) -> None:
    item = DetectedObject(id="books_1", category="books", placement="surface", parent="bookcase_1",
                          size=(width, 0.2, 0.26), centre=(0.4, 0.12, 0.65), yaw=270.0, box=None)  # fmt: skip
    found = seat(item, [box((width, 0.2, 0.26))], SHELF, CASE)
    assert abs(found.centre[1] - 0.1) + found.size[0] / 2 <= 0.478 + 1e-6, "the case is turned: its width runs along y"
    assert found.size[0] == pytest.approx(min(width, 0.954), abs=0.003) and found.size[1:] == (0.2, 0.26)


@pytest.mark.parametrize("fold", [None, 0.58])
def test_a_pillow_does_not_lie_with_its_rim_on_a_low_rail(fold: float | None) -> None:
    bed = ProxyLine(id="bed_1", category="bed", centre=(0, 0, 0.255), size=(1.0, 2.0, 0.51))
    parts = [box((1.0, 1.9, 0.48), at=(0, 0, 0.24)), box((1.0, 0.1, 0.51), at=(0, 0.95, 0.255))]
    if fold is not None:  # something thick before it
        parts.append(box((1.0, 0.1, 0.12), at=(0, fold - 0.05, 0.54)))
    item = DetectedObject(id="pillow_1", category="pillow", placement="surface", parent="bed_1",
                          size=(0.6, 0.32, 0.12), centre=(0, 0.76, 0.54), box=None)  # fmt: skip
    found = seat(item, [sphere((0.3, 0.16, 0.06), at=(0, 0, 0.06))], bed, parts)
    assert found.centre[1] + found.size[1] / 2 <= 0.9
    assert found.centre[2] - found.size[2] / 2 == pytest.approx(0.48, abs=0.004)
    assert (found.size[1] < 0.32) == (fold is not None) and found.size[1] > 0.28


def test_a_cushion_on_a_narrow_seat_is_seated_and_not_spread_over_it() -> None:
    chair = ProxyLine(id="armchair_1", category="armchair", centre=(0, 0, 0.22), size=(0.5, 0.45, 0.44))
    cushion = ProxyLine(id="cushion_1", category="cushion", centre=(0, 0, 0.6), size=(0.52, 0.2, 0.3),
                        placement="surface", parent="armchair_1")  # fmt: skip
    throw = cushion.model_copy(update={"id": "throw_1", "category": "throw", "size": (0.7, 0.5, 0.3)})
    carriers = Carriers({"armchair_1": [box((0.5, 0.45, 0.44))]})
    carriers.add(chair)
    assert carriers.spread(cushion) is None
    assert carriers.spread(throw) is not None
