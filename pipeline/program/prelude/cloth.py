# SPDX-License-Identifier: GPL-3.0-or-later
"""Cloth: covers that hang over a box, curtains in pleats, rugs. Closed sheets, UVs in metres on the flat cloth."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from .budget import spend_vertices
from .checks import choice, fail, is_number, number, point, positive, sizes, whole
from .numbers import rand
from .rings import placed
from .ripples import ripples, seed_of, thick_sheet
from .shape import Floats, Shape
from .solids import ORIGIN, rounded_box

CELL = 0.035


def hang_of(hang: Any) -> tuple[float, ...]:
    """How far a cloth hangs down on the left (-x), right, front (-y) and back, metres."""
    if is_number(hang):
        hang = (hang, hang, hang, hang)
    if not isinstance(hang, (tuple, list)) or len(hang) != 4:
        raise fail("drape", "hang must be a number or four: left, right, front, back")
    return tuple(number("drape", "each hang", h, 0.0, 20.0) for h in hang)


def drape(
    size: Any, hang: Any = 0.3, thickness: Any = 0.02, folds: Any = 0.5, puff: Any = 0.3, radius: Any = 0.02,
    floor: Any = None, fringe: Any = 0.0, at: Any = ORIGIN, seed: Any = 0,
) -> Shape:  # fmt: skip
    """A duvet, throw or tablecloth over a box. `at` is the centre of the box's top, `size` (width, depth) of that top.

    Args:
        hang: how far it hangs down: one number, or (left, right, front, back); 0 ends at the edge.
        folds: how much the hanging part waves, 0 to 1. puff: how much the upper side billows, 0 flat to 1 down-filled.
        radius: of the bend at the edge. floor: height at which it comes to lie, or None. fringe: length at front and back.
    """  # fmt: skip
    w, d = (positive("drape", "each size", side) for side in point("drape", "size", size, 2))
    left, right, front, back = hang_of(hang)
    thick = number("drape", "thickness", thickness, 0.001, 0.3)
    bend = min(positive("drape", "radius", radius), 0.3 * min(w, d)) + thick
    wave, billow = number("drape", "folds", folds, 0.0, 1.0), number("drape", "puff", puff, 0.0, 1.0)
    s, t = np.meshgrid(spaced(-w / 2 - left, w / 2 + right), spaced(-d / 2 - front, d / 2 + back))
    spend_vertices(2 * s.size)
    points = hung(s, t, (w, d), bend, thick, wave, seed_of(seed))
    points[:, :, 2] += thick + billow_of(s, t, (w, d), billow, seed_of(seed))
    if floor is not None:
        points = laid(points, number("drape", "floor", floor) - point("drape", "at", at)[2] + thick)
    cloth = np.stack([s, t], axis=2)
    vertices, faces, uvs = thick_sheet(points, thick, cloth)
    made = replace(placed("drape", vertices, faces, at, smooth=True), uvs=uvs)
    length = number("drape", "fringe", fringe, 0.0, 0.5)
    return made if not length else fringed(made, points, length, at, seed_of(seed))


def spaced(low: float, high: float) -> Floats:
    """Places along a cloth, close enough for folds."""
    return np.linspace(low, high, int(min(140, max(4, math.ceil((high - low) / CELL)))) + 1)


def hung(s: Floats, t: Floats, size: tuple[float, float], bend: float, thick: float, wave: float, seed: Any) -> Floats:
    """Where each point of the flat cloth comes to be: on the top, round the edge, or hanging with folds."""
    x, y = np.clip(s, -size[0] / 2, size[0] / 2), np.clip(t, -size[1] / 2, size[1] / 2)
    dx, dy = s - x, t - y
    over = np.hypot(dx, dy)
    nx, ny = dx / np.maximum(over, 1e-9), dy / np.maximum(over, 1e-9)
    quarter = bend * math.pi / 2
    angle = np.minimum(over, quarter) / bend
    out, down = bend * np.sin(angle), bend * (1 - np.cos(angle)) + np.maximum(over - quarter, 0)
    rest = np.clip((down - bend) / 0.15, 0, 1)
    out = out - 0.8 * (bend - thick) * rest * rest * (3 - 2 * rest)  # it falls back against the side
    slack = np.clip((over - 0.6 * quarter) / 0.35, 0, 1)
    along = x + y + 0.22 * np.arctan2(dy, np.abs(dx) + 1e-9) * np.sign(dx + 1e-12)
    pitch = rand((seed, "pitch"), 0.15, 0.21)
    drift = 0.35 * ripples((seed, "drift"), along, down, 0.5)
    fold = 0.5 + 0.5 * np.sin(math.tau * along / pitch + 2.2 * drift)
    out = out + wave * slack * (0.045 * fold + 0.012 * (1 + ripples((seed, "hang"), along, down, 0.3)))
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
    vertices, faces = [made.vertices], list(made.faces)
    start = made.vertex_count
    for row, inner in ((points[0], points[1]), (points[-1], points[-2])):
        for i in range(len(row) - 1):
            for k in range(2):
                root = row[i] + (row[i + 1] - row[i]) * (0.25 + 0.5 * k) + offset
                side = (row[i + 1] - row[i]) * 0.13
                fall = row[i] - inner[i]
                fall = fall / max(float(np.linalg.norm(fall)), 1e-9) * length * rand((seed, "tassel", i, k), 0.8, 1.1)
                turned = np.cross(side, fall)
                turned *= 0.5 * float(np.linalg.norm(side)) / max(float(np.linalg.norm(turned)), 1e-9)
                vertices.append(np.array([root - side, root + side, root + turned, root + fall]))
                faces += [
                    (start, start + 1, start + 3),
                    (start + 1, start + 2, start + 3),
                    (start + 2, start, start + 3),
                ]
                faces.append((start + 2, start + 1, start))
                start += 4
    spend_vertices(start - made.vertex_count)
    added = sum(len(face) for face in faces) - (0 if made.uvs is None else len(made.uvs))
    uvs = None if made.uvs is None else np.concatenate([made.uvs, np.zeros((added, 2))])
    return replace(made, vertices=np.concatenate(vertices), faces=tuple(faces), uvs=uvs)


def curtain(
    size: Any, pleats: Any = 0, gather: Any = 0.0, thickness: Any = 0.004, at: Any = ORIGIN, seed: Any = 0
) -> Shape:
    """A curtain panel that hangs in pleats and fills `size` (width, depth, height); `at` is its centre.

    Args:
        pleats: how many, 0 for one every 12 cm. gather: how far it is drawn together by a tie half-way down, 0 to 0.8.
    """
    w, d, h = sizes("curtain", "size", size)
    count = whole("curtain", "pleats", pleats, 0, 200) or max(2, round(w / 0.12))
    tie = number("curtain", "gather", gather, 0.0, 0.8)
    thick = min(number("curtain", "thickness", thickness, 0.001, 0.1), d / 3)
    columns, rows = min(400, 10 * count) + 1, 25
    spend_vertices(2 * columns * rows)
    u, v = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    mark = seed_of(seed)
    loose = (1 - v) ** 0.7  # pinched at the top, free below
    phase = u + 0.012 * loose * ripples((mark, "phase"), 3.0 * u, 0.3 * v, 0.5)
    turn = math.tau * count * phase
    deep = 0.72 + 0.28 * loose * (1 + 0.5 * ripples((mark, "depth"), 2.0 * u, v, 0.4))
    y = (np.sin(turn) + 0.25 * np.sin(2 * turn + 0.7)) * deep
    x = u - 0.5 + 0.16 / count * np.sin(2 * turn) * deep
    if tie:
        narrow = 1 - tie * np.exp(-(((v - 0.42) / 0.2) ** 2))
        x, y = (x + 0.5) * narrow - 0.5, y * np.sqrt(narrow)
    points = np.stack([x * w, y * (d - thick) / 2, (v - 0.5) * h], axis=2)
    low, high = points.reshape(-1, 3).min(axis=0), points.reshape(-1, 3).max(axis=0)
    points = (points - (low + high) / 2) / (high - low) * np.array((w, d - thick, h))
    points[:, :, 1] += thick / 2 * np.sign(normal_turn())
    cloth = np.stack([u * w * 1.8, v * h], axis=2)
    vertices, faces, uvs = thick_sheet(points, thick, cloth)
    return replace(placed("curtain", vertices, faces, at, smooth=True), uvs=uvs)


def normal_turn() -> float:
    """A sheet whose columns run along x and whose rows run up has its upper side towards -y."""
    return -1.0


def rug(size: Any, shape: Any = "box", fringe: Any = 0.0, at: Any = ORIGIN, seed: Any = 0) -> Shape:
    """A rug of `size` (width, depth, thickness), its underside at z = 0 of `at`; `shape` is "box", "round" or "hide".

    Args:
        fringe: length of the tassels at front and back, inside the size.
    """
    w, d, h = sizes("rug", "size", size)
    form = choice("rug", "shape", shape, ("box", "round", "hide"))
    length = min(number("rug", "fringe", fringe, 0.0, 0.5), 0.2 * d) if form == "box" else 0.0
    if form == "box":
        pile = rounded_box((w, d - 2 * length, h), min(h * 0.45, 0.02), (0, 0, h / 2), segments=2)
        return placed_again(tasselled(pile, w, d / 2 - length, length, h, seed_of(seed)), at)
    count = 96
    angles = np.linspace(0, math.tau, count, endpoint=False)
    reach = np.ones(count)
    if form == "hide":
        mark = seed_of(seed)
        reach = 0.78 + 0.16 * np.cos(4 * angles + 0.4) + 0.05 * ripples(mark, np.cos(angles), np.sin(angles), 0.5)
    edge = min(h, 0.01)
    rings = [(1.0, 0.0), (1.0, h - edge / 2), (1.0 - edge / min(w, d), h), (0.5, h)]
    outline = np.stack([np.cos(angles) * reach, np.sin(angles) * reach], axis=1)
    outline *= np.array((w, d)) / (outline.max(axis=0) - outline.min(axis=0))
    outline -= (outline.max(axis=0) + outline.min(axis=0)) / 2
    spend_vertices(count * len(rings) + 1)
    vertices = np.concatenate(
        [np.column_stack([outline * k, np.full(count, z)]) for k, z in rings] + [np.array([[0.0, 0.0, h]])]
    )
    faces = [tuple(range(count - 1, -1, -1))]
    for ring in range(len(rings) - 1):
        a = ring * count
        faces += [(a + i, a + (i + 1) % count, a + count + (i + 1) % count, a + count + i) for i in range(count)]
    last = (len(rings) - 1) * count
    faces += [(last + i, last + (i + 1) % count, last + count) for i in range(count)]
    return placed("rug", vertices, faces, at, smooth=False)


def tasselled(pile: Shape, width: float, edge: float, length: float, height: float, seed: Any) -> Shape:
    """The rug with tassels on its front and back edges."""
    if not length:
        return pile
    vertices, faces = [pile.vertices], list(pile.faces)
    start = pile.vertex_count
    count = min(400, max(2, round(width / 0.02)))
    spend_vertices(10 * count)
    for side in (-1, 1):
        for i in range(count):
            x = -width / 2 + width * (i + 0.5) / count
            tip = x + rand((seed, side, i), -0.006, 0.006)
            half, z = 0.3 * width / count, 0.5 * height
            near, far = side * (edge - 0.004), side * (edge + length)
            low = [(x - half, near, 0.1 * height), (x + half, near, 0.1 * height), (x, near, z)]
            vertices.append(np.array([*low, (tip + half, far, 0.001), (tip - half, far, 0.001)]))
            a = start
            ring = [
                (a, a + 1, a + 3, a + 4),
                (a + 2, a + 4, a + 3),
                (a + 1, a + 2, a + 3),
                (a + 2, a, a + 4),
                (a, a + 2, a + 1),
            ]
            faces += ring if side > 0 else [face[::-1] for face in ring]
            start += 5
    return replace(pile, vertices=np.concatenate(vertices), faces=tuple(faces), smooth=False)


def placed_again(shape: Shape, at: Any) -> Shape:
    """The shape moved by `at`."""
    return replace(shape, vertices=shape.vertices + np.array(point("rug", "at", at)))
