# SPDX-License-Identifier: GPL-3.0-or-later
"""Cloth: covers that hang over a box, curtains in pleats. Closed sheets, UVs in metres on the flat cloth."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from .arguments import by_kind
from .budget import spend_vertices
from .checks import choice, fail, is_number, number, point, positive, sizes, whole
from .numbers import rand
from .rings import placed
from .ripples import normals_of, ripples, seed_of, thick_sheet
from .shape import Floats, Shape
from .soft import welded
from .solids import ORIGIN, torus
from .weaving import tasselled

CELL = 0.035


def hang_of(hang: Any) -> tuple[float, ...]:
    """How far a cloth hangs down on the left (-x), right, front (-y) and back, metres."""
    if is_number(hang):
        hang = (hang, hang, hang, hang)
    if not isinstance(hang, (tuple, list)) or len(hang) != 4:
        raise fail("drape", "hang must be a number or four: left, right, front, back")
    return tuple(number("drape", "each hang", h, 0.0, 20.0) for h in hang)


@by_kind
def drape(
    size: Any, hang: Any = 0.3, thickness: Any = 0.02, folds: Any = 0.5, puff: Any = 0.3, radius: Any = 0.02,
    floor: Any = None, fringe: Any = 0.0, quilt: Any = 0.0, at: Any = ORIGIN, seed: Any = 0,
) -> Shape:  # fmt: skip
    """A duvet, throw or tablecloth over a box; size (width, depth) and at are those of its top.

    Args:
        hang: how far its hem is below at: a number or (left, right, front, back); what hangs stands off up to 0.1.
            folds, puff: waves of what hangs, billows on top, 0 to 1. floor: height where it comes to lie. fringe: length,
            at front and back. quilt: size of stitched squares.
    """  # fmt: skip
    w, d = (positive("drape", "each size", side) for side in point("drape", "size", size, 2))
    thick = number("drape", "thickness", thickness, 0.001, 0.3)
    bend = min(positive("drape", "radius", radius), 0.3 * min(w, d)) + thick
    left, right, front, back = (reaching(down, bend, thick) for down in hang_of(hang))
    wave, billow = number("drape", "folds", folds, 0.0, 1.0), number("drape", "puff", puff, 0.0, 1.0)
    square = number("drape", "quilt", quilt, 0.0, 5.0)
    s, t = np.meshgrid(spaced(-w / 2 - left, w / 2 + right, thick), spaced(-d / 2 - front, d / 2 + back, thick))
    spend_vertices(2 * s.size)
    points = hung(s, t, (w, d), (left, right, front, back), bend, thick, wave, seed_of(seed))
    points[:, :, 2] += thick + billow_of(s, t, (w, d), billow, seed_of(seed))
    if square:
        stitched = np.abs(np.sin(math.pi * s / square) * np.sin(math.pi * t / square)) ** 0.5
        points += normals_of(points) * (min(0.035, 0.1 * square) * (0.4 + 0.6 * billow) * stitched)[:, :, None]
    if floor is not None:
        points = laid(points, number("drape", "floor", floor) - point("drape", "at", at)[2] + thick)
    cloth = np.stack([s, t], axis=2)
    vertices, faces, uvs = thick_sheet(points, thick * hem_of(s, t, thick), cloth)
    made = replace(placed("drape", vertices, faces, at, smooth=True, crease=75.0), uvs=uvs)
    length = number("drape", "fringe", fringe, 0.0, 0.5)
    return made if not length else fringed(made, points, length, at, seed_of(seed))


def reaching(down: float, bend: float, thick: float) -> float:
    """The length of cloth beyond an edge whose hem is `down` metres below what it lies on: it goes round a bend first."""
    drop = down + 0.8 * thick * min(1.0, down / bend)  # its upper side begins a thickness higher, its hem is thin
    if drop < bend:
        return bend * math.acos(1 - drop / bend)
    return bend * math.pi / 2 + drop - bend


def hem_of(s: Floats, t: Floats, thick: float) -> Floats:
    """How much of its thickness the cloth has, (rows, columns, 1): it is sewn together at its hem."""
    inside = np.minimum.reduce([s - s.min(), s.max() - s, t - t.min(), t.max() - t])
    return np.asarray(np.sqrt(np.clip(inside / (1.5 * thick), 0, 1)) * 0.8 + 0.2)[:, :, None]


def spaced(low: float, high: float, thick: float) -> Floats:
    """Places along a cloth, close enough for folds, with one more next to each hem."""
    even = np.linspace(low, high, int(min(110, max(4, math.ceil((high - low) / CELL)))) + 1)
    near = min(0.5 * thick, 0.4 * (even[1] - even[0]))
    return np.concatenate([even[:1], [low + near], even[1:-1], [high - near], even[-1:]])


def hung(
    s: Floats, t: Floats, size: tuple[float, float], hang: tuple[float, ...], bend: float, thick: float, wave: float,
    seed: Any,
) -> Floats:  # fmt: skip
    """Where each point of the flat cloth comes to be: on the top, round the edge, or hanging with folds.

    At a corner the hem stays level: the cloth runs round it in folds instead of hanging down in a point.
    """
    x, y = np.clip(s, -size[0] / 2, size[0] / 2), np.clip(t, -size[1] / 2, size[1] / 2)
    dx, dy = s - x, t - y
    across = np.where(dx < 0, max(hang[0], 1e-9), max(hang[1], 1e-9))
    deep = np.where(dy < 0, max(hang[2], 1e-9), max(hang[3], 1e-9))
    a, b = np.abs(dx) / across, np.abs(dy) / deep
    heading = np.arctan2(b, a + 1e-12)
    over = np.maximum(a, b) * (across * np.cos(heading) ** 2 + deep * np.sin(heading) ** 2)
    nx, ny = np.sign(dx) * np.cos(heading), np.sign(dy) * np.sin(heading)
    over = np.where((dx == 0) & (dy == 0), 0.0, over)
    quarter = bend * math.pi / 2
    angle = np.minimum(over, quarter) / bend
    out, down = bend * np.sin(angle), bend * (1 - np.cos(angle)) + np.maximum(over - quarter, 0)
    rest = np.clip((down - bend) / 0.15, 0, 1)
    out = out - 0.8 * (bend - thick) * rest * rest * (3 - 2 * rest)  # it falls back against the side
    slack = np.clip((over - 0.6 * quarter) / 0.35, 0, 1)
    corner = (a > 0) & (b > 0)
    along = x + y + np.where(corner, 0.30, 0.22) * np.sign(dx + 1e-12) * np.arctan2(ny, np.abs(nx) + 1e-9)
    pitch = rand((seed, "pitch"), 0.15, 0.21)
    drift = 0.35 * ripples((seed, "drift"), along, down, 0.5)
    fold = 0.5 + 0.5 * np.sin(math.tau * along / pitch + 2.2 * drift)
    loose = np.where(corner, np.sin(2 * heading), 0.0) * np.clip(over / 0.25, 0, 1)
    calm = 1 - 0.75 * loose
    out = out + wave * slack * calm * (0.045 * fold + 0.012 * (1 + ripples((seed, "hang"), along, down, 0.3)))
    out = out + 0.3 * loose * np.maximum(over - 0.5 * quarter, 0)  # the spare cloth of a corner stands off in one fold
    return np.stack([x + nx * out, y + ny * out, -down], axis=2)


def billow_of(s: Floats, t: Floats, size: tuple[float, float], puff: float, seed: Any) -> Floats:
    """How much higher the cloth lies on the top: stuffing and soft wrinkles."""
    inside = np.clip(1 - np.abs(s / (size[0] / 2)) ** 6, 0, 1) * np.clip(1 - np.abs(t / (size[1] / 2)) ** 6, 0, 1)
    heave = 0.5 + 0.5 * ripples((seed, "heave"), s, t, 0.45)
    wrinkle = np.abs(ripples((seed, "wrinkle"), s + 0.4 * t, t, 0.2)) - 0.5
    return np.asarray(inside * puff * (0.035 * heave + 0.014 * wrinkle + 0.012))


def laid(points: Floats, level: float) -> Floats:
    """What would hang below the level lies on it, farther out."""
    result = points.copy()
    below = np.maximum(level - result[:, :, 2], 0)
    centre = result.reshape(-1, 3).mean(axis=0)
    away = result[:, :, :2] - centre[:2]
    away /= np.maximum(np.linalg.norm(away, axis=2, keepdims=True), 1e-9)
    result[:, :, :2] += away * below[:, :, None]
    result[:, :, 2] = np.maximum(result[:, :, 2], level)
    return result


def fringed(made: Shape, points: Floats, length: float, at: Any, seed: Any) -> Shape:
    """The cloth with tassels along its front and back rims."""
    offset = np.array(point("drape", "at", at))
    roots, sides, falls = [], [], []
    for row, inner in ((points[0], points[2]), (points[-1], points[-3])):
        spans = np.linalg.norm(np.diff(row, axis=0), axis=1)
        reach = np.concatenate([[0.0], np.cumsum(spans)])
        places = np.linspace(0.004, float(reach[-1]) - 0.004, max(2, min(260, round(float(reach[-1]) / 0.016))))
        root, behind = (
            np.stack([np.interp(places, reach, line[:, i]) for i in range(3)], axis=1) for line in (row, inner)
        )
        fall = root - behind
        fall /= np.maximum(np.linalg.norm(fall, axis=1, keepdims=True), 1e-9)
        side = np.gradient(root, axis=0)
        roots.append(root - 0.004 * fall)
        sides.append(side / np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-9))
        falls.append(fall)
    return tasselled(made, np.concatenate(roots) + offset, np.concatenate(sides), np.concatenate(falls), length, seed)


@by_kind
def curtain(
    size: Any, pleats: Any = 0, gather: Any = 0.0, thickness: Any = 0.004, heading: Any = "wave", at: Any = ORIGIN,
    seed: Any = 0,
) -> Shape:  # fmt: skip
    """In pleats, 0 for one every 12 cm.

    Args:
        gather: drawn together by a tie half-way down, 0 to 0.8. heading: "wave", "pinch" or "rings".
    """  # fmt: skip
    w, d, h = sizes("curtain", "size", size)
    count = whole("curtain", "pleats", pleats, 0, 200) or max(2, round(w / 0.12))
    tie = number("curtain", "gather", gather, 0.0, 0.8)
    top = choice("curtain", "heading", heading, ("wave", "pinch", "rings"))
    thick = min(number("curtain", "thickness", thickness, 0.001, 0.1), d / 3)
    ring = min(0.022, 0.45 * d, 0.1 * h) if top == "rings" else 0.0
    tall = h - 1.4 * ring
    points, u, v = pleated(count, tie, top, seed_of(seed))
    points = points * np.array((w, (d - thick) / 2, tall))
    low, high = points.reshape(-1, 3).min(axis=0), points.reshape(-1, 3).max(axis=0)
    points = (points - (low + high) / 2) / (high - low) * np.array((w, d - thick, tall))
    points[:, :, 1] += thick / 2 * np.sign(normal_turn())
    points[:, :, 2] -= 0.7 * ring
    cloth = np.stack([u * w * 1.8, v * h], axis=2)
    vertices, faces, uvs = thick_sheet(points, thick, cloth)
    made = replace(placed("curtain", vertices, faces, at, smooth=True, crease=75.0), uvs=uvs)
    if not ring:
        return made
    x, y, z = point("curtain", "at", at)
    columns = [round((i + 0.5) * (len(points[0]) - 1) / count) for i in range(count)]
    hoops = [
        torus(
            ring,
            0.16 * ring,
            segments=14,
            rings=6,
            axis="x",
            at=(x + float(points[-1, k, 0]), y, z + h / 2 - 1.16 * ring),
        )
        for k in columns
    ]
    return welded([made, *hoops])


def pleated(count: int, tie: float, top: str, mark: str) -> tuple[Floats, Floats, Floats]:
    """The points of a curtain of width 1, depth about 2 and height 1, and their u and v, (rows, columns)."""
    columns, rows = min(400, 10 * count) + 1, 19 if tie else 11
    spend_vertices(2 * columns * rows)
    u, v = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows) ** 0.9)
    loose = (1 - v) ** 0.7  # pinched at the top, free below
    phase = u + 0.012 * loose * ripples((mark, "phase"), 3.0 * u, 0.3 * v, 0.5)
    turn = math.tau * count * phase
    deep = 0.72 + 0.28 * loose * (1 + 0.5 * ripples((mark, "depth"), 2.0 * u, v, 0.4))
    y = (np.sin(turn) + 0.25 * np.sin(2 * turn + 0.7)) * deep
    x = u - 0.5 + 0.16 / count * np.sin(2 * turn) * deep
    if top == "pinch":
        sewn = np.clip((v - 0.86) / 0.06, 0, 1)
        y = y * (1 - sewn) + sewn * (0.75 * np.maximum(np.cos(turn), 0) ** 6 - 0.2)
    if tie:
        narrow = 1 - tie * np.exp(-(((v - 0.42) / 0.2) ** 2))
        x, y = (x + 0.5) * narrow - 0.5, y * np.sqrt(narrow)
    return np.stack([x, y, v - 0.5], axis=2), u, v


def normal_turn() -> float:
    """A sheet whose columns run along x and whose rows run up has its upper side towards -y."""
    return -1.0
