# SPDX-License-Identifier: GPL-3.0-or-later
"""Cloths on things: at which height they lie, and what they make of the surface for whatever lies on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..artifacts.layout import ProxyLine
from ..program.prelude.covers import seen_from
from ..program.prelude.lying import laid
from ..program.prelude.shape import Shape


def below(proxy: ProxyLine, proxies: Mapping[str, ProxyLine], shapes: Mapping[str, Sequence[Shape]]) -> list[Shape]:
    """What carries a thing, directly or not, in the thing's own frame.

    Args:
        shapes: parts of each thing in its own frame, by id.
    """
    found: list[Shape] = []
    at, seen = proxies.get(proxy.parent or ""), {proxy.id}
    while at is not None and at.id not in seen:
        seen.add(at.id)
        found += carried(shapes.get(at.id, ()), at, proxy)
        at = proxies.get(at.parent or "")
    return found


def carried(shapes: Sequence[Shape], owner: ProxyLine, other: ProxyLine) -> list[Shape]:
    """A thing's shapes in the frame of another thing."""
    return seen_from(shapes, owner.model_dump(), other.model_dump())


def lain(proxy: ProxyLine, cloth: Sequence[Shape], ground: Sequence[Shape]) -> tuple[ProxyLine, list[Shape]]:
    """A cloth at the height at which it lies, and its shapes there, in its own frame.

    Args:
        cloth: its shapes before they are laid. ground: what is below it, in its frame.
    """
    found = laid(list(cloth), ground)
    moves = [new.vertices[:, 2] - old.vertices[:, 2] for new, old in zip(found, cloth, strict=True)]
    up = round(float(np.median(np.concatenate(moves))), 4) if moves else 0.0
    if not up:
        return proxy, found
    centre = (*proxy.centre[:2], proxy.centre[2] + up)
    lifted = proxy.model_copy(update={"centre": centre})
    return lifted, laid(list(cloth), carried(ground, proxy, lifted))
