# SPDX-License-Identifier: GPL-3.0-or-later
"""Which categories weaker vision models mistake for which: things of like outline from above, or of like use.

Each row is a neighbourhood; what is confused becomes another member of its row. The rows were put together from what the
categories look like from above (a bench and a low table are both a plain rectangle), not from what the benchmark's matching
forgives: about half of the swaps lead out of the family that it gives half a point for.
"""

from __future__ import annotations

import re

NEIGHBOURS = (
    ("bed", "sofa", "daybed"),
    ("sofa", "bed", "bench"),
    ("armchair", "ottoman", "chair"),
    ("chair", "stool", "side table"),
    ("stool", "side table", "chair"),
    ("bench", "coffee table", "ottoman"),
    ("ottoman", "coffee table", "stool"),
    ("nightstand", "side table", "cabinet"),
    ("coffee table", "bench", "ottoman"),
    ("desk", "table", "console"),
    ("table", "desk", "counter"),
    ("counter", "cabinet", "table"),
    ("cabinet", "dresser", "wardrobe"),
    ("wardrobe", "bookshelf", "cabinet"),
    ("dresser", "desk", "cabinet"),
    ("bookshelf", "wardrobe", "cabinet"),
    ("shelf", "cabinet", "console"),
    ("lamp", "vase", "plant"),
    ("plant", "lamp", "vase"),
    ("vase", "lamp", "bowl"),
    ("rug", "blanket", "mat"),
    ("curtain", "panel", "blind"),
    ("pillow", "blanket", "cushion"),
    ("cushion", "pillow", "bag"),
    ("throw", "towel", "rug"),
    ("duvet", "mattress", "sheet"),
    ("picture", "mirror", "window"),
    ("mirror", "picture", "panel"),
    ("laptop", "book", "tablet"),
    ("monitor", "picture", "speaker"),
    ("television", "picture", "panel"),
    ("book", "tablet", "box"),
    ("bowl", "plate", "vase"),
    ("cup", "vase", "candle"),
    ("sink", "bowl", "cabinet"),
    ("refrigerator", "cabinet", "wardrobe"),
    ("stove", "cabinet", "counter"),
)
ANYTHING = ("box", "cabinet", "decoration")
"""What an unfamiliar thing is taken for."""


def confused(category: str, share: float) -> str:
    """A category that this one is mistaken for.

    Args:
        share: 0..1, picks one of the neighbours.
    """
    words = re.findall(r"[a-z]+", category.lower())
    row = next((row for row in NEIGHBOURS if category.lower() == row[0]), None)
    if row is None:
        # The last word says what a thing is: a "table lamp" is a lamp.
        row = next((row for word in reversed(words) for row in NEIGHBOURS if word == row[0]), None)
    others = ANYTHING if row is None else row[1:]
    return others[min(len(others) - 1, int(share * len(others)))]
