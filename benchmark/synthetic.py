# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms made of numbers: a floor, furniture and a camera, and what a model of a given exactness would say of them.

No pictures are drawn. The corners and boxes are projected exactly and then shaken, so that the truth is known to the
last digit. Sizes of the furniture vary as those in shops do; they are not taken from the ranges that calibration knows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from code_as_room.pipeline.artifacts.analysis import ArchitectureItem, DetectedObject, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImageBox, ImagePoint, Metres2
from code_as_room.pipeline.geometry import camera as cam
from code_as_room.pipeline.geometry.camera import GeometryError
from code_as_room.pipeline.geometry.footprint import image_box_of
from code_as_room.pipeline.geometry.polygon import point_in_polygon, rectangle_corners

Way = Literal["orthographic", "straight", "shifted", "tilted", "steep"]
WAYS: tuple[Way, ...] = ("orthographic", "straight", "shifted", "tilted", "steep")
"""How a room is seen; "shifted": straight down with the principal point off the centre; "steep": 25 to 42 degrees."""

# category, width, depth, height in metres; each varies by 8 %, and by 12 % in height.
FURNITURE = (
    ("double bed", 1.65, 2.1, 0.95),
    ("wardrobe", 1.6, 0.6, 2.1),
    ("nightstand", 0.45, 0.42, 0.52),
    ("desk", 1.4, 0.7, 0.74),
    ("office chair", 0.62, 0.62, 0.95),
    ("bookcase", 0.9, 0.32, 1.9),
    ("sofa", 2.1, 0.92, 0.84),
    ("armchair", 0.82, 0.84, 0.86),
    ("coffee table", 1.1, 0.62, 0.43),
    ("dining table", 1.6, 0.9, 0.75),
    ("dining chair", 0.46, 0.52, 0.88),
    ("dresser", 1.2, 0.48, 0.85),
    ("floor lamp", 0.4, 0.4, 1.6),
    ("potted plant", 0.4, 0.4, 1.0),
    ("rug", 2.2, 1.6, 0.01),
)


@dataclass(frozen=True)
class Exactness:
    """Standard deviations of what is said.

    Attributes:
        corner, box: units of 0-1000, for each coordinate.
        centre: part of the room's longer side. size, height: relative. room: width and depth, each, relative.
        scale: relative, common to all metres.
        wrong_view: chance that the view is called by another word.
    """

    corner: float = 0.0
    box: float = 0.0
    centre: float = 0.0
    size: float = 0.0
    height: float = 0.0
    room: float = 0.0
    scale: float = 0.0
    wrong_view: float = 0.0


EXACT = Exactness()
STRONG = Exactness(3.0, 3.0, 0.01, 0.04, 0.06, 0.015, 0.02, 0.1)
WEAK = Exactness(8.0, 8.0, 0.03, 0.10, 0.15, 0.05, 0.15, 0.33)


@dataclass(frozen=True)
class TrueRoom:
    """A room and the camera that sees it; metres, origin at the floor's middle."""

    way: Way
    floor: list[Metres2]
    height: float
    camera: CameraModel
    objects: list[DetectedObject]
    architecture: list[ArchitectureItem] = field(default_factory=list)

    @property
    def size(self) -> tuple[float, float]:
        """Width and depth of the floor's bounding rectangle."""
        extent = np.ptp(np.array(self.floor), axis=0)
        return float(extent[0]), float(extent[1])


def make_room(rng: np.random.Generator, way: Way, outline: str = "", off_down: float | None = None) -> TrueRoom:
    """A furnished room that is all in its picture.

    Args:
        off_down: degrees between the line of sight and straight down for "steep", instead of any.
        outline: "rectangle", "l", "quad" or "hexagon"; "" for any, rectangles most often.
    """
    while True:
        floor = _outline(rng, outline or str(rng.choice(["rectangle", "rectangle", "l", "quad", "hexagon"])))
        height = float(rng.uniform(2.4, 3.0))
        camera = _camera(rng, way, floor, height, off_down)
        if camera is None:
            continue
        objects = _furniture(rng, floor, camera)
        if len(objects) >= 5:
            return TrueRoom(way, [(float(x), float(y)) for x, y in floor], height, camera, objects, [_door(rng, floor)])


def _outline(rng: np.random.Generator, name: str) -> np.ndarray:
    w, d = rng.uniform(3.2, 7.0), rng.uniform(2.8, 5.5)
    a, b = rng.uniform(0.35, 0.6), rng.uniform(0.4, 0.65)
    corners = {
        "rectangle": [(0, 0), (w, 0), (w, d), (0, d)],
        "l": [(0, 0), (w, 0), (w, d * b), (w * a, d * b), (w * a, d), (0, d)],
        "hexagon": [(0, d * 0.2), (w * 0.25, 0), (w, 0), (w, d * 0.8), (w * 0.75, d), (0, d)],
        "quad": [(0, 0), (w, rng.uniform(-0.1, 0.1) * d), (w * rng.uniform(0.8, 1.0), d), (rng.uniform(-0.1, 0.15) * w, d * 0.95)],
    }[name]  # fmt: skip
    points = np.array(corners, dtype=float)
    centred: np.ndarray = points - (points.min(axis=0) + points.max(axis=0)) / 2
    return centred


def _camera(
    rng: np.random.Generator, way: Way, floor: np.ndarray, height: float, off_down: float | None
) -> CameraModel | None:
    size = (int(rng.integers(800, 1500)), int(rng.integers(700, 1300)))
    towards = rng.uniform(0, 2 * math.pi)
    angle = {"tilted": rng.uniform(8, 22), "steep": rng.uniform(25, 42)}.get(way, 0.0)
    if off_down is not None:
        angle, towards = off_down, rng.normal(0, 0.05)
    elif way == "steep":  # people stand in front of a room and look into it, not askew
        towards = rng.choice([0.0, math.pi / 2, math.pi]) + rng.normal(0, 0.12)
    rotation = cam.tilt_rotation(angle * math.cos(towards), angle * math.sin(towards), 0.0)
    kind: cam.Kind = "orthographic" if way == "orthographic" else "perspective"
    focal = max(size) / 2 / math.tan(math.radians(rng.uniform(30, 65)) / 2)
    principal = cam.CENTRE
    if way == "shifted":
        principal = tuple((np.array(cam.CENTRE) + rng.choice([-1, 1], 2) * rng.uniform(60, 160, 2)).tolist())
    corners = np.concatenate([np.column_stack([floor, np.full(len(floor), z)]) for z in (0.0, height)])
    aim = np.zeros(3)
    for distance in np.geomspace(3.5, 60, 60):
        for _ in range(3):  # move the camera until the room lies in the middle of the picture
            position = aim + distance * rotation[:, 2]
            if position[2] < height + 0.8 and kind == "perspective":
                break
            scale = focal if kind == "perspective" else min(size) / distance
            camera = cam.camera_from(kind, position.tolist(), rotation, scale, size, principal)
            seen = cam.project(camera, corners)
            if not np.isfinite(seen).all():
                break
            ground = cam.to_plane(camera, [((seen.min(axis=0) + seen.max(axis=0)) / 2), cam.CENTRE], height / 2)
            if not np.isfinite(ground).all():
                break
            if seen.min() > 15 and seen.max() < 985:
                return camera
            aim = aim + np.array((*(ground[0] - ground[1])[:2], 0.0))
    return None


def _furniture(rng: np.random.Generator, floor: np.ndarray, camera: CameraModel) -> list[DetectedObject]:
    """Eight to sixteen pieces that do not overlap, two thirds of them along a wall."""
    placed: list[tuple[float, float, float, float]] = []
    objects: list[DetectedObject] = []
    order = rng.permutation(len(FURNITURE)).tolist() + rng.permutation(len(FURNITURE)).tolist()
    low, high = floor.min(axis=0), floor.max(axis=0)
    for index in order[: int(rng.integers(12, 24))]:
        category, *typical = FURNITURE[index]
        size = np.array(typical) * np.exp(rng.normal(0, (0.08, 0.08, 0.12)))
        yaw = float(rng.choice([0, 90, 180, 270]) + (rng.uniform(-40, 40) if rng.random() < 0.15 else 0.0)) % 360
        for _ in range(12):
            half = np.ptp(rectangle_corners((0, 0), size[:2].tolist(), yaw), axis=0) / 2
            at = rng.uniform(low + half, np.maximum(low + half + 1e-3, high - half))
            if rng.random() < 0.67:
                axis = int(rng.integers(0, 2))
                at[axis] = low[axis] + half[axis] if rng.random() < 0.5 else high[axis] - half[axis]
            rectangle = (at[0] - half[0], at[1] - half[1], at[0] + half[0], at[1] + half[1])
            corners = rectangle_corners(at.tolist(), (size[:2] * 0.98).tolist(), yaw)
            flat = size[2] < 0.05
            if not all(point_in_polygon((float(x), float(y)), floor) for x, y in corners):
                continue
            if not flat and any(_overlap(rectangle, other) for other in placed):
                continue
            centre = (float(at[0]), float(at[1]), float(size[2]) / 2)
            try:
                box = image_box_of(camera, centre, size.tolist(), yaw)
            except GeometryError:
                continue
            if not flat:
                placed.append(rectangle)
            objects.append(
                DetectedObject(
                    id=f"{category.replace(' ', '_')}_{len(objects)}", category=category, box=box, centre=centre,
                    size=(float(size[0]), float(size[1]), float(size[2])), yaw=yaw, salience="minor" if flat else "major",
                )
            )  # fmt: skip
            break
    return objects


def _overlap(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    return min(a[2], b[2]) > max(a[0], b[0]) and min(a[3], b[3]) > max(a[1], b[1])


def _door(rng: np.random.Generator, floor: np.ndarray) -> ArchitectureItem:
    start, end = floor[0], floor[1]
    step = (end - start) / np.linalg.norm(end - start)
    width = float(rng.normal(0.86, 0.05))
    a, b = start + 0.4 * step, start + (0.4 + width) * step
    return ArchitectureItem(
        id="door", kind="door", start=(float(a[0]), float(a[1])), end=(float(b[0]), float(b[1])), height=2.05
    )


def told(room: TrueRoom, rng: np.random.Generator, exactness: Exactness, tops: bool = True) -> SceneAnalysis:
    """What a model of this exactness says of the room.

    Args:
        tops: whether wall tops are pointed out; never in an orthographic view that shows no wall faces.
    """
    e, camera = exactness, room.camera
    floor = np.array(room.floor)
    yardstick = math.exp(rng.normal(0, e.scale)) if e.scale else 1.0
    width, depth = (v * math.exp(rng.normal(0, e.room)) for v in room.size)
    stretch = np.array((width / room.size[0], depth / room.size[1])) * yardstick
    right = "orthographic" if room.way == "orthographic" else "perspective"
    view = right
    if rng.random() < e.wrong_view:
        view = "perspective" if right == "orthographic" else str(rng.choice(["orthographic", "plan"]))
    low, high = (cam.project(camera, np.column_stack([floor, np.full(len(floor), z)])) for z in (0.0, room.height))
    return SceneAnalysis(
        image_size=camera.image_size,
        view=view,
        room_size=(width * yardstick, depth * yardstick, room.height * yardstick * math.exp(rng.normal(0, e.height / 2))),
        floor=[],
        floor_polygon=_shaken(low, rng, e.corner),
        wall_top_polygon=_shaken(high, rng, e.corner) if tops and right == "perspective" else None,
        objects=[_told(o, rng, e, yardstick, stretch, max(room.size)) for o in room.objects],
        architecture=[
            a.model_copy(update={"start": _scaled(a.start, stretch), "end": _scaled(a.end, stretch)})
            for a in room.architecture
        ],
    )  # fmt: skip


def _scaled(point: Metres2, stretch: np.ndarray) -> Metres2:
    return point[0] * float(stretch[0]), point[1] * float(stretch[1])


def _shaken(points: np.ndarray, rng: np.random.Generator, units: float) -> list[ImagePoint]:
    moved = points + rng.normal(0, 1, points.shape) * units
    return [ImagePoint(x=float(x), y=float(y)) for x, y in moved]


def _told(
    item: DetectedObject, rng: np.random.Generator, e: Exactness, yardstick: float, stretch: np.ndarray, side: float
) -> DetectedObject:
    assert item.box is not None
    edges = np.array(list(item.box.model_dump().values())) + rng.normal(0, 1, 4) * e.box
    (x0, x1), (y0, y1) = sorted((edges[0], edges[2])), sorted((edges[1], edges[3]))
    box = ImageBox(x_min=x0, y_min=y0, x_max=max(x1, x0 + 2), y_max=max(y1, y0 + 2))
    moved = (np.array(item.centre[:2]) + rng.normal(0, 1, 2) * e.centre * side) * stretch
    size = np.array(item.size) * yardstick * np.exp(rng.normal(0, 1, 3) * (e.size, e.size, e.height))
    centre = (float(moved[0]), float(moved[1]), float(size[2]) / 2)
    wide, deep, tall = (float(v) for v in size)
    return item.model_copy(update={"box": box, "centre": centre, "size": (wide, deep, tall)})
