# SPDX-License-Identifier: GPL-3.0-or-later
"""Places in the picture as models are used to give them, brought to what was asked for: named fields, 0-1000.

Gemini thinks in `[y_min, x_min, y_max, x_max]`, others in `[x_min, y_min, x_max, y_max]`; some give pixels of the picture
that they were sent, some fractions of it, some mix the axes up. What is asked for is told in the prompt, so this is
only for models that follow their habit all the same. Nothing is guessed: where the numbers allow two readings they stay.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeGuard

_BOX = ("x_min", "y_min", "x_max", "y_max")
_BOX_NAMES = frozenset({"box", "bbox", "box_2d", "bbox_2d", "box2d", "bbox2d", "bounding_box", "boundingbox"})
_POLYGONS = frozenset({"floor_polygon", "wall_top_polygon"})
_OTHER_BOXES = (("x1", "y1", "x2", "y2"), ("left", "top", "right", "bottom"), ("xmin", "ymin", "xmax", "ymax"))
_FRACTION_MOST = 1.2
_OUTSIDE = 1020.0
_BEYOND = 1.02
_MOST_DEPTH = 40
_LEAST_THINGS = 6
"""With fewer things, how boxes and metres go together tells nothing."""


@dataclass
class _Found:
    """What was found in a reply: boxes and points as dictionaries, which are changed in place."""

    boxes: list[dict[str, Any]] = field(default_factory=list)
    points: list[dict[str, Any]] = field(default_factory=list)
    things: list[tuple[dict[str, Any], float, float]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def note(self, sentence: str) -> None:
        if sentence not in self.notes:
            self.notes.append(sentence)


def as_asked(data: Any, model: str, sizes: Sequence[tuple[int, int]]) -> tuple[Any, tuple[str, ...]]:
    """A parsed reply with its places in the picture as they were asked for; the reply itself is not changed.

    Args:
        model: the model's name, since some vendors' models are known for a habit.
        sizes: width and height in pixels of the pictures that were sent, in their order.

    Returns:
        The reply, and sentences on what was read in another way than it was written.
    """
    found = _Found()
    result = _copied(data, "gemini" in model.lower(), found, 0)
    _bring_to_scale(found, sizes)
    if _axes_are_mixed_up(found.things):
        for box in found.boxes:
            box.update(zip(_BOX, (box["y_min"], box["x_min"], box["y_max"], box["x_max"]), strict=True))
        for point in found.points:
            point["x"], point["y"] = point["y"], point["x"]
        found.note("x and y of the picture were given the other way round, and read so")
    return result, tuple(found.notes)


def _copied(data: Any, y_first: bool, found: _Found, depth: int) -> Any:
    """A copy in which boxes and corners have their named fields."""
    if depth > _MOST_DEPTH:
        return data
    if isinstance(data, list):
        return [_copied(value, y_first, found, depth + 1) for value in data]
    if not isinstance(data, dict):
        return data
    result: dict[str, Any] = {}
    for key, value in data.items():
        name = key.lower()
        box = _box(value, y_first or name == "box_2d", found) if name in _BOX_NAMES else None
        if box is not None:
            result["box" if "box" not in data else key] = box
        elif name in _POLYGONS and isinstance(value, list):
            result[key] = [_point(corner, y_first, found) for corner in value]
        else:
            result[key] = _copied(value, y_first, found, depth + 1)
    own, place = result.get("box"), result.get("centre_m")
    if isinstance(own, dict) and any(own is box for box in found.boxes) and isinstance(place, dict):
        x, y = place.get("x_m"), place.get("y_m")
        if _is_number(x) and _is_number(y):
            found.things.append((own, x, y))
    return result


def _box(value: Any, y_first: bool, found: _Found) -> dict[str, Any] | None:
    """A box with its named fields; None where it is none, or not a whole one."""
    numbers: Sequence[Any] = ()
    if isinstance(value, list) and len(value) == 2 and all(isinstance(v, list) and len(v) == 2 for v in value):
        value = [*value[0], *value[1]]
    if isinstance(value, list) and len(value) == 4 and all(map(_is_number, value)):
        numbers = (value[1], value[0], value[3], value[2]) if y_first else value
        if y_first:
            found.note("boxes were given as lists of y and x, and read so")
    elif isinstance(value, dict):
        named = {str(key).lower(): number for key, number in value.items()}
        if set(named) >= {"x", "y", "width", "height"} and all(
            _is_number(named[n]) for n in ("x", "y", "width", "height")
        ):
            numbers = (named["x"], named["y"], named["x"] + named["width"], named["y"] + named["height"])
        for names in (_BOX, *_OTHER_BOXES):
            if set(named) >= set(names):
                numbers = [named[name] for name in names]
    if len(numbers) != 4 or not all(map(_is_number, numbers)):
        return None
    box: dict[str, Any] = dict(zip(_BOX, numbers, strict=True))
    found.boxes.append(box)
    return box


def _point(value: Any, y_first: bool, found: _Found) -> Any:
    """A corner with its named fields, or as it is."""
    if isinstance(value, dict) and len(value) == 1 and isinstance(next(iter(value.values())), list):
        value = next(iter(value.values()))
    if isinstance(value, list) and len(value) == 2 and all(map(_is_number, value)):
        value = {"x": value[1], "y": value[0]} if y_first else {"x": value[0], "y": value[1]}
    if isinstance(value, dict) and _is_number(value.get("x")) and _is_number(value.get("y")):
        point = dict(value)
        found.points.append(point)
        return point
    return value


def _bring_to_scale(found: _Found, sizes: Sequence[tuple[int, int]]) -> None:
    """Fractions and pixels to 0-1000."""
    every = [abs(number) for number in _numbers(found)]
    # A single small box tells nothing; the corners of a room cannot all lie within one thousandth of the picture.
    if len(every) >= 8 and max(every) <= _FRACTION_MOST:
        _multiply(found, 1000.0, 1000.0)
        found.note("places in the picture were given as fractions of it, and read so")
        return
    # Boxes may be inside out: that is told and mended where the picture's objects are read.
    right = [max(box["x_min"], box["x_max"]) for box in found.boxes]
    low = [max(box["y_min"], box["y_max"]) for box in found.boxes]
    outside = sum(x > _OUTSIDE or y > _OUTSIDE for x, y in zip(right, low, strict=True))
    # One box beyond the edge is a slip. Corners may lie outside of the picture, so they tell nothing.
    if outside < 2 or outside * 25 < len(found.boxes):
        return
    for width, height in sizes:
        if max(right) <= width * _BEYOND and max(low) <= height * _BEYOND:
            _multiply(found, 1000.0 / width, 1000.0 / height)
            found.note("places in the picture were given in its pixels, and read so")
            return


def _numbers(found: _Found) -> Iterator[float]:
    for box in found.boxes:
        yield from (box[name] for name in _BOX)
    for point in found.points:
        yield from (point["x"], point["y"])


def _multiply(found: _Found, by_x: float, by_y: float) -> None:
    for box in found.boxes:
        for name in _BOX:
            box[name] *= by_x if name.startswith("x") else by_y
    for point in found.points:
        point["x"] *= by_x
        point["y"] *= by_y


def _axes_are_mixed_up(things: Sequence[tuple[dict[str, Any], float, float]]) -> bool:
    """Whether the boxes go with the metres (x right, y up) only when their axes are exchanged."""
    if len(things) < _LEAST_THINGS:
        return False
    across = [(box["x_min"] + box["x_max"]) / 2 for box, _, _ in things]
    down = [(box["y_min"] + box["y_max"]) / 2 for box, _, _ in things]
    x, up = [x for _, x, _ in things], [-y for _, _, y in things]
    straight = (_alike(across, x) + _alike(down, up)) / 2
    exchanged = (_alike(down, x) + _alike(across, up)) / 2
    return exchanged > 0.85 and straight < 0.4


def _alike(one: Sequence[float], other: Sequence[float]) -> float:
    """Correlation, -1 to 1; 0 where one of them does not vary."""
    a, b = sum(one) / len(one), sum(other) / len(other)
    both = sum((u - a) * (v - b) for u, v in zip(one, other, strict=True))
    spread = math.sqrt(sum((u - a) ** 2 for u in one) * sum((v - b) ** 2 for v in other))
    return both / spread if spread > 1e-9 and math.isfinite(spread) else 0.0


def _is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e9
