# SPDX-License-Identifier: GPL-3.0-or-later
"""What names may mean: no unknown ones, no second meaning for the language's own in the module, no recursion."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field

from ..errors import ProgramError
from .refusals import MOST_PROBLEMS, unknown_name
from .scopes import Definition, Names, Scope


@dataclass(frozen=True)
class Known:
    """The names that the language gives a program.

    Attributes:
        functions: built-in functions and constructors.
        constants: pi and the like.
        layout: names of layout lines, statements of their own with literal arguments.
        lines: names of all lines, layout lines and those that are only statements of the module (furnish, build).
        reserved: names that a program may not bind in the module, as the prelude beside it needs them.
    """

    functions: frozenset[str]
    constants: frozenset[str]
    layout: frozenset[str] = frozenset()
    lines: frozenset[str] = frozenset()
    reserved: frozenset[str] = field(default=frozenset(), repr=False)

    @property
    def own(self) -> frozenset[str]:
        """All names with a meaning of their own."""
        return self.functions | self.constants | self.lines


def check_names(names: Names, known: Known, complete: bool = True) -> list[ProgramError]:
    """Problems with the names of a program.

    Args:
        names: the scopes of the program.
        known: the language's own names.
        complete: whether the text is the whole program; if not, unknown names may still come and are left alone.
    """
    problems: list[ProgramError] = []
    own = known.own
    for name, line, scope in names.bindings:
        if scope is not names.module:
            continue  # inside a def or comprehension a name is its own, as in Python: nothing else can see it
        if name in own:
            problems.append(
                ProgramError(f"{name} belongs to the room language and cannot be redefined here", line, rename(name))
            )
        elif name in known.reserved:
            problems.append(ProgramError(f"{name} belongs to Python and cannot be redefined here", line, rename(name)))
    for node, scope in names.uses:
        if node.id in own or scope.owner(node.id) is not None or not complete:
            continue
        if len(problems) >= MOST_PROBLEMS:
            break
        visible = set(own)
        around: Scope | None = scope
        while around is not None:
            visible.update(around.names)
            around = around.around
        problems.append(unknown_name(node.id, node.lineno, sorted(visible)))
    return problems + recursion(names)


def rename(name: str) -> str:
    """The advice to take another name."""
    return f"Use another name, such as {name}_1."


def recursion(names: Names) -> list[ProgramError]:
    """Functions that call themselves, directly or through others. Any mention of a function counts as a call."""
    calls: dict[Definition, set[Definition]] = {}
    for node, scope in names.uses:
        owner = scope.owner(node.id)
        mentioned = names.definitions.get((owner, node.id), []) if owner is not None else []
        around: Scope | None = scope
        while around is not None and mentioned:
            if isinstance(around.node, (ast.FunctionDef, ast.Lambda)):
                calls.setdefault(around.node, set()).update(mentioned)
            around = around.around
    problems = []
    done: set[Definition] = set()
    for start in calls:
        for definition in circle(start, calls, done):
            name = getattr(definition, "name", "a lambda")
            message = f"{name} calls itself; recursion is not in the room language"
            problems.append(ProgramError(message, definition.lineno, "Use a for loop."))
    return problems


def circle(start: Definition, calls: dict[Definition, set[Definition]], done: set[Definition]) -> list[Definition]:
    """The first function found that can be reached from itself, walking from `start`; empty when there is none."""
    path: list[tuple[Definition, Iterator[Definition]]] = [(start, iter(calls.get(start, ())))]
    on_path = {start}
    if start in done:
        return []
    while path:
        node, following = path[-1]
        step = next(following, None)
        if step is None:
            done.add(node)
            on_path.discard(node)
            path.pop()
        elif step in on_path:
            done.update(on_path)
            return [step]
        elif step not in done:
            on_path.add(step)
            path.append((step, iter(calls.get(step, ()))))
    return []


def check_lines(tree: ast.Module, names: Names, known: Known, allowed: bool) -> list[ProgramError]:
    """Problems with lines: each is a statement, outside functions; layout lines are top-level and literal.

    Args:
        tree: the program.
        names: its scopes.
        known: the language's own names.
        allowed: whether the program may hold lines at all; object programs may not.
    """
    statements: dict[ast.Name, tuple[ast.Call, bool]] = {}
    open_blocks: list[tuple[list[ast.stmt], bool]] = [(tree.body, True)]
    while open_blocks:
        block, top = open_blocks.pop()
        for node in block:
            if (
                isinstance(node, ast.Expr)
                and isinstance(node.value, ast.Call)
                and isinstance(node.value.func, ast.Name)
            ):
                statements[node.value.func] = (node.value, top)
            elif isinstance(node, (ast.If, ast.For)):
                open_blocks += [(node.body, False), (node.orelse, False)]
    problems = []
    for part, scope in names.uses:
        if part.id in known.lines and not is_local(part.id, scope, names.module):
            message: tuple[str, str] | None = (f"{part.id} is a line of the room", "An object program only has defs.")
            if allowed:
                message = line_problem(part.id, statements.get(part), known)
            if message:
                problems.append(ProgramError(message[0], part.lineno, message[1]))
    return problems


def is_local(name: str, scope: Scope, module: Scope) -> bool:
    """Whether a name that is read in a scope means something that a def or comprehension calls so itself."""
    owner = scope.owner(name)
    return owner is not None and owner is not module


def line_problem(name: str, place: tuple[ast.Call, bool] | None, known: Known) -> tuple[str, str] | None:
    """What is wrong with one use of a line's name."""
    if place is None:
        return f"{name} must be a statement of its own outside functions", "Return shapes from the def instead."
    call, top = place
    if name not in known.layout:
        return None
    if not top:
        return f"{name} must be a line of its own, not inside for or if", "Write one line for each."
    for value in [*call.args, *(keyword.value for keyword in call.keywords)]:
        if not is_literal(value):
            return f"{name} takes plain numbers and texts, so that it can be edited", "Write the values out."
    return None


def is_literal(node: ast.expr) -> bool:
    """Whether the value is written out: numbers, texts, True, False, None, and tuples and lists of them."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        node = node.operand
        return isinstance(node, ast.Constant) and type(node.value) in (int, float)
    if isinstance(node, (ast.Tuple, ast.List)):
        return all(is_literal(item) for item in node.elts)
    return isinstance(node, ast.Constant)
