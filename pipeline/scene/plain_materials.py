# SPDX-License-Identifier: GPL-3.0-or-later
"""Our materials without their patterns, for exports that know no nodes (glTF, USD).

Base colour and roughness then are the constants that their sockets hold. Normals go without bumps.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

import bpy

from .tags import COLOUR

_PLAIN = ("Base Color", "Roughness", "Metallic", "Emission Color", "Alpha", "Normal")


@contextlib.contextmanager
def plain_materials() -> Iterator[None]:
    """Unlink the patterns of our materials inside the `with` block. What is a picture stays, as exports take it along."""
    cut: list[tuple[Any, Any, Any]] = []
    ours: list[Any] = list(bpy.data.materials)
    for material in ours:
        if COLOUR not in material or material.library is not None or material.node_tree is None:
            continue
        tree = material.node_tree
        for link in list(tree.links):
            shader = link.to_node.type == "BSDF_PRINCIPLED" and link.to_socket.name in _PLAIN
            if shader and link.from_node.type != "TEX_IMAGE":
                cut.append((tree, link.from_socket, link.to_socket))
                tree.links.remove(link)
    try:
        yield
    finally:
        for tree, start, end in cut:
            tree.links.new(start, end)
