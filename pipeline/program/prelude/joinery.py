# SPDX-License-Identifier: GPL-3.0-or-later
"""What joiners make of boards: fronts with sunk or raised panels."""

from __future__ import annotations

from typing import Any

import numpy as np

from .arguments import by_kind
from .budget import spend_vertices
from .checks import choice, fail, number, positive, sizes, whole
from .rings import Faces, placed
from .shape import Shape
from .solids import ORIGIN


@by_kind
def panelled(
    size: Any, columns: Any = 1, rows: Any = 1, border: Any = 0.07, depth: Any = 0.008, style: Any = "sunk",
    at: Any = ORIGIN,
) -> Shape:  # fmt: skip
    """An upright board, panels let into its front: doors, drawers.

    Args:
        border: frame round each. style: "sunk" or "raised".
    """  # fmt: skip
    w, d, h = sizes("panelled", "size", size)
    across, up = whole("panelled", "columns", columns, 1, 40), whole("panelled", "rows", rows, 1, 40)
    edge = min(positive("panelled", "border", border), 0.8 * w / (across + 1), 0.8 * h / (up + 1))
    sunk = number("panelled", "depth", depth, 0.0, 10.0)
    if sunk >= d:
        raise fail("panelled", "depth must be less than the board's own depth")
    raised = choice("panelled", "style", style, ("sunk", "raised")) == "raised"
    wide, tall = (w - edge * (across + 1)) / across, (h - edge * (up + 1)) / up
    xs = [-w / 2 + (i // 2) * (wide + edge) + (i % 2) * edge for i in range(2 * across + 2)]
    zs = [-h / 2 + (i // 2) * (tall + edge) + (i % 2) * edge for i in range(2 * up + 2)]
    spend_vertices(len(xs) * len(zs) + 16 * across * up + 4)
    y = -d / 2
    points = [(a, y, c) for c in zs for a in xs]
    n = len(xs)
    faces: Faces = []
    slope = min(0.6 * sunk + 0.002, 0.2 * wide, 0.2 * tall)
    field = min(0.045, 0.25 * wide, 0.25 * tall)
    for j in range(len(zs) - 1):
        for i in range(n - 1):
            ring = (j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i)
            if i % 2 == 0 or j % 2 == 0:
                faces.append(ring)
                continue
            steps = [(slope, sunk)] + ([(slope + 0.003, sunk), (slope + field, 0.25 * sunk)] if raised else [])
            for inset, deep in steps:
                start = len(points)
                box = (xs[i] + inset, xs[i + 1] - inset, zs[j] + inset, zs[j + 1] - inset)
                points += [
                    (a, y + deep, c)
                    for a, c in ((box[0], box[2]), (box[1], box[2]), (box[1], box[3]), (box[0], box[3]))
                ]
                inner = (start, start + 1, start + 2, start + 3)
                faces += [(ring[k], ring[(k + 1) % 4], inner[(k + 1) % 4], inner[k]) for k in range(4)]
                ring = inner
            faces.append(ring)
    back = len(points)
    points += [(-w / 2, d / 2, -h / 2), (w / 2, d / 2, -h / 2), (w / 2, d / 2, h / 2), (-w / 2, d / 2, h / 2)]
    last = n * (len(zs) - 1)
    faces.append((back + 1, back, back + 3, back + 2))
    faces.append((*range(n - 1, -1, -1), back, back + 1))
    faces.append((*range(last, last + n), back + 2, back + 3))
    faces.append((*range(0, last + 1, n), back + 3, back))
    faces.append((*range(last + n - 1, n - 2, -n), back + 1, back + 2))
    return placed("panelled", np.array(points), faces, at)
