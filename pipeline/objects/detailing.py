# SPDX-License-Identifier: GPL-3.0-or-later
"""The room's objects while they are being modelled: what each is made of so far, and the room's text of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..artifacts.analysis import Finding
from ..artifacts.layout import Layout, ProxyLine
from ..artifacts.objects import (
    Descriptions,
    Geometry,
    ObjectDescription,
    ObjectProgram,
    OwnModelling,
    PieceReply,
    RoomStyle,
)
from ..errors import ProgramError
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout
from .alike import alike, groups
from .cloths import furnish_line
from .library import PLAIN, Made, asked_piece, best_piece, def_of, shapes_of, tinted
from .lying_on import covers_of
from .text import Modelling, compose, function_name, read_modelling
from .tinting import seen_from_above, tints_for
from .twins import codes_of, other_colours, twin_tints
from .written import Written


@dataclass
class Detailing:
    """Objects on their way from proxies to geometry.

    Attributes:
        layout: where everything stands; never changed here.
        todo: the objects that are modelled now; of those that are alike only the first.
        members: first of each group -> all of it.
        library: id of the first -> its library piece. written: the same for programs of the model.
        names: id of the first -> name of its def; the same for those that may be of another colour than their first.
        standing: what the room text of before says; kept: ids that stay as they are in it.
        own: what the artist says.
    """

    layout: Layout
    descriptions: Descriptions
    style: RoomStyle
    todo: list[ProxyLine]
    members: dict[str, list[str]]
    names: dict[str, str]
    standing: Modelling
    kept: frozenset[str]
    own: OwnModelling
    before: Geometry
    library: dict[str, Made] = field(default_factory=dict)
    written: dict[str, Written] = field(default_factory=dict)
    notes: dict[str, str] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)

    @staticmethod
    def begin(
        layout: Layout,
        descriptions: Descriptions,
        style: RoomStyle,
        standing: str,
        before: Geometry,
        own: OwnModelling,
        keep: frozenset[str],
        twins: Mapping[str, str] | None = None,
    ) -> Detailing:
        """Sort out what is to be modelled.

        Args:
            standing: the room text that this stage wrote the last time, "" for none.
            keep: ids that stay as they stand there; what is not furnished there is modelled nevertheless.
            twins: id of each thing that is made like another -> id of that one, where that is known; None where sizes and
                colours say it.
        """
        former = _read(standing)
        present = [p.id for p in layout.proxies]
        apart = {i for i in present if i in own.functions or i in own.boxes}
        kept = frozenset(i for i in present if i in keep and i in former.furnished and i not in apart)
        todo = [p for p in layout.proxies if p.id not in apart and p.id not in kept]
        members = groups(alike(todo, descriptions) if twins is None else _by_twins(todo, twins))
        firsts = [p for p in todo if p.id in members]
        taken = {n for i in kept for n in former.closure([former.functions.get(i, "")])}
        for snippet in own.functions.values():
            taken |= set(_read(snippet).defs)
        names: dict[str, str] = {}
        for proxy in firsts:
            names[proxy.id] = function_name(proxy.id, {*taken, *names.values()})
        for first, group in members.items() if twins is None else ():
            for other in (i for i in group if other_colours(descriptions.of(first), descriptions.of(i))):
                names[other] = function_name(other, {*taken, *names.values()})
        return Detailing(layout, descriptions, style, firsts, members, names, former, kept, own, before)

    def described(self, identifier: str) -> ObjectDescription:
        """What is known of how an object looks."""
        return self.descriptions.of(identifier)

    def from_library(self) -> None:
        """Give every object its library piece; nothing is asked."""
        for proxy in self.todo:
            if proxy.id not in self.library:
                covers = covers_of(proxy, self.layout)
                self.library[proxy.id] = best_piece(proxy, self.described(proxy.id), self._carried(proxy.id), covers)

    def leave(self, first: str) -> bool:
        """Let an object, and those that are made like it, stay as they stand; False where they do not stand yet."""
        group = self.members.get(first, [first])
        if any(i not in self.standing.furnished for i in group):
            return False
        self.todo = [proxy for proxy in self.todo if proxy.id != first]
        self.kept |= frozenset(group)
        for kept in (self.members, self.library, self.written, self.notes):
            kept.pop(first, None)
        return True

    def take_pieces(self, replies: list[PieceReply]) -> None:
        """Take over what a model chose from the library, where that can be made."""
        wanted = {reply.id: reply for reply in replies}
        for proxy in self.todo:
            reply = wanted.get(proxy.id)
            if reply is None or not reply.piece.strip():
                continue
            made = asked_piece(proxy, self.described(proxy.id), reply, covers_of(proxy, self.layout))
            if made is None:
                self.notes[proxy.id] = f"The model chose {reply.piece.strip()[:60]!r}, which the library does not have."
            else:
                self.library[proxy.id] = made

    def _carried(self, identifier: str) -> tuple[str, ...]:
        return tuple(p.category.lower() for p in self.layout.proxies if p.parent == identifier)

    def text(self) -> str:
        """The room's text with everything that is modelled by now."""
        defs: dict[str, str] = {}
        statements: dict[str, str] = {}
        for name in self.standing.defs:
            if name in self.standing.closure(self.standing.functions.get(i, "") for i in self.kept):
                defs[name] = self.standing.defs[name]
        for identifier in self.kept:
            statements[identifier] = self.standing.furnished[identifier]
        for identifier, snippet in self.own.functions.items():
            own = _read(snippet)
            defs |= own.defs
            if identifier in own.furnished and identifier not in self.own.boxes:
                statements[identifier] = own.furnished[identifier]
        for proxy in self.todo:
            name = self.names[proxy.id]
            if proxy.id in self.written:
                for helper, code in _read(self.written[proxy.id].code).defs.items():
                    defs[helper] = code
            elif proxy.id in self.library:
                defs[name] = self.library[proxy.id].text(name, proxy.label or proxy.category.replace("_", " "))
            else:
                continue
            for member in self.members[proxy.id]:
                like = self.layout.proxy(member) or proxy
                twin = self._in_own_colours(proxy, like)
                if twin:
                    defs[self.names[member]] = twin
                statements[member] = furnish_line(like, self.names[member] if twin else name)
        others = [o for snippet in self.own.functions.values() for o in _read(snippet).others]
        others += [o for w in self.written.values() for o in _read(w.code).others]
        if self.kept:
            others += self.standing.others
        ordered = {p.id: statements[p.id] for p in self.layout.proxies if p.id in statements}
        return compose(self.layout, defs, ordered, list(dict.fromkeys(others)))

    def _in_own_colours(self, first: ProxyLine, proxy: ProxyLine) -> str:
        """The def of an object that is made as the first of its kind in other colours, "" where they are the same."""
        if proxy.id == first.id or proxy.id not in self.names:
            return ""
        own, of_kind = self.described(proxy.id), self.described(first.id)
        if first.id in self.written:
            shapes, tints = list(self.written[first.id].shapes), {}
        else:
            made = self.library[first.id]
            shapes, tints = shapes_of(made.choice, first.size), dict(made.tints)
        tints = twin_tints(codes_of(shapes, tints), of_kind, own) or tints_for(seen_from_above(shapes), own)
        title = proxy.label or proxy.category.replace("_", " ")
        return def_of(self.names[proxy.id], tinted(f"{self.names[first.id]}(size)", tints), title) if tints else ""

    def sound_text(self) -> str:
        """As `text`, after everything that cannot be evaluated in the whole room gave way to the library, then to boxes."""
        text = self.text()
        for _ in range(3):
            try:
                evaluate(text, FINISHED_ROOM_LIMITS)
                parse_layout(text)
                return text
            except ProgramError as error:
                message = str(error)[:200]
            if self.written:
                for identifier in self.written:
                    self.notes[identifier] = f"Together with the others its program failed: {message}"
                self.written.clear()
            elif self.own.functions:
                self.findings.append(
                    Finding(about="own functions", message=f"They could not be kept: {message}", severity="error")
                )
                self.own = OwnModelling(boxes=[*self.own.boxes, *self.own.functions])
            else:
                self.findings.append(Finding(about="objects", message=f"Only boxes: {message}", severity="error"))
                self.library.clear()
            text = self.text()
        return text

    def geometry(self) -> Geometry:
        """Who modelled what, in the layout's order."""
        firsts = {member: first for first, members in self.members.items() for member in members}
        objects = []
        for proxy in self.layout.proxies:
            former = self.before.of(proxy.id)
            if proxy.id in self.own.boxes:
                objects.append(ObjectProgram(id=proxy.id, source="proxy", note="shown as a box by you"))
            elif proxy.id in self.own.functions:
                name = _read(self.own.functions[proxy.id]).functions.get(proxy.id, "")
                objects.append(ObjectProgram(id=proxy.id, source="artist", function=name))
            elif proxy.id in self.kept:
                name = self.standing.functions.get(proxy.id, "")
                objects.append(former or ObjectProgram(id=proxy.id, source="artist", function=name))
            else:
                objects.append(self._program(proxy.id, firsts.get(proxy.id, proxy.id)))
        return Geometry(objects=objects, findings=[*self.findings, *self._fallbacks()])

    def _program(self, identifier: str, first: str) -> ObjectProgram:
        like = first if first != identifier else ""
        name, note = self._def_name(identifier, first), self.notes.get(first, "")
        if first in self.written:
            return ObjectProgram(id=identifier, function=name, source="program", like=like, note=note)
        made = self.library.get(first)
        if made is None:
            return ObjectProgram(id=identifier, source="proxy", like=like, note=note or "It could not be modelled.")
        parameters = {key: str(value) for key, value in made.choice.parameters.items()}
        return ObjectProgram(
            id=identifier,
            function=name,
            source="library",
            like=like,
            piece=made.choice.piece.name,
            parameters=parameters,
            note=note or made.note,
        )

    def _def_name(self, identifier: str, first: str) -> str:
        line, of_kind = self.layout.proxy(identifier), self.layout.proxy(first)
        modelled = first in self.written or first in self.library
        if modelled and line is not None and of_kind is not None and self._in_own_colours(of_kind, line):
            return self.names[identifier]
        return self.names.get(first, "")

    def _fallbacks(self) -> list[Finding]:
        found = [Finding(about=i, message=note) for i, note in self.notes.items() if note]
        found += [
            Finding(about=i, message=made.note, severity="warning" if made.choice.piece.name == PLAIN else "note")
            for i, made in self.library.items()
            if made.note and i not in self.notes and i not in self.written
        ]
        return found


def _by_twins(proxies: Sequence[ProxyLine], twins: Mapping[str, str]) -> dict[str, str]:
    """The first of each thing's kind: the one that it is said to be like, where that is among them."""
    found: dict[str, str] = {}
    for proxy in proxies:
        wanted = twins.get(proxy.id, proxy.id)
        there = next((p.id for p in proxies if twins.get(p.id, p.id) == wanted), proxy.id)
        found[proxy.id] = there
    return found


def _read(text: str) -> Modelling:
    try:
        return read_modelling(text) if text.strip() else Modelling()
    except ProgramError:
        return Modelling()
