# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of a room text that says what things look like: named looks and `finish` statements, read and written.

oak = wood("#6A4A32")
finish("bed_1", {"frame": oak, "pillow": linen("#EFEAE0"), "": fabric("#B9B4AA")})
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field

from ..artifacts.layout import Layout
from .limits import FINISHED_ROOM_LIMITS
from .lines import WIDTH, called_name, quoted
from .parse_safe import parse
from .prelude.recorder import SURFACES
from .prelude.registry import LOOKS

TITLE = "# Materials"
"""The comment above what `with_materials` writes."""


_END = "build()\n"


@dataclass
class Materials:
    """What a room text says of materials.

    Attributes:
        looks: the expression of each look that has a name, by its name, in their order.
        finishes: for each id (or surface), the expression of each part's or role's look; "" is everything else.
    """

    looks: dict[str, str] = field(default_factory=dict)
    finishes: dict[str, dict[str, str]] = field(default_factory=dict)


def read_materials(text: str) -> Materials:
    """Take the statements on materials out of a room text. Those that are not written plainly are passed over.

    Raises:
        ProgramError: the text is not Python, or too large.
    """
    found = Materials()

    rows = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")

    def source(node: ast.expr) -> str:
        """As written, on one line; Python's own function looks through the whole text each time."""
        taken = [row.encode() for row in rows[node.lineno - 1 : node.end_lineno]]
        taken[-1] = taken[-1][: node.end_col_offset]
        taken[0] = taken[0][node.col_offset :]
        return " ".join(b"\n".join(taken).decode().split())

    for node in parse(text, FINISHED_ROOM_LIMITS).body:
        named = look_name(node)
        if named and isinstance(node, ast.Assign):
            found.looks[named] = source(node.value)
        elif called_name(node) == "finish" and isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            identifier = finished(node)
            looks = [*node.value.args[1:], *(k.value for k in node.value.keywords if k.arg == "looks")]
            if identifier is None or len(looks) != 1:
                continue
            given = looks[0]
            if not isinstance(given, ast.Dict):
                found.finishes[identifier] = {"": source(given)}
                continue
            found.finishes[identifier] = {
                str(key.value): source(value)
                for key, value in zip(given.keys, given.values, strict=True)
                if isinstance(key, ast.Constant)
            }
    return found


def look_name(node: ast.stmt) -> str:
    """The name that a statement gives to a look, "" for other statements."""
    if (
        isinstance(node, ast.Assign)
        and len(node.targets) == 1
        and isinstance(node.targets[0], ast.Name)
        and isinstance(node.value, ast.Call)
        and isinstance(node.value.func, ast.Name)
        and node.value.func.id in LOOKS
    ):
        return node.targets[0].id
    return ""


def finished(node: ast.stmt) -> str | None:
    """What a finish statement is for, None for other statements and where it is not written out."""
    argument = finish_argument(node)
    return argument.value if argument is not None and isinstance(argument.value, str) else None


def finish_argument(node: ast.stmt) -> ast.Constant | None:
    """The literal that says what a finish statement is for."""
    if called_name(node) != "finish" or not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Call):
        return None
    arguments = [*node.value.args[:1], *(k.value for k in node.value.keywords if k.arg == "id")]
    return arguments[0] if arguments and isinstance(arguments[0], ast.Constant) else None


def print_materials(materials: Materials) -> str:
    """The section of a room text: named looks first, then one statement for each thing; "" where there is nothing."""
    lines = [f"{name} = {expression}" for name, expression in materials.looks.items()]
    for identifier, looks in materials.finishes.items():
        pairs = [f"{quoted(key)}: {expression}" for key, expression in looks.items()]
        start = f"finish({quoted(identifier)}, {{"
        whole = f"{start}{', '.join(pairs)}}})"
        lines.append(whole if len(whole) <= WIDTH else "\n".join([start, *(f"    {pair}," for pair in pairs), "})"]))
    return "\n".join([TITLE, *lines]) + "\n" if lines else ""


def with_materials(text: str, materials: Materials) -> str:
    """The room text with these materials in the place of those that it has; every other line stays.

    Raises:
        ProgramError: the text cannot be parsed, before or after.
    """
    tree = parse(text, FINISHED_ROOM_LIMITS)
    lines = text.splitlines(keepends=True)
    gone = [node for node in tree.body if look_name(node) or called_name(node) == "finish"]
    end = next((n.lineno - 1 for n in reversed(tree.body) if called_name(n) == "build"), len(lines))
    above = [*lines[:end], *([] if not lines or lines[end - 1].endswith("\n") else ["\n"])]
    for node in reversed(gone):
        del above[node.lineno - 1 : node.end_lineno]
    kept = "".join(line for line in above if line.strip() != TITLE).rstrip()
    section = print_materials(materials)
    result = "\n\n".join(part.rstrip("\n") for part in (kept, section) if part) + "\n\n" + "".join(lines[end:])
    parse(result, FINISHED_ROOM_LIMITS)
    return result


def with_first_materials(text: str, materials: Materials) -> str:
    """As `with_materials`, for a text that says nothing of materials and ends in `build()`: nothing of it is read."""
    kept, section = text.removesuffix(_END).rstrip(), print_materials(materials).rstrip("\n")
    return "\n\n".join(part for part in (kept, section, _END) if part)


def present_names(layout: Layout) -> set[str]:
    """Everything that `finish` may name in a room with this layout."""
    groups = (layout.walls, layout.doors, layout.windows, layout.openings, layout.proxies)
    return {line.id for group in groups for line in group} | set(SURFACES)


def without_finishes_of_nothing(statements: Iterable[str], present: Collection[str]) -> list[str]:
    """Statements of a room text without the finishes of what is not there any more."""
    kept = []
    for statement in statements:
        names = [finished(node) for node in ast.parse(statement).body] if statement.startswith("finish") else []
        if all(name is None or name in present for name in names):
            kept.append(statement)
    return kept
