# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs of objects as a model wrote them: read, repaired where that is safe, evaluated within limits, and checked."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from ..artifacts.layout import ProxyLine
from ..errors import ProgramError
from ..library import catalogue
from ..program.evaluate import evaluate_object
from ..program.limits import DEFAULT_LIMITS
from ..program.lines import LINE_TYPES, called_name
from ..program.parse_safe import parse
from ..program.prelude.palette import ROLE_COLOURS, split_role
from ..program.prelude.shape import Shape
from ..program.reuse import remember
from .checks import Checked, check, extent
from .text import library_names

_FENCE = re.compile(r"```(?:python)?\s*\n(.*?)```", re.DOTALL)
SHARED = "shared_"
"""What the names of defs begin with that several objects' programs have in common, text by text; they stay as they are."""
STRETCH = 1.6
"""How far a program's shapes may be stretched to fill their proxy before that would show."""
FAR = 2.2
"""The same for drafts, where what stands otherwise was not made by looking at the picture."""
_LIKE_ROLES: dict[str, str] = {
    "chrome": "steel", "aluminium": "steel", "aluminum": "steel", "iron": "metal", "gold": "brass", "copper": "brass",
    "oak": "wood", "walnut": "dark wood", "pine": "wood", "timber": "wood", "plywood": "wood", "rattan": "wicker",
    "cotton": "linen", "wool": "fabric", "cloth": "fabric", "textile": "fabric", "upholstery": "fabric",
    "suede": "leather", "paint": "painted", "lacquer": "painted", "white": "painted", "concrete": "stone",
    "porcelain": "ceramic", "clay": "terracotta", "leaf": "foliage", "leaves": "foliage", "plant": "foliage",
    "earth": "soil", "glow": "shade", "bulb": "shade", "cardboard": "paper", "display": "screen",
}  # fmt: skip


@dataclass(frozen=True)
class Written:
    """An object's program that was evaluated.

    Attributes:
        name: of its def. code: its def and its helpers, ready for a room text.
        shapes: what it makes in its proxy's size. checked: what was measured on them before they were stretched to fit.
    """

    name: str
    code: str
    shapes: tuple[Shape, ...]
    checked: Checked


def take_program(
    text: str, proxy: ProxyLine, name: str, taken: Collection[str] = (), stretch: float = STRETCH
) -> Written:
    """Make a model's program an object's: under its own names, filling its proxy, with known materials.

    Args:
        name: that its def is to have. taken: names that its helpers must not have.
        stretch: how far its shapes may be stretched to fill the proxy.

    Raises:
        ProgramError: it is outside the room language, over a limit, or makes nothing of use; the line is in the text.
    """
    source = program_of(text)
    tree = parse(source, DEFAULT_LIMITS)
    main, source = _named(source, tree, name, taken)
    library = catalogue.source(_library_names(source))
    size = tuple(float(v) for v in proxy.size)
    head = f"{library}\n\n" if library else ""
    try:
        tree = parse(head + source, DEFAULT_LIMITS)
        shapes = evaluate_object(head + source, main, args=(size,), tree=tree)
    except ProgramError as error:
        error.line = max(0, error.line - head.count("\n")) if error.line else 0
        raise
    shapes = [shape for shape in shapes if len(shape.vertices)]
    if not shapes:
        raise ProgramError("the program makes no shapes")
    checked = check(shapes, size, proxy.placement)
    fixes = _fixes(shapes, size, stretch)
    if fixes is None:
        raise ProgramError(f"its shapes are far from the size {_sizes(size)}: {'; '.join(checked.findings[:3])}")
    if not fixes and not _roles(shapes):
        remember(head + source, name, size, shapes, tree)
        return Written(name, source, tuple(shapes), checked)
    if main != name:
        raise ProgramError("its names cannot be used")
    # What it replaces may have been fitted, too.
    inner = next(n for k in itertools.count(1) if (n := f"{name}_shapes{k if k > 1 else ''}") not in taken)
    source = _renamed(source, {name: inner})
    source += f"\n\n\ndef {name}(size):\n    return {_wrapped(f'{inner}(size)', fixes, _roles(shapes))}"
    # What was made is fitted as the wrapped def will do it: making it again would take as long as the first time.
    fit = f"def fitted(shapes, size):\n    return {_wrapped('shapes', fixes, _roles(shapes))}\n"
    needed = catalogue.source(["fill"]) if fixes else ""
    shapes = evaluate_object(f"{needed}\n\n{fit}", "fitted", args=(shapes, size))
    remember(f"{catalogue.source(_library_names(source))}\n\n{source}", name, size, shapes)
    return Written(name, source, tuple(shapes), checked)


def _wrapped(call: str, fill: bool, roles: dict[str, str]) -> str:
    if roles:
        call = f"tint({call}, {{{', '.join(f'{_quoted(a)}: {_quoted(b)}' for a, b in roles.items())}}})"
    return f"fill({call}, size)" if fill else call


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _fixes(shapes: Sequence[Shape], size: Sequence[float], stretch: float) -> bool | None:
    """Whether the shapes have to be stretched to fill the proxy; None where that would spoil them."""
    low, high = extent(shapes)
    ratios = np.array(size) / np.maximum(high - low, 1e-6)
    if ratios.max() > stretch or ratios.min() < 1 / stretch:
        return None
    middle = np.abs((low + high)[:2] / 2).max()
    return bool(np.abs(ratios - 1).max() > 0.001 or middle > 0.001 or abs(low[2]) > 0.001)


def _roles(shapes: Sequence[Shape]) -> dict[str, str]:
    """Known materials for those that the language does not know, by what they are called."""
    found = {}
    for shape in shapes:
        role, _ = split_role(shape.material)
        if role and role not in ROLE_COLOURS and role != "front":
            words = re.findall(r"[a-z]+", role.lower())
            known = [w for w in [" ".join(words), *reversed(words)] if w in ROLE_COLOURS]
            like = [_LIKE_ROLES[w] for w in reversed(words) if w in _LIKE_ROLES]
            found[role] = (known + like + ["painted"])[0]
    return found


def program_of(text: str) -> str:
    """The program in a reply, without code fences, layout lines and furnish statements."""
    fenced = _FENCE.findall(text)
    source = max(fenced, key=len) if fenced else text
    return source.replace("\r\n", "\n").replace("\t", "    ").strip("\n").rstrip()


def _named(source: str, tree: ast.Module, name: str, taken: Collection[str]) -> tuple[str, str]:
    """The program with its main def called `name` and helpers out of the way of others; nothing else at its top."""
    lines = source.splitlines()
    defs = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    kept = []
    for node in tree.body:
        if called_name(node) in (*LINE_TYPES, "furnish", "build") or _is_text(node):
            continue
        kept.append("\n".join(lines[node.lineno - 1 : node.end_lineno]))
    if not defs:
        raise ProgramError("there is no def in it; write one that takes size and returns shapes")
    main = next((d for d in defs if d.name == name), defs[-1])
    if len(main.args.args) - len(main.args.defaults) > 1 or not main.args.args:
        raise ProgramError(f"def {main.name} must take one parameter, size", main.lineno)
    library = catalogue.definitions()
    bound = {
        n.id
        for node in tree.body
        if isinstance(node, ast.Assign)
        for n in ast.walk(node.targets[0])
        if isinstance(n, ast.Name)
    }
    names = {main.name: name}
    for other in [*(d.name for d in defs if d is not main), *sorted(bound)]:
        own = other.startswith((name, SHARED)) and other not in library and other not in taken
        names[other] = other if own else f"{name}_{other}"
    text = "\n\n\n".join(kept)
    changed = {old: new for old, new in names.items() if old != new}
    return name, _renamed(text, changed) if changed else text


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _renamed(source: str, names: dict[str, str]) -> str:
    """The program with other names for its own defs and numbers. What a def calls so itself (a parameter) goes along."""
    tree = parse(source, DEFAULT_LIMITS)
    spots: list[tuple[int, int, str]] = []
    lines = source.splitlines(keepends=True)

    def column(line: int, offset: int) -> int:
        return len(lines[line - 1].encode()[:offset].decode())

    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and node.id in names:
            spots.append((node.lineno, column(node.lineno, node.col_offset), node.id))
        elif isinstance(node, ast.arg) and node.arg in names:
            spots.append((node.lineno, column(node.lineno, node.col_offset), node.arg))
        elif isinstance(node, ast.keyword) and node.arg in names:
            continue  # a keyword names a parameter of what is called, which is not ours
        elif isinstance(node, ast.FunctionDef) and node.name in names:
            line = lines[node.lineno - 1]
            spots.append((node.lineno, line.index(node.name, line.index("def") + 3), node.name))
    for number, at, old in sorted(set(spots), reverse=True):
        text = lines[number - 1]
        lines[number - 1] = text[:at] + names[old] + text[at + len(old) :]
    return "".join(lines)


def _library_names(source: str) -> list[str]:
    """The library's defs that a program uses and does not define itself."""
    if not library_names(source):
        return []
    tree = parse(source, DEFAULT_LIMITS)
    own = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    used = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}
    return sorted((used & catalogue.definitions().keys()) - own)


def _sizes(size: Sequence[float]) -> str:
    return " x ".join(f"{v:.2f}" for v in size)
