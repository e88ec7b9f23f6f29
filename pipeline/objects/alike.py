# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects are the same thing several times, such as eight dining chairs: they are modelled once."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ..artifacts.layout import ProxyLine
from ..artifacts.objects import Descriptions, ObjectDescription
from .colours import colour_distance
from .rows import is_varied
from .twins import other_colours

_SIZE = math.log(1.12)
_COLOUR = 0.13
_PLAIN = 0.8
"""Share of its main colour from which a thing is of one colour; others may be patterned."""


def alike(proxies: Sequence[ProxyLine], descriptions: Descriptions) -> dict[str, str]:
    """The id of each object -> the id of the first one that is the same thing, which may be itself.

    Same category and placement, sizes within 12 %, and colours that look the same where they are known. Rows of
    books and of clothes are never alike (`rows.py`). Things that are mainly of one colour each may differ in it;
    `twins.py` gives each its own.
    """
    known = {d.id: d for d in descriptions.objects}
    empty = ObjectDescription(id="")
    firsts: list[ProxyLine] = []
    found: dict[str, str] = {}
    for proxy in proxies:
        described = known.get(proxy.id, empty)
        same = next((f for f in firsts if _same(f, proxy) and _same_look(known.get(f.id, empty), described)), None)
        if same is None:
            firsts.append(proxy)
        found[proxy.id] = proxy.id if same is None else same.id
    return found


def _same(a: ProxyLine, b: ProxyLine) -> bool:
    if (a.category.lower(), a.placement, a.shape) != (b.category.lower(), b.placement, b.shape):
        return False
    if is_varied(a):
        return False
    return all(abs(math.log(max(x, 1e-3) / max(y, 1e-3))) < _SIZE for x, y in zip(a.size, b.size, strict=True))


def _same_look(a: ObjectDescription, b: ObjectDescription) -> bool:
    if a.material and b.material and not set(_words(a.material)) & set(_words(b.material)):
        return False
    if not a.measured or not b.measured:
        return True
    if colour_distance(a.measured[0].code, b.measured[0].code) < _COLOUR:
        return True
    return other_colours(a, b) and min(a.measured[0].share, b.measured[0].share) > _PLAIN


def _words(text: str) -> list[str]:
    return text.lower().replace(",", " ").split()


def groups(firsts: Mapping[str, str]) -> dict[str, list[str]]:
    """The first of each group -> all of it, itself included."""
    found: dict[str, list[str]] = {}
    for identifier, first in firsts.items():
        found.setdefault(first, []).append(identifier)
    return found
