# SPDX-License-Identifier: GPL-3.0-or-later
"""Curtains hang from the rod that is over them: seen from above, both are at the same place, and their heights are guesses."""

from __future__ import annotations

import re
from collections.abc import Collection

import numpy as np

from ..artifacts.layout import Layout, ProxyLine

_CURTAIN = re.compile(r"\b(curtains?|sheers?|drapes?|voile)\b", re.IGNORECASE)
_ROD = re.compile(r"\b(rod|rail|pole|track)\b", re.IGNORECASE)
_ACROSS, _APART = 0.25, 0.45
"""Metres between a curtain and its rod: across the rod, and in height."""


def hung_from_rods(layout: Layout, held: Collection[str] = ()) -> Layout:
    """The layout with each curtain reaching up to the middle of the rod above it, and no lower at its hem than it was.

    Args:
        held: ids of what stays as it is.
    """
    rods = [p for p in layout.proxies if _ROD.search(p.category.replace("_", " "))]
    if not rods:
        return layout
    proxies = [p if p.id in held or not _is_curtain(p) else _reaching(p, rods) for p in layout.proxies]
    return layout.model_copy(update={"proxies": proxies})


def _is_curtain(proxy: ProxyLine) -> bool:
    said = proxy.category.replace("_", " ")
    return bool(_CURTAIN.search(said)) and not _ROD.search(said)


def _reaching(proxy: ProxyLine, rods: list[ProxyLine]) -> ProxyLine:
    top, base = (proxy.centre[2] + sign * proxy.size[2] / 2 for sign in (1, -1))
    levels = [rod.centre[2] for rod in rods if _over(rod, proxy) and abs(rod.centre[2] - top) <= _APART]
    if not levels:
        return proxy
    level = min(levels, key=lambda z: abs(z - top))
    height = round(level - base, 4)
    return proxy.model_copy(
        update={"size": (*proxy.size[:2], height), "centre": (*proxy.centre[:2], round(base + height / 2, 4))}
    )


def _over(rod: ProxyLine, proxy: ProxyLine) -> bool:
    """Whether the middle of a curtain is under a rod, seen from above."""
    angle = np.radians(rod.yaw)
    dx, dy = proxy.centre[0] - rod.centre[0], proxy.centre[1] - rod.centre[1]
    along, across = dx * np.cos(angle) + dy * np.sin(angle), dy * np.cos(angle) - dx * np.sin(angle)
    return bool(abs(along) <= rod.size[0] / 2 + 0.05 and abs(across) <= _ACROSS)
