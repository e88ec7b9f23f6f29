# SPDX-License-Identifier: GPL-3.0-or-later
"""The sentences with which a program is refused: what is wrong and what to write instead, for a model to act on."""

from __future__ import annotations

import ast
import difflib
import inspect
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from ..errors import ProgramError

MOST_PROBLEMS = 10
MOST_CANDIDATES = 500


class ProgramProblems(ProgramError):
    """A program was refused before it ran. `message` and `line` are those of the first problem.

    Attributes:
        problems: all problems that were found, in the order of their lines, at most ten.
    """

    def __init__(self, problems: Sequence[ProgramError]) -> None:
        first = problems[0]
        super().__init__(first.message, first.line, first.fix)
        self.problems = tuple(problems[:MOST_PROBLEMS])

    def __str__(self) -> str:
        return "\n".join(ProgramError.__str__(problem) for problem in self.problems)


def refuse(problems: Sequence[ProgramError]) -> None:
    """Raise the problems, if there are any, sorted by line and without repetitions."""
    seen = {(problem.line, problem.message): problem for problem in problems}
    if seen:
        raise ProgramProblems(sorted(seen.values(), key=lambda problem: problem.line))


STATEMENTS: dict[type[ast.AST], tuple[str, str]] = {
    ast.Import: ("imports are not in the room language", "The functions you need (sin, sqrt, lerp, ...) are there."),
    ast.ImportFrom: (
        "imports are not in the room language",
        "The functions you need (sin, sqrt, lerp, ...) are there.",
    ),
    ast.ClassDef: ("classes are not in the room language", "Use a def that returns a list of shapes."),
    ast.While: ("while is not in the room language", "Use for i in range(n), with break if needed."),
    ast.Try: ("try is not in the room language", "Write code that cannot fail, with if."),
    ast.With: ("with is not in the room language", ""),
    ast.Global: ("global is not in the room language", "Return the value from the function instead."),
    ast.Nonlocal: ("nonlocal is not in the room language", "Return the value from the function instead."),
    ast.Delete: ("del is not in the room language", "Make a new list without the item."),
    ast.Assert: ("assert is not in the room language", "Leave it out."),
    ast.Raise: ("raise is not in the room language", "Leave it out."),
    ast.Match: ("match is not in the room language", "Use if and elif."),
    ast.AnnAssign: ("annotations are not in the room language", "Write name = value without the type."),
    ast.AsyncFunctionDef: ("async is not in the room language", "Use a plain def."),
    ast.AsyncFor: ("async is not in the room language", "Use a plain for."),
    ast.AsyncWith: ("async is not in the room language", ""),
}
if hasattr(ast, "TryStar"):
    STATEMENTS[ast.TryStar] = STATEMENTS[ast.Try]

EXPRESSIONS: dict[type[ast.AST], tuple[str, str]] = {
    ast.Set: ("sets are not in the room language", "Use a list or a dict."),
    ast.SetComp: ("sets are not in the room language", "Use a list or a dict."),
    ast.NamedExpr: (":= is not in the room language", "Assign in a statement of its own."),
    ast.Yield: ("yield is not in the room language", "Append to a list and return it."),
    ast.YieldFrom: ("yield is not in the room language", "Append to a list and return it."),
    ast.Await: ("await is not in the room language", ""),
}

OPERATORS: dict[type[ast.AST], tuple[str, str]] = {
    ast.MatMult: ("@ is not in the room language", "Write the products out."),
    ast.LShift: ("<< is not in the room language", "Multiply by a power of 2."),
    ast.RShift: (">> is not in the room language", "Use // with a power of 2."),
    ast.BitOr: ("| is not in the room language", "Use or between conditions."),
    ast.BitAnd: ("& is not in the room language", "Use and between conditions."),
    ast.BitXor: ("^ is not in the room language", "Use ** for powers."),
    ast.Invert: ("~ is not in the room language", "Use not."),
}

ATTRIBUTES: dict[str, str] = {
    "append": "Use append({0}, value) instead of {0}.append(value).",
    "extend": "Use {0} += values instead of {0}.extend(values).",
    "insert": "Build a new list with + instead of {0}.insert(...).",
    "keys": "Use keys({0}) instead of {0}.keys().",
    "values": "Use values({0}) instead of {0}.values().",
    "items": "Use items({0}) instead of {0}.items().",
    "get": "Use {0}[key] if key in {0} else default instead of {0}.get(key, default).",
    "sort": "Use {0} = sorted({0}) instead of {0}.sort().",
    "reverse": "Use {0} = {0}[::-1] instead of {0}.reverse().",
    "copy": "Use list({0}) or {0}[:] instead of {0}.copy().",
    "format": 'Use an f-string such as f"leg_{{i}}" instead of .format(...).',
    "join": "Build the text with + or an f-string instead of .join(...).",
    "pop": "Use {0}[:-1] for a list without its last item instead of {0}.pop().",
    "vertices": "Shapes cannot be looked into; keep the numbers you made them from.",
    "location": "Use move(shape, (x, y, z)) instead of setting .location.",
}
MODULES = frozenset(
    {"math", "np", "numpy", "random", "bpy", "bmesh", "mathutils", "itertools", "functools", "os", "sys"}
)

NAMES: dict[str, str] = {
    "print": "Leave it out; nothing is printed.",
    "set": "Use a list or a dict.",
    "dict": "Write {key: value}.",
    "map": "Use a list comprehension.",
    "filter": "Use a list comprehension with if.",
    "pow": "Write a ** b.",
    "divmod": "Write a // b and a % b.",
    "isinstance": "Types cannot be asked for; pass a parameter instead.",
    "type": "Types cannot be asked for; pass a parameter instead.",
    "random": "Use rand(seed) or rand(seed, low, high).",
    "uniform": "Use rand(seed, low, high).",
    "math": "Write sin(x), sqrt(x), pi without math.",
    "next": "Use a for loop or an index.",
    "iter": "Use a for loop.",
    "inf": "Use a large number such as 1e9.",
    "complex": "There are only real numbers.",
    "rotate": "Write turn(shapes, degrees, axis).",
    "translate": "Write move(shapes, (x, y, z)).",
    "union": "Put the shapes into a list.",
    "group": "Put the shapes into a list.",
    "difference": "Write carve(shapes, cutters).",
    "subtract": "Write carve(shapes, cutters).",
    "intersection": "Shapes can be carved, but not intersected; make the shape that is meant.",
    "cube": "Write box((width, depth, height)).",
    "plane": "Write a thin box((width, depth, height)), or grid(...).",
    "dist": "Write hypot(x2 - x1, y2 - y1).",
    "copysign": "Write abs(x) if y >= 0 else -abs(x).",
    "isclose": "Write abs(a - b) < 0.001.",
}


def attribute_refusal(node: ast.Attribute) -> ProgramError:
    """Why `node` is refused, with the way to write it if there is one."""
    owner = node.value.id if isinstance(node.value, ast.Name) else "x"
    if owner in MODULES:
        fix = f"Write {node.attr}(...) without {owner}, if the language has it."
    else:
        fix = ATTRIBUTES.get(node.attr, "Use plain functions, indexing and dicts.").format(owner)
    return ProgramError(f"attributes are not in the room language (.{node.attr})", node.lineno, fix)


def unknown_name(name: str, line: int, known: Iterable[str]) -> ProgramError:
    """An unknown name, with the name that was probably meant."""
    if name in NAMES:
        return ProgramError(f"{name} is not in the room language", line, NAMES[name])
    candidates = [other for other in known if abs(len(other) - len(name)) <= 3][:MOST_CANDIDATES]
    close = difflib.get_close_matches(name[:60], candidates, 1)
    return ProgramError(f"the name {name[:60]} is not known", line, f"Did you mean {close[0]}?" if close else "")


def sentence(error: BaseException) -> str:
    """One plain sentence for an exception that came up while a program ran."""
    text = str(error).replace("math.", "")
    if isinstance(error, KeyError):
        return f"the dict has no key {str(error)[:80]}"
    if isinstance(error, ZeroDivisionError):
        return "division by zero"
    if isinstance(error, RecursionError):
        return "calls or values are nested too deeply"
    if isinstance(error, MemoryError):
        return "the program needs too much memory"
    if isinstance(error, OverflowError):
        return "the result is too large"
    if text == "math domain error" or text.endswith("domain error"):
        return "the function is not defined for this number (such as sqrt or log of a negative one)"
    if isinstance(error, (TypeError, ValueError, IndexError)) and text:
        return text[:300]
    return f"this cannot be evaluated ({type(error).__name__}: {text[:200]})"


def misfit(error: Exception, name: str, call: Callable[..., Any]) -> str:
    """What a function of the language takes, when an error says that it was given something else; "" otherwise."""
    if not isinstance(error, TypeError) or f"{getattr(call, '__name__', name)}() " not in str(error):
        return ""
    try:
        parameters = list(inspect.signature(call).parameters.values())
    except (TypeError, ValueError):
        return ""
    words = [p.name if p.default is p.empty else f"{p.name}=" for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD]
    return f"Write {name}({', '.join(words)})." if words else ""


def located(error: Exception, line: int, fix: str = "") -> ProgramError:
    """The error as a ProgramError that carries a line; an inner line is kept."""
    if isinstance(error, ProgramError):
        if not error.line:
            error.line = line
        return error
    return ProgramError(sentence(error), line, fix)
