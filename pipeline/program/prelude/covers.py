# SPDX-License-Identifier: GPL-3.0-or-later
"""Which things the cloths of a room lie on, once all of it is known."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from .budget import spend_vertices
from .lying import laid
from .proxies import proxy_shapes
from .record import Record
from .shape import Shape

NEAR = 0.02
"""Metres round a cloth within which it could meet something."""


def lay_covers(record: Record, names: Iterable[str]) -> None:
    """Lay these objects of a record onto what carries them, and the smaller ones onto the larger ones on the same thing.

    What stands beside all that keeps their ends out. Their shapes as they were are kept in `record.plain`.
    """
    lines = {line["id"]: line for line in record.proxies}
    done: list[str] = []
    for name in sorted(names, key=lambda i: -lines[i]["size"][0] * lines[i]["size"][1]):
        line = lines[name]
        carriers = ancestors(line, lines)
        below: list[Shape] = []
        for other in [*carriers, *(o for o in done if lines[o]["parent"] in carriers)]:
            shapes = record.furnished.get(other) or proxy_shapes(lines[other])
            below += seen_from(shapes, lines[other], line)
        spend_vertices(sum(shape.vertex_count for shape in record.furnished[name]))
        record.plain[name] = record.furnished[name]
        beside = standing_beside(record, line, {name, *carriers}, lines)
        record.furnished[name] = laid(record.furnished[name], below, beside)
        done.append(name)


def standing_beside(
    record: Record, line: Mapping[str, Any], own: set[str], lines: Mapping[str, Mapping[str, Any]]
) -> list[Shape]:
    """The shapes near a cloth that have nothing to do with what it lies on, in the cloth's frame.

    Args:
        own: the ids of the cloth and of all that carries it.
    """
    points = np.concatenate([shape.vertices for shape in record.furnished[line["id"]]])
    low, high = points.min(axis=0) - NEAR, points.max(axis=0) + NEAR
    found: list[Shape] = []
    for other in record.proxies:
        reach = math.hypot(*other["size"][:2]) / 2 + math.hypot(*(high - low)[:2]) / 2
        apart = math.dist(other["centre"][:2], line["centre"][:2])
        if apart > reach or other["placement"] in ("wall", "ceiling") or own & {other["id"], *ancestors(other, lines)}:
            continue
        shapes = record.furnished.get(other["id"]) or proxy_shapes(other)
        for shape in seen_from(shapes, other, line):
            near = (shape.vertices.max(axis=0) > low) & (shape.vertices.min(axis=0) < high)
            found += [shape] if near.all() else []
    return found


def ancestors(line: Mapping[str, Any], lines: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """The ids of the proxies that carry a proxy, the next one first."""
    found: list[str] = []
    at = line["parent"]
    while at in lines and at not in found:
        found.append(at)
        at = lines[at]["parent"]
    return found


def seen_from(shapes: Iterable[Shape], owner: Mapping[str, Any], other: Mapping[str, Any]) -> list[Shape]:
    """Shapes in the frame of one proxy line as they are in the frame of another."""
    turn = math.radians(owner["yaw"] - other["yaw"])
    away = math.radians(-other["yaw"])
    dx, dy = owner["centre"][0] - other["centre"][0], owner["centre"][1] - other["centre"][1]
    base = [line["centre"][2] - line["size"][2] / 2 for line in (owner, other)]
    offset = np.array(
        (dx * math.cos(away) - dy * math.sin(away), dx * math.sin(away) + dy * math.cos(away), base[0] - base[1])
    )
    matrix = np.array(((math.cos(turn), -math.sin(turn), 0.0), (math.sin(turn), math.cos(turn), 0.0), (0.0, 0.0, 1.0)))
    return [replace(shape, vertices=shape.vertices @ matrix.T + offset) for shape in shapes]
