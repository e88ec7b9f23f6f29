# SPDX-License-Identifier: GPL-3.0-or-later
"""A model's answer on materials: what of it can be used, and a sentence on what cannot."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from ..artifacts.analysis import Finding
from ..artifacts.materials import MaterialsReply, PaletteReply, PartMaterialReply
from ..artifacts.objects import ParameterReply
from ..errors import ProgramError
from ..objects.colours import clean_code
from ..objects.tinting import calm
from .choice import FAMILIES, Choice, look_of
from .difference import difference
from .parts import Cell
from .usual import by_name

_ALIASES = {"mirror": "mirror_glass", "painted": "painted_wood", "cotton": "linen", "wool": "fabric", "brass": "metal",
            "steel": "metal", "rattan": "wicker", "terracotta": "ceramic", "porcelain": "ceramic", "brick": "tile",
            "paint": "plaster", "emissive": "glow", "lampshade": "shade", "rug": "carpet"}  # fmt: skip
_ODD = 18.0
"""CIEDE2000 by which a material program may miss the measured colour without a reason."""
_NEAR = 6.0
"""CIEDE2000 within which the palette's colour stands for a measured one."""
_SAID = 2.0
"""CIEDE2000 within which a part has the very colour that the palette says."""


@dataclass
class Answered:
    """What a model answered, by object and part, and the room's palette.

    Attributes:
        findings: what could not be used; at most one sentence for each object.
        seen: the colour that the picture shows of an entry of the palette, six sRGB digits, by its name.
    """

    parts: dict[str, list[PartMaterialReply]] = field(default_factory=dict)
    palette: dict[str, PaletteReply] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    seen: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, replies: Sequence[MaterialsReply | None], known: Sequence[str]) -> Answered:
        """The replies put together. Objects that are not in the room are told of; the first answer on one counts."""
        found, strangers = cls(), []
        for reply in replies:
            if reply is None:
                continue
            for entry in reply.palette:
                found.palette.setdefault(entry.name.strip().lower(), entry)
            for thing in reply.objects:
                if thing.id not in known:
                    strangers.append(thing.id)
                else:
                    found.parts.setdefault(thing.id, list(thing.parts))
        if strangers:
            said = ", ".join(dict.fromkeys(strangers))[:200]
            found.tell("materials", f"The answer spoke of {said}, which is not in the room.")
        return found

    def tell(self, about: str, message: str) -> None:
        """A finding, unless there is one on the same thing."""
        if not any(f.about == about for f in self.findings):
            self.findings.append(Finding(about=about, message=message, severity="warning"))

    def check_parts(self, identifier: str, cells: Sequence[Cell]) -> None:
        """Tell of parts that an object has not."""
        names = {n for c in cells for n in (c.part, c.material, c.role)} | {"", "all"}
        odd = [p.part for p in self.parts.get(identifier, []) if p.part not in names]
        if odd:
            self.tell(identifier, f"The answer spoke of its {odd[0]!r}, which it has not.")

    def about(self, identifier: str, cell: Cell) -> PartMaterialReply | None:
        """What was said of a part: by its name, else by its material, else of the whole object."""
        said = self.parts.get(identifier, [])
        for name in (cell.part, cell.material, cell.role):
            found = next((p for p in said if name and p.part == name), None)
            if found is not None:
                return found
        return next((p for p in said if p.part in ("", "all")), None)

    def entry_of(self, identifier: str, cell: Cell) -> tuple[str, str]:
        """The name of the palette's entry that a part was said to be of, and its colour, six sRGB digits; "" for none."""
        said = self.about(identifier, cell)
        if said is None or said.veto.strip() or said.program.strip():
            return "", ""
        name = said.material.strip().lower()
        entry = self.palette.get(name)
        return name, clean_code(entry.color) if entry is not None else ""

    def choice(self, identifier: str, cell: Cell, category: str, fallback: Choice) -> Choice:
        """What a part is made of by the answer, or the fallback with a finding; its colour stays unless vetoed."""
        said = self.about(identifier, cell)
        if said is None:
            return self._as_the_rest(fallback)
        entry = self.palette.get(said.material.strip().lower())
        family = family_of(entry.family if entry is not None else said.material)
        fixed = by_name(cell, category)
        if (fixed and family != fixed) or (family in ("shade", "glow") and fallback.family == "linen"):
            return fallback
        code = self._colour(identifier, said, entry, fallback, family)
        if said.program.strip() and not fixed:
            made = self._program(identifier, cell, said, code)
            if made is not None:
                return made
        if not family:
            if said.material.strip():
                self.tell(
                    identifier, f"{said.material.strip()[:40]!r} is no material that is known; it has the usual one."
                )
            return replace(fallback, code=code) if said.veto.strip() else fallback
        options = self._options(identifier, family, code, [*(entry.options if entry else []), *said.options])
        word = said.material.strip().lower() if entry is not None else fallback.word
        return Choice(
            family, code, options, word=word, why=said.veto.strip()[:120] or "as the model saw it", source="model"
        )

    def _as_the_rest(self, fallback: Choice) -> Choice:
        """A part that nothing was said of, in the palette's manner where it is of one of its materials."""
        entry = self.palette.get(fallback.word)
        if entry is None or family_of(entry.family) != fallback.family:
            return fallback
        return replace(fallback, options=self._options("materials", fallback.family, fallback.code, entry.options))

    def _colour(
        self, identifier: str, said: PartMaterialReply, entry: PaletteReply | None, fallback: Choice, family: str
    ) -> str:
        written = clean_code(said.color)
        if said.color.strip() and not written:
            self.tell(identifier, f"{said.color.strip()[:30]!r} is no colour; the measured one stands.")
        if said.veto.strip() and written:
            return calm(written)
        shared = clean_code(entry.color) if entry is not None else ""
        if shared and said.veto.strip():
            return calm(shared)
        seen = self.seen.get(said.material.strip().lower(), shared)
        # What the picture does not show has the colour that was said.
        if shared and (difference(seen, fallback.code) < _NEAR or difference(shared, fallback.code) < _SAID):
            return calm(seen)
        if fallback.source == "usual" and (written or shared):
            # Nothing was measured of it: the model's word is better than what such things usually are.
            return calm(written or shared)
        if fallback.family in ("glass", "mirror_glass") and family != fallback.family and written:
            return calm(written)
        return fallback.code

    def _options(
        self, identifier: str, family: str, code: str, given: Sequence[ParameterReply]
    ) -> tuple[tuple[str, str], ...]:
        """The parameters that the family has, each tried by itself."""
        found: dict[str, str] = {}
        for option in given:
            name, value = option.name.strip(), option.value.strip().strip("'\"")
            if name in ("color", "colour", ""):
                continue
            bare = re.fullmatch(r"#?[0-9A-Fa-f]{6}", value)
            plain = re.fullmatch(r"-?\d*\.?\d+|True|False|\([\d., ]+\)", value)
            written = (
                f'"#{value.lstrip("#").upper()}"' if bare and not value.isdigit() else value if plain else f'"{value}"'
            )
            try:
                look_of(Choice(family, code, ((name, written),)).expression)
                found[name] = written
            except ProgramError:
                self.tell(identifier, f"{family} has no {name[:30]} of {value[:30]!r}; that was left out.")
        return tuple(sorted(found.items()))

    def _program(self, identifier: str, cell: Cell, said: PartMaterialReply, code: str) -> Choice | None:
        part = cell.part or cell.role or "surface"
        try:
            look = look_of(said.program)
        except ProgramError as error:
            reason = str(error)[:200].rstrip(".")
            self.tell(identifier, f"The material program for its {part} could not be used ({reason}).")
            return None
        if "picture(" in look.key:
            self.tell(identifier, f"The material program for its {part} shows an image that is not there.")
            return None
        mean = look.colour.lstrip("#")
        if not said.veto.strip() and difference(mean, code) > _ODD:
            self.tell(identifier, f"The material program for its {part} is #{mean}, but the picture shows #{code}.")
            return None
        if look.name != "principled":
            return Choice(look.name, mean, program=look.key, why="as the model saw it", source="model")
        return Choice("principled", mean, program=look.key, word=f"{cell.part or cell.role}_look",
                      why="a material program of its own", source="model")  # fmt: skip


def family_of(text: str) -> str:
    """The family that a model means, "" for none."""
    name = re.sub(r"[\s-]+", "_", text.strip().lower())
    name = _ALIASES.get(name, name)
    if name in FAMILIES:
        return name
    return next((f for f in (_ALIASES.get(w, w) for w in reversed(name.split("_"))) if f in FAMILIES), "")
