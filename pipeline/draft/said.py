# SPDX-License-Identifier: GPL-3.0-or-later
"""What a draft says so far: its lines, looks and programs, under ids of their own, and what became of each statement."""

from __future__ import annotations

from ..analysis.clean import clean_id
from ..artifacts.draft import DraftStatement
from ..objects.library import Made as Piece
from .looks import Palette
from .programs import Defs, Made
from .statements import Statement
from .things import Fixed, LightSaid, RoomSaid, Thing


class Said:
    """What a draft says so far.

    Attributes:
        room, fixed, things, lighting: its lines; things by id, in their order. finishes: looks by id, then by part or role.
        lamps: what light lines shine from.
        palette, defs: its looks and its programs. made: what the things are made of; pieces: the library's for others.
        problems: why a thing's own program could not be used. statements: what became of each.
        furnished: defs that furnish lines name, by the thing's id. ids: by what things are called in the draft; written: the
            other way round. of_def: place in `statements` of what became of each def.
    """

    def __init__(self) -> None:
        self.room: RoomSaid | None = None
        self.fixed: dict[str, Fixed] = {}
        self.things: dict[str, Thing] = {}
        self.lighting: LightSaid | None = None
        self.lamps: list[str] = []
        self.finishes: dict[str, dict[str, str]] = {}
        self.palette = Palette()
        self.defs = Defs(self.palette)
        self.made: dict[str, Made] = {}
        self.pieces: dict[str, Piece] = {}
        self.problems: dict[str, str] = {}
        self.statements: list[DraftStatement] = []
        self.ended = False
        self.outer: list[Fixed] = []
        self.furnished: dict[str, str] = {}
        self.ids: dict[str, str] = {}
        self.written: dict[str, list[str]] = {}
        self.taken: set[str] = set()
        self.of_def: dict[str, int] = {}

    def id_of(self, written: str) -> str:
        """What something is called that the draft calls so."""
        return self.ids.get(written, written)

    def def_of(self, thing: Thing, seen: frozenset[str] = frozenset()) -> str:
        """The name of the draft's def that makes a thing, "" for none."""
        for name in (self.furnished.get(thing.id), thing.id, *self.written.get(thing.id, [])):
            if name is not None and name in self.defs.defs:
                return name
        like = self.things.get(self.ids.get(thing.like, thing.like))
        if like is not None and like.id not in seen and like.id != thing.id:
            return self.def_of(like, seen | {thing.id})
        return thing.like if thing.like in self.defs.defs else ""

    def first_of(self, thing: Thing) -> str:
        """The id of the first thing that is made just like this one; its own where it is that."""
        name = self.def_of(thing)
        if not name or thing.colours:
            return thing.id
        return next((t.id for t in self.things.values() if not t.colours and self.def_of(t) == name), thing.id)

    def firsts(self) -> dict[str, str]:
        """`first_of` for all things."""
        found: dict[str, str] = {}
        by_def: dict[str, str] = {}
        for thing in self.things.values():
            name = "" if thing.colours else self.def_of(thing)
            found[thing.id] = by_def.setdefault(name, thing.id) if name else thing.id
        return found

    def new_id(self, written: str, fallback: str) -> str:
        """An id that nothing else has, for what the draft calls so."""
        name = clean_id(written, self.taken, fallback)
        if self.ids.setdefault(written, name) == name:
            self.written.setdefault(name, []).append(written)
        return name

    def note(self, statement: Statement, kind: str, identifier: str, verdict: str = "ok", sentence: str = "") -> None:
        """Say what became of a statement."""
        said = " ".join(sentence.split())[:300]
        entry = DraftStatement(
            kind=kind, id=identifier[:80], first=statement.first, last=statement.last, verdict=verdict, sentence=said
        )
        self.statements.append(entry)

    def judge_def(self, name: str, verdict: str, sentence: str = "") -> None:
        """Say what became of a def that was read before."""
        index = self.of_def.get(name)
        if index is not None:
            update = {"verdict": verdict, "sentence": " ".join(sentence.split())[:300]}
            self.statements[index] = self.statements[index].model_copy(update=update)
