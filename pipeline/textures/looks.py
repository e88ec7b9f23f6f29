# SPDX-License-Identifier: GPL-3.0-or-later
"""How a texture is written in the room language."""

from __future__ import annotations

from ..artifacts.textures import Texture

ROUGHNESS = {"floor": 0.5, "wall": 0.8, "rug": 0.95, "cloth": 0.95, "picture": 0.7, "screen": 0.25}


def picture_text(texture: Texture) -> str:
    """The map of a texture, such as `picture("floor", size=(2.4, 2.4))`; "" where it has no image.

    What tiles repeats every so many metres; what does not fills its part once.
    """
    if not texture.name:
        return ""
    parts = [f'"{texture.name}"']
    if texture.tiles:
        parts.append(f"size=({_number(texture.size[0])}, {_number(texture.size[1])})")
    if texture.turned:
        parts.append(f"turned={_number(texture.turned)}")
    return f"picture({', '.join(parts)})"


def look_text(texture: Texture) -> str:
    """A look that shows a texture and nothing else, "" where it has no image."""
    shown = picture_text(texture)
    return f"principled(base={shown}, roughness={ROUGHNESS[texture.kind]})" if shown else ""


def finish_text(texture: Texture) -> str:
    """The line that puts a texture on its surface alone, "" where it has no image.

    An object has one `finish` line only: where it has one already, its part takes the look instead.
    """
    look = look_text(texture)
    return f'finish("{texture.surface}", {{"{texture.part}": {look}}})' if look else ""


def _number(value: float) -> str:
    return f"{value:.4f}".rstrip("0").rstrip(".")
