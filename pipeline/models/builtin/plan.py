# SPDX-License-Identifier: GPL-3.0-or-later
"""Line drawings: black walls and thin outlines on white."""

from __future__ import annotations

import numpy as np

from .grid import Bools, Floats, Ints, components, opened, polygon_mask
from .outline import Outline, inset
from .regions import Sorted
from .segment import area_means


def is_plan(lab: Floats) -> bool:
    """True for a drawing: no colour, mostly white, the rest mostly black, and little between."""
    chroma = np.hypot(lab[..., 1], lab[..., 2])
    white, black = lab[..., 0] > 88, lab[..., 0] < 40
    return bool(
        np.mean(chroma < 10) > 0.98
        and white.mean() > 0.55
        and 0.005 < black.mean() < 0.4
        and white.mean() + black.mean() > 0.82
    )


def _without_lines(labels: Ints, line: Bools) -> Ints:
    """Give every line pixel the label of a neighbouring area, so that areas meet where a line parted them."""
    result = np.where(line, -1, labels)
    for _ in range(8):
        empty = result < 0
        if not empty.any():
            break
        padded = np.pad(result, 1, constant_values=-1)
        best = np.full(result.shape, -1, dtype=np.int64)
        for dy, dx in ((0, 1), (2, 1), (1, 0), (1, 2)):
            near = padded[dy : dy + result.shape[0], dx : dx + result.shape[1]]
            best = np.maximum(best, near)
        result = np.where(empty, best, result)
    return np.maximum(result, 0)


def sort_plan(lab: Floats, ink: Floats, outline: Outline) -> Sorted:
    """Find bare floor and drawn things: what lines enclose inside the walls.

    The floor is the largest area between the lines; areas that are joined with the outside, such as the quarter
    circle of a door whose gap is open, count as floor too.
    """
    shape = (lab.shape[0], lab.shape[1])
    room = polygon_mask(shape, inset(outline.inner, np.full(len(outline.inner), 1.0)))
    line = ink < 65
    areas = components(line)
    size = np.bincount(areas[room], minlength=int(areas.max()) + 1)
    _, mean = area_means(areas, lab)
    drawn = np.zeros(len(size), dtype=bool)
    drawn[areas[line]] = True
    size = np.where(drawn, 0, size)
    floor = int(np.argmax(size))
    bare = (areas == floor) | (~room & ~line)
    outside = np.unique(areas[~room & ~line])
    bare |= np.isin(areas, outside)
    labels = _without_lines(areas, line)
    ground = np.append(outside, floor)
    foreground = opened(room & ~bare & ~np.isin(labels, ground), 1)
    colour = np.array([100.0, 0.0, 0.0], dtype=np.float32)
    return Sorted(labels, bare & room, foreground, colour)
