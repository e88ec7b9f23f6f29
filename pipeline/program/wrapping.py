# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of a program broken where they are too long to be read, at brackets first, as a person would."""

from __future__ import annotations

import ast
import copy
import io
import re
import tokenize
from collections.abc import Iterator

from .lines import quoted

WIDTH = 120
_OPEN, _CLOSE = "([{", ")]}"
_WORDS = re.compile(r" (?:for|if|else|and|or|\+|-|\*) ")


def wrapped(text: str, width: int = WIDTH) -> str:
    """The same program with its long lines broken. What cannot be broken without doubt stays as it is."""
    found: list[str] = []
    depth, in_text = 0, False
    for line in text.split("\n"):
        quotes = line.count('"""')
        whole = not in_text and not quotes and _depth(line) == 0
        in_text ^= quotes % 2 == 1
        depth += 0 if quotes or in_text else _depth(line)
        found += _broken(line, width, depth > 0) if whole and len(line) > width and not has_comment(line) else [line]
    result = "\n".join(found)
    try:
        same = ast.dump(ast.parse(result)) == ast.dump(ast.parse(text))
    except SyntaxError:  # quotes within quotes, as Python 3.12 and later write f-strings
        same = False
    return result if same else _piecewise(text, width)


def _piecewise(text: str, width: int) -> str:
    """As `wrapped`, with every line tried by itself."""
    lines = text.split("\n")
    meant = ast.dump(ast.parse(text))
    for at in [n for n, line in enumerate(lines) if len(line) > width and not has_comment(line)]:
        tried = "\n".join([*lines[:at], *_broken(lines[at], width), *lines[at + 1 :]])
        try:
            if ast.dump(ast.parse(tried)) == meant:
                lines[at] = "\n".join(_broken(lines[at], width))
        except SyntaxError:
            continue
    return "\n".join(lines)


def written(node: ast.AST) -> str:
    """A statement as text, with strings in double quotes and no brackets round what `f(x for x in y)` is given.

    It is the same whatever Python it is written by, and every Python that Blender has can read it.
    """
    texts = _Formatted()
    code = _in_double_quotes(ast.unparse(texts.visit(copy.deepcopy(node))))
    for name, text in reversed(texts.found.items()):
        code = code.replace(name, text)
    lines = code.split("\n")
    for at, line in enumerate(lines):
        bare = _bare_generators(line)
        if bare != line:
            tried = [*lines[:at], bare, *lines[at + 1 :]]
            if ast.dump(ast.parse("\n".join(tried))) == ast.dump(ast.parse(code)):
                lines = tried
    return "\n".join(lines)


class _Formatted(ast.NodeTransformer):
    """Puts names in the place of f-strings, whose text would depend on the Python that writes it."""

    def __init__(self) -> None:
        self.found: dict[str, str] = {}

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.expr:
        """An f-string."""
        text = _f_string(node)
        if text is None:
            return node
        name = f"__f{len(self.found)}__"
        self.found[name] = f'f"{text}"'
        return ast.Name(name)


def _f_string(node: ast.JoinedStr) -> str | None:
    """What stands between the quotes of an f-string, None for those with quotes within quotes."""
    parts: list[str] = []
    for value in node.values:
        if isinstance(value, ast.Constant):
            parts.append(quoted(str(value.value))[1:-1].replace("{", "{{").replace("}", "}}"))
        elif isinstance(value, ast.FormattedValue):
            inner, spec = ast.unparse(value.value), ""
            if isinstance(value.format_spec, ast.JoinedStr):
                spec = ":" + (_f_string(value.format_spec) or "")
            if '"' in inner or "\\" in inner or "\n" in inner or spec == ":":
                return None
            sign = f"!{chr(value.conversion)}" if value.conversion >= 0 else ""
            parts.append(f"{{{' ' if inner.startswith('{') else ''}{inner}{sign}{spec}}}")
    return "".join(parts)


def _bare_generators(line: str) -> str:
    """f((x for x in y)) as f(x for x in y)."""
    at = len(line)
    while (at := line.rfind("((", 0, at)) > 0:
        depths = [(place, letter) for place, letter, depth in _marks(line[at + 1 :]) if depth == 0]
        end = next((place for place, letter in depths if letter == ")"), -1)
        inner = line[at + 2 : at + 1 + end]
        if (
            end > 0
            and line[at + 2 + end : at + 3 + end] == ")"
            and " for " in inner
            and re.match(r"[\w\]]", line[at - 1])
        ):
            line = f"{line[: at + 1]}{inner}{line[at + 2 + end :]}"
    return line


def bare_tuples(code: str) -> str:
    """A program with `a, b = (c, d)` and `return (c, d)` without the brackets, as a person writes them."""
    return "\n".join(map(_bare_tuple, code.split("\n")))


def _bare_tuple(line: str) -> str:
    head, _, value = line.partition("(")
    if not head.endswith((" = ", "return ")) or not value.endswith(")") or ", " not in value:
        return line
    bare = head + value[:-1]
    try:
        bodies = [ast.dump(ast.parse(f"def f():\n {text.strip()}")) for text in (line, bare)]
    except SyntaxError:
        return line
    return bare if bodies[0] == bodies[1] else line


def _in_double_quotes(code: str) -> str:
    """A program with its short strings in double quotes, where that changes nothing else."""
    rows = code.split("\n")
    depth = 0  # Python 3.12 and later take f-strings apart
    for token in reversed(list(tokenize.generate_tokens(io.StringIO(code).readline))):
        kind = tokenize.tok_name[token.type]
        depth += (kind == "FSTRING_END") - (kind == "FSTRING_START")
        if kind == "STRING" and not depth and token.start[0] == token.end[0] and token.string.startswith("'"):
            row, start, end = token.start[0] - 1, token.start[1], token.end[1]
            rows[row] = rows[row][:start] + quoted(ast.literal_eval(token.string)) + rows[row][end:]
    return "\n".join(rows)


def _marks(text: str) -> Iterator[tuple[int, str, int]]:
    """(place, character, depth of brackets) of all outside of strings, up to a comment; a bracket has its outer depth."""
    depth, quote, skip = 0, "", False
    for at, letter in enumerate(text):
        if quote:
            if skip:
                skip = False
            elif letter == "\\":
                skip = True
            elif letter == quote:
                quote = ""
            continue
        if letter in "\"'":
            quote = letter
            continue
        if letter == "#":
            yield at, letter, depth
            return
        if letter in _CLOSE:
            depth -= 1
        yield at, letter, depth
        if letter in _OPEN:
            depth += 1


def has_comment(line: str) -> bool:
    """Whether a line ends in a comment."""
    return any(letter == "#" for _, letter, _ in _marks(line))


def _depth(line: str) -> int:
    """How many brackets more a line opens than it closes."""
    return sum((letter in _OPEN) - (letter in _CLOSE) for _, letter, _ in _marks(line))


def _broken(line: str, width: int, inside: bool = False) -> list[str]:
    """A line in several, or as it is. `inside`: it stands in a bracket, where it may end anywhere."""
    if len(line) <= width:
        return [line]
    indent = line[: len(line) - len(line.lstrip())]
    opened, groups = 0, []
    for at, letter, depth in _marks(line):
        if depth == 0 and letter in _OPEN:
            opened = at
        elif depth == 0 and letter in _CLOSE and at > opened + 1:
            groups.append((opened, at))
    start, end = max(groups, key=lambda group: group[1] - group[0], default=(0, 0))
    if end - start < 0.5 * len(line.strip()):
        head = re.match(r"\s*(?:return|[\w., \[\]]+ =) ", line)
        if head:
            return [f"{head.group()}(", *_filled(line[head.end() :], indent + "    ", width), f"{indent})"]
        parts = _cut(line.strip(), _operators(line.strip())) if inside else []
        if len(parts) > 1:
            return [piece for row in _rows(parts, indent, width) for piece in _broken(row, width, len(parts) > 1)]
    if not end:
        return [line]
    start, end = _innermost(line, start, end, width)
    inner = _filled(line[start + 1 : end], indent + "    ", width)
    return [line[: start + 1], *inner, *_broken(indent + line[end:].lstrip(), width)]


def _innermost(line: str, start: int, end: int, width: int) -> tuple[int, int]:
    """The bracket to break a line in: where what is in it is mostly a call at its end, as in f(made, g(...)), that one's."""
    while True:
        body = line[start + 1 : end].rstrip(" ,")
        last = max((at for at, letter, depth in _marks(body) if depth == 0 and letter in _OPEN), default=-1)
        closes = [at for at, letter, depth in _marks(body) if depth == 0 and letter in _CLOSE]
        called = last > 0 and (body[last - 1].isalnum() or body[last - 1] in "_, ([")
        if not called or not closes or closes[-1] != len(body) - 1 or len(body) - last < 0.6 * len(body):
            return start, end
        if (
            start + 1 + last >= width - 20
            or any(letter == "," for at, letter, depth in _marks(body[:last]) if depth)
            or (" " in body[:last].replace(", ", ","))
        ):
            return start, end
        start, end = start + 1 + last, start + 1 + closes[-1]


def _operators(text: str) -> list[int]:
    """Where operators stand that are in no bracket."""
    outer = {at for at, _, depth in _marks(text) if depth == 0}
    return [found.start() for found in _WORDS.finditer(text) if found.start() in outer]


def _cut(text: str, places: list[int]) -> list[str]:
    parts = [text[a:b].strip() for a, b in zip([0, *places], [*places, len(text)], strict=True)]
    return [part for part in parts if part]


def _rows(parts: list[str], indent: str, width: int) -> list[str]:
    """Parts side by side in lines of this width."""
    lines = [indent]
    for part in parts:
        if lines[-1] != indent and len(lines[-1]) + 1 + len(part) > width:
            lines.append(indent)
        lines[-1] += part if lines[-1] == indent else f" {part}"
    return lines


def _filled(body: str, indent: str, width: int) -> list[str]:
    """What stands in a bracket, in lines: after its commas, else before its operators."""
    words = _operators(body)
    commas = [at + 1 for at, letter, depth in _marks(body) if depth == 0 and letter == ","]
    loops = any(body[at:].startswith(" for ") for at in words)
    cuts = [at for at in words if body[at:].startswith((" for ", " if "))] if loops else commas or words
    parts = _cut(body, cuts)
    if commas and not loops and not body.rstrip().endswith(","):
        parts[-1] += ","
    rows = _rows(parts, indent, width)
    return [piece for row in rows for piece in _broken(row, width, inside=True)]
