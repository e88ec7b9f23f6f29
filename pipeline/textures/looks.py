# SPDX-License-Identifier: GPL-3.0-or-later
"""How textures are written in the room language, and put into the finishes that a room's text has already."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..artifacts.textures import Texture, Textures
from ..materials.difference import difference
from ..materials.parts import cells_of
from ..program import finishes
from ..program.lines import quoted
from ..program.prelude.dressing import look_of_role
from ..program.prelude.looks import Look
from ..program.prelude.record import Record
from ..program.prelude.shape import Shape
from .names import shows_image_of

ROUGHNESS = {"floor": 0.5, "wall": 0.8, "rug": 0.95, "cloth": 0.95, "picture": 0.7, "screen": 0.25}
_KEPT = ("roughness", "specular", "coat", "sheen")
"""Numbers of the look before that a texture keeps: only colours come from the image."""
_FAINT = 9.0
"""CIEDE2000 up to which a pattern that was modelled is the one that the image shows."""
_RELIEF = {"rug": "bump(noise_map(0.008), 0.003)", "cloth": "bump(noise_map(0.004), 0.001)"}
"""Pile and weave, which no image of a room from above shows."""


def picture_text(texture: Texture) -> str:
    """The map of a texture, such as `picture("floor", size=(2.4, 2.4))`; "" where it has no image.

    What tiles repeats every so many metres over the object's x and y; what does not fills its part once.
    """
    if not texture.name:
        return ""
    parts = [quoted(texture.name)]
    if texture.tiles:
        parts.append(f"size=({_number(texture.size[0])}, {_number(texture.size[1])})")
    if texture.turned:
        parts.append(f"turned={_number(texture.turned)}")
    if texture.tiles:
        parts.append('space="object"')
    if texture.colour:
        parts.append(f'color="#{texture.colour}"')
    return f"picture({', '.join(parts)})"


def look_text(texture: Texture, before: Look | None = None) -> str:
    """A look that shows a texture, "" where it has no image.

    Args:
        before: the look that the surface had, whose gloss stays.
    """
    shown = picture_text(texture)
    if not shown:
        return ""
    numbers: dict[str, float] = {"roughness": ROUGHNESS[texture.kind]}
    if before is not None and texture.kind not in ("picture", "screen"):
        numbers |= {n: v for n, v in before.inputs if n in _KEPT and isinstance(v, (int, float))}
    parts = [f"base={shown}", *(f"{name}={_number(value)}" for name, value in numbers.items())]
    if texture.kind in _RELIEF:
        parts.append(f"bump={_RELIEF[texture.kind]}")
    return f"principled({', '.join(parts)})"


def finished_text(text: str, textures: Textures, record: Record) -> str:
    """A room text in which every surface that has an image shows it, and those that have none do not any more.

    An object has one finish only: the part that shows the image takes another look there, the others stay.

    Args:
        record: what the text evaluates to.

    Raises:
        ProgramError: the text cannot be parsed.
    """
    found = finishes.read_materials(text)
    for texture in textures.surfaces:
        finish = found.finishes.get(texture.surface, {})
        old = [key for key, look in finish.items() if shows_image_of(texture.surface, look)]
        finish = {key: look for key, look in finish.items() if key not in old}
        if texture.name:
            shapes = record.furnished.get(texture.surface, ())
            key = _key(texture, shapes)
            look = look_text(texture, _look_before(key, record.finishes.get(texture.surface, {})))
            finish |= dict.fromkeys([key, *_like(key, texture, shapes)], look)
        if finish:
            found.finishes[texture.surface] = finish
        else:
            found.finishes.pop(texture.surface, None)
    _forget_unused(found)
    return finishes.with_materials(text, found)


def _shows_own(surface: str, look: str) -> bool:
    """Whether a look shows an image that was made for this surface; its name begins with the surface's."""
    start = f"picture({quoted(surface)[:-1]}"
    return any(f"{start}{end}" in look for end in ('"', "_"))


def _key(texture: Texture, shapes: Sequence[Shape]) -> str:
    """Which part, or material role, shows the image: what is seen most, where that is not known."""
    if texture.part or not shapes:
        return texture.part
    widest = max(cells_of(shapes, texture.kind in ("picture", "screen")), key=lambda cell: cell.share)
    return widest.part or widest.role


def _like(key: str, texture: Texture, shapes: Sequence[Shape]) -> list[str]:
    """Other parts of a rug in nearly the same colour: streaks that somebody modelled, which the image has already."""
    if texture.kind != "rug":
        return []
    cells = [cell for cell in cells_of(shapes) if cell.part and cell.code]
    own = next((cell.code for cell in cells if cell.part == key), "")
    return [cell.part for cell in cells if own and cell.part != key and difference(cell.code, own) < _FAINT]


def _look_before(key: str, finish: Mapping[str, Look]) -> Look | None:
    return look_of_role("", [dict(finish)], key)


def _forget_unused(found: finishes.Materials) -> None:
    """Take out the named looks that nothing wears any more."""
    worn = {look for finish in found.finishes.values() for look in finish.values()}
    expressions = " ".join(worn)
    found.looks = {name: e for name, e in found.looks.items() if name in worn or name in expressions}


def _number(value: float) -> str:
    return f"{value:.4f}".rstrip("0").rstrip(".")
