# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks where a draft has materials: each becomes a material role with a colour of its own, by which it is known later.

A draft says part("top", board, material=oak) with oak = wood("#A87C52", figure=0.6). In the room language a part has a role
and a colour ("wood #A87C52"); which look that stands for is kept here, and stage 8 is told of it.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field

from ..errors import ProgramError
from ..materials.choice import look_of
from ..program.prelude.looks import Look
from ..program.prelude.palette import coloured_role
from ..program.prelude.registry import LOOKS
from .spots import Spots

MAPS = frozenset({"noise_map", "wave_map", "voronoi_map", "brick_map", "picture", "ramp", "mix", "bump"})
FAMILIES = frozenset(LOOKS) - MAPS
_ROLES = {"planks": "wood", "painted_wood": "painted", "knit": "fabric", "carpet": "fabric", "mirror_glass": "mirror",
          "concrete": "stone", "plaster": "painted", "glow": "shade", "principled": "painted"}  # fmt: skip


@dataclass
class Palette:
    """The looks of a draft.

    Attributes:
        named: expression by name, as written. roles: material ("wood #A87C52") -> expression of the look that it means.
        numbers: the draft's numbers as statements, which expressions may use.
    """

    named: dict[str, str] = field(default_factory=dict)
    roles: dict[str, str] = field(default_factory=dict)
    numbers: str = ""
    _known: dict[str, tuple[str, Look]] = field(default_factory=dict)

    def look(self, expression: str) -> Look:
        """The look of an expression, or of a name.

        Raises:
            ProgramError: it is no look.
        """
        return self._of(expression)[1]

    def material(self, expression: str) -> str:
        """The material that stands for a look in an object's shapes. Raises as `look`."""
        return self._of(expression)[0]

    def _of(self, expression: str) -> tuple[str, Look]:
        written = self.named.get(expression, expression)
        if written in self._known:
            return self._known[written]
        look = look_of(f"{self._preamble()}{written}")
        code = look.colour.lstrip("#").upper()
        role = _ROLES.get(look.name, look.name)
        material = coloured_role(role, code)
        # Two looks of one role and one colour are told apart by a colour that nobody can see is another.
        step = 1
        while self.roles.get(material, look.key) != look.key and step < 30:
            material = coloured_role(role, f"{(int(code, 16) ^ step):06X}")
            step += 1
        self.roles[material] = look.key
        self._known[written] = material, look
        return material, look

    def _preamble(self) -> str:
        return f"{self.numbers.rstrip()}\n" if self.numbers.strip() else ""

    def named_as(self, key: str) -> str:
        """The name of a look of the palette, by its key; "" for none."""
        return next((n for n, e in self.named.items() if e in self._known and self._known[e][1].key == key), "")


def with_roles(source: str, palette: Palette, own: frozenset[str]) -> tuple[str, list[str]]:
    """A def with materials in the place of looks, and what could not be done.

    Args:
        own: names of the draft's defs and numbers, which mean themselves.
    """
    nodes = list(ast.walk(ast.parse(source)))
    bound = {n.id for n in nodes if isinstance(n, ast.Name) and not isinstance(n.ctx, ast.Load)}
    bound |= {a.arg for a in nodes if isinstance(a, ast.arg)}
    families, named = FAMILIES - own - bound, palette.named.keys() - bound - own
    spots = Spots(source)
    notes: list[str] = []
    inside: set[int] = set()
    for node in nodes:
        if id(node) in inside:
            inside |= {id(child) for child in ast.iter_child_nodes(node)}
            continue
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in families:
            spots.replace(node, _material(spots.text_of(node), node, spots, palette, notes))
            inside |= {id(child) for child in ast.iter_child_nodes(node)}
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in named:
            try:
                spots.replace(node, f'"{palette.material(node.id)}"')
            except ProgramError as error:
                notes.append(f"{node.id}: {error.message}")
                spots.replace(node, '"painted"')
    return spots.text(), notes


def _material(written: str, node: ast.Call, spots: Spots, palette: Palette, notes: list[str]) -> str:
    """A look's call as a material; one whose colour is worked out while the def runs keeps its role and that colour."""
    assert isinstance(node.func, ast.Name)
    try:
        return f'"{palette.material(" ".join(written.split()))}"'
    except ProgramError as error:
        message = error.message
    role = _ROLES.get(node.func.id, node.func.id)
    colours = [*node.args[:1], *(k.value for k in node.keywords if k.arg in ("color", "colour", "base"))]
    if not colours:
        notes.append(f"{node.func.id}: {message}")
        return f'"{role}"'
    return f'("{role} " + ({spots.text_of(colours[0])}))'
