# SPDX-License-Identifier: GPL-3.0-or-later
"""The one version difference that `room.py` needs too (the others are in `compat.py`)."""

from __future__ import annotations

from typing import Any


def ensure_node_tree(owner: Any) -> Any:
    """The node tree of a material or world. Until 4.5 it must be switched on; from 5.0 it is always there."""
    if owner.node_tree is None:
        owner.use_nodes = True
    return owner.node_tree
