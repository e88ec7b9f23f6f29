# SPDX-License-Identifier: GPL-3.0-or-later
"""Works out what the panel shows of the images on surfaces, with the rest of the room's state."""

from __future__ import annotations

from collections.abc import Mapping

from ..pipeline.artifacts.textures import Texture, TextureChoices, Textures
from ..pipeline.memory import Memory
from ..pipeline.run_textures import changed_since, order_name
from ..pipeline.spending import money
from . import painters
from .texture_rows import SurfaceRow, TextureState

WORDS = {"model": "Painted", "picture": "From the picture", "procedural": "Made"}


def read(memory: Memory, titles: Mapping[str, str]) -> TextureState:
    """The surfaces as memory has them. Main thread only.

    Args:
        titles: of the objects, by what they are called in the layout.
    """
    textures = memory.latest(Textures)
    if textures is None:
        return TextureState()
    choices = memory.latest(TextureChoices) or TextureChoices()
    chosen = {c.surface: c.source or "" for c in choices.surfaces}
    changed = changed_since(memory)
    rows = tuple(
        SurfaceRow(
            t.surface,
            "Floor" if t.surface == "floor" else titles.get(t.surface, t.surface),
            WORDS[t.source],
            chosen.get(t.surface, ""),
            t.note,
            _detail(t),
            t.surface in changed,
        )
        for t in textures.surfaces
    )
    painter, problem = painters.painter_words(), painters.image_problem()
    todo = [t for t in textures.surfaces if t.source != "model" and choices.order(t.surface)[0] == "model"]
    paints = _paints(len(todo)) if painter and not problem and todo else ""
    return TextureState(rows, order_name(choices), painter, problem, paints)


def _paints(count: int) -> str:
    """What painting this many images means, so that nobody is surprised by the bill."""
    price = painters.image_price()
    words = f"{count} image{'' if count == 1 else 's'} will be painted"
    return words if price is None else f"{words}, free" if not price else f"{words}, about {money(count * price)}"


def _detail(texture: Texture) -> str:
    """The image in a few words, "" where there is none."""
    if not texture.name:
        return ""
    size = f"{texture.size[0]:.2f} x {texture.size[1]:.2f} m, {texture.pixels[0]} x {texture.pixels[1]} pixels"
    return f"{size}, by {texture.model}" if texture.model else size
