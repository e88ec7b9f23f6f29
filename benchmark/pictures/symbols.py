# SPDX-License-Identifier: GPL-3.0-or-later
"""Symbols of furniture for plans: outlines in an object's own axes (metres, front towards -y), filling its size."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

Point = tuple[float, float]


@dataclass(frozen=True)
class Stroke:
    """A line through points; `filled` hides what is below."""

    points: list[Point]
    closed: bool = True
    filled: bool = True
    thin: bool = False


def _box(x0: float, y0: float, x1: float, y1: float, radius: float = 0.0, thin: bool = False) -> Stroke:
    """A rectangle with rounded corners."""
    radius = min(radius, (x1 - x0) / 2, (y1 - y0) / 2)
    if radius <= 0:
        return Stroke([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], thin=thin)
    points = []
    for k, (cx, cy) in enumerate(((x1, y1), (x0, y1), (x0, y0), (x1, y0))):
        mx, my = cx + (-radius if cx == x1 else radius), cy + (-radius if cy == y1 else radius)
        for i in range(7):
            t = math.pi / 2 * (k + i / 6)
            points.append((mx + radius * math.cos(t), my + radius * math.sin(t)))
    return Stroke(points, thin=thin)


def _round(radius: float, x: float = 0.0, y: float = 0.0, thin: bool = False, filled: bool = True) -> Stroke:
    turns = [2 * math.pi * i / 48 for i in range(48)]
    return Stroke([(x + radius * math.cos(t), y + radius * math.sin(t)) for t in turns], True, filled, thin)


def _line(*points: Point) -> Stroke:
    return Stroke(list(points), closed=False, filled=False, thin=True)


def sofa(w: float, d: float) -> list[Stroke]:
    """Arms, back and two or three seat cushions."""
    x, y, arm, back = w / 2, d / 2, 0.16, 0.2
    seats = 3 if w > 2 else 2
    step = (w - 2 * arm) / seats
    cushions = [
        _box(-x + arm + i * step, -y + 0.02, -x + arm + (i + 1) * step, y - back, 0.06, True) for i in range(seats)
    ]
    body = [_box(-x, -y, x, y, 0.08), _box(-x, y - back, x, y, 0.06, True)]
    return body + [_box(s, -y, s + arm, y - 0.05, 0.06, True) for s in (-x, x - arm)] + cushions


def armchair(w: float, d: float) -> list[Stroke]:
    """A tub: a round back that runs into the arms, and a seat."""
    x, y, arm = w / 2, d / 2, 0.15
    curve = [(x * math.cos(t), y - x + x * math.sin(t)) for t in [math.pi * i / 24 for i in range(25)]]
    inner = [((x - arm) * math.cos(t), y - x + (x - arm) * math.sin(t)) for t in [math.pi * i / 24 for i in range(25)]]
    return [
        Stroke([(x, -y), *curve, (-x, -y)]),
        Stroke([(x - arm, -y + 0.03), *inner, (-x + arm, -y + 0.03)], thin=True),
    ]


def chair(w: float, d: float) -> list[Stroke]:
    """A seat with a curved rail behind it."""
    x, y = w / 2, d / 2
    ends = [(-x + w * i / 10, y - 0.1 * (2 * i / 10 - 1) ** 2) for i in range(11)]
    rail = ends + [(px, py - 0.055) for px, py in reversed(ends)]
    return [_box(-x + 0.02, -y, x - 0.02, y - 0.07, 0.07), Stroke(rail)]


def stool(w: float, d: float) -> list[Stroke]:
    """A padded stool."""
    return [
        _box(-w / 2, -d / 2, w / 2, d / 2, 0.05),
        _box(-w / 2 + 0.04, -d / 2 + 0.04, w / 2 - 0.04, d / 2 - 0.04, 0.04, True),
    ]


def table(w: float, d: float) -> list[Stroke]:
    """A table top."""
    return [_box(-w / 2, -d / 2, w / 2, d / 2, 0.02)]


def round_table(w: float, d: float) -> list[Stroke]:
    """A round table top with its edge."""
    return [_round(w / 2), _round(w / 2 - 0.03, thin=True)]


def coffee_table(w: float, d: float) -> list[Stroke]:
    """A low table with a glass top."""
    x, y = w / 2, d / 2
    shine = [_line((-x * 0.5 + k, -y * 0.3), (-x * 0.2 + k, y * 0.4)) for k in (0.0, 0.12)]
    return [_box(-x, -y, x, y, 0.03), _box(-x + 0.05, -y + 0.05, x - 0.05, y - 0.05, 0.02, True), *shine]


def rug(w: float, d: float) -> list[Stroke]:
    """A border and fringes at both ends."""
    x, y = w / 2, d / 2
    fringe = [
        _line((s * (x - 0.07), -y + k * 0.05), (s * x, -y + k * 0.05)) for s in (-1, 1) for k in range(1, int(d / 0.05))
    ]
    whole = Stroke([(-x, -y), (x, -y), (x, y), (-x, y)], thin=True)
    inner = _box(-x + 0.07, -y, x - 0.07, y, thin=True)
    return [whole, *fringe, inner, _box(-x + 0.2, -y + 0.13, x - 0.2, y - 0.13, thin=True)]


def sideboard(w: float, d: float) -> list[Stroke]:
    """A low cupboard: doors are marked at its front."""
    x, y = w / 2, d / 2
    doors = max(2, round(w / 0.5))
    marks = [_line((-x + w * i / doors, -y), (-x + w * i / doors, -y + 0.1)) for i in range(1, doors)]
    return [_box(-x, -y, x, y), _line((-x, -y + 0.04), (x, -y + 0.04)), *marks]


def bookcase(w: float, d: float) -> list[Stroke]:
    """A tall open shelf: crossed, with the backs of its books along the front."""
    x, y = w / 2, d / 2
    return [_box(-x, -y, x, y), _line((-x, -y), (x, y)), _line((-x, y), (x, -y))]


def piano(w: float, d: float) -> list[Stroke]:
    """An upright piano with its keys at the front."""
    x, y, key = w / 2, d / 2, 0.16
    keys = [
        _line((-x + 0.08 + k * 0.06, -y), (-x + 0.08 + k * 0.06, -y + key)) for k in range(int((w - 0.16) / 0.06) + 1)
    ]
    return [_box(-x, -y, x, y), _line((-x, -y + key), (x, -y + key)), _line((-x, y - 0.1), (x, y - 0.1)), *keys]


def television(w: float, d: float) -> list[Stroke]:
    """A flat screen on a foot."""
    x, y = w / 2, d / 2
    return [_box(-x * 0.3, -y, x * 0.3, y, 0.02, True), _box(-x, -y * 0.3, x, y * 0.3, 0.01)]


def plant(w: float, d: float) -> list[Stroke]:
    """Leaves round a stem."""
    leaves = []
    for k in range(9):
        t = 2 * math.pi * k / 9
        cos, sin = math.cos(t), math.sin(t)
        outline = [
            (0.06, 0.0),
            (w * 0.25, w * 0.11),
            (w * 0.42, w * 0.07),
            (w / 2, 0.0),
            (w * 0.4, -w * 0.08),
            (w * 0.2, -w * 0.09),
        ]
        leaves.append(Stroke([(px * cos - py * sin, px * sin + py * cos) for px, py in outline], thin=True))
    return [*leaves, _round(w * 0.08, thin=True)]


def lamp(w: float, d: float) -> list[Stroke]:
    """A round shade with a cross."""
    r = w / 2
    return [_round(r), _line((-r, 0), (r, 0)), _line((0, -r), (0, r)), _round(r * 0.35, thin=True)]


def vase(w: float, d: float) -> list[Stroke]:
    """Rings."""
    return [_round(w / 2, thin=True), _round(w * 0.3, thin=True)]


def cushion(w: float, d: float) -> list[Stroke]:
    """A cushion with hollow sides."""
    x, y, n = w / 2, d / 2, 8
    sides = []
    for (ax, ay), (bx, by) in (((-x, -y), (x, -y)), ((x, -y), (x, y)), ((x, y), (-x, y)), ((-x, y), (-x, -y))):
        for i in range(n):
            t = i / n
            dent = 0.10 * math.sin(math.pi * t)
            px, py = ax + (bx - ax) * t, ay + (by - ay) * t
            sides.append((px * (1 - dent), py * (1 - dent)))
    return [Stroke(sides, thin=True)]


def laptop(w: float, d: float) -> list[Stroke]:
    """Keyboard and screen."""
    return [_box(-w / 2, -d / 2, w / 2, d / 2, 0.01, True), _line((-w / 2, d * 0.3), (w / 2, d * 0.3))]


def books(w: float, d: float) -> list[Stroke]:
    """A pile of books."""
    return [_box(-w / 2, -d / 2, w / 2, d / 2, thin=True), _line((-w * 0.4, -d / 2), (-w * 0.4, d / 2))]


SYMBOLS: dict[str, Callable[[float, float], list[Stroke]]] = {
    f.__name__: f
    for f in (
        sofa, armchair, chair, stool, table, round_table, coffee_table, rug, sideboard, bookcase, piano, television,
        plant, lamp, vase, cushion, laptop, books,
    )
}  # fmt: skip
"""By the name that a plan's items have as their piece."""
