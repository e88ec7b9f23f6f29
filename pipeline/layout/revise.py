# SPDX-License-Identifier: GPL-3.0-or-later
"""Revise: the layout after the critic's edits that evidence does not speak against. (Paper, stage 3.)"""

from __future__ import annotations

from ..artifacts.analysis import Calibration
from ..artifacts.layout import Layout
from .initial import proxy_of
from .sanitise import Sanitised


def revise(layout: Layout, sanitised: Sanitised, calibration: Calibration) -> Layout:
    """The layout after the edits: touched proxies are placed anew from their evidence, the rest stays as it is."""
    removed = {e.id for e in sanitised.edits if e.op == "remove"}
    renamed = {e.id: e.category for e in sanitised.edits if e.op == "recategorise" and e.category}
    moved = {e.id for e in sanitised.edits if e.op in ("move", "resize", "turn", "add")}
    proxies = []
    for proxy in layout.proxies:
        if proxy.id in removed:
            continue
        if proxy.id in moved:
            base = proxy.centre[2] - proxy.size[2] / 2
            again = proxy_of(sanitised.evidence.objects[proxy.id], calibration, base)[0]
            # The detected parent may be nothing that stage 3 places, such as the rug below a chair.
            proxy = again.model_copy(update={"parent": proxy.parent})
        if proxy.id in renamed:
            proxy = proxy.model_copy(update={"category": renamed[proxy.id]})
        proxies.append(proxy)
    known = {p.id for p in layout.proxies}
    for edit in sanitised.edits:
        if edit.op == "add" and edit.id not in known:
            proxies.append(proxy_of(sanitised.evidence.objects[edit.id], calibration, 0.0)[0])
    return layout.model_copy(update={"proxies": proxies})
