# SPDX-License-Identifier: GPL-3.0-or-later
"""Which surfaces of a room an image could lie on: the floor, rugs, covers, pictures on walls, screens."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..artifacts.layout import Layout, ProxyLine
from ..artifacts.textures import TextureKind
from ..program.prelude.shape import Shape
from .planes import Face, floor_face, front_face, top_face

MOST = 16
FLOOR = "floor"
_WORDS: dict[TextureKind, tuple[str, ...]] = {
    "rug": ("rug", "carpet", "mat", "doormat", "runner"),
    "cloth": ("blanket", "throw", "bedspread", "coverlet", "quilt", "duvet", "tablecloth"),
    "picture": ("picture", "painting", "poster", "photo", "photograph", "print", "artwork", "art", "map", "blackboard"),
    "screen": ("tv", "television", "screen"),
}
_NOT = frozenset(("mirror", "shelf", "clock", "lamp", "light", "holder", "stand", "rack", "cabinet"))
_FACES = frozenset(("paper", "screen"))
_FLAT_RUG = 0.08
_LEAST_AREA = 0.05


@dataclass(frozen=True)
class Target:
    """A surface that an image could lie on.

    Attributes:
        surface: "floor" or an object's id; part: the part of it that shows the image, "" for all of it.
        face: where it is, as it was placed; without: ids that do not hide it.
        words: what it is, in the artist's words; round: a disc.
    """

    surface: str
    part: str
    kind: TextureKind
    face: Face
    without: tuple[str, ...]
    words: str
    round: bool = False


def targets_of(layout: Layout, shapes: Mapping[str, Sequence[Shape]] | None = None) -> list[Target]:
    """The surfaces of a room, the floor first, then the largest.

    Args:
        shapes: the parts of each object in its own frame, where it is built already.
    """
    floor = Target(FLOOR, "", "floor", floor_face(layout.room.floor), (), "floor")
    found = [t for p in layout.proxies if (t := _target(p, layout, (shapes or {}).get(p.id, ()))) is not None]
    found = [t for t in found if t.face.size[0] * t.face.size[1] >= _LEAST_AREA]
    found.sort(key=lambda t: (-t.face.size[0] * t.face.size[1], t.surface))
    return [floor, *found[: MOST - 1]]


def kind_of(proxy: ProxyLine) -> TextureKind | None:
    """What kind of surface an object is, None for what is no flat thing."""
    words = ["".join(c for c in word if c.isalnum()) for word in proxy.category.lower().split()]
    if not words or not _NOT.isdisjoint(words):
        return None
    for kind, known in _WORDS.items():
        if words[-1] in known or words[-1].removesuffix("s") in known:
            return kind if _fits(kind, proxy) else None
    return None


def _fits(kind: TextureKind, proxy: ProxyLine) -> bool:
    if kind == "rug":
        return proxy.placement == "floor" and proxy.size[2] <= _FLAT_RUG
    if kind == "cloth":
        return proxy.placement == "surface" and proxy.size[2] < 0.7 * min(proxy.size[:2]) + 0.2
    if kind == "picture":
        return proxy.placement == "wall" and proxy.size[1] <= 0.15
    return proxy.size[1] <= 0.35


def _target(proxy: ProxyLine, layout: Layout, shapes: Sequence[Shape]) -> Target | None:
    kind = kind_of(proxy)
    if kind is None:
        return None
    width, depth, height = proxy.size
    part = ""
    if kind in ("rug", "cloth"):
        # A cover hangs down at its sides: most of it lies a little below its highest fold.
        level = height if kind == "rug" else 0.85 * height
        face = top_face(proxy, (-width / 2, -depth / 2), (width / 2, depth / 2), level)
    else:
        shown = _front_part(shapes)
        low, high, y = (-width / 2, 0.0), (width / 2, height), -depth / 2
        if shown is not None:
            part = shown.part
            points = shown.vertices
            low, high = (points[:, 0].min(), points[:, 2].min()), (points[:, 0].max(), points[:, 2].max())
            y = float(points[:, 1].min())
        face = front_face(proxy, low, high, y)
    words = proxy.label or proxy.category
    return Target(proxy.id, part, kind, face, _belongs(proxy, layout), words, proxy.shape == "round")


def _front_part(shapes: Sequence[Shape]) -> Shape | None:
    """The part that shows a picture: the widest flat one of paper or glass that looks forward."""
    flat = [s for s in shapes if s.part and s.material.split(" #")[0] in _FACES and np.ptp(s.vertices[:, 1]) < 0.03]
    return max(flat, key=lambda s: float(np.ptp(s.vertices[:, 0]) * np.ptp(s.vertices[:, 2])), default=None)


def _belongs(proxy: ProxyLine, layout: Layout) -> tuple[str, ...]:
    """An object and what it stands on, hangs from or lies on."""
    parents = {p.id: p.parent for p in layout.proxies}
    found = [proxy.id]
    at = proxy.parent
    while at is not None and at not in found:
        found.append(at)
        at = parents.get(at)
    if proxy.placement == "wall":
        found += [w.id for w in layout.walls if w.id == proxy.parent]
    return tuple(found)
