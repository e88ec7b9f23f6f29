# SPDX-License-Identifier: GPL-3.0-or-later
"""How well calibration finds camera, proportions and scale of synthetic rooms, by view and by exactness of the answers.

python -m benchmark.calibration [--rooms 20] [--seed 1]

Columns: `kind` the camera is of the right kind and its tilt within 5 degrees, `tilt` median error in degrees, `aspect` mean
error of width / depth, `scale` mean error of the room's size (root of its area), `feet` mean distance of footprints
lifted from exact boxes from where they are, as a part of the room's diagonal, scale left aside; `spread` the uncertainty
of the scale that is stated. All but degrees in percent.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import astuple, dataclass

import numpy as np
from code_as_room.pipeline.analysis.calibrate import calibrate
from code_as_room.pipeline.artifacts.analysis import Calibration
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.geometry.footprint import lift_box

from .synthetic import EXACT, STRONG, WAYS, WEAK, Exactness, TrueRoom, make_room, told

LEVELS: dict[str, Exactness] = {"exact": EXACT, "strong": STRONG, "weak": WEAK}


@dataclass(frozen=True)
class Errors:
    """Of one room; see the module for what they are."""

    kind: float
    tilt: float
    aspect: float
    scale: float
    feet: float
    spread: float


def tilt_of(calibration: Calibration) -> float:
    """Degrees between the line of sight and straight down."""
    return math.degrees(math.acos(max(-1.0, min(1.0, calibration.camera.matrix[10]))))


def errors(room: TrueRoom, found: Calibration) -> Errors:
    """How far the calibration is from the truth."""
    extent = np.ptp(np.array(found.floor), axis=0)
    width, depth = room.size
    scale = math.sqrt(extent[0] * extent[1] / (width * depth))
    true_tilt = math.degrees(math.acos(max(-1.0, min(1.0, room.camera.matrix[10]))))
    tilt = abs(tilt_of(found) - true_tilt)
    right = found.camera.kind == room.camera.kind and tilt < 5.0
    aspect = abs(math.log(extent[0] / extent[1] * depth / width))
    return Errors(float(right), tilt, aspect, abs(math.log(scale)), _feet(room, found, scale), found.scale_spread)


def _feet(room: TrueRoom, found: Calibration, scale: float) -> float:
    off = []
    for item in room.objects:
        assert item.box is not None
        try:
            lifted = lift_box(found.camera, item.box, 0.0, item.size[2] * scale, item.yaw, item.size)
        except RoomError:
            off.append(0.3)
            continue
        at = np.array(lifted.centre[:2]) / scale - np.array(item.centre[:2])
        sides = np.abs(np.array(lifted.size[:2]) / scale - np.array(item.size[:2]))
        off.append(min(0.3, (float(np.hypot(*at)) + float(sides.mean()) / 2) / math.hypot(*room.size)))
    return float(np.mean(off))


def measure(way: str, level: str, tops: bool, rooms: int, seed: int) -> tuple[list[Errors], int]:
    """Errors of so many rooms, and how many were refused."""
    found, refused = [], 0
    for number in range(rooms):
        rng = np.random.default_rng([seed, number, WAYS.index(way)])  # type: ignore[arg-type]
        room = make_room(rng, way)  # type: ignore[arg-type]
        analysis = told(room, rng, LEVELS[level], tops)
        try:
            found.append(errors(room, calibrate(analysis)[1]))
        except RoomError:
            refused += 1
    return found, refused


def row(found: list[Errors], refused: int) -> str:
    """One line of the table."""
    if not found:
        return f"   -  refused {refused}"
    values = np.array([astuple(e) for e in found])
    kind, _, aspect, scale, feet, spread = values.mean(axis=0) * 100
    tilt = float(np.median(values[:, 1]))
    extra = f"  refused {refused}" if refused else ""
    return f"{kind:5.0f} {tilt:6.1f} {aspect:7.1f} {scale:6.1f} {feet:6.2f} {spread:7.1f}{extra}"


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rooms", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print("view          walls  answers   kind   tilt  aspect  scale   feet  spread")
    for tops in (True, False):
        for way in WAYS:
            if tops and way == "orthographic":
                continue
            for level in LEVELS:
                line = row(*measure(way, level, tops, options.rooms, options.seed))
                print(f"{way:13} {'tops' if tops else 'none':6} {level:8} {line}", flush=True)


if __name__ == "__main__":
    main()
