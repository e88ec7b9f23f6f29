# SPDX-License-Identifier: GPL-3.0-or-later
"""Library programs that come nearest to objects, as examples for a model that writes one."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ..artifacts.layout import ProxyLine
from ..library import catalogue
from ..program.prelude.palette import category_family
from .choose import candidates

MOST = 2
LONGEST = 4_200
"""Characters of one example, helpers included; longer pieces teach little for their price."""
_FITTED = re.compile(r"^( +)return fill\((.*), size\)$", re.MULTILINE)
_CALLED = re.compile(r"(?<!def )\bfill\(")
_DEFINED = re.compile(r"^def fill\(.*?\n\n\n", re.MULTILINE | re.DOTALL)


def nearest_programs(proxies: Sequence[ProxyLine], most: int = MOST) -> str:
    """The text of up to two library programs, nearest to the largest of these objects first."""
    ranked: dict[str, float] = {}
    for proxy in proxies:
        weight = 1.0 + proxy.size[0] * proxy.size[1] * proxy.size[2]
        for choice in candidates(proxy, "", category_family(proxy.category))[:3]:
            ranked[choice.piece.name] = max(ranked.get(choice.piece.name, 0.0), choice.score * weight)
    chosen: list[str] = []
    for name in sorted(ranked, key=lambda n: -ranked[n]):
        if len(catalogue.source([name])) <= LONGEST:
            chosen.append(name)
        if len(chosen) == most:
            break
    if not chosen:
        fitting = (d.name for d in catalogue.definitions().values() if d.name in catalogue.pieces())
        chosen = [name for name in fitting if 1500 < len(catalogue.source([name])) <= LONGEST][:1]
    return without_fitting(catalogue.source(chosen))


def without_fitting(source: str) -> str:
    """Library programs without the `fill` that lets them take any size: what a model writes is not to use it."""
    plain = _FITTED.sub(r"\1return \2", source)
    return plain if _CALLED.search(plain) else _DEFINED.sub("", plain)
