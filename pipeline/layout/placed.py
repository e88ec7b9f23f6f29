# SPDX-License-Identifier: GPL-3.0-or-later
"""Which boxes of a layout may share space, and what they look like to relations and score."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..artifacts.graph import GraphEdge
from ..artifacts.layout import ProxyLine
from ..geometry.polygon import intersection_area, rectangle_corners
from .standing import FACING_ANGLE, FLAT, Placed, facing_error, footprint_gap

TOUCH = 0.01
"""Heights that share less than this do not count as sharing, metres."""
TUCKED = frozenset({"under", "over"})
SEATED = frozenset({"faces", "belongs_to"})
TABLE_HEIGHTS = (0.5, 1.2)
"""Heights in metres of what one sits at, so that a seat goes partly under it."""
SEAT_SIDE = 0.85
SEAT_HEIGHTS = (0.35, 1.35)
"""Longest side and heights of a seat for one, metres."""
MOST_UNDER = 0.75
"""Largest part of a seat's outline that goes under what one sits at."""
BELONGS_GAP = 0.6


def placed(proxy: ProxyLine) -> Placed:
    """A proxy as relations see it."""
    return Placed(proxy.id, proxy.centre, proxy.size, proxy.yaw, proxy.placement, proxy.parent)


def may_share(a: ProxyLine, b: ProxyLine, tucked: frozenset[frozenset[str]]) -> bool:
    """Whether two proxies may overlap seen from above: rugs, parent and child, one above the other, tucked chairs."""
    if a.parent == b.id or b.parent == a.id:
        return True
    if a.size[2] < FLAT or b.size[2] < FLAT:
        return True
    low = max(a.centre[2] - a.size[2] / 2, b.centre[2] - b.size[2] / 2)
    high = min(a.centre[2] + a.size[2] / 2, b.centre[2] + b.size[2] / 2)
    return high - low < TOUCH or frozenset((a.id, b.id)) in tucked


def tucked_pairs(edges: Iterable[GraphEdge], proxies: Sequence[ProxyLine]) -> frozenset[frozenset[str]]:
    """Pairs of which one stands partly under the other: the model says so, or says that it is its seat and it looks so.

    A chair pushed under its desk is one; so is what faces, or belongs to, a thing of table height that it runs into with
    its front; and so is, whatever was said, a thing of a chair's size that stands with its front under such a thing.
    """
    by_id = {p.id: p for p in proxies}
    pairs = {frozenset((a.id, b.id)) for a in proxies for b in proxies if a is not b and _is_seat_of(a, b)}
    for edge in edges:
        item, other = by_id.get(edge.source), by_id.get(edge.target)
        if edge.origin != "model" or item is None or other is None:
            continue
        if edge.relation in TUCKED or (edge.relation in SEATED and _sits_at(item, other)):
            pairs.add(frozenset((edge.source, edge.target)))
    return frozenset(pairs)


def _sits_at(item: ProxyLine, other: ProxyLine) -> bool:
    seat, table = placed(item), placed(other)
    low, high = TABLE_HEIGHTS
    fits = low <= table.span[1] <= high and item.size[0] * item.size[1] < other.size[0] * other.size[1]
    return fits and facing_error(seat, table) <= FACING_ANGLE


def _is_seat_of(item: ProxyLine, other: ProxyLine) -> bool:
    """Whether size, direction and place alone make one the seat of the other: it stands partly under it, facing it."""
    if item.placement != "floor" or other.placement != "floor":
        return False
    if max(item.size[:2]) > SEAT_SIDE or not SEAT_HEIGHTS[0] <= item.size[2] <= SEAT_HEIGHTS[1]:
        return False
    if not _sits_at(item, other):
        return False
    own, table = (rectangle_corners(p.centre[:2], p.size[:2], p.yaw) for p in (item, other))
    under = intersection_area(own, table) / (item.size[0] * item.size[1])
    return 0.0 < under <= MOST_UNDER


def companions(edges: Iterable[GraphEdge], proxies: Sequence[ProxyLine]) -> dict[str, str]:
    """What keeps its place beside what: things on the floor that are said to belong to a larger one near by."""
    by_id = {p.id: p for p in proxies if p.placement == "floor"}
    found: dict[str, str] = {}
    for edge in edges:
        item, other = by_id.get(edge.source), by_id.get(edge.target)
        if edge.origin != "model" or edge.relation != "belongs_to" or item is None or other is None:
            continue
        larger = other.size[0] * other.size[1] > item.size[0] * item.size[1]
        if larger and edge.source not in found and footprint_gap(placed(item), placed(other)) <= BELONGS_GAP:
            found[edge.source] = edge.target
    return {child: parent for child, parent in found.items() if parent not in found}
