# SPDX-License-Identifier: GPL-3.0-or-later
"""A draft while it is read: each statement is judged alone, and what cannot be used costs only itself."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

from ..analysis.clean import SIDE_NAMES, clean_id
from ..artifacts.draft import DraftStatement
from ..artifacts.layout import ProxyLine
from ..artifacts.objects import ObjectDescription
from ..errors import ProgramError, RoomError
from ..objects.library import Made as Piece
from ..objects.library import best_piece
from ..objects.mending import mended
from ..objects.text import function_name
from ..program.evaluate import Evaluation
from ..program.limits import DEFAULT_LIMITS
from ..program.parse_safe import parse
from ..program.prelude.recorder import SURFACES
from ..program.prelude.registry import RESERVED
from ..program.vocabulary import room_vocabulary
from .calls import Call, Ref, calls_of, has_lines
from .looks import FAMILIES, Palette
from .programs import Defs, Made, make, piece_program, tinted
from .statements import Statement, is_prose
from .things import Arguments, Fixed, LightSaid, RoomSaid, Thing, read_fixed, read_light, read_room, read_thing

MOST_THINGS = 300
MOST_STATEMENTS = 2000
CUT = "The answer ended in the middle of it."
_ORDERS = {
    "room": ("size", "floor", "seen", "top"),
    "wall": ("id", "start", "end", "height", "thickness"),
    "door": ("id", "wall", "start", "end", "height"),
    "window": ("id", "wall", "start", "end", "sill", "height"),
    "opening": ("id", "wall", "start", "end", "sill", "height"),
    "proxy": ("id", "category", "at", "size", "yaw"),
    "lighting": ("style", "sun_from"),
}
_WORKED_OUT = frozenset({"light", "world", "view", "camera"})
"""Lines that the picture decides later."""


class Draft:
    """What a draft says so far.

    Attributes:
        room, fixed, things, lighting: its lines; things by id, in their order. finishes: looks by id, then by part or role.
        lamps: what light lines shine from.
        palette, defs: its looks and its programs. made: what the things are made of; pieces: the library's for others.
        problems: why a thing's own program could not be used. statements: what became of each.
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
        self._furnished: dict[str, str] = {}
        self._ids: dict[str, str] = {}
        self._taken: set[str] = set()
        self._of_def: dict[str, int] = {}
        self._waiting: dict[str, dict[str, str]] = {}

    # ---- one statement ----

    def take(self, statement: Statement) -> bool:
        """Read one statement; whether the room has changed by it. Nothing is raised."""
        if len(self.statements) >= MOST_STATEMENTS:
            return False
        before = len(self.statements)
        try:
            return self._take(statement)
        except RoomError as error:
            message = CUT if statement.cut else f"{error.message} {error.fix}".strip()
            self._note(statement, _kind(statement.text), _word_of(statement.text), "refused", message)
        except (ValueError, TypeError, ArithmeticError, LookupError, RecursionError, AttributeError) as error:
            words = f"It could not be read ({type(error).__name__})."
            self._note(statement, _kind(statement.text), _word_of(statement.text), "refused", words)
        return len(self.statements) == before

    def _take(self, statement: Statement) -> bool:
        try:
            tree = parse(statement.text, DEFAULT_LIMITS)
        except ProgramError:
            if is_prose(statement.text):
                return False
            raise
        changed = False
        for node in tree.body:
            changed |= self._node(node, statement)
        return changed

    def _node(self, node: ast.stmt, statement: Statement) -> bool:
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            self._note(statement, "import", "", "mended", "Imports are not needed.")
            return False
        if isinstance(node, ast.Pass) or (
            isinstance(node, ast.Expr) and isinstance(node.value, (ast.Constant, ast.Name))
        ):
            return False
        text = _text_of(node, statement.text)
        if isinstance(node, ast.FunctionDef):
            return self._def(node, text, statement)
        if isinstance(node, ast.AnnAssign) and node.value is not None:
            node = ast.copy_location(ast.Assign([node.target], node.value), node)
            text = ast.unparse(ast.fix_missing_locations(node))
        if isinstance(node, ast.Assign):
            return self._value(node, text, statement)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Tuple) and len(node.value.elts) == 1:
            node = ast.copy_location(ast.Expr(node.value.elts[0]), node)
        if has_lines(node):
            return self._lines(node, statement)
        raise ProgramError("This is no line of a room, no look, no number and no def.")

    def _note(self, statement: Statement, kind: str, identifier: str, verdict: str = "ok", sentence: str = "") -> None:
        said = " ".join(sentence.split())[:300]
        entry = DraftStatement(
            kind=kind, id=identifier[:80], first=statement.first, last=statement.last, verdict=verdict, sentence=said
        )
        self.statements.append(entry)

    # ---- values and looks ----

    def _value(self, node: ast.Assign, text: str, statement: Statement) -> bool:
        targets = [n for t in node.targets for n in ast.walk(t) if isinstance(n, ast.Name)]
        if not targets or not all(isinstance(t, (ast.Name, ast.Tuple, ast.List)) for t in node.targets):
            raise ProgramError("Only names can be bound.")
        name = targets[0].id
        if (
            isinstance(node.value, ast.Call)
            and isinstance(node.value.func, ast.Name)
            and node.value.func.id in FAMILIES
        ):
            expression = " ".join(ast.unparse(node.value).split())
            self.palette.look(expression)
            for target in targets:
                self.palette.named[target.id] = expression
            self._note(statement, "look", name)
            return False
        if isinstance(node.value, ast.Name) and node.value.id in self.palette.named:
            self.palette.named[name] = self.palette.named[node.value.id]
            self._note(statement, "look", name)
            return False
        verdict = "ok"
        if any(t.id in RESERVED for t in targets):
            raise ProgramError(f"{name} is a word of the language.", 0, "Choose another name.")
        try:
            self._evaluated(text)
        except ProgramError:
            rewritten = mended(text)
            if rewritten is None:
                raise
            self._evaluated(rewritten)
            text, verdict = rewritten, "mended"
        for target in targets:
            self.defs.bind_number(target.id, text)
        self._note(statement, "number", name, verdict, "" if verdict == "ok" else "It was written in another way.")
        return False

    def _evaluated(self, text: str) -> None:
        """Raise ProgramError where a statement cannot be evaluated with all that stands before it."""
        known = "\n\n".join(dict.fromkeys([*self.defs.numbers.values(), *self.defs.defs.values()]))
        looks = "\n".join(f'{n} = "look"' for n in self.palette.named if n not in RESERVED)
        Evaluation(room_vocabulary(), None, DEFAULT_LIMITS).feed(f"{looks}\n{known}\n{text}\n", complete=False)

    def _def(self, node: ast.FunctionDef, text: str, statement: Statement) -> bool:
        if node.decorator_list:
            raise ProgramError("Decorators are not in the room language.")
        name = node.name
        again = name in self.defs.defs
        self.defs.defs[name] = text
        self._note(statement, "def", name)
        self._of_def[name] = len(self.statements) - 1
        users = [t for t in self.things.values() if self.def_of(t) == name]
        if not users:
            self._helper(name, text)
            return False
        if again:
            for thing in users:
                self.made.pop(thing.id, None)
        for thing in users:
            self._model(thing)
        return True

    def _helper(self, name: str, text: str) -> None:
        """A def that no thing is made by yet: whether it is in the language."""
        try:
            parse(text, DEFAULT_LIMITS)
            self._checked(text)
        except ProgramError as error:
            try:
                rewritten = mended(text)
                if rewritten is None:
                    raise error
                self._checked(rewritten)
                self.defs.defs[name] = rewritten
                self._judge_def(name, "mended", "It was written in another way.")
            except ProgramError as second:
                self._judge_def(name, "refused", second.message)

    def _checked(self, text: str) -> None:
        Evaluation(room_vocabulary(), None, DEFAULT_LIMITS).feed(text, complete=False)

    def _judge_def(self, name: str, verdict: str, sentence: str = "") -> None:
        index = self._of_def.get(name)
        if index is not None:
            update = {"verdict": verdict, "sentence": " ".join(sentence.split())[:300]}
            self.statements[index] = self.statements[index].model_copy(update=update)

    # ---- lines ----

    def _lines(self, node: ast.stmt, statement: Statement) -> bool:
        preamble = self.palette.numbers
        known = self.defs.defs.keys() | {t.id for t in self.things.values()}
        found = calls_of(node, preamble, known, self.palette.named)
        changed = False
        for call in found:
            try:
                notes = self._line(call)
                name = str(call.args[0] if call.args else call.keywords.get("id", ""))[:60]
                verdict = "mended" if notes or not call.plain else "ok"
                sentence = " ".join(notes) or (
                    "" if call.plain else "Its values were worked out; lines take plain literals."
                )
                self._note(statement, call.name, "" if call.name == "room" else name, verdict, sentence)
                changed = True
            except ProgramError as error:
                name = str(call.args[0])[:60] if call.args else ""
                self._note(statement, call.name, name, "refused", f"{error.message} {error.fix}".strip())
        return changed

    def _line(self, call: Call) -> list[str]:
        """Take one line over; sentences on what was forgiven."""
        if call.name == "build":
            self.ended = True
            return []
        if call.name in _WORKED_OUT:
            parent = call.keywords.get("parent")
            if call.name == "light" and isinstance(parent, str):
                self.lamps.append(parent)
            return [] if call.name == "light" else ["It is worked out from the picture."]
        if call.name == "furnish":
            return self._furnish(call)
        if call.name == "finish":
            return self._finish(call)
        given = Arguments(call.name, call.args, call.keywords, _ORDERS[call.name])
        if call.name == "room":
            if self.room is not None:
                raise ProgramError("There is a room line already.")
            self.room = read_room(given)
        elif call.name == "lighting":
            self.lighting = read_light(given)
        elif call.name == "proxy":
            self._thing(read_thing(given), given.notes)
        else:
            self._fixed(read_fixed(call.name, given), given.notes)
        return given.notes

    def _new_id(self, written: str, fallback: str) -> str:
        name = clean_id(written, self._taken, fallback)
        self._ids.setdefault(written, name)
        return name

    def _fixed(self, found: Fixed, notes: list[str]) -> None:
        if found.kind == "partition" and (found.partition is False or _is_outer(found, self.room) or self.room is None):
            if self.room is not None and _is_outer(found, self.room):
                return
            self.outer.append(found)
            return
        if found.id in self._ids and found.id in self.fixed and self.fixed[found.id].kind == found.kind:
            raise ProgramError(f"There is a {found.kind} {found.id} already.")
        name = self._new_id(found.id, found.kind)
        if name != found.id:
            notes.append(f"It is called {name}.")
        self.fixed[name] = replace(found, id=name)

    def _thing(self, found: Thing, notes: list[str]) -> None:
        if len(self.things) >= MOST_THINGS:
            raise ProgramError(f"A room has at most {MOST_THINGS} things.")
        before = self.things.get(self._ids.get(found.id, ""))
        if before is not None and _same_place(before, found):
            raise ProgramError(f"{found.id} stands there already.")
        name = self._new_id(found.id, "object")
        if name != found.id:
            notes.append(f"It is called {name}.")
        thing = replace(found, id=name, parent=self._parent(found.parent))
        self.things[name] = thing
        self._model(thing)

    def _parent(self, written: str | None) -> str | None:
        return None if written is None else self._ids.get(written, written)

    def _furnish(self, call: Call) -> list[str]:
        given = Arguments("furnish", call.args, call.keywords, ("id", "shapes", "lying"))
        identifier, shapes = given.word("id"), given.take("shapes")
        given.take("lying")
        name = self._ids.get(identifier, identifier)
        thing = self.things.get(name)
        if thing is None:
            raise ProgramError(f"There is no proxy line of {identifier or 'it'} above.")
        if not isinstance(shapes, (Ref, str)):
            raise ProgramError("furnish needs the name of a def.")
        text = shapes if isinstance(shapes, str) else shapes.text
        if text.startswith("lambda"):
            made = f"{name}_made"
            tree = ast.parse(text, mode="eval").body
            assert isinstance(tree, ast.Lambda)
            self.defs.defs[made] = (
                f"def {made}({ast.unparse(tree.args) or 'size'}):\n    return {ast.unparse(tree.body)}"
            )
            word = made
        else:
            word = re.sub(r"\W.*", "", text, flags=re.DOTALL)
        if word not in self.defs.defs:
            piece = replace(thing, piece=word)
            if not piece_program(piece, "made"):
                raise ProgramError(f"There is no def {word} above.")
            thing = piece
            self.things[name] = piece
        elif self.def_of(thing) == word and name in self.made:
            return []
        else:
            self._furnished[name] = word
        self.made.pop(name, None)
        self._model(thing)
        return []

    def _finish(self, call: Call) -> list[str]:
        given = Arguments("finish", call.args, call.keywords, ("id", "looks"))
        written, looks = given.word("id"), given.take("looks")
        pairs = {"": looks} if isinstance(looks, Ref) else looks
        if not isinstance(pairs, dict) or not pairs:
            raise ProgramError('finish needs a look, or looks by part: finish("bed_1", {"frame": oak}).')
        found, notes = {}, []
        for key, value in pairs.items():
            try:
                if not isinstance(value, Ref):
                    raise ProgramError("it is no look")
                self.palette.look(value.text)
                found[str(key)[:60]] = self.palette.named.get(value.text, value.text)
            except ProgramError as error:
                notes.append(f"{key or written}: {error.message}.")
        if not found:
            raise ProgramError(" ".join(notes))
        name = self._ids.get(written, written)
        known = {*self.things, *self.fixed, *SURFACES, *SIDE_NAMES}
        if name not in known and not name.startswith(("wall_", "partition")):
            raise ProgramError(f"There is no {written or 'such thing'} in the room.")
        self.finishes[name] = {**self.finishes.get(name, {}), **found}
        return notes

    # ---- what things are made of ----

    def id_of(self, written: str) -> str:
        """What something is called that the draft calls so."""
        return self._ids.get(written, written)

    def def_of(self, thing: Thing, seen: frozenset[str] = frozenset()) -> str:
        """The name of the draft's def that makes a thing, "" for none."""
        for name in (self._furnished.get(thing.id), thing.id, *(w for w, i in self._ids.items() if i == thing.id)):
            if name is not None and name in self.defs.defs:
                return name
        like = self.things.get(self._ids.get(thing.like, thing.like))
        if like is not None and like.id not in seen and like.id != thing.id:
            return self.def_of(like, seen | {thing.id})
        return thing.like if thing.like in self.defs.defs else ""

    def first_of(self, thing: Thing) -> str:
        """The id of the first thing that is made just like this one; its own where it is that."""
        name = self.def_of(thing)
        if not name or thing.colours:
            return thing.id
        return next((t.id for t in self.things.values() if not t.colours and self.def_of(t) == name), thing.id)

    def _like(self, thing: Thing) -> Thing:
        """A twin of a thing with a library's piece has that piece."""
        at, seen = thing, {thing.id}
        while not at.piece and at.like:
            other = self.things.get(self._ids.get(at.like, at.like))
            if other is None or other.id in seen:
                break
            seen.add(other.id)
            at = other
        return replace(thing, piece=at.piece, options=thing.options or at.options, colours=thing.colours or at.colours)

    def _model(self, thing: Thing) -> None:
        """Work out what a thing is made of; the library's piece stands where that fails."""
        proxy, main = proxy_line(thing), function_name(thing.id, ())
        name = self.def_of(thing)
        try:
            if name:
                call = tinted("MADE", thing.colours) if thing.colours else ""
                source, notes = self.defs.program(name, main, call)
                made = make(source, proxy, notes)
                self.made[thing.id] = made
                self.problems.pop(thing.id, None)
                if made.mended or made.notes:
                    self._judge_def(name, "mended", "; ".join(made.notes) or "It was written in another way.")
            elif source := piece_program(self._like(thing), main):
                self.made[thing.id] = make(source, proxy)
            elif thing.piece:
                self.problems[thing.id] = f"The library has no {thing.piece}."
                self.pieces[thing.id] = self._piece(proxy)
        except (
            RoomError,
            ValueError,
            TypeError,
            ArithmeticError,
            LookupError,
            RecursionError,
            AttributeError,
        ) as error:
            message = error.message if isinstance(error, RoomError) else f"It cannot be made ({type(error).__name__})."
            self.made.pop(thing.id, None)
            self.problems[thing.id] = message
            self.pieces[thing.id] = self._piece(proxy)
            if name and self.first_of(thing) == thing.id:
                self._judge_def(name, "refused", message)

    def _piece(self, proxy: ProxyLine) -> Piece:
        return best_piece(proxy, ObjectDescription(id=proxy.id))

    # ---- asked again, and the end ----

    def refused_programs(self) -> list[tuple[str, str, str]]:
        """(def's name, its text, what is wrong with it) of objects whose programs could not be used."""
        found: dict[str, tuple[str, str, str]] = {}
        for identifier, problem in self.problems.items():
            thing = self.things.get(identifier)
            name = self.def_of(thing) if thing is not None else ""
            if name and self.first_of(thing) == identifier:  # type: ignore[arg-type]
                found.setdefault(name, (name, self.defs.defs[name], problem))
        return list(found.values())

    def amend(self, statements: Iterable[Statement]) -> None:
        """Take defs that were asked again; what became of the first ones is told anew."""
        for statement in statements:
            held = len(self.statements)
            former = dict(self._of_def)
            texts = dict(self.defs.defs)
            self.take(statement)
            added = self.statements[held:]
            del self.statements[held:]
            for entry in added:
                if entry.kind != "def" or entry.id not in former:
                    continue
                self._of_def[entry.id] = former[entry.id]
                if entry.verdict in ("ok", "mended"):
                    self._judge_def(entry.id, "mended", "It was asked again alone.")
                else:
                    self.defs.defs[entry.id] = texts[entry.id]
                    self._judge_def(entry.id, "refused", entry.sentence)

    def close(self) -> None:
        """The library's pieces for what nothing was written of; and which of them stand in the place of refused programs."""
        for thing in self.things.values():
            if thing.id not in self.made and thing.id not in self.pieces:
                self.pieces[thing.id] = self._piece(proxy_line(thing))
        for identifier in self.problems:
            name = self.def_of(self.things[identifier])
            index = self._of_def.get(name)
            piece = self.pieces.get(identifier)
            if index is not None and piece is not None and self.statements[index].verdict == "refused":
                sentence = self.statements[index].sentence
                self._judge_def(name, f"replaced by {piece.choice.piece.name}", sentence)


def proxy_line(thing: Thing) -> ProxyLine:
    """A thing as the line of the room language; its parent may not be there."""
    x, y, z = thing.at
    return ProxyLine(
        id=thing.id,
        category=thing.category,
        centre=(x, y, z + thing.size[2] / 2),
        size=(round(thing.size[0], 4), round(thing.size[1], 4), round(thing.size[2], 4)),
        yaw=thing.yaw,
        placement=thing.placement,
        parent=thing.parent,
        salience=thing.salience,
        label=thing.label,
        shape=thing.shape,
    )


def read(statements: Sequence[Statement], amended: Sequence[Statement] = ()) -> Draft:
    """A whole draft."""
    draft = Draft()
    for statement in statements:
        draft.take(statement)
    draft.amend(amended)
    draft.close()
    return draft


def _text_of(node: ast.stmt, text: str) -> str:
    rows = text.replace("\r\n", "\n").split("\n")
    found = "\n".join(rows[node.lineno - 1 : node.end_lineno])
    if node.col_offset or (node.end_col_offset or 0) < len(rows[(node.end_lineno or node.lineno) - 1].rstrip()):
        # More than one statement on a line, or a remark behind it.
        found = ast.get_source_segment(text, node) or found
    return found.rstrip()


def _kind(text: str) -> str:
    word = re.match(r"\s*([A-Za-z_]\w*)", text)
    return word.group(1) if word else ""


def _word_of(text: str) -> str:
    found = re.search(r"def\s+(\w+)|\(\s*[\"']([^\"']{1,60})[\"']|^\s*(\w+)\s*=", text)
    return next((g for g in found.groups() if g), "") if found else ""


def _same_place(a: Thing, b: Thing) -> bool:
    return a.category == b.category and max(abs(p - q) for p, q in zip(a.at[:2], b.at[:2], strict=True)) < 0.05


def _is_outer(wall: Fixed, room: RoomSaid | None) -> bool:
    """Whether a wall's line runs along one of the floor's edges."""
    if room is None:
        return False
    for a, b in zip(room.floor, [*room.floor[1:], room.floor[0]], strict=True):
        length = max(1e-6, ((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2) ** 0.5)
        ux, uy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
        if all(abs((p[0] - a[0]) * uy - (p[1] - a[1]) * ux) < 0.2 and -0.3 < (p[0] - a[0]) * ux + (p[1] - a[1]) * uy < length + 0.3
               for p in (wall.start, wall.end)):  # fmt: skip
            return True
    return False
