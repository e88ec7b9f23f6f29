# SPDX-License-Identifier: GPL-3.0-or-later
"""What stays exactly as it stands: locked objects, and all that is not chosen when only a part is done anew."""

from __future__ import annotations

from collections.abc import Collection

from ..artifacts.layout import Layout, ProxyLine


def pinned(layout: Layout, standing: Layout, ids: Collection[str], known: Collection[str | None]) -> Layout:
    """The layout with these objects as they stand; what does not stand yet is as it was.

    Args:
        known: what the analysis knows, by its present name. Pinned objects that it does not know any more stay too.
    """
    proxies = []
    for proxy in layout.proxies:
        there = standing.proxy(proxy.id) if proxy.id in ids else None
        proxies.append(proxy if there is None else there)
    present = {p.id for p in proxies}
    proxies += [p for p in standing.proxies if p.id in ids and p.id not in present and p.id not in known]
    result = layout.model_copy(update={"proxies": proxies})
    return result.model_copy(update={"proxies": [with_known_parent(p, result) for p in proxies]})


def with_known_parent(proxy: ProxyLine, layout: Layout) -> ProxyLine:
    """The proxy with its parent where the layout has one of that name; a program with an unknown parent cannot run."""
    cut = (layout.walls, layout.doors, layout.windows, layout.openings)
    known = {p.id for p in layout.proxies} | {line.id for lines in cut for line in lines}
    return proxy if proxy.parent is None or proxy.parent in known else proxy.model_copy(update={"parent": None})
