# SPDX-License-Identifier: GPL-3.0-or-later
"""Which predicted thing is which true one: Hungarian assignment on category, overlap and distance.

Definition (after the metrics page that the project started from): similarity = 0.5 category + 0.25 IoU +
0.25 max(0, 1 - d / D), pairs of foreign categories are forbidden, centres must be within D = max(0.5 m, 15 % of the
room's diagonal, half the thing's own diagonal).
"""

from __future__ import annotations

import math
import re

import numpy as np
from code_as_room.pipeline.geometry.polygon import bounding_rectangle, centroid, footprint_iou
from scipy.optimize import linear_sum_assignment

from .rooms import Polygon, Room, Thing

FAMILIES = [
    {"bed", "cot", "crib", "mattress", "bunk"},
    {"sofa", "couch", "loveseat", "settee", "armchair", "chair", "stool", "bench", "ottoman", "pouf", "seat", "recliner"},
    {"table", "desk", "nightstand", "bedside", "console", "sideboard", "worktop", "stand", "vanity", "workbench"},
    {"wardrobe", "closet", "cabinet", "dresser", "drawers", "chest", "cupboard", "shelf", "shelves", "bookcase", "bookshelf",
     "unit", "armoire", "rack", "storage", "shelving", "commode", "credenza", "sideboard", "nightstand"},
    {"lamp", "light", "sconce", "chandelier", "pendant", "lantern"},
    {"rug", "carpet", "mat", "runner"},
    {"curtain", "curtains", "drape", "drapes", "sheer", "blind", "blinds", "drapery"},
    {"pillow", "cushion", "bolster"},
    {"throw", "blanket", "duvet", "quilt", "bedspread", "comforter", "coverlet", "bedding", "plaid", "runner"},
    {"plant", "tree", "shrub", "flower", "flowers", "potted", "vase", "bouquet"},
    {"picture", "painting", "poster", "frame", "art", "artwork", "print", "mirror", "photo", "canvas"},
    {"book", "books", "magazine", "notebook", "paper", "papers", "documents", "notepad"},
    {"laptop", "monitor", "screen", "tv", "television", "computer", "keyboard", "tablet"},
    {"clothes", "clothing", "garment", "garments", "hangers", "sweater", "sweaters", "shirts", "linens"},
    {"bowl", "cup", "mug", "plate", "tray", "dish", "vase", "jar", "bottle", "box", "basket", "decor", "ornament",
     "sculpture", "object", "figurine", "clock", "candle", "jewelry", "bag", "hat", "glasses", "sunglasses", "bin"},
]  # fmt: skip


def words(category: str) -> list[str]:
    """The category's words, lower case, plural s cut off the long ones."""
    return re.findall(r"[a-z]+", category.lower().replace("_", " "))


def similarity(a: str, b: str) -> float:
    """1 for the same last word or a word in common, 0.5 for one family, else 0."""
    first, second = words(a), words(b)
    singular_a, singular_b = {w.rstrip("s") for w in first}, {w.rstrip("s") for w in second}
    if singular_a & singular_b:
        return 1.0
    for family in FAMILIES:
        stems = {w.rstrip("s") for w in family}
        if singular_a & stems and singular_b & stems:
            return 0.5
    return 0.0


def scaled(polygon: Polygon, metres: tuple[float, float]) -> Polygon:
    """A polygon of the unit frame in metres of the true room."""
    return [(x * metres[0], y * metres[1]) for x, y in polygon]


def boxed(polygon: Polygon) -> Polygon:
    """Its axis-aligned bounding rectangle."""
    x0, y0, x1, y1 = bounding_rectangle(polygon)
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def match(truth: Room, result: Room) -> list[tuple[Thing, Thing, float]]:
    """Pairs (true thing, predicted thing, footprint IoU), both rooms laid over one another by their floors' rectangles."""
    size = truth.metres
    shape = boxed if truth.bounding_boxes_only else list
    true = [shape(scaled(t.footprint, size)) for t in truth.things]
    found = [shape(scaled(t.footprint, size)) for t in result.things]
    gain = np.zeros((len(true), len(found)))
    ious = np.zeros_like(gain)
    room_diagonal = math.hypot(*size)
    for i, a in enumerate(true):
        x0, y0, x1, y1 = bounding_rectangle(a)
        reach = max(0.5, 0.15 * room_diagonal, math.hypot(x1 - x0, y1 - y0) / 2)
        for j, b in enumerate(found):
            kind = similarity(truth.things[i].category, result.things[j].category)
            distance = math.dist(centroid(a), centroid(b))
            if kind == 0 or distance > reach:
                continue
            ious[i, j] = footprint_iou(a, b)
            gain[i, j] = 0.5 * kind + 0.25 * ious[i, j] + 0.25 * max(0.0, 1 - distance / reach)
    rows, columns = linear_sum_assignment(-gain)
    pairs = zip(rows.tolist(), columns.tolist(), strict=True)
    return [(truth.things[i], result.things[j], float(ious[i, j])) for i, j in pairs if gain[i, j] > 0]
