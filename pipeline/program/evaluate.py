# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluates room programs and object programs: text in, a Record or shapes out, nothing executed by Python itself.

The way of a text: `scan` and `parse_safe` make a syntax tree, `check`, `scopes` and `names` refuse what is outside the
language (all of it, before anything runs), `statements` and its parts compile the tree to closures, `limits` counts
while they run. Every evaluation has its own meter, frames and compiled code, so evaluations may run side by side in
threads and inside each other.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import fields
from functools import lru_cache
from typing import Any

from ..errors import ProgramError
from .check import Checker
from .limits import DEFAULT_LIMITS, FINISHED_ROOM_LIMITS, Limits, Meter
from .names import check_lines, check_names
from .parse_safe import TOO_DEEP, parse, uncollected
from .prelude.budget import vertex_budget
from .prelude.record import Record
from .prelude.recorder import Recorder
from .prelude.shape import Shape, flat_shapes
from .refusals import located, refuse, unknown_name
from .reuse import reuse
from .scopes import Binder, Scope, place
from .statements import Statements
from .values import CONTAINERS, UNSET, Frame, Function, measure
from .vocabulary import Vocabulary, room_vocabulary

__all__ = ["DEFAULT_LIMITS", "Evaluation", "Limits", "ProgramError", "call_function", "evaluate", "evaluate_object"]


def evaluate(text: str, limits: Limits = DEFAULT_LIMITS) -> Record:
    """Evaluate a room program: the text after the marker, without the prelude.

    Raises ProgramError with the line for text that is outside the room language (`refusals.ProgramProblems`, which
    lists up to ten problems), over a limit, or that fails while it runs.
    """
    if limits is FINISHED_ROOM_LIMITS and isinstance(text, str):
        return _copied(_finished_room(text))
    return _evaluated(text, limits)


@lru_cache(maxsize=3)
def _finished_room(text: str) -> Record:
    """Stages, checks and building evaluate one and the same text; what it means depends on nothing else."""
    return _evaluated(text, FINISHED_ROOM_LIMITS)


def _copied(record: Record) -> Record:
    """A record of the caller's own; only the shapes and looks in it are shared, which nobody can change."""
    values: dict[str, Any] = {}
    for f in fields(record):
        value = getattr(record, f.name)
        if isinstance(value, list):
            value = [dict(line) for line in value]
        elif isinstance(value, dict):
            value = {key: copy(inner) if isinstance(inner, (list, dict)) else inner for key, inner in value.items()}
        values[f.name] = value
    return Record(**values)


def _evaluated(text: str, limits: Limits) -> Record:
    recorder = Recorder()
    vocabulary = room_vocabulary()
    lines = {name: getattr(recorder, name) for name in vocabulary.lines}
    known = reuse(text, limits)
    lines["furnish"] = known.furnish(recorder.furnish, recorder.size_of)
    Evaluation(vocabulary, lines, limits).feed(known.text)
    return recorder.record


def evaluate_object(
    text: str, name: str, limits: Limits = DEFAULT_LIMITS, args: Sequence[Any] = (), tree: ast.Module | None = None
) -> list[Shape]:
    """The shapes that the def `name` of an object program returns. The text has defs, but no lines of the room.

    Args:
        tree: what `parse` made of the text, where that is at hand.

    Raises ProgramError as `evaluate` does, and when the def is missing or returns something else than shapes.
    """
    evaluation = Evaluation(room_vocabulary(), None, limits)
    evaluation.feed(text, tree=tree)
    result = evaluation.call(name, args)
    try:
        if result.__class__ in CONTAINERS:
            measure(evaluation.meter, result)
        return flat_shapes(name, result)
    except Exception as error:
        raise located(error, evaluation.line_of(name)) from None


def call_function(text: str, name: str, args: Sequence[Any] = (), limits: Limits = DEFAULT_LIMITS) -> Any:
    """What the def `name` of a text with defs returns for these arguments: numbers, texts, containers or shapes."""
    evaluation = Evaluation(room_vocabulary(), None, limits)
    evaluation.feed(text)
    return evaluation.call(name, args)


class Evaluation:
    """One program while it is evaluated: fed whole, or in pieces that follow each other.

    Args:
        vocabulary: the names a program may use.
        lines: the functions of layout lines, furnish and build; None where a program may not have them.
        limits: for all pieces and calls together.

    Attributes:
        meter: what was used so far.
    """

    def __init__(
        self,
        vocabulary: Vocabulary,
        lines: Mapping[str, Callable[..., Any]] | None,
        limits: Limits = DEFAULT_LIMITS,
    ) -> None:
        self.limits = limits
        self.meter = Meter(limits)
        self._lines_allowed = lines is not None
        self._natives = vocabulary.natives(self.meter, lines or {})
        self._known = vocabulary.known(self._natives)
        self._constants = dict(vocabulary.constants)
        self._module = Scope(None)
        self._top: Frame = []

    def feed(self, text: str, complete: bool = True, tree: ast.Module | None = None) -> None:
        """Evaluate a text: first all of it is checked, then all of it runs.

        Args:
            text: whole statements; line numbers count from its beginning.
            complete: whether no other piece follows. If one does, names that are not known yet may be used in defs.
            tree: what `parse` made of the text, where that is at hand.
        """
        try:
            with uncollected():
                run = self._compile(text, complete, tree)
        except (RecursionError, MemoryError):
            raise ProgramError(TOO_DEEP, 0, "Give parts of it a name in statements before.") from None
        self._run(lambda: run(self._top))

    def call(self, name: str, args: Sequence[Any] = ()) -> Any:
        """Call a def of the texts that were fed. Raises ProgramError when there is none of this name."""
        slot = self._module.slots.get(name)
        function = self._top[slot] if slot is not None else None
        if not isinstance(function, Function):
            raise (
                unknown_name(name, 0, self._module.names) if function is None else ProgramError(f"{name} is not a def")
            )
        return self._run(lambda: function(*args))

    def line_of(self, name: str) -> int:
        """The line of the first binding of a module's name, 0 if there is none."""
        return self._module.names.get(name, 0)

    def _run(self, action: Callable[[], Any]) -> Any:
        self.meter.depth = 0
        with vertex_budget(max(0, self.meter.vertices[0])) as left:
            self.meter.vertices = left
            try:
                return action()
            except Exception as error:
                raise located(error, 0) from None

    def _compile(self, text: str, complete: bool, tree: ast.Module | None) -> Callable[[Frame], Any]:
        tree = tree or parse(text, self.limits)
        refuse(Checker(self.limits).run(tree))
        names = Binder(self._module).run(tree)
        refuse(check_lines(tree, names, self._known, self._lines_allowed) + check_names(names, self._known, complete))
        for node, scope in names.uses:
            if scope.owner(node.id) is None and node.id not in self._known.own:
                self._module.bind(node.id, node.lineno)
        place(self._module)
        compiler = Statements(names, self.meter, self._natives, self._constants, self._top)
        run = compiler.runner(compiler.block(tree.body, self._module), charge=self.meter)
        self._top += self._module.contents(len(self._top), UNSET)
        return run
