# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects are cloths that lie on others, and so take on their shape."""

from __future__ import annotations

import re

from ..artifacts.layout import ProxyLine
from ..program.lines import quoted

_CLOTHS = frozenset({
    "throw", "blanket", "duvet", "comforter", "quilt", "bedspread", "coverlet", "bedding", "plaid", "afghan", "sheet",
    "tablecloth", "runner", "cloth", "placemat", "doily", "covers",
})  # fmt: skip
_BUNDLED = frozenset({"rolled", "stack", "stacked", "pile", "basket", "pillow", "pillows", "cushion", "box"})
"""What is said of cloths that do not lie spread out, and of things that only are called after cloths."""
_FOLDED, _STACK = 0.15, 0.7
"""Metres up to which what is folded is a stack, and square metres of its outline; what is higher is folded once or twice and hangs
over an edge, and of what is larger only an edge is folded."""
MOST_HEIGHT = 1.0
"""Of its shorter side; what is higher is a heap, or hangs from something."""


def is_lying_cloth(proxy: ProxyLine) -> bool:
    """Whether an object is a cloth that lies spread over what carries it."""
    if proxy.placement != "surface" or not proxy.parent:
        return False
    words = set(re.findall(r"[a-z]+", f"{proxy.category} {proxy.label}".lower()))
    kind = re.findall(r"[a-z]+", proxy.category.lower())
    if not _CLOTHS.intersection(kind) or words & _BUNDLED or _is_stack(proxy, words):
        return False
    return proxy.size[2] <= MOST_HEIGHT * min(proxy.size[:2])


def _is_stack(proxy: ProxyLine, words: set[str]) -> bool:
    width, depth, height = proxy.size
    return "folded" in words and height <= _FOLDED and width * depth <= _STACK


def furnish_line(proxy: ProxyLine, function: str) -> str:
    """The statement that furnishes an object with a def of the room."""
    lying = ", lying=True" if is_lying_cloth(proxy) else ""
    return f"furnish({quoted(proxy.id)}, {function}{lying})"
