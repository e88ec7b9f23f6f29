# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 4's placements: rugs, lamps and plants on the floor, things on walls, ceilings and surfaces. (Paper, stage 4.)

The majors are frozen. Each function returns proxies; what could not be placed is said in the ledger.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TypeVar

from ..artifacts.analysis import Calibration, DetectedObject, Finding
from ..artifacts.layout import Layout, ProxyLine, WallLine
from ..geometry.camera import GeometryError
from ..geometry.footprint import lift_on_wall
from ..geometry.polygon import overlap_fraction, rectangle_corners
from .initial import proxy_of
from .score import corners
from .walls import NAMES, along, point_on

WALL_REACH = 0.9
FREE_PICTURE_Z = 1.5
LOWER = 0.05
"""Metres by which a thing stands below its parent's highest edge before it is believed to (on a seat, on a shelf)."""
LAPPED = 0.5
"""A thing that is wider than what carries it reaches over this part of it at least."""
RUG = 0.06
"""Height in metres below which a thing on the floor is so flat that others stand on it."""


def top_of(proxy: ProxyLine) -> float:
    """Height of a proxy's top above the floor."""
    return proxy.centre[2] + proxy.size[2] / 2


def on_floor(item: DetectedObject, calibration: Calibration) -> tuple[ProxyLine, list[Finding]]:
    """A minor thing that stands or lies on the floor."""
    return proxy_of(item.model_copy(update={"parent": None}), calibration, 0.0)


def on_ceiling(item: DetectedObject, calibration: Calibration) -> tuple[ProxyLine, list[Finding]]:
    """A thing that hangs from the ceiling: its top touches it."""
    height = min(item.size[2], calibration.height)
    return proxy_of(item.model_copy(update={"parent": None}), calibration, calibration.height - height)


def on_surface(
    item: DetectedObject,
    parents: Mapping[str, ProxyLine],
    calibration: Calibration,
    tops: Mapping[str, float] | None = None,
) -> tuple[ProxyLine, list[Finding]] | None:
    """A thing on another: at its parent's top, its middle above the parent. None without a placed parent.

    Args:
        tops: how high the parents were said to end, by id, metres; the layout may have them a little higher or lower.
    """
    parent = parents.get(item.parent or "")
    if parent is None:
        return None
    base = top_of(parent)
    # Beds, sofas and shelves carry things below their highest edge; the model's own height says so.
    stated = item.centre[2] - item.size[2] / 2
    floor_of_parent = parent.centre[2] - parent.size[2] / 2
    # A throw over a duvet hangs down beside it, so it may begin as low.
    lowest = floor_of_parent + (0.05 if parent.placement == "floor" else -0.05)
    said_top = (tops or {}).get(parent.id, base)
    if lowest < stated < base - LOWER and stated < said_top - LOWER:
        base = stated
    proxy, findings = proxy_of(item, calibration, base)
    moved = _over(proxy, parent)
    if moved is not proxy and math.dist(moved.centre[:2], proxy.centre[:2]) > 0.05:
        findings.append(Finding(about=item.id, message=f"It was moved onto {parent.id}, which carries it."))
    return moved, findings


def _over(proxy: ProxyLine, parent: ProxyLine) -> ProxyLine:
    """The same thing with its middle no nearer to the parent's edge than it can stand."""
    angle = math.radians(-parent.yaw)
    dx, dy = proxy.centre[0] - parent.centre[0], proxy.centre[1] - parent.centre[1]
    local = (dx * math.cos(angle) - dy * math.sin(angle), dx * math.sin(angle) + dy * math.cos(angle))
    turned = math.radians(proxy.yaw - parent.yaw)
    reach = (
        abs(proxy.size[0] * math.cos(turned)) / 2 + abs(proxy.size[1] * math.sin(turned)) / 2,
        abs(proxy.size[0] * math.sin(turned)) / 2 + abs(proxy.size[1] * math.cos(turned)) / 2,
    )
    limits = [
        parent.size[i] / 2 - 0.6 * reach[i]
        if reach[i] < parent.size[i] / 2
        # Wider than what carries it: a screen over two desks stays where it is seen.
        else max(0.2 * parent.size[i], reach[i] - LAPPED * parent.size[i])
        for i in (0, 1)
    ]
    kept = [max(-limits[i], min(limits[i], local[i])) for i in (0, 1)]
    if abs(kept[0] - local[0]) + abs(kept[1] - local[1]) < 1e-6:
        return proxy
    back = -angle
    x = parent.centre[0] + kept[0] * math.cos(back) - kept[1] * math.sin(back)
    y = parent.centre[1] + kept[0] * math.sin(back) + kept[1] * math.cos(back)
    return proxy.model_copy(update={"centre": (x, y, proxy.centre[2])})


def on_wall(
    item: DetectedObject, walls: Sequence[WallLine], calibration: Calibration
) -> tuple[ProxyLine, list[Finding]] | None:
    """A thing on a wall: its back on the wall's face, its place along the wall from the picture. None without a wall."""
    wall = nearest_wall(item, walls)
    if wall is None:
        return None
    start, end, inward = _face(wall, item)
    width, depth, height = _along_wall(item, wall)
    low = max(0.0, min(item.centre[2] - item.size[2] / 2, calibration.height - height))
    spot = along(wall, (item.centre[0], item.centre[1]))[0]
    findings: list[Finding] = []
    if item.box is not None and (calibration.trust is None or calibration.trust.evidence != "metres"):
        try:
            lifted = lift_on_wall(calibration.camera, item.box, start, end, (low, low + height), depth)
            place = lifted.along if inward > 0 else math.dist(start, end) - lifted.along
            spot = (spot + 2 * place) / 3
            width = math.sqrt(max(0.05, lifted.width) * width)
            low, height = _vertical(lifted.z_min, lifted.z_max, low, height, calibration.height)
        except GeometryError as error:
            findings.append(Finding(about=item.id, message=f"Its box was not used: {error.message}"))
    length = math.dist(wall.start, wall.end)
    width = min(width, length)
    spot = max(width / 2, min(length - width / 2, spot))
    foot = point_on(wall, spot)
    nx, ny = -(wall.end[1] - wall.start[1]) / length * inward, (wall.end[0] - wall.start[0]) / length * inward
    off = depth / 2 + (wall.thickness / 2 if wall.partition else 0.0) + 0.002
    # Facing the room: local -Y points along the wall's inward normal, also where the wall runs askew.
    yaw = round(math.degrees(math.atan2(nx, -ny)), 4) % 360.0
    proxy = ProxyLine(
        id=item.id,
        category=item.category,
        label=item.label,
        centre=(foot[0] + nx * off, foot[1] + ny * off, low + height / 2),
        size=(width, depth, height),
        yaw=yaw,
        placement="wall",
        parent=wall.id,
        salience=item.salience,
    )
    return proxy, findings


def _vertical(z_min: float, z_max: float, low: float, height: float, ceiling: float) -> tuple[float, float]:
    """Lower edge and height from the picture and the model's word, in equal parts, inside the wall."""
    bottom = max(0.0, (z_min + low) / 2)
    top = min(ceiling, (z_max + low + height) / 2)
    return (bottom, top - bottom) if top - bottom > 0.02 else (low, height)


def nearest_wall(item: DetectedObject, walls: Sequence[WallLine]) -> WallLine | None:
    """The wall a thing hangs on: the named one, or else the nearest whose span holds it."""
    name = NAMES.get(item.parent or "", item.parent)
    named = [w for w in walls if name and (w.id == name or w.id.rpartition("_")[0] == name)]
    best: tuple[float, WallLine] | None = None
    for wall in named or walls:
        length = math.dist(wall.start, wall.end)
        spot, off = along(wall, (item.centre[0], item.centre[1]))
        distance = abs(off) + max(0.0, -spot, spot - length)
        if best is None or distance < best[0]:
            best = (distance, wall)
    if best is None or (not named and best[0] > WALL_REACH):
        return None
    return best[1]


def _face(wall: WallLine, item: DetectedObject) -> tuple[tuple[float, float], tuple[float, float], float]:
    """The wall's segment with the room on its left as seen from the thing's side, and which side that is."""
    if not wall.partition or along(wall, (item.centre[0], item.centre[1]))[1] >= 0:
        return wall.start, wall.end, 1.0
    return wall.end, wall.start, -1.0


def _along_wall(item: DetectedObject, wall: WallLine) -> tuple[float, float, float]:
    """Width along the wall, depth off it, height: the thin side is the depth whatever the model called it."""
    width, depth, height = item.size
    if depth > width:
        width, depth = depth, width
    return width, max(0.01, min(depth, 0.6)), height


def rug_like(item: DetectedObject) -> bool:
    """Whether a thing on the floor is so flat that others stand on it."""
    return item.placement == "floor" and item.size[2] < RUG


def crowded(proxy: ProxyLine, others: Sequence[ProxyLine]) -> str | None:
    """Id of a placed thing that covers most of this one at the same height, or None."""
    rect = rectangle_corners(proxy.centre, proxy.size, proxy.yaw)
    for other in others:
        if other.id == proxy.parent or other.size[2] < 0.06 or other.parent == proxy.id:
            continue
        low = max(proxy.centre[2] - proxy.size[2] / 2, other.centre[2] - other.size[2] / 2)
        high = min(top_of(proxy), top_of(other))
        if high - low > 0.05 and overlap_fraction(rect, corners(other)) > 0.5:
            return other.id
    return None


_Item = TypeVar("_Item", DetectedObject, ProxyLine)


def order_by_depth(items: Sequence[_Item]) -> list[_Item]:
    """Parents before their children; else in their order."""
    by_id = {i.id: i for i in items}

    def level(item: _Item) -> int:
        steps, parent = 0, item.parent
        while parent in by_id and steps < len(by_id):
            steps, parent = steps + 1, by_id[parent].parent
        return steps

    return sorted(items, key=level)


def parents_of(layout: Layout) -> dict[str, ProxyLine]:
    """Proxies by id."""
    return {p.id: p for p in layout.proxies}
