# SPDX-License-Identifier: GPL-3.0-or-later
"""Metres, boxes, and both fused, over made-up rooms with known errors: `python -m benchmark.fusion [--rooms N]`.

Each room is furnished at random (along the walls, in the middle, turned, repeated, small things on others), seen through
a known camera, and measured twice, in metres and in boxes, with errors of several kinds. The table has the mean footprint
IoU with the truth of: the metres alone, the boxes alone (lifted with the height that was said), both fused with usual
errors, and both fused with what was learnt from the picture.
"""

from __future__ import annotations

import argparse
import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field

from code_as_room.pipeline.analysis.reliability import learn_trust
from code_as_room.pipeline.artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImageBox, ImagePoint, Metres3
from code_as_room.pipeline.artifacts.trust import Trust
from code_as_room.pipeline.geometry.camera import GeometryError, Kind, camera_from, project, tilt_rotation
from code_as_room.pipeline.geometry.footprint import image_box_of, lift_box
from code_as_room.pipeline.geometry.polygon import footprint_iou, outside_fraction, rectangle_corners
from code_as_room.pipeline.layout.fuse import fuse

PIXELS = (1300, 1050)
# Name, width, depth, height, usually along a wall.
KINDS = [
    ("bed", 1.7, 2.1, 0.9, True), ("wardrobe", 1.6, 0.6, 2.1, True), ("desk", 1.3, 0.65, 0.75, True),
    ("sofa", 2.0, 0.9, 0.8, True), ("sideboard", 1.5, 0.45, 0.7, True), ("shelf", 0.9, 0.35, 1.9, True),
    ("nightstand", 0.45, 0.4, 0.5, True), ("armchair", 0.8, 0.8, 0.8, False), ("coffee table", 1.0, 0.6, 0.4, False),
    ("chair", 0.48, 0.5, 0.85, False), ("dining table", 1.6, 0.9, 0.75, False), ("rug", 2.2, 1.6, 0.01, False),
    ("plant", 0.4, 0.4, 1.0, True), ("stool", 0.4, 0.4, 0.45, False),
]  # fmt: skip
SMALL = [("lamp", 0.3, 0.3, 0.45), ("books", 0.25, 0.2, 0.1), ("cushion", 0.5, 0.4, 0.15), ("laptop", 0.34, 0.25, 0.2)]


@dataclass(frozen=True)
class Errors:
    """What is wrong with the metres and the boxes of one picture.

    Attributes:
        centre: metres; size, height: relative; box: thousandths of the picture, each edge for itself.
        stretch, sizes: factors of all centres and all sizes; box_shift, box_stretch: of all boxes; inset: all boxes are
            too tight by this; gross: share of things with one measurement far off.
    """

    centre: float = 0.03
    size: float = 0.04
    height: float = 0.12
    box: float = 4.0
    stretch: float = 1.0
    sizes: float = 1.0
    box_shift: tuple[float, float] = (0.0, 0.0)
    box_stretch: float = 1.0
    inset: float = 0.0
    gross: float = 0.0


CASES: dict[str, Errors] = {
    "both good": Errors(),
    "metres excellent": Errors(centre=0.012, size=0.015, height=0.05, box=6.0),
    "metres good, boxes poor": Errors(box=15.0),
    "boxes good, metres poor": Errors(centre=0.15, size=0.18, height=0.3, box=3.0),
    "both middling": Errors(centre=0.08, size=0.1, height=0.2, box=8.0),
    "both poor": Errors(centre=0.18, size=0.2, height=0.3, box=15.0),
    "sizes 30 % small": Errors(centre=0.06, size=0.08, sizes=0.7, box=6.0),
    "centres stretched 15 %": Errors(centre=0.06, size=0.08, stretch=1.15, box=6.0),
    "boxes shifted": Errors(centre=0.03, size=0.05, box=5.0, box_shift=(12.0, -9.0)),
    "boxes stretched": Errors(centre=0.03, size=0.05, box=5.0, box_stretch=1.03),
    "boxes tight": Errors(box=4.0, inset=6.0),
    "some far off": Errors(centre=0.06, size=0.08, box=6.0, gross=0.12),
}


@dataclass
class MadeUp:
    """A room with its truth and what was measured of it."""

    camera: CameraModel
    truth: list[DetectedObject]
    analysis: SceneAnalysis
    calibration: Calibration
    ious: dict[str, list[float]] = field(default_factory=dict)


def _camera(dice: random.Random, width: float, depth: float) -> CameraModel:
    kind: Kind = "orthographic" if dice.random() < 0.25 else "perspective"
    height = dice.uniform(1.1, 2.5) * max(width, depth) + 2.6
    scale = min(PIXELS[0] / (width * 1.45), PIXELS[1] / (depth * 1.5))
    if kind == "orthographic":
        return camera_from(kind, (0.0, 0.0, height), tilt_rotation(0, 0), scale, PIXELS)
    tilt = dice.choice((0.0, 0.0, 0.0, dice.uniform(-14, 14)))
    back = -math.tan(math.radians(tilt)) * height
    return camera_from(kind, (0.0, back, height), tilt_rotation(tilt, 0), scale * height * 0.92, PIXELS)


def _furniture(dice: random.Random, width: float, depth: float) -> list[DetectedObject]:
    things: list[DetectedObject] = []

    def put(
        name: str, size: Metres3, yaw: float, x: float, y: float, placement: str, parent: str | None, z: float
    ) -> bool:
        rect = rectangle_corners((x, y), size, yaw)
        floor = [(-width / 2, -depth / 2), (width / 2, -depth / 2), (width / 2, depth / 2), (-width / 2, depth / 2)]
        if placement == "floor":
            if outside_fraction(rect, floor) > 1e-6:
                return False
            for other in things:
                solid = other.placement == "floor" and min(other.size[2], size[2]) > 0.05
                if solid and footprint_iou(rect, rectangle_corners(other.centre, other.size, other.yaw)) > 0:
                    return False
        things.append(
            DetectedObject(
                id=f"{name.replace(' ', '_')}_{len(things)}", category=name, placement=placement, parent=parent,  # type: ignore[arg-type]
                salience="major" if placement == "floor" and size[2] > 0.05 else "minor", box=None,
                centre=(x, y, z + size[2] / 2), size=size, yaw=yaw % 360,
            )
        )  # fmt: skip
        return True

    for _ in range(dice.randint(9, 16)):
        name, w, d, h, wall = dice.choice(KINDS)
        size = (w * dice.uniform(0.85, 1.2), d * dice.uniform(0.85, 1.2), h * dice.uniform(0.85, 1.15))
        for _ in range(2 if name in ("chair", "nightstand", "stool") else 1):
            for _ in range(20):
                x, y = dice.uniform(-width / 2, width / 2), dice.uniform(-depth / 2, depth / 2)
                yaw = dice.choice((0, 90, 180, 270)) if wall or dice.random() < 0.7 else dice.uniform(0, 360)
                if wall:
                    gap = 0.0 if dice.random() < 0.7 else dice.uniform(0, 0.2)
                    yaw, x, y = {
                        0: (180.0, x, -depth / 2 + size[1] / 2 + gap),
                        90: (270.0, width / 2 - size[1] / 2 - gap, y),
                        180: (0.0, x, depth / 2 - size[1] / 2 - gap),
                        270: (90.0, -width / 2 + size[1] / 2 + gap, y),
                    }[int(yaw)]
                if put(name, size, yaw, x, y, "floor", None, 0.0):
                    break
    for carrier in [t for t in things if 0.3 < t.size[2] < 1.0]:
        if dice.random() < 0.4:
            name, w, d, h = dice.choice(SMALL)
            x, y = (carrier.centre[i] + dice.uniform(-0.3, 0.3) * min(carrier.size[:2]) for i in (0, 1))
            put(name, (w, d, h), dice.choice((0.0, 90.0, 20.0)), x, y, "surface", carrier.id, carrier.size[2])
    return things


def make_room(seed: int, errors: Errors) -> MadeUp:
    """One furnished room, seen and measured with errors."""
    dice = random.Random(seed)
    width, depth = dice.uniform(3.2, 7.5), dice.uniform(3.0, 6.0)
    camera = _camera(dice, width, depth)
    truth = _furniture(dice, width, depth)
    floor = [(-width / 2, -depth / 2), (width / 2, -depth / 2), (width / 2, depth / 2), (-width / 2, depth / 2)]
    seen = []
    for true in truth:
        box = _tight_box(true, camera, dice)
        seen.append(_measured(true, box, errors, dice))
    corners = project(camera, [(x, y, 0.0) for x, y in floor])
    analysis = SceneAnalysis(
        image_size=PIXELS,
        view="perspective" if camera.kind == "perspective" else "orthographic",
        room_size=(width, depth, 2.6),
        floor=floor,
        floor_polygon=[ImagePoint(x=float(x), y=float(y)) for x, y in corners],
        objects=seen,
    )
    calibration = Calibration(camera=camera, floor=floor, height=2.6, error_px=0.0, scale_source="model")
    return MadeUp(camera, truth, analysis, calibration)


def _tight_box(true: DetectedObject, camera: CameraModel, dice: random.Random) -> ImageBox:
    """What the picture shows of a thing. Half of them are no cuboids: one half of their height is narrower."""
    if dice.random() < 0.5:
        return image_box_of(camera, true.centre, true.size, true.yaw)
    (x, y, z), (w, d, h) = true.centre, true.size
    shares = [1.0, dice.uniform(0.5, 1.0)]
    dice.shuffle(shares)
    corner = 1.0 - 0.1 * abs(math.sin(2 * math.radians(true.yaw)))
    halves = [
        image_box_of(camera, (x, y, z + part * h / 4), (w * s * corner, d * s * corner, h / 2), true.yaw)
        for part, s in zip((-1, 1), shares, strict=True)
    ]
    return ImageBox(
        x_min=min(b.x_min for b in halves), y_min=min(b.y_min for b in halves),
        x_max=max(b.x_max for b in halves), y_max=max(b.y_max for b in halves),
    )  # fmt: skip


def _measured(true: DetectedObject, box: ImageBox, errors: Errors, dice: random.Random) -> DetectedObject:
    far_metres = 8.0 if dice.random() < errors.gross / 2 else 1.0
    far_box = 10.0 if dice.random() < errors.gross / 2 else 1.0
    x, y = (v * errors.stretch + dice.gauss(0, errors.centre * far_metres) for v in true.centre[:2])
    w, d = (v * errors.sizes * math.exp(dice.gauss(0, errors.size)) for v in true.size[:2])
    h = true.size[2] * math.exp(dice.gauss(0, errors.height))
    if true.size[2] < 0.05:
        h = true.size[2]
    base = true.centre[2] - true.size[2] / 2
    edges = {}
    for i, (name, value) in enumerate(box.model_dump().items()):
        across = i % 2
        unit = max(PIXELS) / PIXELS[across]
        out = -1 if i < 2 else 1
        moved = 500 + (value - 500) * errors.box_stretch
        edges[name] = moved + unit * (
            errors.box_shift[across] - out * errors.inset + dice.gauss(0, errors.box * far_box)
        )
    low_x, high_x = sorted((edges["x_min"], edges["x_max"]))
    low_y, high_y = sorted((edges["y_min"], edges["y_max"]))
    new = ImageBox(x_min=low_x, y_min=low_y, x_max=max(high_x, low_x + 3), y_max=max(high_y, low_y + 3))
    return true.model_copy(update={"box": new, "centre": (x, y, base + h / 2), "size": (w, d, h)})


def compare(room: MadeUp, trust: Trust | None = None) -> dict[str, list[float]]:
    """Footprint IoU of each major with its truth, for each way of placing it."""
    side = max(room.analysis.room_size[:2])
    learnt = trust or learn_trust(room.analysis, room.calibration)
    result: dict[str, list[float]] = {"metres": [], "boxes": [], "usual": [], "learnt": []}
    for true, item in zip(room.truth, room.analysis.objects, strict=True):
        if true.salience != "major" or true.placement != "floor":
            continue
        outline = rectangle_corners(true.centre, true.size, true.yaw)

        def score(centre: Metres3, size: Metres3, yaw: float, outline: object = outline) -> float:
            return footprint_iou(outline, rectangle_corners(centre, size, yaw))  # type: ignore[arg-type]

        result["metres"].append(score(item.centre, item.size, item.yaw))
        try:
            assert item.box is not None
            lifted = lift_box(room.camera, item.box, 0.0, item.size[2], item.yaw, item.size)
            result["boxes"].append(score(lifted.centre, lifted.size, item.yaw))
        except GeometryError:
            result["boxes"].append(0.0)
        for name, used in (("usual", Trust()), ("learnt", learnt)):
            fused = fuse(item, room.camera, side, 0.0, used)[0]
            result[name].append(score(fused.centre, fused.size, fused.yaw))
    return result


def means(errors: Errors, rooms: int, make: Callable[[int, Errors], MadeUp] = make_room) -> dict[str, float]:
    """Mean footprint IoU over that many rooms."""
    total: dict[str, list[float]] = {}
    for seed in range(rooms):
        for name, values in compare(make(seed, errors)).items():
            total.setdefault(name, []).extend(values)
    return {name: sum(values) / len(values) for name, values in total.items()}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rooms", type=int, default=20)
    options = parser.parse_args()
    print(f"| {'errors':<26}| metres | boxes  | usual  | learnt |")
    print("|---|---|---|---|---|")
    for name, errors in CASES.items():
        shown = means(errors, options.rooms)
        print(f"| {name:<26}| " + " | ".join(f"{v:.4f}" for v in shown.values()) + " |", flush=True)


if __name__ == "__main__":
    main()
