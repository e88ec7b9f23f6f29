# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of a room text that models the objects: defs and `furnish` statements, taken apart and put together.

An object's def takes the size of its proxy, and `furnish("bed_1", bed_1)` hands it over: so the geometry follows when
the proxy's line changes.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from ..artifacts.layout import Layout
from ..library import catalogue
from ..program.finishes import present_names, without_finishes_of_nothing
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import LINE_TYPES, called_name, parse_layout, print_layout
from ..program.parse_safe import names_read, parse
from ..program.prelude.registry import RESERVED

END = "build()\n"


@dataclass
class Modelling:
    """What a room text says of its objects' geometry.

    Attributes:
        defs: text of each def of the module by its name, in their order.
        uses: names that each def uses of the module.
        furnished: object id -> the furnish statement's text.
        functions: object id -> name of the function that it is furnished with, where it is one of the text's.
        others: other statements, such as numbers that functions use.
    """

    defs: dict[str, str] = field(default_factory=dict)
    uses: dict[str, frozenset[str]] = field(default_factory=dict)
    furnished: dict[str, str] = field(default_factory=dict)
    functions: dict[str, str] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)

    def closure(self, names: Iterable[str]) -> set[str]:
        """These defs and all that they use."""
        found: set[str] = set()
        waiting = [name for name in names if name in self.defs]
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                waiting += [used for used in self.uses.get(name, ()) if used in self.defs]
        return found

    def code_of(self, identifier: str) -> str:
        """An object's function as text, with the helpers that are not the library's; "" when it has none."""
        name = self.functions.get(identifier, "")
        library = catalogue.definitions()
        kept = self.closure([name]) - {n for n in library if self.defs.get(n) == library[n].text} if name else set()
        return "\n\n\n".join(text for n, text in self.defs.items() if n in kept)


def read_modelling(text: str) -> Modelling:
    """Take a room text apart.

    Raises:
        ProgramError: it is not Python, or too large.
    """
    text = text.removeprefix("\ufeff")
    tree = parse(text, FINISHED_ROOM_LIMITS)
    found = Modelling()
    lines = text.splitlines(keepends=True)
    for node in tree.body:
        source = "".join(lines[node.lineno - 1 : node.end_lineno]).rstrip()
        if isinstance(node, ast.FunctionDef):
            found.defs[node.name] = source
            found.uses[node.name] = _names_used(node, source)
        elif called_name(node) == "furnish" and isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            _read_furnish(found, node.value, source)
        elif called_name(node) not in (*LINE_TYPES, "build"):
            found.others.append(source)
    return found


def _names_used(node: ast.FunctionDef, source: str) -> frozenset[str]:
    """All names that a def reads; its text is remembered, since rooms are read after every change."""
    try:
        return names_read(source)
    except SyntaxError:  # rows counted in another way, as after a line separator in a comment
        return frozenset(n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load))


def _read_furnish(found: Modelling, call: ast.Call, source: str) -> None:
    arguments = [*call.args, *(k.value for k in call.keywords)]
    if len(arguments) < 2 or not isinstance(arguments[0], ast.Constant) or not isinstance(arguments[0].value, str):
        return
    identifier, given = arguments[0].value, arguments[1]
    found.furnished[identifier] = source
    if isinstance(given, ast.Call):
        given = given.func
    if isinstance(given, ast.Name):
        found.functions[identifier] = given.id


def compose(
    layout: Layout,
    defs: Mapping[str, str],
    furnish: Mapping[str, str],
    others: Iterable[str] = (),
    printed: str = "",
) -> str:
    """A room text: the layout's lines, the library's defs, the objects' own, and what each object is furnished with.

    Args:
        defs: text of the objects' own defs by name. What they use of the library is added.
        furnish: object id -> its furnish statement. Ids that are not in the layout are left out.
        others: statements that the defs need. printed: the layout as `print_layout` prints it, where that is at hand.
    """
    printed = printed or print_layout(layout)
    present = {p.id for p in layout.proxies}
    lines = [statement for i, statement in furnish.items() if i in present]
    if not lines and not defs:
        return printed
    used = set().union(*map(library_names, defs.values())) - defs.keys()
    parts = [printed.removesuffix(END).rstrip()]
    if used:
        parts.append("# Furniture library\n" + _without(catalogue.source(sorted(used)), defs).strip())
    others = without_finishes_of_nothing(others, present_names(layout))
    if others:
        parts.append("\n".join(others))
    parts.append("# Objects: each function takes the size of its object (width, depth, height in metres)")
    parts += [text.strip() for text in defs.values()]
    parts.append("\n".join(lines))
    return "\n\n\n".join(part for part in parts if part) + "\n\n" + END


@lru_cache(maxsize=4096)
def library_names(text: str) -> frozenset[str]:
    """The names in a def that are the library's: most defs of a room are the same from one version to the next."""
    return frozenset(re.findall(r"[A-Za-z_]\w*", text)) & catalogue.definitions().keys()


def _without(source: str, names: Collection[str]) -> str:
    """The library's text without the defs of these names, which somebody wrote anew."""
    kept = [
        block for block in source.split("\n\n\n") if not (m := re.match(r"def (\w+)", block)) or m.group(1) not in names
    ]
    return "\n\n\n".join(kept)


def relaid(text: str, layout: Layout) -> str:
    """A room text with another layout: functions stay, and what is gone is not furnished any more.

    Raises:
        ProgramError: as `read_modelling`.
    """
    if layout == parse_layout(text):
        return text
    old = read_modelling(text)
    others = without_finishes_of_nothing(old.others, present_names(layout))
    if not old.furnished and not any(statement.startswith("finish(") for statement in others):
        return print_layout(layout)
    present = {p.id for p in layout.proxies}
    statements = [statement for i, statement in old.furnished.items() if i in present]
    kept = [*others, *old.defs.values()]
    body = "\n\n\n".join([print_layout(layout).removesuffix(END).rstrip(), *kept, "\n".join(statements)])
    return body + "\n\n" + END


def without_statements(text: str, ids: Collection[str]) -> str:
    """A room text without the furnish statements of these objects; their functions stay.

    Raises:
        ProgramError: as `read_modelling`.
    """
    tree = parse(text, FINISHED_ROOM_LIMITS)
    lines = text.splitlines(keepends=True)
    for node in reversed(tree.body):
        if called_name(node) == "furnish" and isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            first = node.value.args[0] if node.value.args else None
            if isinstance(first, ast.Constant) and first.value in ids:
                del lines[node.lineno - 1 : node.end_lineno]
    return "".join(lines)


def with_statements(text: str, statements: Sequence[str]) -> str:
    """A room text with more statements before its `build()`.

    Raises:
        ProgramError: as `read_modelling`.
    """
    tree = parse(text, FINISHED_ROOM_LIMITS)
    lines = text.splitlines(keepends=True)
    last = next((node.lineno - 1 for node in reversed(tree.body) if called_name(node) == "build"), len(lines))
    return "".join([*lines[:last], *(f"{statement}\n" for statement in statements), *lines[last:]])


def function_name(identifier: str, taken: Collection[str]) -> str:
    """A name for an object's def: its id as far as that can be a name, and nobody else's."""
    base = re.sub(r"\W+", "_", identifier.encode("ascii", "ignore").decode()).strip("_").lower() or "thing"
    base = f"thing_{base}" if base[0].isdigit() else base
    library = catalogue.definitions()
    name, number = base, 1
    while name in RESERVED or name in library or name in taken or name in _KEYWORDS:
        number += 1
        name = f"{base}_made" if number == 2 else f"{base}_made_{number - 1}"
    return name


_KEYWORDS = frozenset({"and", "as", "assert", "async", "await", "break", "class", "continue", "def", "del", "elif", "else",
                       "except", "finally", "for", "from", "global", "if", "import", "in", "is", "lambda", "match",
                       "nonlocal", "not", "or", "pass", "raise", "return", "try", "while", "with", "yield"})  # fmt: skip
