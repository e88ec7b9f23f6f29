# SPDX-License-Identifier: GPL-3.0-or-later
"""Things whose size is much the same in every home, and what they say of the room's scale.

The ranges hold for what most shops sell; a thing outside of one is not wrong. A kind of thing is one anchor however many
of it stand in the room, since six chairs of one design are one measurement.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..artifacts.analysis import DetectedObject, SceneAnalysis
from ..artifacts.camera import CameraModel
from ..geometry.camera import GeometryError
from ..geometry.footprint import lift_box
from ..geometry.polygon import intersection_area, rectangle_corners

Range = tuple[float, float, float]
"""Low, typical, high in metres: about 19 of 20 lie between low and high."""


@dataclass(frozen=True)
class Usual:
    """Usual sizes: the footprint's shorter and longer side, whichever way it is turned, and the height over all."""

    short: Range | None = None
    long: Range | None = None
    height: Range | None = None


# Mattresses: 190 to 210 cm long in Europe, 191 to 203 in North America; the frame and the headboard add 3 to 25 cm.
_BED: Range = (1.96, 2.10, 2.32)
_SINGLE = Usual((0.85, 0.99, 1.15), _BED)  # mattress 80 to 100
_DOUBLE = Usual((1.40, 1.64, 1.90), _BED)  # mattress 135 to 180
_KING = Usual((1.60, 1.94, 2.18), _BED)  # mattress 150 to 200
# Seats: 40 to 48 cm of seat depth and width (EN 1728, EN 12520 for strength; widths as in catalogues) with a backrest.
_CHAIR = Usual((0.40, 0.47, 0.55), (0.44, 0.54, 0.64), (0.76, 0.86, 1.02))
_OFFICE_CHAIR = Usual((0.52, 0.63, 0.72), (0.54, 0.66, 0.76))  # five-star base (EN 1335): 60 to 70 cm across
_ARMCHAIR = Usual((0.66, 0.79, 0.94), (0.70, 0.86, 1.02))
_STOOL = Usual((0.30, 0.38, 0.46), (0.32, 0.41, 0.50))
_SOFA = Usual((0.78, 0.91, 1.08), (1.55, 2.08, 2.60))  # two and a half to three seats of 55 to 70 cm and two arms
_LOVESEAT = Usual((0.76, 0.89, 1.05), (1.25, 1.58, 1.85))
# Tables: 60 cm of width and 40 cm of depth for each person, 72 to 76 cm high (EN 1730, EN 527 for desks).
_DINING_TABLE = Usual((0.74, 0.90, 1.10), (1.10, 1.60, 2.30), (0.71, 0.75, 0.78))
_DESK = Usual((0.50, 0.66, 0.82), (0.95, 1.35, 1.85), (0.70, 0.74, 0.79))
_COFFEE_TABLE = Usual((0.45, 0.60, 0.85), (0.70, 1.05, 1.40))
# Storage: 60 cm deep for hangers, 35 to 55 for folded clothes, 25 to 40 for books and files.
_WARDROBE = Usual((0.50, 0.60, 0.68))
_DRESSER = Usual((0.38, 0.47, 0.56))
_NIGHTSTAND = Usual((0.33, 0.41, 0.51), (0.37, 0.47, 0.62))
_BOOKCASE = Usual((0.24, 0.31, 0.41))
_MEDIA = Usual((0.33, 0.42, 0.53))
# Kitchen and bath: the 60 cm grid of EN 1116, worktops 60 to 65 deep and 85 to 95 high; sanitary ware as in catalogues.
_WORKTOP = Usual((0.56, 0.62, 0.69), None, (0.84, 0.90, 0.96))
_APPLIANCE = Usual((0.53, 0.60, 0.66), (0.56, 0.61, 0.69))
_FRIDGE = Usual((0.54, 0.62, 0.74), (0.56, 0.68, 0.93))
_TOILET = Usual((0.34, 0.37, 0.42), (0.52, 0.66, 0.76))
_BATHTUB = Usual((0.68, 0.75, 0.86), (1.48, 1.70, 1.84))
_SHOWER = Usual((0.74, 0.88, 1.02))
_VANITY = Usual((0.40, 0.49, 0.58))
# Cots take a mattress of 60 x 120 or 70 x 140 cm; upright pianos have 88 keys of 13.7 mm between two cheeks.
_COT = Usual((0.62, 0.72, 0.84), (1.22, 1.32, 1.50))
_PIANO = Usual((0.50, 0.60, 0.68), (1.40, 1.50, 1.58))
_UNKNOWN = Usual()

DOOR: Range = (0.68, 0.83, 1.00)
"""Width of a door for one leaf: 61, 73.5, 86 or 98.5 cm leaves (DIN 18101), 24 to 36 inches."""
WIDEST_DOOR = 1.3

USUAL: dict[str, Usual] = {
    "bed": Usual(None, _BED), "single bed": _SINGLE, "twin bed": _SINGLE, "bunk bed": _SINGLE, "double bed": _DOUBLE,
    "queen bed": _DOUBLE, "king bed": _KING, "bed frame": Usual(None, _BED),
    "pet bed": _UNKNOWN, "dog bed": _UNKNOWN, "cat bed": _UNKNOWN, "doll bed": _UNKNOWN, "toddler bed": _UNKNOWN,
    "kids bed": _UNKNOWN, "child bed": _UNKNOWN, "sofa bed": _SOFA, "crib": _COT, "cot": _COT, "baby bed": _COT,
    "nightstand": _NIGHTSTAND, "night stand": _NIGHTSTAND, "bedside table": _NIGHTSTAND, "bedside cabinet": _NIGHTSTAND,
    "wardrobe": _WARDROBE, "armoire": _WARDROBE, "dresser": _DRESSER, "chest of drawers": _DRESSER,
    "sofa": _SOFA, "couch": _SOFA, "loveseat": _LOVESEAT, "sectional sofa": _UNKNOWN, "corner sofa": _UNKNOWN,
    "l shaped sofa": _UNKNOWN, "sectional": _UNKNOWN, "armchair": _ARMCHAIR, "lounge chair": _ARMCHAIR,
    "chair": _CHAIR, "dining chair": _CHAIR, "side chair": _CHAIR, "office chair": _OFFICE_CHAIR,
    "desk chair": _OFFICE_CHAIR, "swivel chair": _OFFICE_CHAIR, "gaming chair": _OFFICE_CHAIR, "kids chair": _UNKNOWN,
    "child chair": _UNKNOWN, "high chair": _UNKNOWN, "egg chair": _UNKNOWN, "hanging chair": _UNKNOWN,
    "rocking chair": _UNKNOWN, "bean bag chair": _UNKNOWN, "accent chair": _ARMCHAIR,
    "stool": _STOOL, "bar stool": _STOOL, "dining table": _DINING_TABLE, "desk": _DESK, "writing desk": _DESK,
    "coffee table": _COFFEE_TABLE, "bookcase": _BOOKCASE, "bookshelf": _BOOKCASE, "tv stand": _MEDIA, "tv unit": _MEDIA,
    "tv cabinet": _MEDIA, "media console": _MEDIA, "kitchen counter": _WORKTOP, "worktop": _WORKTOP,
    "base cabinet": _WORKTOP, "kitchen base cabinet": _WORKTOP, "stove": _APPLIANCE, "oven": _APPLIANCE,
    "cooker": _APPLIANCE, "dishwasher": _APPLIANCE, "washing machine": _APPLIANCE, "washer": _APPLIANCE,
    "dryer": _APPLIANCE, "tumble dryer": _APPLIANCE, "hair dryer": _UNKNOWN, "toy stove": _UNKNOWN,
    "refrigerator": _FRIDGE, "fridge": _FRIDGE, "mini fridge": _UNKNOWN, "toilet": _TOILET, "bathtub": _BATHTUB,
    "bath tub": _BATHTUB, "shower": _SHOWER, "shower tray": _SHOWER, "vanity": _VANITY, "piano": _PIANO,
    "upright piano": _PIANO, "grand piano": _UNKNOWN,
}  # fmt: skip

BOX_EDGE = 4.0
"""Usual error of a box's edge, 0-1000."""
STATED = 0.10
"""Relative error of a length that is only stated: a model may state what such things usually measure."""
TURNED = 15.0
"""A thing turned by more degrees shows too little of its two sides."""
COVERED = 0.06
"""A thing of which more lies under another (a chair at a table) may show only in part."""


@dataclass(frozen=True)
class Anchor:
    """A kind of thing as a yardstick.

    Attributes:
        name: the kind ("door", "office chair"); count: how many of it were measured.
        log_factor: logarithm of what all metres must be multiplied by for it to have its usual size; spread: its
            standard deviation.
    """

    name: str
    log_factor: float
    spread: float
    count: int


def usual_size(category: str) -> Usual | None:
    """The usual sizes of a category, by its last words ("modern double bed with drawers" is a double bed), or None."""
    text = re.split(r" with | on | in | of (?!drawers)|[,(/]", category.lower().replace("-", " ").replace("_", " "))[0]
    words = [w for w in re.findall(r"[a-z]+", text) if not w.isdigit()]
    for first in range(len(words)):
        for phrase in (" ".join(words[first:]), " ".join([*words[first:-1], words[-1].removesuffix("s")])):
            if phrase in USUAL:
                found = USUAL[phrase]
                return None if found == _UNKNOWN else found
    return None


def find_anchors(analysis: SceneAnalysis, camera: CameraModel) -> list[Anchor]:
    """What the things of known size say, in the metres of the analysis and of its camera.

    A footprint is measured in the picture, through the camera; heights and doors only as they are stated.
    """
    found: dict[str, list[tuple[float, float]]] = {}
    for item in analysis.objects:
        usual = usual_size(item.category)
        if usual is None or item.placement != "floor" or item.shape == "l_shape":
            continue
        votes = _footprint_votes(item, usual, analysis, camera)
        if usual.height is not None:
            votes.append(_vote(usual.height, item.size[2], 2 * STATED))
        if votes:
            found.setdefault(item.category.lower(), []).append(_joined(votes))
    doors = [math.dist(a.start, a.end) for a in analysis.architecture if a.kind == "door"]
    for width in doors:
        if 0.3 < width < WIDEST_DOOR * 2:
            found.setdefault("door", []).append(_vote(DOOR, width, STATED))
    return [_of_kind(name, votes) for name, votes in sorted(found.items())]


def _footprint_votes(
    item: DetectedObject, usual: Usual, analysis: SceneAnalysis, camera: CameraModel
) -> list[tuple[float, float]]:
    off_axis = abs((item.yaw + 45.0) % 90.0 - 45.0)
    if item.box is None or off_axis > TURNED or _at_the_edge(item) or _partly_hidden(item, analysis.objects):
        return []
    try:
        lifted = lift_box(
            camera, item.box, max(0.0, item.centre[2] - item.size[2] / 2), item.size[2], item.yaw, item.size,
            shape=item.shape,
        )  # fmt: skip
    except GeometryError:
        return []
    if lifted.residual > 5 * BOX_EDGE:
        return []
    short, long = sorted(lifted.size[:2])
    unit = math.sqrt(item.box.area / max(1e-6, short * long))  # picture units for a metre
    return [
        _vote(usual_side, side, math.sqrt(2) * BOX_EDGE / unit / side)
        for usual_side, side in ((usual.short, short), (usual.long, long))
        if usual_side is not None and side > 0.02
    ]


def _at_the_edge(item: DetectedObject) -> bool:
    assert item.box is not None
    return min(item.box.x_min, item.box.y_min) < 1.0 or max(item.box.x_max, item.box.y_max) > 999.0


def _partly_hidden(item: DetectedObject, objects: Sequence[DetectedObject]) -> bool:
    """Whether another thing stands where this one does, so that its box may show it only in part."""
    own = rectangle_corners(item.centre, item.size, item.yaw)
    area = item.size[0] * item.size[1]
    for other in objects:
        if other.id == item.id or other.placement != "floor" or other.size[2] < 0.1 or other.parent == item.id:
            continue
        if intersection_area(own, rectangle_corners(other.centre, other.size, other.yaw)) > COVERED * area:
            return True
    return False


def _vote(usual: Range, side: float, measured: float) -> tuple[float, float]:
    low, typical, high = usual
    return math.log(typical / side), math.hypot(math.log(high / low) / 4, measured)


def _joined(votes: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """The weighted mean of votes on one thing."""
    weights = np.array([1 / spread**2 for _, spread in votes])
    mean = float(np.dot([value for value, _ in votes], weights) / weights.sum())
    return mean, 1 / math.sqrt(float(weights.sum()))


def _of_kind(name: str, votes: Sequence[tuple[float, float]]) -> Anchor:
    """Things of one kind share what their design does; their disagreement is measured too."""
    values = np.array([value for value, _ in votes])
    spread = float(np.median([spread for _, spread in votes]))
    apart = 1.4826 * float(np.median(np.abs(values - np.median(values)))) if len(values) > 2 else 0.0
    return Anchor(name, float(np.median(values)), max(spread, apart), len(votes))
