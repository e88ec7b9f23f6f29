# SPDX-License-Identifier: GPL-3.0-or-later
"""Which boxes of a layout may share space, and what they look like to relations and score."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..artifacts.graph import GraphEdge
from ..artifacts.layout import ProxyLine
from .standing import FACING_ANGLE, FLAT, Placed, facing_error, footprint_gap

TOUCH = 0.01
"""Heights that share less than this do not count as sharing, metres."""
TUCKED = frozenset({"under", "over"})
SEATED = frozenset({"faces", "belongs_to"})
TABLE_HEIGHTS = (0.5, 1.2)
"""Heights in metres of what one sits at, so that a seat goes partly under it."""
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
    its front.
    """
    by_id = {p.id: p for p in proxies}
    pairs = set()
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
