# SPDX-License-Identifier: GPL-3.0-or-later
"""Which syntax is in the room language. Everything that is not named here is refused, before anything runs."""

from __future__ import annotations

import ast

from ..errors import ProgramError
from .functions import GENERATOR_TAKERS
from .limits import Limits
from .refusals import EXPRESSIONS, MOST_PROBLEMS, OPERATORS, STATEMENTS, attribute_refusal
from .text import FORMAT, spec_of
from .values import LARGEST_FLOAT, LARGEST_INT

ALLOWED_OPERATORS = (
    ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod, ast.Pow, ast.USub, ast.UAdd, ast.Not,
    ast.And, ast.Or, ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.In, ast.NotIn, ast.Is, ast.IsNot,
)  # fmt: skip
MOST_GENERATORS = 4
SPEC_HELP = "Use a format such as {x:.2f}, {i:03d} or {x:g}."


class Checker:
    """Collects what is not in the language from one tree, with lines.

    Args:
        limits: for the depth of blocks and the length of strings.
    """

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.problems: list[ProgramError] = []

    def report(self, node: ast.AST, message: str, fix: str = "") -> None:
        """Note a problem at the line of the node."""
        self.problems.append(ProgramError(message, getattr(node, "lineno", 0), fix))

    def run(self, tree: ast.Module) -> list[ProgramError]:
        """The problems of a whole program."""
        self.block(tree.body, in_def=False, in_loop=False, depth=0)
        return self.problems

    def block(self, body: list[ast.stmt], in_def: bool, in_loop: bool, depth: int) -> None:
        """The statements of one block."""
        if body and depth > self.limits.blocks:
            self.report(body[0], "blocks are nested too deeply", "Move the inner part into a def.")
            return
        for node in body:
            if len(self.problems) >= MOST_PROBLEMS:
                return
            self.statement(node, in_def, in_loop, depth)

    def statement(self, node: ast.stmt, in_def: bool, in_loop: bool, depth: int) -> None:
        """One statement."""
        if isinstance(node, ast.Expr):
            self.expression(node.value)
        elif isinstance(node, ast.Assign):
            for target in node.targets:
                self.target(target)
            self.expression(node.value)
        elif isinstance(node, ast.AugAssign):
            if isinstance(node.op, tuple(OPERATORS)):
                self.report(node, *OPERATORS[type(node.op)])
            self.target(node.target)
            self.expression(node.value)
        elif isinstance(node, ast.If):
            self.conditional(node, in_def, in_loop, depth)
        elif isinstance(node, ast.For):
            self.target(node.target)
            self.expression(node.iter)
            self.block(node.body, in_def, True, depth + 1)
            self.block(node.orelse, in_def, in_loop, depth + 1)
        elif isinstance(node, ast.FunctionDef):
            self.definition(node, depth)
        elif isinstance(node, ast.Return):
            if not in_def:
                self.report(node, "return is outside a def")
            if node.value is not None:
                self.expression(node.value)
        elif isinstance(node, (ast.Break, ast.Continue)):
            if not in_loop:
                self.report(node, f"{type(node).__name__.lower()} is outside a for loop")
        elif not isinstance(node, ast.Pass):
            default = (f"{type(node).__name__} is not in the room language", "")
            self.report(node, *STATEMENTS.get(type(node), default))

    def conditional(self, node: ast.If, in_def: bool, in_loop: bool, depth: int) -> None:
        """if and all its elifs."""
        while True:
            self.expression(node.test)
            self.block(node.body, in_def, in_loop, depth + 1)
            if len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If):
                node = node.orelse[0]
                continue
            self.block(node.orelse, in_def, in_loop, depth + 1)
            return

    def definition(self, node: ast.FunctionDef, depth: int) -> None:
        """A def and its body."""
        self.name(node, node.name)
        for decorator in node.decorator_list:
            self.report(decorator, "decorators are not in the room language", "Call the function instead.")
        if node.returns is not None:
            self.report(node, "annotations are not in the room language", "Leave -> and the type out.")
        self.parameters(node.args, node)
        for default in node.args.defaults:
            self.expression(default)
        self.block(node.body, True, False, depth + 1)

    def parameters(self, arguments: ast.arguments, node: ast.AST) -> None:
        """The parameters of a def or lambda."""
        if arguments.vararg or arguments.kwarg or arguments.kwonlyargs or arguments.posonlyargs:
            self.report(node, "* and / among parameters are not in the room language", "Name each parameter.")
        names = [argument.arg for argument in arguments.args]
        for argument in arguments.args:
            self.name(argument, argument.arg)
            if argument.annotation is not None:
                self.report(argument, "annotations are not in the room language", "Leave the type out.")
            if names.count(argument.arg) > 1:
                self.report(argument, f"the parameter {argument.arg} is there twice")

    def name(self, node: ast.AST, name: str) -> None:
        """A name that is read, bound or used as a keyword."""
        if name.startswith("_") and name != "_":
            self.report(node, f"names that begin with an underscore are not allowed ({name[:60]})", "Rename it.")
        elif not name.isascii():
            self.report(node, "names must be plain ASCII letters, digits and underscores")

    def target(self, node: ast.expr) -> None:
        """What is assigned to."""
        if isinstance(node, (ast.Tuple, ast.List)):
            for item in node.elts:
                self.target(item)
        elif isinstance(node, ast.Name):
            self.name(node, node.id)
        elif isinstance(node, ast.Subscript):
            if isinstance(node.slice, ast.Slice):
                self.report(node, "assigning to a slice is not in the room language", "Build a new list with +.")
            self.expression(node.value)
            self.expression(node.slice)
        elif isinstance(node, ast.Starred):
            self.report(node, "* on the left of = is not in the room language", "Use slices.")
        else:
            self.expression(node)

    def expression(self, node: ast.expr) -> None:
        """An expression and everything in it, without recursion."""
        open_nodes: list[ast.AST] = [node]
        while open_nodes:
            part = open_nodes.pop()
            open_nodes.extend(reversed(self.parts(part)))

    def parts(self, node: ast.AST) -> list[ast.AST]:
        """Check one node; the nodes in it that are to be checked next."""
        kind = type(node)
        if kind in EXPRESSIONS:
            self.report(node, *EXPRESSIONS[kind])
            return []
        check = getattr(self, f"on_{kind.__name__}", None)
        if check is not None:
            found: list[ast.AST] = check(node)
            return found
        if not isinstance(node, (ast.BoolOp, ast.IfExp, ast.Tuple, ast.List)):
            self.report(node, f"{kind.__name__} is not in the room language")
            return []
        return [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]

    def on_Constant(self, node: ast.Constant) -> list[ast.AST]:
        """A number, text, True, False or None."""
        value = node.value
        if isinstance(value, str):
            if len(value) > self.limits.string_chars:
                self.report(node, f"a text is longer than {self.limits.string_chars:,} characters")
            elif any("\ud800" <= character <= "\udfff" for character in value):
                self.report(node, "a text holds a broken character (half of a surrogate pair)")
        elif isinstance(value, bytes):
            self.report(node, "bytes are not in the room language", 'Use "text".')
        elif isinstance(value, complex):
            self.report(node, "complex numbers are not in the room language")
        elif value is Ellipsis:
            self.report(node, "... is not in the room language", "Write what is meant, or pass.")
        elif isinstance(value, int) and abs(value) > LARGEST_INT:
            self.report(node, "a whole number is larger than 2**63", "Use a float such as 1e20.")
        elif isinstance(value, float) and not -LARGEST_FLOAT <= value <= LARGEST_FLOAT:
            self.report(node, "a number is too large")
        return []

    def on_Name(self, node: ast.Name) -> list[ast.AST]:
        """A variable or function that is read."""
        self.name(node, node.id)
        return []

    def on_Attribute(self, node: ast.Attribute) -> list[ast.AST]:
        """Never allowed."""
        self.problems.append(attribute_refusal(node))
        return [] if isinstance(node.value, ast.Name) else [node.value]

    def on_BinOp(self, node: ast.BinOp) -> list[ast.AST]:
        """Arithmetic."""
        self.operator(node, node.op)
        return [node.left, node.right]

    def on_UnaryOp(self, node: ast.UnaryOp) -> list[ast.AST]:
        """-x, +x, not x"""
        self.operator(node, node.op)
        return [node.operand]

    def operator(self, node: ast.AST, operation: ast.AST) -> None:
        """An operator must be one of the language's."""
        if not isinstance(operation, ALLOWED_OPERATORS):
            name = type(operation).__name__
            self.report(node, *OPERATORS.get(type(operation), (f"{name} is not in the room language", "")))

    def on_Compare(self, node: ast.Compare) -> list[ast.AST]:
        """Comparisons; is only with None."""
        operands = [node.left, *node.comparators]
        for number, operation in enumerate(node.ops):
            self.operator(node, operation)
            if isinstance(operation, (ast.Is, ast.IsNot)):
                right = operands[number + 1]
                if not (isinstance(right, ast.Constant) and right.value is None):
                    self.report(node, "is compares only with None in the room language", "Use == or !=.")
        return list(operands)

    def on_Dict(self, node: ast.Dict) -> list[ast.AST]:
        """{key: value}"""
        found: list[ast.AST] = []
        for key, value in zip(node.keys, node.values, strict=True):
            if key is None:
                self.report(value, "** in a dict is not in the room language", "Write each key.")
            else:
                found += [key, value]
        return found

    def on_Starred(self, node: ast.Starred) -> list[ast.AST]:
        """*values among the items of a list or the arguments of a call."""
        return [node.value]

    def on_Subscript(self, node: ast.Subscript) -> list[ast.AST]:
        """values[index]"""
        if isinstance(node.slice, ast.Slice):
            bounds = (node.slice.lower, node.slice.upper, node.slice.step)
            return [node.value, *(bound for bound in bounds if bound is not None)]
        if isinstance(node.slice, ast.Tuple) and any(isinstance(e, (ast.Slice, ast.Starred)) for e in node.slice.elts):
            self.report(node, "an index has one number or one slice", "Use a[i][j].")
            return [node.value]
        return [node.value, node.slice]

    def on_Call(self, node: ast.Call) -> list[ast.AST]:
        """A call of a plain name."""
        found: list[ast.AST] = []
        if isinstance(node.func, ast.Attribute):
            found += self.on_Attribute(node.func)
        elif isinstance(node.func, ast.Name):
            self.name(node.func, node.func.id)
        else:
            self.report(node, "only a plain name can be called", "Give the function a name first.")
            found.append(node.func)
        seen: set[str] = set()
        for keyword in node.keywords:
            if keyword.arg is None:
                self.report(node, "** in a call is not in the room language", "Write each argument.")
            else:
                self.name(keyword.value, keyword.arg)
                if keyword.arg in seen:
                    self.report(keyword.value, f"the argument {keyword.arg} is given twice")
                seen.add(keyword.arg)
        alone = len(node.args) == 1 and isinstance(node.func, ast.Name) and node.func.id in GENERATOR_TAKERS
        for argument in node.args:
            if alone and isinstance(argument, ast.GeneratorExp):
                found += self.generators(argument.generators, argument.elt)
            else:
                found.append(argument)
        return found + [keyword.value for keyword in node.keywords]

    def on_GeneratorExp(self, node: ast.GeneratorExp) -> list[ast.AST]:
        """A generator that is not the only argument of tuple, sum, ..."""
        self.report(
            node,
            "a generator can only be the one argument of tuple, list, sum, min, max, any, all or sorted",
            "Use [...].",
        )
        return []

    def on_ListComp(self, node: ast.ListComp) -> list[ast.AST]:
        """[element for x in xs if condition]"""
        return self.generators(node.generators, node.elt)

    def on_DictComp(self, node: ast.DictComp) -> list[ast.AST]:
        """{key: value for x in xs}"""
        return self.generators(node.generators, node.key, node.value)

    def generators(self, generators: list[ast.comprehension], *elements: ast.expr) -> list[ast.AST]:
        """The for and if parts of a comprehension, then its elements."""
        if len(generators) > MOST_GENERATORS:
            self.report(elements[0], f"a comprehension has more than {MOST_GENERATORS} for", "Use for statements.")
        found: list[ast.AST] = []
        for generator in generators:
            if generator.is_async:
                self.report(generator.iter, "async is not in the room language")
            self.target(generator.target)
            found += [generator.iter, *generator.ifs]
        return found + list(elements)

    def on_Lambda(self, node: ast.Lambda) -> list[ast.AST]:
        """lambda x: ..."""
        self.parameters(node.args, node)
        return [*node.args.defaults, node.body]

    def on_JoinedStr(self, node: ast.JoinedStr) -> list[ast.AST]:
        """f"..." with plain fields."""
        found: list[ast.AST] = []
        for part in node.values:
            if isinstance(part, ast.FormattedValue):
                if part.conversion not in (-1, None):
                    self.report(node, "! in an f-string is not in the room language", "Leave it out.")
                if part.format_spec is not None:
                    self.format_spec(node, part.format_spec)
                found.append(part.value)
            elif isinstance(part, ast.Constant):
                found += self.on_Constant(part)
        return found

    def format_spec(self, node: ast.JoinedStr, spec: ast.expr) -> None:
        """The part after the colon of a field."""
        text = spec_of(spec)
        if text is None or not FORMAT.fullmatch(text):
            self.report(node, "this format is not in the room language", SPEC_HELP)
