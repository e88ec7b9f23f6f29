# SPDX-License-Identifier: GPL-3.0-or-later
"""Which cloths lie spread over what carries them, and which are bundles that stand on it."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.artifacts.layout import ProxyLine
from code_as_room.pipeline.objects.cloths import is_lying_cloth


@pytest.mark.parametrize(
    ("category", "size", "lies"),
    [
        ("throw", (1.4, 0.5, 0.4), True),
        ("folded throw on the bench", (0.32, 0.45, 0.285), True),  # too high for a stack: it hangs over the edge
        ("folded throw", (0.4, 0.3, 0.09), False),
        ("duvet, upper edge folded over", (2.05, 1.53, 0.13), True),
        ("stack of blankets", (0.5, 0.4, 0.4), False),
        ("throw pillow", (0.5, 0.5, 0.2), False),
        ("blanket", (0.3, 0.3, 0.9), False),  # it hangs from something
        ("vase", (0.3, 0.3, 0.1), False),
    ],
)
def test_what_lies(category: str, size: tuple[float, float, float], lies: bool) -> None:
    thing = ProxyLine(id="a", category=category, centre=(0, 0, 1), size=size, placement="surface", parent="bench_1")
    assert is_lying_cloth(thing) is lies
    assert not is_lying_cloth(thing.model_copy(update={"placement": "floor", "parent": None}))
