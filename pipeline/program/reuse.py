# SPDX-License-Identifier: GPL-3.0-or-later
"""What a function made of a proxy's size once is not made again: the same text and the same size give the same shapes.

A room is evaluated after every edit, and mostly one line of it changed. So shapes are kept by the text of a function with
all that it uses, and by the size that it was given; functions whose shapes are known are neither compiled nor run. A
function that uses numbers of the module is always run.
"""

from __future__ import annotations

import ast
import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

from ..errors import ProgramError
from .limits import FINISHED_ROOM_LIMITS, Limits
from .parse_safe import names_read, parse
from .prelude.budget import spend_vertices
from .prelude.shape import Shape, flat_shapes

MOST_VERTICES = 6_000_000
Key = tuple[str, tuple[float, ...]]


class ShapeStore:
    """Shapes by function and size; the least recently used go first. Thread-safe."""

    def __init__(self, most: int = MOST_VERTICES) -> None:
        self._most = most
        self._held: OrderedDict[Key, list[Shape]] = OrderedDict()
        self._count = 0
        self._lock = threading.Lock()

    def find(self, key: Key) -> list[Shape] | None:
        """What was kept under this key."""
        with self._lock:
            found = self._held.get(key)
            if found is not None:
                self._held.move_to_end(key)
            return found

    def keep(self, key: Key, shapes: list[Shape]) -> None:
        """Keep shapes, which nobody may change from now on."""
        with self._lock:
            if key in self._held:
                return
            self._held[key] = shapes
            self._count += sum(shape.vertex_count for shape in shapes)
            while self._count > self._most and len(self._held) > 1:
                _, gone = self._held.popitem(last=False)
                self._count -= sum(shape.vertex_count for shape in gone)

    def clear(self) -> None:
        """Forget everything."""
        with self._lock:
            self._held.clear()
            self._count = 0


STORE = ShapeStore()


def remember(text: str, name: str, size: Iterable[float], shapes: list[Shape], tree: ast.Module | None = None) -> None:
    """Keep what a def of a text with defs was seen to make of a size, so that a room with the same defs need not make it.

    Args:
        tree: what `parse` made of the text, where that is at hand.
    """
    try:
        module = _Module.of(tree or parse(text, FINISHED_ROOM_LIMITS), text)
    except ProgramError:
        return
    digest = module.digest(name)
    if digest is not None and shapes:
        STORE.keep((digest, tuple(float(v) for v in size)), list(shapes))


@dataclass
class Reuse:
    """One room text, and what of it need not run.

    Attributes:
        text: the room text, with blank lines in the place of functions whose shapes are known.
        closures: object id -> digest of the function that it is furnished with and of all that it uses.
        known: object id -> its shapes, where they are known.
    """

    text: str
    closures: dict[str, str] = field(default_factory=dict)
    known: dict[str, list[Shape]] = field(default_factory=dict)

    def furnish(self, plain: Callable[[Any, Any, Any], None], size_of: Callable[[str], Any]) -> Callable[..., None]:
        """The room's `furnish`, which takes known shapes and keeps new ones.

        Args:
            plain: the recorder's own. size_of: the size of a proxy, None when its line does not stand above.
        """

        def furnish(id: Any, shapes: Any, lying: Any = False) -> None:
            known = self.known.get(id) if isinstance(id, str) else None
            if known is not None:
                spend_vertices(sum(shape.vertex_count for shape in known))
                return plain(id, known, lying)
            size = size_of(id) if isinstance(id, str) and callable(shapes) else None
            if size is not None:
                key = (self.closures[id], tuple(size)) if id in self.closures else None
                alike = STORE.find(key) if key is not None else None  # what stands above may be just the same
                if alike is not None:
                    spend_vertices(sum(shape.vertex_count for shape in alike))
                    return plain(id, alike, lying)
                shapes = flat_shapes("furnish", shapes(size))
                if key is not None and shapes:
                    STORE.keep(key, shapes)
            return plain(id, shapes, lying)

        return furnish


def reuse(text: str, limits: Limits) -> Reuse:
    """Look through a room text. One that cannot be parsed is left as it is, for whoever says what is wrong with it."""
    if not isinstance(text, str) or "furnish(" not in text or "\r" in text:
        return Reuse(text)
    try:
        tree = parse(text, limits)
    except ProgramError:
        return Reuse(text)
    module = _Module.of(tree, text)
    found = Reuse(text)
    spent: list[ast.stmt] = []
    for identifier, (statement, name) in module.furnished.items():
        digest = module.digest(name)
        size = module.sizes.get(identifier)
        if digest is None or size is None:
            continue
        found.closures[identifier] = digest
        shapes = STORE.find((digest, size))
        if shapes is not None:
            found.known[identifier] = shapes
            spent.append(statement)
    if spent:
        found.text = module.without(spent, found.known)
    return found


@dataclass
class _Module:
    lines: list[str]
    tree: ast.Module
    defs: dict[str, ast.FunctionDef]
    bound: frozenset[str]
    furnished: dict[str, tuple[ast.stmt, str]]
    sizes: dict[str, tuple[float, ...]]

    @staticmethod
    def of(tree: ast.Module, text: str) -> _Module:
        defs: dict[str, ast.FunctionDef] = {}
        twice: set[str] = set()
        bound: set[str] = set()
        furnished: dict[str, tuple[ast.stmt, str]] = {}
        sizes: dict[str, tuple[float, ...]] = {}
        for node in tree.body:
            if isinstance(node, ast.FunctionDef):
                if node.name in defs:
                    twice.add(node.name)
                defs[node.name] = node
                continue
            bound |= {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and not isinstance(n.ctx, ast.Load)}
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
                _read_call(node, node.value, furnished, sizes)
        return _Module(text.split("\n"), tree, defs, frozenset(bound | twice), furnished, sizes)

    def source(self, name: str) -> str:
        node = self.defs[name]
        return "\n".join(self.lines[node.lineno - 1 : node.end_lineno])

    def closure(self, name: str) -> set[str] | None:
        """A def and all that it uses; None when it uses more than defs."""
        found: set[str] = set()
        waiting = [name]
        while waiting:
            at = waiting.pop()
            if at in self.bound or at not in self.defs:
                return None
            if at in found:
                continue
            found.add(at)
            names = names_read(self.source(at))
            if names & self.bound:
                return None
            waiting += names & self.defs.keys()
        return found

    def digest(self, name: str) -> str | None:
        """A digest of a function's text and all it uses, None where more than text decides on what it makes."""
        names = self.closure(name)
        if names is None:
            return None
        digest = hashlib.sha1(name.encode(), usedforsecurity=False)
        for other in sorted(names):
            digest.update(self.source(other).encode())
        return digest.hexdigest()

    def without(self, spent: list[ast.stmt], known: dict[str, Any]) -> str:
        """The text with nothing in the place of functions that only known objects use."""
        needed: set[str] = set()
        for node in self.tree.body:
            if node not in spent and not isinstance(node, ast.FunctionDef):
                needed |= {n.id for n in ast.walk(node) if isinstance(n, ast.Name)} & self.defs.keys()
        given = {name for i, (_, name) in self.furnished.items() if i in known}
        used = set().union(*(self.closure(name) or set() for name in given)) if given else set()
        # What nothing furnishes with is still looked at: the language refuses a text for any of its lines.
        roots = needed | (self.defs.keys() - used)
        kept: set[str] = set()
        waiting = list(roots)
        while waiting:
            name = waiting.pop()
            if name not in kept:
                kept.add(name)
                waiting += names_read(self.source(name)) & self.defs.keys()
        gone = [self.defs[name] for name in used - kept]
        lines = list(self.lines)
        taken: dict[int, int] = {}
        for node in self.tree.body:
            for number in range(node.lineno, (node.end_lineno or node.lineno) + 1):
                taken[number] = taken.get(number, 0) + 1
        for statement in [*gone, *spent]:
            span = range(statement.lineno, (statement.end_lineno or statement.lineno) + 1)
            if any(taken[number] > 1 for number in span):
                return "\n".join(self.lines)
            for number in span:
                lines[number - 1] = ""
            if not isinstance(statement, ast.FunctionDef):
                lying = ", lying=True" if _is_lying(statement) else ""
                lines[statement.lineno - 1] = f"furnish({_identifier(statement)!r}, []{lying})"
        return "\n".join(lines)


def _read_call(
    node: ast.stmt, call: ast.Call, furnished: dict[str, tuple[ast.stmt, str]], sizes: dict[str, tuple[float, ...]]
) -> None:
    name = call.func.id if isinstance(call.func, ast.Name) else ""
    first = call.args[0].value if call.args and isinstance(call.args[0], ast.Constant) else None
    if not isinstance(first, str):
        return
    plain = all(k.arg == "lying" and isinstance(k.value, ast.Constant) for k in call.keywords)
    if name == "furnish" and len(call.args) == 2 and plain and isinstance(call.args[1], ast.Name):
        furnished[first] = (node, call.args[1].id)
    elif name == "proxy":
        for keyword in call.keywords:
            if keyword.arg == "size" and isinstance(keyword.value, ast.Tuple | ast.List):
                values = [v.value for v in keyword.value.elts if isinstance(v, ast.Constant)]
                if len(values) == 3 and all(isinstance(v, int | float) for v in values):
                    sizes[first] = tuple(float(v) for v in values if isinstance(v, int | float))


def _is_lying(statement: ast.stmt) -> bool:
    assert isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call)
    return any(isinstance(k.value, ast.Constant) and k.value.value is True for k in statement.value.keywords)


def _identifier(statement: ast.stmt) -> str:
    assert isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call)
    argument = statement.value.args[0]
    assert isinstance(argument, ast.Constant)
    return str(argument.value)
