# SPDX-License-Identifier: GPL-3.0-or-later
"""What a draft answers to the questions on how things look: descriptions, programs, materials, light."""

from __future__ import annotations

import ast
from collections.abc import Collection

from ..artifacts.light import LightReply
from ..artifacts.materials import MaterialsReply, ObjectMaterialsReply, PaletteReply, PartMaterialReply
from ..artifacts.objects import DescribedReply, DescriptionsReply, ParameterReply, ProgramReply, ProgramsReply
from ..errors import ProgramError
from ..materials.choice import FAMILIES
from ..materials.difference import difference
from ..materials.parts import Cell, cells_of
from ..program.prelude.recorder import SURFACES
from .reading import Draft
from .things import Thing

SMALL = 0.004
"""Share of the picture below which a thing's own colours stand whatever was measured."""
AS_DRAFTED = "as the draft has it"
_WALLS = {"left": "wall_w", "right": "wall_e", "top": "wall_n", "bottom": "wall_s"}


def descriptions_reply(draft: Draft, ids: Collection[str], style: str) -> DescriptionsReply:
    """Words for things by their labels and materials."""
    objects = [_described(draft, t) for t in draft.things.values() if t.id in ids]
    return DescriptionsReply(room_style=style, objects=objects)


def _described(draft: Draft, thing: Thing) -> DescribedReply:
    cells = _cells(draft, thing)
    if not cells:
        return DescribedReply(id=thing.id, structure=thing.label)
    largest = max(cells, key=lambda c: (bool(c.code), c.share))
    words = dict.fromkeys(f"{c.role} {c.part}".strip() for c in sorted(cells, key=lambda c: -c.share) if c.role)
    return DescribedReply(
        id=thing.id,
        main_colour=f"#{largest.code}" if largest.code else "",
        material=", ".join(list(words)[:6]),
        structure=thing.label,
    )


def _cells(draft: Draft, thing: Thing) -> list[Cell]:
    made = draft.made.get(thing.id)
    return cells_of(made.written.shapes, thing.placement == "wall") if made is not None else []


def programs_reply(draft: Draft, ids: Collection[str]) -> ProgramsReply:
    """The programs that the draft has of these things."""
    return ProgramsReply(
        objects=[ProgramReply(id=i, program=draft.made[i].source) for i in draft.things if i in ids and i in draft.made]
    )


def materials_reply(draft: Draft, ids: Collection[str]) -> MaterialsReply:
    """The draft's looks for the parts of these things, and for the room's surfaces.

    The draft's own colours stand, since whoever chose them saw the picture; where a near one was measured in the picture
    that one does, since models see colours stronger than they are. Small things keep their own.
    """
    palette = _Palette(draft)
    objects = []
    for thing in draft.things.values():
        if thing.id in ids and (parts := _parts(draft, thing, palette)):
            objects.append(ObjectMaterialsReply(id=thing.id, parts=parts))
    for name, looks in draft.finishes.items():
        if name in draft.things:
            continue
        expression = looks.get("") or next(iter(looks.values()))
        known = _WALLS.get(name, name)
        if known in SURFACES or known in draft.fixed or known.startswith("wall_"):
            look = palette.part("", expression, "").model_copy(update={"color": "", "veto": ""})
            objects.append(ObjectMaterialsReply(id=known, parts=[look]))
    return MaterialsReply(palette=list(palette.entries.values()), objects=objects)


def _parts(draft: Draft, thing: Thing, palette: _Palette) -> list[PartMaterialReply]:
    """One entry for each material that the draft says anything of, finishes before the palette."""
    said = draft.finishes.get(thing.id) or draft.finishes.get(draft.first_of(thing), {})
    found: dict[str, PartMaterialReply] = {}
    small = _is_small(thing)
    for cell in _cells(draft, thing):
        finish = next((said[key] for key in (cell.part, cell.material, cell.role) if key and key in said), said.get(""))
        by_part = cell.part and cell.part in said
        key = cell.part if by_part else cell.material
        if not key or key in found:
            continue
        expression = finish or draft.palette.roles.get(cell.material)
        if expression:
            found[key] = palette.part(key, expression, "" if small else cell.code)
        elif cell.code and small:
            found[key] = PartMaterialReply(part=key, color=f"#{cell.code}", veto=AS_DRAFTED)
    return list(found.values())


def _is_small(thing: Thing) -> bool:
    """Whether a thing is so small in the picture that what is measured there is as much its surroundings."""
    if thing.seen is None:
        return True
    x0, y0, x1, y1 = thing.seen
    return (x1 - x0) * (y1 - y0) < SMALL * 1e6


class _Palette:
    """The looks of an answer, each with a name."""

    def __init__(self, draft: Draft) -> None:
        self._draft = draft
        self.entries: dict[str, PaletteReply] = {}

    def part(self, part: str, expression: str, code: str) -> PartMaterialReply:
        """What a part is made of.

        Args:
            code: the colour that its shapes have, which stands unless a near one was measured; with another one, and with "",
                the look's colour counts whatever was measured.
        """
        try:
            look = self._draft.palette.look(expression)
        except ProgramError:
            return PartMaterialReply(part=part)
        colour = look.colour if look.colour.startswith("#") else f"#{look.colour}"
        veto = "" if code and difference(code, colour.lstrip("#")) <= 1.0 else AS_DRAFTED
        family, options = _taken_apart(look.key)
        if family not in FAMILIES:
            return PartMaterialReply(part=part, material="", color=colour, veto=AS_DRAFTED, program=look.key)
        if look.key not in self.entries:
            base = self._draft.palette.named_as(look.key) or family
            taken = {e.name for e in self.entries.values()}
            name = next(n for k in range(1, 1000) if (n := base if k == 1 else f"{base} {k}") not in taken)
            self.entries[look.key] = PaletteReply(name=name, family=family, color=colour, options=options)
        name = self.entries[look.key].name
        return PartMaterialReply(part=part, material=name, color=colour if veto else "", veto=veto)


def _taken_apart(key: str) -> tuple[str, list[ParameterReply]]:
    """A look's family and its options; ("", []) where its colour is no plain one."""
    node = ast.parse(key, mode="eval").body
    if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
        return "", []
    plain = all(isinstance(a, ast.Constant) for a in node.args)
    options = [
        ParameterReply(name=str(k.arg), value=ast.unparse(k.value).strip("'\""))
        for k in node.keywords
        if k.arg not in ("color", "colour")
    ]
    return (node.func.id if plain else ""), options


def light_reply(draft: Draft) -> LightReply | None:
    """The answer to the question on the light; None where the draft says nothing of it."""
    said = draft.lighting
    if said is None and not draft.lamps:
        return None
    if said is None:
        return LightReply(
            lamps_on=[n for n in draft.lamps if n in draft.things], windows=[n for n in draft.lamps if n in draft.fixed]
        )
    return LightReply(
        style=said.style,
        sun_from=said.sun_from,
        windows=[draft.id_of(n) for n in said.windows],
        lamps_on=[draft.id_of(n) for n in said.lamps_on],
        warmth=said.warmth,
    )
