# SPDX-License-Identifier: GPL-3.0-or-later
"""Rewrites what is good Python but not the room language, so that a model's program is not lost over a way of writing.

Only what has one meaning is rewritten: `math.sin(x)`, `shapes.append(x)`, annotations, `cylinder(r=0.1, ...)`,
`box(1, 2, 3)`, `cushion = cushion(...)`. Nothing is run. The rewritten text goes through all checks as any other.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterable
from typing import Any

from ..errors import ProgramError
from ..program.functions import GENERATOR_TAKERS
from ..program.limits import DEFAULT_LIMITS
from ..program.parse_safe import parse
from ..program.prelude import registry
from .idiom_names import with_own_names, without_stars
from .idioms import Idioms
from .written import program_of

_MODULES = frozenset({"math", "np", "numpy"})
_METHODS = frozenset({"keys", "values", "items"})
_SAME: dict[str, str] = {"fabs": "abs", "translate": "move", "rotate": "turn", "cube": "box", "subtract": "carve",
                         "difference": "carve", "power": "pow"}  # fmt: skip
_KEYWORDS: dict[str, tuple[str, ...]] = {
    "radius": ("r", "rad", "corner_radius", "bevel"),
    "height": ("h", "length", "depth"),
    "top_radius": ("radius2", "radius_top", "r2"),
    "at": ("pos", "position", "center", "centre", "location", "loc", "origin"),
    "size": ("dims", "dimensions"),
    "segments": ("sides", "resolution", "segs"),
    "about": ("pivot", "at", "center", "centre", "origin"),
    "angle": ("degrees", "deg"),
    "by": ("offset", "vector", "delta"),
    "shapes": ("shape", "objects", "parts"),
    "edge": ("bevel", "rounding"),
}
"""What else the parameters of constructors are called, where a constructor has no parameter of that name itself."""
_LISTS = frozenset({"union", "group"})
_SPREAD = {"box": 3, "rounded_box": 3, "wedge": 3, "move": 4, "scale": 4}
"""Constructors that take a triple, with how many arguments they are given when its numbers are written singly."""


def mended(source: str) -> str | None:
    """The program in the room language as far as that is a matter of writing; None when there is nothing to rewrite.

    Comments are lost with it.

    Raises:
        ProgramError: it is not Python, or too large.
    """
    tree = parse(program_of(source), DEFAULT_LIMITS)
    before = ast.dump(tree)
    with_own_names(tree)
    tree = ast.fix_missing_locations(Idioms(tree).visit(tree))
    without_stars(tree)
    tree = _apart(tree)
    made = ast.fix_missing_locations(_Mender(_bound(tree)).visit(tree))
    for node in ast.walk(made):
        if isinstance(node, ast.FunctionDef):
            _rename_own(node)
    if ast.dump(made) == before:
        return None
    try:
        return ast.unparse(made)
    except (RecursionError, ValueError):
        raise ProgramError("the program is nested too deeply") from None


def _apart(tree: ast.Module) -> ast.Module:
    """The tree with no node in it twice."""
    try:
        return parse(ast.unparse(ast.fix_missing_locations(tree)), DEFAULT_LIMITS)
    except (RecursionError, ValueError):
        raise ProgramError("the program is nested too deeply") from None


class _Mender(ast.NodeTransformer):
    """Args: bound: names that the program binds anywhere, which are left alone."""

    def __init__(self, bound: frozenset[str]) -> None:
        self.bound = bound

    def visit_Import(self, node: ast.Import) -> ast.stmt:
        """Modules are not needed."""
        return ast.Pass()

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.stmt:
        """Modules are not needed."""
        return ast.Pass()

    def visit_Assert(self, node: ast.Assert) -> ast.stmt:
        """A program has no need to stop."""
        return ast.Pass()

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST:
        """name: type = value"""
        if node.value is None:
            return ast.Pass()
        return self.generic_visit(ast.Assign([node.target], node.value))

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """Annotations and the * before keywords go."""
        node.returns = None
        given = node.args
        for argument in [*given.posonlyargs, *given.args, *given.kwonlyargs]:
            argument.annotation = None
        if not given.vararg and not given.kwarg:
            given.args += given.kwonlyargs
            ordered = given.defaults or any(given.kw_defaults)
            given.defaults += [default or ast.Constant(None) for default in given.kw_defaults if default or ordered]
            given.kwonlyargs, given.kw_defaults = [], []
            given.args, given.posonlyargs = [*given.posonlyargs, *given.args], []
        return self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> ast.AST:
        """print(...) goes; values.extend(more) becomes one loop."""
        call = node.value
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "print":
            return ast.Pass()
        if _is_method(call, "extend", 1):
            assert isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute)
            added = ast.Expr(_call("append", call.func.value, ast.Name("added_item", ast.Load())))
            return self.generic_visit(ast.For(ast.Name("added_item", ast.Store()), call.args[0], [added], []))
        return self.generic_visit(node)

    def visit_Set(self, node: ast.Set) -> ast.AST:
        """{1, 2}"""
        return self.generic_visit(ast.List(node.elts, ast.Load()))

    def visit_GeneratorExp(self, node: ast.GeneratorExp) -> ast.AST:
        """A list does as well; those that the language takes are never visited."""
        return self.generic_visit(ast.ListComp(node.elt, node.generators))

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """math.pi, math.sin"""
        if isinstance(node.value, ast.Name) and node.value.id in _MODULES - self.bound:
            return ast.Name(node.attr, node.ctx)
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Methods, modules' functions, and other words for arguments."""
        if isinstance(node.func, ast.Attribute):
            node = self.method(node, node.func)
        if isinstance(node.func, ast.Name) and node.func.id not in self.bound:
            name = node.func.id
            if name in _SAME:
                node.func.id = name = _SAME[name]
            if name in ("pow", "union", "group", "dict"):
                return self.generic_visit(rewritten(name, node))
            if len(node.args) == 1 and isinstance(node.args[0], ast.GeneratorExp) and name in GENERATOR_TAKERS:
                self.generic_visit(node.args[0])
                return node
            if name in registry.CONSTRUCTORS:
                return self.generic_visit(fitted(name, node))
        return self.generic_visit(node)

    def method(self, node: ast.Call, func: ast.Attribute) -> ast.Call:
        """values.append(x) and its like as functions."""
        if isinstance(func.value, ast.Name) and func.value.id in _MODULES - self.bound:
            return ast.Call(ast.Name(func.attr, ast.Load()), node.args, node.keywords)
        if func.attr == "append" and len(node.args) == 1 or func.attr in _METHODS and not node.args:
            return _call(func.attr, func.value, *node.args)
        return _call("list", func.value) if func.attr == "copy" and not node.args else node


def rewritten(name: str, node: ast.Call) -> ast.expr:
    """pow(a, b), union(a, b), dict(a=1) as the language writes them; the call itself where it is anything else."""
    if name == "pow" and len(node.args) == 2:
        return ast.BinOp(node.args[0], ast.Pow(), node.args[1])
    if name in _LISTS and node.args and not node.keywords:
        return ast.List(list(node.args), ast.Load())
    if name == "dict" and not node.args and all(k.arg for k in node.keywords):
        return ast.Dict([ast.Constant(k.arg) for k in node.keywords], [k.value for k in node.keywords])
    return node


def fitted(name: str, node: ast.Call) -> ast.expr:
    """A call of a constructor with its own words for its arguments, and its material and name where they belong."""
    takes = inspect.signature(registry.CONSTRUCTORS[name]).parameters
    if len(node.args) == _SPREAD.get(name) and not any(isinstance(a, ast.Starred) for a in node.args):
        kept = node.args[: _SPREAD[name] - 3]
        node.args = [*kept, ast.Tuple(node.args[len(kept) :], ast.Load())]
    if name == "part":
        node = _part(node)
    given = {k.arg for k in node.keywords}
    for keyword in node.keywords:
        own = next(
            (p for p, words in _KEYWORDS.items() if keyword.arg in words and p in takes and p not in given), None
        )
        if keyword.arg not in takes and own is not None:
            keyword.arg = own
            given.add(own)
    if "size" in takes and "size" not in given and {"width", "depth", "height"} <= given - set(takes):
        sides = {k.arg: k.value for k in node.keywords if k.arg in ("width", "depth", "height")}
        node.keywords = [k for k in node.keywords if k.arg not in sides]
        size = ast.Tuple([sides["width"], sides["depth"], sides["height"]], ast.Load())
        node.keywords.insert(0, ast.keyword("size", size))
    return node if name == "part" or "at" not in takes else _named(name, node, takes)


def _part(node: ast.Call) -> ast.Call:
    """part(shapes, "leg") and part("leg", shapes, material="wood", color="#8A5A3C")."""
    if len(node.args) >= 2 and _is_words(node.args[1]) and not _is_words(node.args[0]):
        node.args[0], node.args[1] = node.args[1], node.args[0]
    given = {k.arg: k for k in node.keywords}
    colour = given.get("color") or given.get("colour")
    if colour is not None and "material" in given:
        role = given["material"]
        node.keywords.remove(colour)
        words = [v.value for v in (role.value, colour.value) if isinstance(v, ast.Constant)]
        if len(words) == 2 and all(isinstance(word, str) for word in words):
            role.value = ast.Constant(" ".join(map(str, words)))
    return node


def _named(name: str, node: ast.Call, takes: Any) -> ast.expr:
    """box(..., name="leg", material="wood") as part("leg", box(...), material="wood")."""
    more = {k.arg: k.value for k in node.keywords if k.arg in ("name", "part", "material") and k.arg not in takes}
    if not more:
        return node
    node.keywords = [k for k in node.keywords if k.arg not in more]
    words = more.get("name") or more.get("part")
    role = [ast.keyword("material", more["material"])] if "material" in more else []
    if words is None:
        return _call("material", more["material"], node)
    return ast.Call(ast.Name("part", ast.Load()), [words, node], role)


def _rename_own(node: ast.FunctionDef) -> None:
    """cushion = cushion(...): what a def calls so itself gets a number behind its name, calls mean the language's."""
    own = {n.id for n in _directly(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    called = {n.func for n in ast.walk(node) if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)}
    parameters = {a.arg for n in ast.walk(node) if isinstance(n, ast.arguments) for a in n.args}
    defs = {n.name for n in ast.walk(node) if isinstance(n, ast.FunctionDef)}
    taken = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
    lambdas = {
        t.id
        for n in ast.walk(node)
        if isinstance(n, ast.Assign) and isinstance(n.value, ast.Lambda)
        for t in n.targets
        if isinstance(t, ast.Name)
    }
    both = own & {f.id for f in called if isinstance(f, ast.Name)} & registry.CONSTRUCTORS.keys()
    for name in both - parameters - defs - lambdas:
        new = next(f"{name}_{k}" for k in range(1, 1000) if f"{name}_{k}" not in taken)
        for part in ast.walk(node):
            if isinstance(part, ast.Name) and part.id == name and part not in called:
                part.id = new


def _directly(node: ast.FunctionDef) -> Iterable[ast.AST]:
    """The nodes of a def outside of the defs, lambdas and comprehensions in it."""
    waiting: list[ast.AST] = list(node.body)
    while waiting:
        part = waiting.pop()
        if isinstance(part, (ast.FunctionDef, ast.Lambda, ast.ListComp, ast.DictComp, ast.GeneratorExp)):
            continue
        yield part
        waiting += ast.iter_child_nodes(part)


def _bound(tree: ast.Module) -> frozenset[str]:
    names = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    names |= {n.arg for n in ast.walk(tree) if isinstance(n, ast.arg)}
    # A value of a constructor's own name does not keep its calls from being read.
    names -= registry.CONSTRUCTORS.keys()
    return frozenset(names | {n.name for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)})


def _is_method(node: ast.expr, name: str, count: int) -> bool:
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == name
        and len(node.args) == count
    )


def _is_words(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _call(name: str, *arguments: ast.expr) -> ast.Call:
    return ast.Call(ast.Name(name, ast.Load()), list(arguments), [])
