# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an object's shapes are what its proxy asks for: pure measurements, each with a sentence for who wrote them.

Everything is in the proxy's local frame: origin at the centre of its base, X its width, -Y its front, Z up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..program.prelude.palette import ROLE_COLOURS, split_role
from ..program.prelude.shape import Shape

Floats = NDArray[np.float64]
TOLERANCE = 0.02
"""Of the proxy's size: how far an object may stick out of it, or stay away from its faces."""
TOUCH = 0.006
"""Metres between two parts that still touch."""
BLOCK = 0.15
"""Metres up to which a thing may be a plain box: toy blocks, dice, soap."""
MOST_VERTICES = 40_000
_SIDES = (("left", "right"), ("front", "back"), ("bottom", "top"))
_ROLES = frozenset({*ROLE_COLOURS, "", "front"})
_FEW = 400


@dataclass(frozen=True)
class Checked:
    """What was measured on an object.

    Attributes:
        findings: sentences on what is wrong, worst first. penalty: 0 for a sound object, about 1 for a useless one.
    """

    findings: tuple[str, ...] = ()
    penalty: float = 0.0


@dataclass
class _Sheet:
    findings: list[tuple[float, str]] = field(default_factory=list)

    def note(self, penalty: float, sentence: str) -> None:
        self.findings.append((penalty, sentence))


def check(shapes: Sequence[Shape], size: Sequence[float], placement: str = "floor") -> Checked:
    """Measure an object's shapes against its proxy.

    Args:
        size: width, depth and height of the proxy. placement: "floor", "surface", "wall" or "ceiling".
    """
    solid = [shape for shape in shapes if len(shape.vertices)]
    if not solid:
        return Checked(("There are no shapes.",), 1.0)
    sheet = _Sheet()
    _check_box(sheet, solid, size)
    _check_parts(sheet, solid)
    _check_held(sheet, solid, size, placement)
    if placement in ("floor", "surface"):
        _check_standing(sheet, solid)
    count = sum(shape.vertex_count for shape in solid)
    if count > MOST_VERTICES:
        sheet.note(0.3, f"It has {count:,} vertices; {MOST_VERTICES:,} are the most. Use fewer segments and copies.")
    if len(solid) == 1 and len(solid[0].faces) <= 6 and max(size) > BLOCK:
        sheet.note(0.5, "It is one plain box. Model its parts.")
    found = sorted(sheet.findings, key=lambda item: -item[0])
    return Checked(tuple(sentence for _, sentence in found), min(1.5, sum(p for p, _ in found)))


def extent(shapes: Sequence[Shape]) -> tuple[Floats, Floats]:
    """The lowest and the highest corner of the box round all shapes."""
    points = np.concatenate([shape.vertices for shape in shapes])
    return points.min(axis=0), points.max(axis=0)


def _check_box(sheet: _Sheet, shapes: Sequence[Shape], size: Sequence[float]) -> None:
    """It lies inside its proxy, and reaches the proxy's faces."""
    low, high = extent(shapes)
    wanted_low = np.array((-size[0] / 2, -size[1] / 2, 0.0))
    wanted_high = np.array((size[0] / 2, size[1] / 2, size[2]))
    for axis, names in enumerate(_SIDES):
        slack = max(TOLERANCE * size[axis], 0.002)
        for name, beyond in zip(names, (wanted_low[axis] - low[axis], high[axis] - wanted_high[axis]), strict=True):
            share = abs(float(beyond)) / size[axis]
            if beyond > slack:
                sheet.note(min(0.5, 0.1 + share), f"It sticks out of its box at the {name} by {beyond * 100:.1f} cm.")
            elif beyond < -slack:
                sheet.note(min(0.4, 0.05 + share), f"It ends {-beyond * 100:.1f} cm before its box's {name}.")


def _check_parts(sheet: _Sheet, shapes: Sequence[Shape]) -> None:
    """Parts have names and known materials."""
    unnamed = sum(not shape.part for shape in shapes)
    if unnamed:
        sheet.note(0.05, f"{unnamed} of {len(shapes)} shapes have no part name; use part(name, shapes, material=...).")
    unknown = sorted({role for shape in shapes if (role := split_role(shape.material)[0]) not in _ROLES})
    if unknown:
        sheet.note(0.1, f"These are no materials: {', '.join(unknown)[:120]}. Known ones: {', '.join(ROLE_COLOURS)}.")
    if all(not shape.material for shape in shapes):
        sheet.note(0.1, "No part has a material.")


def _check_held(sheet: _Sheet, shapes: Sequence[Shape], size: Sequence[float], placement: str) -> None:
    """Every part touches the ground (or the wall, or the ceiling), or something that does."""
    low, high = extent(shapes)
    boxes = [(s.vertices.min(axis=0), s.vertices.max(axis=0)) for s in shapes]
    slack = max(TOUCH, 0.01 * max(size))
    held = [_is_held(a, b, low, high, slack, placement) for a, b in boxes]
    if not any(held):
        held[int(np.argmin([a[2] for a, _ in boxes]))] = True
    waiting = [i for i, is_held in enumerate(held) if is_held]
    while waiting:
        i = waiting.pop()
        for j in range(len(shapes)):
            if (
                not held[j]
                and _boxes_meet(boxes[i], boxes[j])
                and _meet(shapes[i].vertices, shapes[j].vertices, boxes[j])
            ):
                held[j] = True
                waiting.append(j)
    loose = list(dict.fromkeys(shapes[i].part or "a part" for i, is_held in enumerate(held) if not is_held))
    if loose:
        share = sum(not h for h in held) / len(held)
        sheet.note(0.15 + 0.3 * share, f"These touch nothing and float: {', '.join(loose)[:120]}.")


def _is_held(a: Floats, b: Floats, low: Floats, high: Floats, slack: float, placement: str) -> bool:
    if placement == "wall":
        return bool(high[1] - b[1] < slack or a[2] - low[2] < slack and low[2] < slack)
    if placement == "ceiling":
        return bool(high[2] - b[2] < slack)
    return bool(a[2] - low[2] < slack)


def _boxes_meet(a: tuple[Floats, Floats], b: tuple[Floats, Floats]) -> bool:
    return bool((a[0] <= b[1] + TOUCH).all() and (b[0] <= a[1] + TOUCH).all())


def _meet(a: Floats, b: Floats, box: tuple[Floats, Floats]) -> bool:
    """Whether two parts whose boxes meet touch: a vertex of one is inside the other's box, or near one of its vertices."""
    inside = ((a >= box[0] - TOUCH) & (a <= box[1] + TOUCH)).all(axis=1)
    if inside.any():
        return True
    low, high = a.min(axis=0) - TOUCH, a.max(axis=0) + TOUCH
    if ((b >= low) & (b <= high)).all(axis=1).any():
        return True
    # Two beams that cross have no vertices in each other: their boxes overlap, and that counts.
    overlap = np.minimum(a.max(axis=0), box[1]) - np.maximum(a.min(axis=0), box[0])
    return bool((overlap > 0.001).all())


def _check_standing(sheet: _Sheet, shapes: Sequence[Shape]) -> None:
    """What stands does not fall over: its middle is above what it stands on."""
    points = np.concatenate([shape.vertices for shape in shapes])
    low, high = points.min(axis=0), points.max(axis=0)
    foot = points[points[:, 2] < low[2] + max(0.01, 0.01 * (high[2] - low[2]))]
    middle = (low + high)[:2] / 2
    reach = 0.1 * (high - low)[:2]
    if ((middle < foot[:, :2].min(axis=0) - reach) | (middle > foot[:, :2].max(axis=0) + reach)).any():
        sheet.note(0.2, "It would fall over: what touches the ground is all at one side.")
