# SPDX-License-Identifier: GPL-3.0-or-later
"""The material slots of our meshes: one for each role and look, and what an artist put into them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ..program.prelude.dressing import MARK, look_of_role
from ..program.prelude.looks import Look
from .materials import ensure_material
from .tags import COLOUR, SLOTS


def write_slots(mesh: Any, roles: Iterable[str], family: str, looks: dict[str, Look]) -> None:
    """Replace the slots by those of these roles (with the keys of looks behind them)."""
    mesh.materials.clear()
    written = []
    for role in roles:
        material = ensure_material(family, role, looks)
        mesh.materials.append(material)
        written.append(f"{role.partition(MARK)[0]}{MARK}{material[COLOUR]}")
    mesh[SLOTS] = written


def artists_slots(mesh: Any) -> dict[str, Any]:
    """The materials that an artist put in the place of ours, by the role of their slot; None for an emptied one."""
    found = {}
    for material, (role, key) in zip(mesh.materials, _written(mesh), strict=False):
        if material is None or material.get(COLOUR) != key:
            found[role] = material
    return found


def put_artists_slots(mesh: Any, own: dict[str, Any]) -> None:
    """Put the artist's materials into the slots of their roles again."""
    for index, (role, _) in enumerate(_written(mesh) if own else ()):
        if role in own and index < len(mesh.materials):
            mesh.materials[index] = own[role]


def redress(mesh: Any, family: str, finishes: Iterable[dict[str, Look]]) -> None:
    """Give a mesh that the artist edited the looks of finishes, role by role; slots that are the artist's stay."""
    written = _written(mesh)
    for index, (role, key) in enumerate(written):
        if index >= len(mesh.materials) or mesh.materials[index] is None or mesh.materials[index].get(COLOUR) != key:
            continue
        look = look_of_role(role, finishes)
        named = role if look is None else f"{role}{MARK}{look.key}"
        wanted = ensure_material(family, named, {} if look is None else {look.key: look})
        if wanted != mesh.materials[index]:
            mesh.materials[index] = wanted
            written[index] = (role, str(wanted[COLOUR]))
            mesh[SLOTS] = [MARK.join(pair) for pair in written]


def _written(mesh: Any) -> list[tuple[str, str]]:
    """(role, key) of each slot as we wrote it."""
    pairs = [str(text).partition(MARK) for text in mesh.get(SLOTS, ())]
    return [(role, key) for role, _, key in pairs]
