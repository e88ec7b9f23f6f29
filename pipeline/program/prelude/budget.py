# SPDX-License-Identifier: GPL-3.0-or-later
"""A hook that counts vertices before they are made, so that a bomb is refused before it takes memory.

In plain Python there is no limit. The interpreter sets one for each evaluation with `vertex_budget`.
"""

from __future__ import annotations

import contextlib
import contextvars
from collections.abc import Iterator

_left: contextvars.ContextVar[list[int] | None] = contextvars.ContextVar("vertices_left", default=None)


def spend_vertices(count: int) -> None:
    """Account for `count` new vertices. Raises ValueError when the evaluation's limit is passed."""
    left = _left.get()
    if left is None:
        return
    left[0] -= int(count)
    if left[0] < 0:
        raise ValueError("too many vertices: use fewer segments, subdivisions or copies")


@contextlib.contextmanager
def vertex_budget(limit: int) -> Iterator[list[int]]:
    """Limit the vertices made inside the `with` block; yields the one-element list that holds what is left."""
    left = [int(limit)]
    token = _left.set(left)
    try:
        yield left
    finally:
        _left.reset(token)
