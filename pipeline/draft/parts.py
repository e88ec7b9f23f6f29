# SPDX-License-Identifier: GPL-3.0-or-later
"""A draft's room in parts, each made once: what another statement costs is its own part, not the room again.

The text is put together from the parts' texts; what it means, `record.py` makes of the parts' shapes.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..artifacts.layout import CameraLine, Layout, Line, ProxyLine
from ..errors import RoomError
from ..objects.cloths import furnish_line, is_lying_cloth
from ..objects.text import compose, function_name, read_modelling
from ..program.finishes import Materials, present_names
from ..program.lines import print_layout, print_line
from ..program.prelude.looks import Look
from ..program.prelude.registry import RESERVED
from ..program.prelude.shape import Shape
from .layout import names_in, parents_of, proxy_line, shell_of
from .reading import Draft
from .things import RoomSaid, Thing


@dataclass
class Part:
    """One thing in a room.

    Attributes:
        source: what it was made of; a part of the same source is the same. line, said: its line, and that as printed.
        statement: what furnishes it, "" for a box; lying: whether as a cloth that lies.
        function: name of the def that it is furnished with, "" for a box. defs: that and what it uses. others: statements
            that these need. shapes: what they make, worked out when somebody asks for them.
    """

    source: tuple[Any, ...]
    line: ProxyLine
    said: str
    statement: str = ""
    lying: bool = False
    function: str = ""
    defs: Mapping[str, str] = field(default_factory=dict)
    others: tuple[str, ...] = ()
    roles: frozenset[str] = frozenset()
    shapes: list[Shape] | None = None

    def is_of(self, source: tuple[Any, ...]) -> bool:
        """Whether it is made of just this."""
        return len(source) == len(self.source) and all(
            a is b or (isinstance(a, str | bool) and a == b) for a, b in zip(source, self.source, strict=True)
        )


@dataclass
class Composed:
    """A room put together.

    Attributes:
        text: without what it says of materials. looks: those that have names in it.
        is_plain: whether the parts' shapes are what the text means: each def has one text, and uses defs only.
    """

    text: str
    layout: Layout
    parts: dict[str, Part]
    materials: Materials
    looks: dict[str, Look]
    is_plain: bool


class RoomParts:
    """The parts of one draft's room, kept for as long as what they were made of stays.

    Attributes:
        made: ids of the things whose parts were made for the last room, all others were known.
    """

    def __init__(self) -> None:
        self._parts: dict[str, Part] = {}
        self._shell: tuple[tuple[Any, ...], Layout] | None = None
        self._said: dict[int, tuple[Line, str]] = {}
        self.made: list[str] = []

    def composed(
        self,
        draft: Draft,
        room: RoomSaid,
        camera: CameraLine | None = None,
        left_out: Collection[str] = (),
        looks: bool = True,
    ) -> Composed:
        """The room as the draft has it by now.

        Args:
            left_out: things that stay boxes. looks: whether it says what things look like.
        """
        layout, parts = self._laid_out(draft, room, camera, left_out)
        defs: dict[str, str] = {}
        is_plain = True
        for part in parts.values():
            is_plain &= not part.others and all(defs.get(name, text) == text for name, text in part.defs.items())
            defs.update(part.defs)
        furnished = {i: part.statement for i, part in parts.items() if part.function}
        others = list(dict.fromkeys(o for p in parts.values() for o in p.others))
        text = compose(layout, defs, furnished, others, print_layout(layout, self._printed))
        materials, named = (Materials(), {}) if not looks else _named_looks(draft, layout, parts, text)
        return Composed(text, layout, parts, materials, named, is_plain)

    def _laid_out(
        self, draft: Draft, room: RoomSaid, camera: CameraLine | None, left_out: Collection[str]
    ) -> tuple[Layout, dict[str, Part]]:
        shell = self._shell_of(draft, room)
        taken = names_in(shell)
        things = [thing for thing in draft.things.values() if thing.id not in taken]
        parents = parents_of(things, taken)
        self.made, former, firsts = [], self._parts, draft.firsts()
        self._parts = {}
        for thing in things:
            first = firsts[thing.id]
            like = first if {first, thing.id} <= draft.made.keys() and first not in left_out else thing.id
            source = (thing, parents[thing.id] or "", thing.id in left_out, like, *_made_of(draft, thing, like))
            part = former.get(thing.id)
            if part is None or not part.is_of(source):
                self.made.append(thing.id)
                part = _part(draft, source)
            self._parts[thing.id] = part
        proxies = [part.line for part in self._parts.values()]
        lines = {"proxies": proxies, "cameras": [camera] if camera else []}
        self._said = {id(part.line): (part.line, part.said) for part in self._parts.values()}
        return shell.model_copy(update=lines), self._parts

    def _shell_of(self, draft: Draft, room: RoomSaid) -> Layout:
        key = (room, *draft.fixed.values())
        if self._shell is None or self._shell[0] != key:
            self._shell = key, shell_of(room, draft.fixed.values())
        return self._shell[1]

    def _printed(self, line: Line) -> str:
        known = self._said.get(id(line))
        return known[1] if known is not None else print_line(line)


def _made_of(draft: Draft, thing: Thing, like: str) -> tuple[Any, ...]:
    return draft.made.get(thing.id), draft.made.get(like), draft.pieces.get(thing.id)


def _part(draft: Draft, source: tuple[Any, ...]) -> Part:
    """The part of a thing, of what `RoomParts` compares it by."""
    thing, parent, is_box, like, made, alike, piece = source
    line = proxy_line(thing).model_copy(update={"parent": parent or None})
    part = Part(source, line, print_line(line))
    if is_box:
        return part
    name = function_name(like, ())
    if made is not None:
        code = read_modelling(alike.written.code)
        part.function, part.defs, part.others = name, code.defs, tuple(code.others)
        part.roles = frozenset(shape.material for shape in made.written.shapes)
        if draft.things[like].size == thing.size:
            part.shapes = list(alike.written.shapes)
    elif piece is not None:
        part.function = name
        part.defs = {name: piece.text(name, thing.label or thing.category.replace("_", " "))}
    if part.function:
        part.statement, part.lying = furnish_line(line, part.function), is_lying_cloth(line)
    return part


def _named_looks(
    draft: Draft, layout: Layout, parts: Mapping[str, Part], text: str
) -> tuple[Materials, dict[str, Look]]:
    """The draft's looks under names that mean nothing else in the text, and what has them."""
    found = Materials()
    names: dict[str, str] = {}
    looks: dict[str, Look] = {}

    def named(expression: str) -> str:
        look = draft.palette.look(expression)
        if look.key not in names:
            base = draft.palette.named_as(look.key) or look.key.partition("(")[0]
            name, number = base, 1
            while name in RESERVED or name in looks or _has_word(text, name):
                number += 1
                name = f"{base}_{number}" if number > 2 or base not in RESERVED else f"{base}_1"
            names[look.key], looks[name] = name, look
        return names[look.key]

    try:
        for identifier, part in parts.items():
            if not part.function or identifier not in draft.made:
                continue
            pairs = {m: named(e) for m, e in draft.palette.roles.items() if m in part.roles}
            said = {key: named(e) for key, e in draft.finishes.get(identifier, {}).items()}
            if pairs or said:
                found.finishes[identifier] = {**pairs, **said}
        present = present_names(layout)
        for identifier, by_part in draft.finishes.items():
            if identifier in present and identifier not in found.finishes and identifier not in draft.things:
                found.finishes[identifier] = {key: named(e) for key, e in by_part.items()}
    except RoomError:
        return Materials(), {}
    found.looks = {name: key for key, name in names.items()}
    return found, looks


def _has_word(text: str, word: str) -> bool:
    return word in text and re.search(rf"(?<!\w){re.escape(word)}(?!\w)", text) is not None
