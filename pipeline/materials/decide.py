# SPDX-License-Identifier: GPL-3.0-or-later
"""What every part of a room is made of: all that is known of it, put together into named looks and finishes."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ..artifacts.layout import Layout
from ..artifacts.materials import Materials, ObjectMaterials, PartMaterial
from ..artifacts.objects import Descriptions, ObjectDescription
from ..objects.lying_on import covers_of
from ..program import finishes
from ..program.prelude.palette import category_family
from ..program.prelude.recorder import SURFACES
from ..program.prelude.shape import Shape
from .answered import Answered
from .choice import Choice
from .colours import part_colours, uncovered
from .difference import difference
from .parts import Cell, cells_of
from .sameness import Sight, seen_colour
from .sharing import finish_of, merged, named
from .usual import usual

_ALIKE = 12.0
"""CIEDE2000 within which things of one function have one colour: they were bought as a pair."""


@dataclass
class Deciding:
    """A room on its way to its materials.

    Attributes:
        cells: the parts of each object, surfaces under their own names; choices: what each of them is made of.
        answered: what the model said; empty without an answer.
        measured: of each object, the colours that the picture has for its materials.
    """

    layout: Layout
    cells: dict[str, list[Cell]]
    choices: dict[str, list[Choice]]
    answered: Answered = field(default_factory=Answered)
    measured: dict[str, dict[str, str]] = field(default_factory=dict)

    @classmethod
    def begin(
        cls,
        layout: Layout,
        shapes: Mapping[str, Sequence[Shape]],
        descriptions: Descriptions,
        functions: Mapping[str, str],
        shell: Mapping[str, Choice],
    ) -> Deciding:
        """Everything decided without an answer.

        Args:
            shapes: the parts of each object in its own frame. functions: the def that each object is made by.
            shell: what the room's surfaces are made of.
        """
        alike = _alike(layout, descriptions, functions)
        cells: dict[str, list[Cell]] = {name: [Cell("", name, 1.0)] for name in shell}
        choices = {name: [choice] for name, choice in shell.items()}
        measured: dict[str, dict[str, str]] = {}
        weighed: dict[tuple[bool, tuple[int, ...]], list[Cell]] = {}
        for proxy in layout.proxies:
            made = shapes.get(proxy.id)
            if not made:
                continue
            # Things that are alike share their shapes.
            key = proxy.placement == "wall", tuple(id(shape) for shape in made)
            if key not in weighed:
                weighed[key] = cells_of(made, proxy.placement == "wall")
            cells[proxy.id] = list(weighed[key])
            described = alike[proxy.id]
            shown = uncovered(cells[proxy.id], made, covers_of(proxy, layout))
            colours = measured[proxy.id] = part_colours(shown, described)
            family = category_family(proxy.category)
            choices[proxy.id] = [
                usual(cell, described, proxy.category, family, colours.get(cell.material, cell.code))
                for cell in cells[proxy.id]
            ]
        return cls(layout, cells, choices, measured=measured)

    def take(self, answered: Answered) -> None:
        """Let a model's answer decide where it can be used."""
        self.answered = answered
        answered.seen = {name: seen_colour(*of) for name, of in self._sights(answered).items()}
        fittings = [name for name in SURFACES if name in answered.parts and name not in self.cells]
        present = fittings_of(self.layout)
        for name in [*fittings, *(i for i in answered.parts if i in present and i not in self.cells)]:
            self.cells[name] = [Cell("", name, 0.2)]
            self.choices[name] = [Choice("painted_wood", "F2EFEA", source="usual", why="what fittings usually are")]
        for name, cells in self.cells.items():
            proxy = self.layout.proxy(name)
            answered.check_parts(name, cells)
            self.choices[name] = [
                answered.choice(name, cell, proxy.category if proxy is not None else "", choice)
                for cell, choice in zip(cells, self.choices[name], strict=True)
            ]

    def _sights(self, answered: Answered) -> dict[str, tuple[str, list[Sight]]]:
        """Of each material of the palette its colour, and what was measured of the parts that are of it."""
        found: dict[str, tuple[str, list[Sight]]] = {}
        for proxy in self.layout.proxies:
            known = self.measured.get(proxy.id, {})
            for cell in self.cells.get(proxy.id, ()):
                name, said = answered.entry_of(proxy.id, cell)
                if said and cell.material in known:
                    weight = proxy.size[0] * proxy.size[1] * cell.share
                    found.setdefault(name, (said, []))[1].append(Sight(known[cell.material], weight))
        return found

    def _role(self, name: str) -> str:
        """Which part of a surface its look is for: windows keep their glass, and doors their handles."""
        if name == "windows" or name in _ids(self.layout.windows):
            return "frame"
        return "door" if name == "doors" or name in _ids(self.layout.doors) else ""

    def written(self, text: str, kept: finishes.Materials, before: Materials) -> tuple[finishes.Materials, Materials]:
        """The looks and finishes for the room's text, and what the artifact says of them.

        Args:
            kept: finishes that stay as they are, with the looks that they name. before: what the last run wrote.
        """
        weights = {p.id: (p.size[0] * p.size[1] + p.size[0] * p.size[2]) for p in self.layout.proxies}
        todo = [name for name in self.cells if name not in kept.finishes]
        wanted = [
            (choice, weights.get(name, 4.0) * (cell.share + 0.02))
            for name in todo
            for cell, choice in zip(self.cells[name], self.choices[name], strict=True)
        ]
        # Why and by whom a look was chosen does not make it another look.
        shared = merged([(_bare(choice), weight) for choice, weight in wanted])
        looks = {name: [shared[_bare(c)] for c in self.choices[name]] for name in todo}
        bound = set(re.findall(r"[A-Za-z_]\w*", text)) - set(before.looks)
        names = named((look for name in todo for look in looks[name]), bound | set(kept.looks), before.looks)
        found = finishes.Materials(dict(kept.looks))
        objects = []
        for name, cells in self.cells.items():
            if name in kept.finishes:
                found.finishes[name] = kept.finishes[name]
                objects.append(_kept(name, kept, before))
                continue
            own = [names[look.expression] for look in looks[name]]
            found.finishes[name] = (
                finish_of(cells, own) if self.layout.proxy(name) is not None else {self._role(name): own[0]}
            )
            parts = [
                PartMaterial(
                    part=c.part, role=c.role, look=look, colour=shown.code, why=choice.why, source=choice.source
                )
                for c, look, shown, choice in zip(cells, own, looks[name], self.choices[name], strict=True)
            ]
            objects.append(ObjectMaterials(id=name, parts=parts))
        used = {look for finish in found.finishes.values() for look in finish.values()}
        found.looks |= {name: expression for expression, name in names.items() if name in used}
        for name, finish in kept.finishes.items():
            found.finishes.setdefault(name, finish)
        # What the artist wrote is not ours, or the next run would take it for a decision of this one.
        ours = {n: f for n, f in found.finishes.items() if n not in kept.finishes or before.finishes.get(n) == f}
        as_made = {
            n: before.looks.get(n, e) for n, e in found.looks.items() if n not in kept.looks or n in before.looks
        }
        return found, Materials(objects=objects, looks=as_made, finishes=ours, findings=self.answered.findings)


def _ids(lines: Iterable[Any]) -> set[str]:
    return {line.id for line in lines}


def fittings_of(layout: Layout) -> set[str]:
    """Ids of walls, doors and windows, which may have a finish of their own."""
    ids = [line.id for line in layout.walls]
    return {*ids, *(line.id for line in layout.doors), *(line.id for line in layout.windows)}


def _bare(choice: Choice) -> Choice:
    return replace(choice, why="", source="measured")


def _kept(name: str, kept: finishes.Materials, before: Materials) -> ObjectMaterials:
    """What is said of something that stays as it is: what was said before, unless the artist changed it."""
    finish, former = kept.finishes[name], before.of(name)
    changed = any(before.looks.get(look) != kept.looks[look] for look in finish.values() if look in kept.looks)
    if former is not None and before.finishes.get(name) == finish and not changed:
        return former
    parts = [PartMaterial(role=key, look=look, why="as you wrote it", source="artist") for key, look in finish.items()]
    return ObjectMaterials(id=name, parts=parts)


def _alike(layout: Layout, descriptions: Descriptions, functions: Mapping[str, str]) -> dict[str, ObjectDescription]:
    """Descriptions by id; of things that one def makes in nearly one colour, that of the one that is seen best."""
    found = {p.id: descriptions.of(p.id) for p in layout.proxies}
    best: dict[str, ObjectDescription] = {}
    for identifier, described in sorted(found.items(), key=lambda item: -item[1].seen):
        name = functions.get(identifier)
        if name is None:
            continue
        first = best.setdefault(name, described)
        known = first.measured and described.measured
        if known and difference(first.measured[0].code, described.measured[0].code) > _ALIKE:
            continue
        found[identifier] = first.model_copy(update={"id": identifier})
    return found


def kept_finishes(
    text: str, before: Materials | None, present: Collection[str], held: Collection[str]
) -> finishes.Materials:
    """Finishes of a text that stay: those that the artist wrote or changed, and those of what is held.

    Args:
        before: what the stage wrote the last time, None when it never did. present: what the room has by now.
    """
    standing = finishes.read_materials(text)
    wrote = before or Materials()
    found = finishes.Materials()
    for name, finish in standing.finishes.items():
        if name in present and (name in held or wrote.finishes.get(name) != finish):
            found.finishes[name] = finish
    expressions = [e for finish in found.finishes.values() for e in finish.values()]
    used = {word for e in expressions for word in re.findall(r"[A-Za-z_]\w*", e)}
    # A look that the artist changed keeps its name and what it means for all that have it.
    changed = {n for n, e in standing.looks.items() if before is not None and wrote.looks.get(n, e) != e}
    for name, finish in standing.finishes.items():
        if name in present and changed & set(finish.values()):
            found.finishes[name] = finish
            used |= set(finish.values())
    found.looks = {n: e for n, e in standing.looks.items() if n in used or n in changed}
    return found
