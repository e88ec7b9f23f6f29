# SPDX-License-Identifier: GPL-3.0-or-later
"""Sorts the picture's areas into floor, wall faces and foreground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .boxes import convex_hull, oriented_box, outline_points, polygon_area
from .grid import Bools, Floats, Ints, components, filled, opened, polygon_mask, union
from .outline import Polygon, inset
from .segment import area_means, merge_areas


@dataclass(frozen=True)
class Sorted:
    """What each pixel of the working picture belongs to.

    Attributes:
        labels: areas of even colour, 0..k-1.
        floor: pixels of bare floor; foreground: pixels that neither floor nor wall explains.
        floor_colour: mean Lab colour of the bare floor.
        contrast: pairs of touching areas (a, b) with border length and colour step across the border.
    """

    labels: Ints
    floor: Bools
    foreground: Bools
    floor_colour: Floats


def border_contrast(labels: Ints, lab: Floats) -> tuple[Ints, Ints, Ints, Floats]:
    """Touching areas a < b, length of their border, and the mean colour step across it, two pixels to each side."""
    firsts, seconds, steps = [], [], []
    for axis in (0, 1):
        grid = labels if axis else labels.T
        values = lab if axis else lab.transpose(1, 0, 2)
        padded = np.pad(values, ((0, 0), (2, 2), (0, 0)), mode="edge")
        left, right = grid[:, :-1], grid[:, 1:]
        apart = left != right
        before, after = padded[:, 1:-4], padded[:, 4:-1]  # one pixel back and one on from the pair
        step = np.linalg.norm(after - before, axis=2)
        firsts.append(left[apart])
        seconds.append(right[apart])
        steps.append(step[apart])
    a, b = np.concatenate(firsts), np.concatenate(seconds)
    count = int(labels.max()) + 1
    keys, inverse = np.unique(np.minimum(a, b) * count + np.maximum(a, b), return_inverse=True)
    inverse = inverse.reshape(-1)
    length = np.bincount(inverse)
    step = np.bincount(inverse, np.concatenate(steps)) / np.maximum(length, 1)
    return keys // count, keys % count, length.astype(np.int64), step.astype(np.float32)


def _bands(labels: Ints, mean: Floats, a: Ints, b: Ints) -> NDArray[np.bool_]:
    """Pairs of areas of one hue where the darker one is a narrow band: the half shade around furniture."""
    size = np.bincount(labels.reshape(-1))
    edge = np.zeros(labels.shape, dtype=bool)
    edge[:, 1:] |= labels[:, 1:] != labels[:, :-1]
    edge[1:] |= labels[1:] != labels[:-1]
    around = np.maximum(np.bincount(labels[edge], minlength=len(size)), 1)
    dark = np.where(mean[a, 0] < mean[b, 0], a, b)
    lit = np.where(mean[a, 0] < mean[b, 0], b, a)
    narrow = size[dark] / around[dark] < 0.012 * max(labels.shape)
    factor = mean[dark, :1] / np.maximum(mean[lit, :1], 1.0)
    tint = np.linalg.norm(mean[dark, 1:] - mean[lit, 1:] * factor, axis=1)
    result: NDArray[np.bool_] = narrow & (tint < 4.0) & (factor[:, 0] > 0.5) & (size[dark] < 0.5 * size[lit])
    return result


def soften(labels: Ints, lab: Floats, side: Ints, step: float = 2.6, apart: float = 9.0) -> Ints:
    """Join areas that meet without an edge, such as the bands of a soft shadow, where both have the same `side`.

    Args:
        side: (h, w) number of the zone (floor, wall face, outside); areas are cut along its borders first.
    """
    count = int(side.max()) + 1
    labels = components(labels * count + side)
    for _ in range(3):
        a, b, length, contrast = border_contrast(labels, lab)
        if not len(a):
            break
        _, mean = area_means(labels, lab)
        close = np.linalg.norm(mean[a] - mean[b], axis=1) < apart
        zone = np.zeros(len(mean), dtype=np.int64)
        zone[labels.reshape(-1)] = side.reshape(-1)
        soft = (contrast < step) & close
        shaded = _bands(labels, mean, a, b) & (contrast < 8.0)
        join = (soft | shaded) & (length > 3) & (zone[a] == zone[b])
        if not join.any():
            break
        labels = union(int(labels.max()) + 1, a[join], b[join])[labels]
    return labels


def _trapezoids(shape: tuple[int, int], top: Polygon, floor: Polygon) -> list[Bools]:
    """Masks of the wall faces between wall tops and floor, one an edge."""
    count = len(top)
    return [
        polygon_mask(shape, np.array([top[i], top[(i + 1) % count], floor[(i + 1) % count], floor[i]]))
        for i in range(count)
    ]


def _distance(mean: Floats, colours: Floats, spread: NDArray[np.float64]) -> Floats:
    """Distance of each area's colour from the nearest of `colours`, in units of `spread`."""
    gap = (mean[:, None] - colours[None]) / spread
    result: Floats = np.sqrt((gap**2).sum(2)).min(1).astype(np.float32)
    return result


def _islands(labels: Ints, lab: Floats, candidates: Ints, floor_size: float) -> list[int]:
    """Areas that are floor by colour but furniture by shape: compact, with an edge all around."""
    short = np.sqrt(floor_size)
    a, b, length, contrast = border_contrast(labels, lab)
    found = []
    size = np.bincount(labels.reshape(-1))
    for area in candidates:
        if not 0.003 * floor_size < size[area] < 0.35 * floor_size:
            continue
        rows, columns = np.nonzero(labels == area)
        crop = labels[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
        mask = filled(np.pad(crop == area, 1))
        if not 0.006 * floor_size < mask.sum() < 0.35 * floor_size:
            continue
        hull = convex_hull(outline_points(mask))
        box = oriented_box(hull)
        if (
            mask.sum() < 0.88 * polygon_area(hull)
            or mask.sum() < 0.6 * box.area
            or min(box.length, box.breadth) < 0.085 * short
        ):
            continue
        mine = (a == area) | (b == area)
        edged = (contrast[mine] > 2.5) | (length[mine] < 4)
        if (length[mine] * edged).sum() > 0.8 * length[mine].sum():
            found.append(int(area))
    return found


def floor_areas(labels: Ints, lab: Floats, inside: Bools, rim: Bools) -> Ints:
    """Areas that are bare floor.

    The colour that dominates along the walls is the floor's; areas join while they are like it, within the floor's
    own spread (planks, tiles).

    Args:
        inside: the floor's outline as a mask; rim: the part of it near the walls.
    """
    size, mean = area_means(labels, lab)
    count = len(size)
    within = np.bincount(labels[inside], minlength=count)
    vote = np.bincount(labels[rim], minlength=count) + 0.25 * within
    alike = np.exp(-0.5 * (np.linalg.norm((mean[:, None] - mean[None]) / (9.0, 5.0, 5.0), axis=2)) ** 2)
    seed = int(np.argmax(alike @ vote * (vote > 0)))
    chosen = np.zeros(count, dtype=bool)
    chosen[seed] = True
    spread = np.array([6.0, 3.5, 3.5])
    for _ in range(4):
        weight = np.where(chosen, within, 0).astype(np.float64) + 1e-6 * chosen
        centre = (mean * weight[:, None]).sum(0) / weight.sum()
        sigma = np.sqrt((((mean - centre) ** 2) * weight[:, None]).sum(0) / weight.sum())
        spread = np.clip(sigma, (3.5, 2.2, 2.2), (7.0, 4.0, 4.0))
        gap = np.linalg.norm((mean - centre) / spread, axis=1)
        chosen = (gap < 2.3) & (within > 0.3 * size)
        chosen[seed] = True
    a, b, length, contrast = border_contrast(labels, lab)
    for _ in range(12):  # along gentle steps: planks, and floor that gets lighter towards a window
        weak = (contrast < 5.0) & (length > 3)
        reached = np.zeros(count, dtype=bool)
        for x, y in ((a, b), (b, a)):
            reached[y[weak & chosen[x]]] = True
        gap = np.linalg.norm((mean - centre) / spread, axis=1)
        more = reached & ~chosen & (gap < 3.2) & (within > 0.3 * size)
        if not more.any():
            break
        chosen |= more
    return np.flatnonzero(chosen)


def _shadows(labels: Ints, rgb: Floats, lab: Floats, lit: Ints, zone: Bools) -> Ints:
    """Areas that are the surface's colour in less light: darker by one factor in all channels, with a soft edge.

    On a surface with a hue of its own the hue tells, and the edge may be harder.

    Args:
        lit: areas of the surface; zone: mask of where it may be.
    """
    size, mean = area_means(labels, rgb)
    count = len(size)
    surface = np.zeros(count, dtype=bool)
    surface[lit] = True
    weight = np.bincount(labels[zone], minlength=count) * surface
    if not weight.any():
        return np.zeros(0, dtype=np.int64)
    base = (mean * weight[:, None]).sum(0) / weight.sum()
    light = np.maximum(mean, 1.0) ** 2.2 / np.maximum(base, 1.0) ** 2.2
    factor = light.mean(1)
    hued = float(np.ptp(base)) > 30
    even = light.std(1) < (0.22 if hued else 0.1) * factor + 0.02
    a, b, length, contrast = border_contrast(labels, lab)
    touching, soft = np.zeros(count), np.zeros(count)
    for x, y in ((a, b), (b, a)):
        np.add.at(touching, x, length * surface[y])
        np.add.at(soft, x, length * surface[y] * (contrast < (16.0 if hued else 6.0)))
    gentle = soft > 0.6 * np.maximum(touching, 1)
    within = np.bincount(labels[zone], minlength=count) > 0.5 * size
    result: Ints = np.flatnonzero(
        even & gentle & (factor > 0.12) & (factor < 1.06) & (touching > 0) & ~surface & within
    )
    return result


def sort_areas(rgb: Floats, lab: Floats, top: Polygon, floor: Polygon, perspective: bool) -> Sorted:
    """Sort all areas inside the walls into floor, wall faces and foreground."""
    shape = (lab.shape[0], lab.shape[1])
    room = polygon_mask(shape, inset(top, np.full(len(top), 1.0)))
    inside = polygon_mask(shape, floor)
    zones = _trapezoids(shape, top, floor) if perspective else []
    side_of = np.where(inside, 1, 0) if perspective else np.where(room, 1, 0)
    for index, zone in enumerate(zones):
        side_of[zone & ~inside] = 2 + index
    labels = soften(merge_areas(lab), lab, side_of)
    size, mean = area_means(labels, lab)
    area_floor = float(inside.sum())
    side = float(np.sqrt(max(area_floor, 1)))
    rim = inside & ~polygon_mask(shape, inset(floor, np.full(len(floor), max(2.0, 0.07 * side))))
    chosen = floor_areas(labels, lab, inside, rim)
    for _ in range(2):
        chosen = np.union1d(chosen, _shadows(labels, rgb, lab, chosen, inside))
    bare = _kept(labels, lab, chosen, inside, area_floor) & (inside if perspective else room)
    faces = np.zeros(shape, dtype=bool)
    for zone in zones:
        vote = np.bincount(labels[zone], minlength=len(size))
        alike = np.linalg.norm((mean - mean[int(np.argmax(vote))]) / (7.0, 4.0, 4.0), axis=1) < 2.0
        lit = np.flatnonzero(alike)
        lit = np.union1d(lit, _shadows(labels, rgb, lab, lit, zone))
        faces |= _kept(labels, lab, lit, zone, area_floor) & zone
    foreground = opened(room & ~bare & ~faces, 1)
    colour = lab[bare].mean(0) if bare.any() else lab[inside].mean(0) if inside.any() else lab.reshape(-1, 3).mean(0)
    return Sorted(labels, bare, foreground, colour.astype(np.float32))


def _kept(labels: Ints, lab: Floats, chosen: Ints, zone: Bools, floor_size: float) -> Bools:
    """Pixels of the chosen areas, less those that are furniture by shape; the zone's biggest area always stays."""
    biggest = chosen[np.argmax(np.bincount(labels[zone], minlength=int(labels.max()) + 1)[chosen])]
    candidates = np.intersect1d(chosen, np.unique(labels[zone]))
    furniture = [area for area in _islands(labels, lab, candidates, floor_size) if area != biggest]
    result: Bools = np.isin(labels, np.setdiff1d(chosen, furniture))
    return result
