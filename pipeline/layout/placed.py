# SPDX-License-Identifier: GPL-3.0-or-later
"""Which boxes of a layout may share space, and what they look like to relations and score."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..artifacts.graph import GraphEdge
from ..artifacts.layout import ProxyLine
from .relations import Placed

FLAT = 0.06
"""Things lower than this (rugs, mats) may lie under others, metres."""
TOUCH = 0.01
"""Heights that share less than this do not count as sharing, metres."""
TUCKED = frozenset({"under", "over"})


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
    """Pairs of which the model says that one stands partly under the other (a chair pushed under its desk)."""
    heights = {p.id: p.size[2] for p in proxies}
    return frozenset(
        frozenset((e.source, e.target))
        for e in edges
        if e.origin == "model" and e.relation in TUCKED and e.source in heights and e.target in heights
    )
