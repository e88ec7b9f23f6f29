# SPDX-License-Identifier: GPL-3.0-or-later
"""Layout lines as text: `print_layout` writes them, `parse_layout` reads them, and the two are inverse.

Printed numbers are rounded to `DECIMALS` places (0.1 mm, 0.0001 degrees), those of a camera's matrix and field of view
to `FINE_DECIMALS`; `canonical` does the same to typed lines, so that `parse_layout(print_layout(x)) == canonical(x)`.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from pydantic import ValidationError

from ..artifacts.layout import (
    CameraLine,
    DoorLine,
    Layout,
    LightLine,
    Line,
    OpeningLine,
    ProxyLine,
    RoomLine,
    ViewLine,
    WallLine,
    WindowLine,
    WorldLine,
)
from ..errors import ProgramError
from .limits import FINISHED_ROOM_LIMITS
from .names import is_local
from .parse_safe import names_read, parse
from .prelude.recorder import Recorder
from .scopes import Binder, Scope

DECIMALS = 4
FINE_DECIMALS = 9
WIDTH = 140

LINE_TYPES: dict[str, type[Line]] = {
    "room": RoomLine,
    "wall": WallLine,
    "door": DoorLine,
    "window": WindowLine,
    "opening": OpeningLine,
    "proxy": ProxyLine,
    "light": LightLine,
    "world": WorldLine,
    "view": ViewLine,
    "camera": CameraLine,
}
"""The type of each layout line by the name it is called by."""

_LISTS = {
    "wall": "walls",
    "door": "doors",
    "window": "windows",
    "opening": "openings",
    "proxy": "proxies",
    "light": "lights",
    "world": "worlds",
    "view": "views",
    "camera": "cameras",
}
_POSITIONAL = {
    "room": 0,
    "wall": 3,
    "door": 1,
    "window": 1,
    "opening": 1,
    "proxy": 2,
    "light": 2,
    "world": 1,
    "view": 1,
    "camera": 2,
}
_FINE = {"matrix", "fov_y", "ortho_height"}
# Fields that are printed only when they differ from their default; all others are always printed.
_QUIET = {"partition", "parent", "label", "shape", "color", "target", "fov_y", "ortho_height", "principal",
          "near", "stops", "size_y", "kelvin", "look", "ceiling", "cut"}  # fmt: skip


@dataclass(frozen=True)
class Statement:
    """A layout line of a text and where it stands.

    Attributes:
        name: what is called ("proxy").
        line: the typed line.
        node: its place: 1-based `lineno`, `end_lineno`, and `col_offset`, `end_col_offset` in UTF-8 bytes.
    """

    name: str
    line: Line
    node: ast.Expr


# ---- print ----


def canonical(layout: Layout) -> Layout:
    """The layout as it is printed: numbers rounded, major objects before minor ones."""
    result = Layout(room=_round_line(layout.room))
    for key in _LISTS.values():
        setattr(result, key, [_round_line(line) for line in getattr(layout, key)])
    result.proxies = sorted(result.proxies, key=lambda proxy: proxy.salience != "major")
    return result


def print_layout(layout: Layout, printed: Callable[[Line], str] | None = None) -> str:
    """The room text of a layout: sections with comments, one statement a line, `build()` at the end.

    Args:
        printed: prints a line, or knows how it was printed before; `print_line` without it.
    """
    printed = printed or print_line
    majors = [proxy for proxy in layout.proxies if proxy.salience == "major"]
    minors = [proxy for proxy in layout.proxies if proxy.salience != "major"]
    sections: list[tuple[str, list[Line]]] = [
        ("Shell", [layout.room, *layout.walls]),
        ("Doors, windows and openings", [*layout.doors, *layout.windows, *layout.openings]),
        ("Major objects", [*majors]),
        ("Minor objects", [*minors]),
        ("Lights", [*layout.lights, *layout.worlds]),
        ("Cameras", [*layout.cameras, *layout.views]),
    ]
    blocks = [
        "\n".join([f"# {title}", *(printed(line) for line in lines)]) + "\n" for title, lines in sections if lines
    ]
    return "\n".join([*blocks, "build()\n"])


def print_line(line: Line, brief: bool = False) -> str:
    """One layout line as a statement, wrapped at `WIDTH` characters where it is longer; `brief` leaves out all defaults."""
    name = name_of(line)
    pieces: list[str] = []
    for index, (key, field) in enumerate(type(line).model_fields.items()):
        value = getattr(line, key)
        decimals = FINE_DECIMALS if key in _FINE else DECIMALS
        named = index >= _POSITIONAL[name]
        if (key in _QUIET or (brief and named)) and _rounded(value, decimals) == field.default:
            continue
        prefix = f"{key}=" if named else ""
        pieces.extend(_value_pieces(prefix, value, decimals))
        pieces[-1] += ","
    pieces[-1] = pieces[-1][:-1] + ")"
    return _fill(f"{name}(", pieces)


def name_of(line: Line) -> str:
    """What a typed line is called by in the text."""
    return next(name for name, kind in LINE_TYPES.items() if isinstance(line, kind))


def _value_pieces(prefix: str, value: Any, decimals: int) -> list[str]:
    """The literal in pieces between which a line may be broken."""
    if isinstance(value, list):
        inner = [f"{_literal(item, decimals)}," for item in value] or [""]
        inner[0] = f"{prefix}[{inner[0]}"
        inner[-1] = inner[-1].removesuffix(",") + "]"
        return inner
    if isinstance(value, tuple) and len(value) > 4:
        return [
            f"{prefix if i == 0 else ''}{'(' if i == 0 else ''}{_literal(item, decimals)}"
            + (")" if i == len(value) - 1 else ",")
            for i, item in enumerate(value)
        ]
    return [prefix + _literal(value, decimals)]


def _literal(value: Any, decimals: int) -> str:
    if value is None or isinstance(value, bool):
        return str(value)
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, tuple):
        return "(" + ", ".join(_literal(item, decimals) for item in value) + ")"
    return _number(value, decimals)


def _number(value: float, decimals: int) -> str:
    rounded = round(float(value), decimals)  # numpy's own numbers print as np.float64(...)
    return repr(rounded).removesuffix(".0") if rounded else "0"


def quoted(text: str) -> str:
    """A string literal in double quotes; whatever is not printable is written as an escape."""
    short = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t"}
    return '"' + "".join(short.get(c) or (c if c.isprintable() else _escape(ord(c))) for c in text) + '"'


def _escape(code: int) -> str:
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _fill(start: str, pieces: list[str]) -> str:
    lines, current = [], start + pieces[0]
    for piece in pieces[1:]:
        if len(current) + 1 + len(piece) > WIDTH:
            lines.append(current)
            current = "    " + piece
        else:
            current += " " + piece
    return "\n".join([*lines, current])


def _round_line(line: Any) -> Any:
    values = {key: getattr(line, key) for key in type(line).model_fields}
    return type(line)(**{key: _rounded(v, FINE_DECIMALS if key in _FINE else DECIMALS) for key, v in values.items()})


def _rounded(value: Any, decimals: int) -> Any:
    if isinstance(value, float):
        return round(value, decimals) + 0.0
    if isinstance(value, (tuple, list)):
        return type(value)(_rounded(item, decimals) for item in value)
    return value


def rounded_line(line: Line) -> Line:
    """The line with its numbers as they are printed."""
    result: Line = _round_line(line)
    return result


# ---- parse ----


def parse_layout(text: str) -> Layout:
    """The layout lines of a room text (what follows the marker), in their order; everything else is passed over.

    Raises:
        ProgramError: the text is not Python or too large, a layout line is not a plain statement with literal arguments, or one
            says something that no room can have. It names the line.
    """
    return _parsed_layout(text).model_copy(deep=True)


@lru_cache(maxsize=4)
def _parsed_layout(text: str) -> Layout:
    """A stage, its checks and its building all read the lines of one and the same text."""
    return layout_of(layout_statements(parse(text, FINISHED_ROOM_LIMITS), text))


def parse_line(text: str) -> Line:
    """One printed layout line.

    Raises:
        ProgramError: the text is not exactly one layout line, or the line says something that no room can have.
    """
    statements = layout_statements(parse(text, FINISHED_ROOM_LIMITS))
    if len(statements) != 1:
        raise ProgramError("one layout line is needed", 0)
    return statements[0].line


def layout_of(statements: list[Statement]) -> Layout:
    """The typed lines of these statements. Raises ProgramError when there is no room line."""
    rooms = [s.line for s in statements if isinstance(s.line, RoomLine)]
    if not rooms:
        raise ProgramError("the room line is missing", 0, "Begin with room(size=(w, d, h), floor=[(x, y), ...]).")
    lists: dict[str, list[Line]] = {key: [] for key in _LISTS.values()}
    for statement in statements:
        if statement.name != "room":
            lists[_LISTS[statement.name]].append(statement.line)
    return Layout.model_validate({"room": rooms[0], **lists})


def layout_statements(tree: ast.Module, text: str = "") -> list[Statement]:
    """The layout lines of a program, each checked as it would be when the program runs.

    Args:
        text: what the tree was made from, where that is at hand: functions in it are looked through once only.
    """
    recorder = Recorder()
    statements = []
    plain: set[int] = set()
    for node in tree.body:
        name = called_name(node)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call) and name in LINE_TYPES:
            plain.add(id(node.value))
            statements.append(_statement(recorder, name, node, node.value))
    misplaced = [
        inner.func
        for inner in ast.walk(ast.Module(_may_have_lines(tree, text), []))
        if isinstance(inner, ast.Call) and id(inner) not in plain
        and isinstance(inner.func, ast.Name) and inner.func.id in LINE_TYPES
    ]  # fmt: skip
    for word in _not_local(tree, misplaced):
        raise ProgramError(
            f"{word.id}(...) is a layout line: write each as a statement of its own at the left margin, "
            "not in a loop, a function or an expression",
            word.lineno,
        )
    return statements


def _not_local(tree: ast.Module, names: list[ast.Name]) -> list[ast.Name]:
    """Those of these names that mean the language's own words: a def may call something of its own by such a name."""
    if not names:
        return []
    found = Binder(Scope(None)).run(tree)
    scopes = {id(use): scope for use, scope in found.uses}
    return [n for n in names if id(n) not in scopes or not is_local(n.id, scopes[id(n)], found.module)]


def _may_have_lines(tree: ast.Module, text: str) -> list[ast.stmt]:
    """The statements without functions that name no layout line."""
    if not text or "\r" in text:
        return tree.body
    rows = text.removeprefix("\ufeff").split("\n")
    return [
        node
        for node in tree.body
        if not isinstance(node, ast.FunctionDef)
        or node.decorator_list
        or not LINE_TYPES.keys().isdisjoint(names_read("\n".join(rows[node.lineno - 1 : node.end_lineno])))
    ]


def called_name(node: ast.stmt) -> str:
    """The name that a statement calls, "" when it is not a plain call."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call) and isinstance(node.value.func, ast.Name):
        return node.value.func.id
    return ""


def _statement(recorder: Recorder, name: str, node: ast.Expr, call: ast.Call) -> Statement:
    if any(isinstance(arg, ast.Starred) for arg in call.args) or any(k.arg is None for k in call.keywords):
        raise ProgramError(f"{name}: write every argument out, without * or **", node.lineno)
    arguments = [literal_of(arg) for arg in call.args]
    keywords = {str(k.arg): literal_of(k.value) for k in call.keywords}
    try:
        fields = checked_fields(recorder, name, arguments, keywords)
        return Statement(name, LINE_TYPES[name].model_validate(fields), node)
    except TypeError as error:
        raise ProgramError(str(error).replace("Recorder.", ""), node.lineno) from None
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise ProgramError(f"{name}: {place}: {first['msg']}", node.lineno) from None
    except ValueError as error:
        raise ProgramError(str(error), node.lineno) from None


def checked_fields(recorder: Recorder, name: str, arguments: list[Any], keywords: dict[str, Any]) -> dict[str, Any]:
    """The fields of one layout line with defaults filled in. Raises ValueError or TypeError as the program would."""
    getattr(recorder, name)(*arguments, **keywords)
    if name == "room":
        return recorder.record.room or {}
    found: dict[str, Any] = getattr(recorder.record, _LISTS[name])[-1]
    return found


def literal_of(node: ast.expr) -> Any:
    """The value of a literal: numbers, strings, True, False, None, tuples and lists of these."""
    if isinstance(node, ast.Constant) and (node.value is None or isinstance(node.value, (bool, int, float, str))):
        return node.value
    if isinstance(node, ast.Tuple):
        return tuple(literal_of(item) for item in node.elts)
    if isinstance(node, ast.List):
        return [literal_of(item) for item in node.elts]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        value = literal_of(node.operand)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return -value if isinstance(node.op, ast.USub) else value
    raise ProgramError("layout lines take literal values only: numbers, texts, tuples and lists", node.lineno)
