# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the truth says that a picture shows the objects of a room that was made from it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.geometry.footprint import image_box_of
from code_as_room.pipeline.memory import Memory
from numpy.typing import NDArray

from .metrics.matching import compare
from .metrics.rooms import load_result, load_truth
from .metrics.runs import shapes_of

Box = tuple[float, float, float, float]
"""Left, top, right, bottom in 0..1 of the picture."""
_INSET = 0.12


@dataclass(frozen=True)
class Boxes:
    """One object's own box, and those of smaller things that may lie before it."""

    own: Box
    others: tuple[Box, ...]

    def place(self, shape: tuple[int, ...]) -> NDArray[np.bool_]:
        """The pixels of a picture of (height, width) that show it, without the rim of its box."""
        left, top, right, bottom = self.own
        x, y = _INSET * (right - left), _INSET * (bottom - top)
        found = _filled(shape, (left + x, top + y, right - x, bottom - y))
        for box in self.others:
            found &= ~_filled(shape, box)
        return found


def true_boxes(picture: Path, scene: Path, memory: Memory) -> dict[str, Boxes]:
    """By the id of each object of a result that stands for a true one; {} where the picture has no truth beside it."""
    truth = next(
        (p for p in (picture.with_name("truth.json"), picture.with_suffix(".truth.json")) if p.is_file()), None
    )
    if truth is None:
        return {}
    boxes = _boxes(json.loads(truth.read_text(encoding="utf-8")), picture.stem)
    pairs = compare(load_truth(truth, picture.stem), load_result(scene, shapes_of(memory))).asked_pairs
    found = {}
    for pair in pairs:
        own = boxes.get(pair.true.id)
        if own is not None:
            others = [
                b for name, b in boxes.items() if name != pair.true.id and _area(b) < _area(own) and _meet(b, own)
            ]
            found[pair.own.id] = Boxes(own, tuple(others))
    return found


def _boxes(data: Mapping[str, Any], style: str) -> dict[str, Box]:
    """The boxes of a truth in any of its formats, by id."""
    camera = data.get("camera")
    model = CameraModel.model_validate(camera) if isinstance(camera, dict) and "matrix" in camera else None
    found = {}
    for item in data["objects"]:
        box = item.get("box")
        if style in item.get("image", {}):
            shown = item["image"][style]
            box = shown.get("visible_box") or shown.get("box")
        elif box is None and model is not None:
            seen = image_box_of(model, item["centre"], item["size"], item["yaw"])
            box = [v / 1000 for v in (seen.x_min, seen.y_min, seen.x_max, seen.y_max)]
        if box is not None and len(box) == 4:
            found[str(item["id"])] = (float(box[0]), float(box[1]), float(box[2]), float(box[3]))
    return found


def _filled(shape: tuple[int, ...], box: Box) -> NDArray[np.bool_]:
    rows, columns = (np.arange(n) for n in shape[:2])
    x, y = (columns + 0.5) / shape[1], (rows + 0.5) / shape[0]
    found: NDArray[np.bool_] = ((y >= box[1]) & (y <= box[3]))[:, None] & ((x >= box[0]) & (x <= box[2]))[None, :]
    return found


def _area(box: Box) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def _meet(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
