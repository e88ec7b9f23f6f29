# SPDX-License-Identifier: GPL-3.0-or-later
"""A draft while it is read: each statement is judged alone, and what cannot be used costs only itself."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Sequence

from ..errors import ProgramError, RoomError
from ..objects.mending import mended
from ..program.evaluate import Evaluation
from ..program.limits import DEFAULT_LIMITS
from ..program.parse_safe import parse, uncollected
from ..program.prelude.registry import RESERVED
from ..program.vocabulary import room_vocabulary
from .calls import has_lines
from .layout import proxy_line
from .lines import take_lines
from .looks import FAMILIES
from .making import model, nearest_piece
from .said import Said
from .statements import Statement, is_prose

MOST_STATEMENTS = 2000
CUT = "The answer ended in the middle of it."


class Draft(Said):
    """What a draft says, read statement by statement."""

    # ---- one statement ----

    def take(self, statement: Statement) -> bool:
        """Read one statement; whether the room has changed by it. Nothing is raised."""
        if len(self.statements) >= MOST_STATEMENTS:
            return False
        before = len(self.statements)
        try:
            with uncollected():
                return self._take(statement)
        except RoomError as error:
            message = CUT if statement.cut else f"{error.message} {error.fix}".strip()
            self.note(statement, _kind(statement.text), _word_of(statement.text), "refused", message)
        except (ValueError, TypeError, ArithmeticError, LookupError, RecursionError, AttributeError) as error:
            words = f"It could not be read ({type(error).__name__})."
            self.note(statement, _kind(statement.text), _word_of(statement.text), "refused", words)
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
            self.note(statement, "import", "", "mended", "Imports are not needed.")
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
            return take_lines(self, node, statement)
        raise ProgramError("This is no line of a room, no look, no number and no def.")

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
            self.note(statement, "look", name)
            return False
        if isinstance(node.value, ast.Name) and node.value.id in self.palette.named:
            self.palette.named[name] = self.palette.named[node.value.id]
            self.note(statement, "look", name)
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
        self.note(statement, "number", name, verdict, "" if verdict == "ok" else "It was written in another way.")
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
        self.note(statement, "def", name)
        self.of_def[name] = len(self.statements) - 1
        users = [t for t in self.things.values() if self.def_of(t) == name]
        if not users:
            self._helper(name, text)
            return False
        if again:
            for thing in users:
                self.made.pop(thing.id, None)
        for thing in users:
            model(self, thing)
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
                self.judge_def(name, "mended", "It was written in another way.")
            except ProgramError as second:
                self.judge_def(name, "refused", second.message)

    def _checked(self, text: str) -> None:
        Evaluation(room_vocabulary(), None, DEFAULT_LIMITS).feed(text, complete=False)

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
            former = dict(self.of_def)
            texts = dict(self.defs.defs)
            self.take(statement)
            added = self.statements[held:]
            del self.statements[held:]
            for entry in added:
                if entry.kind != "def" or entry.id not in former:
                    continue
                self.of_def[entry.id] = former[entry.id]
                if entry.verdict in ("ok", "mended"):
                    self.judge_def(entry.id, "mended", "It was asked again alone.")
                else:
                    self.defs.defs[entry.id] = texts[entry.id]
                    self.judge_def(entry.id, "refused", entry.sentence)

    def close(self) -> None:
        """The library's pieces for what nothing was written of; and which of them stand in the place of refused programs."""
        for thing in self.things.values():
            if thing.id not in self.made and thing.id not in self.pieces:
                self.pieces[thing.id] = nearest_piece(proxy_line(thing))
        for identifier in self.problems:
            name = self.def_of(self.things[identifier])
            index = self.of_def.get(name)
            piece = self.pieces.get(identifier)
            if index is not None and piece is not None and self.statements[index].verdict == "refused":
                sentence = self.statements[index].sentence
                self.judge_def(name, f"replaced by {piece.choice.piece.name}", sentence)


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
