# SPDX-License-Identifier: GPL-3.0-or-later
"""Random programs of the room language, for comparing the interpreter with plain Python."""

from __future__ import annotations

from random import Random

VARIABLES = ("a", "b", "c", "d", "e")
FUNCTIONS = ("f", "g")
NUMBER_FUNCTIONS = ("abs", "sin", "cos", "floor", "round", "int", "float", "sqrt", "str", "bool", "len")
LIST_FUNCTIONS = ("sum", "min", "max", "sorted", "list", "tuple", "len", "any", "all", "reversed", "enumerate", "zip")


class Writer:
    """Writes one random program.

    Args:
        random: the source of choices.
    """

    def __init__(self, random: Random) -> None:
        self.random = random
        self.names = list(VARIABLES)
        self.functions = ["abs", "lerp"]

    def choose(self, *options: str) -> str:
        """One of the options."""
        return self.random.choice(options)

    def program(self) -> str:
        """A whole program that ends with `def result()`."""
        lines = ["a = 1", "b = 2.5", "c = [3, 4, 5]", "d = {'x': 1, 2: 'y'}", "e = (1, 'two', 3.0)", "i, j = 0, 1"]
        for name in FUNCTIONS:
            lines += self.definition(name, 0)
            self.functions = [*FUNCTIONS[: FUNCTIONS.index(name) + 1]]
        for _ in range(self.random.randint(1, 5)):
            lines += self.statement(0, in_def=False, in_loop=False)
        lines += ["def result():", "    return [a, b, c, d, e]"]
        return "\n".join(lines) + "\n"

    def definition(self, name: str, depth: int) -> list[str]:
        """A def with up to two parameters, one of which may have a default."""
        default = self.choose("", f"={self.expression(1)}")
        lines = [f"def {name}(p, q{default}):"]
        outer, self.names = self.names, [*self.names, "p", "q"]
        for _ in range(self.random.randint(0, 2)):
            lines += self.indented(self.statement(depth + 1, in_def=True, in_loop=False))
        lines.append(f"    return {self.expression(2)}")
        self.names = outer
        return lines

    def indented(self, lines: list[str]) -> list[str]:
        """The lines of a block."""
        return ["    " + line for line in lines]

    def block(self, depth: int, in_def: bool, in_loop: bool) -> list[str]:
        """One or two statements, indented."""
        lines: list[str] = []
        for _ in range(self.random.randint(1, 2)):
            lines += self.statement(depth + 1, in_def, in_loop)
        return self.indented(lines)

    def statement(self, depth: int, in_def: bool, in_loop: bool) -> list[str]:
        """Any statement."""
        kinds = ["assign", "assign", "augment", "unpack", "item", "append", "pass"]
        if depth < 3:
            kinds += ["if", "for", "for", "def"]
        if in_loop:
            kinds += ["break", "continue"]
        if in_def:
            kinds.append("return")
        kind = self.random.choice(kinds)
        if kind == "assign":
            return [f"{self.choose(*VARIABLES)} = {self.expression(3)}"]
        if kind == "augment":
            return [f"{self.choose(*VARIABLES)} {self.choose('+=', '-=', '*=', '/=', '//=', '%=')} {self.expression(1)}"]
        if kind == "unpack":
            left = self.choose("a, b", "(a, b), c", "a, (b, c)", "[a, b]", "a, c[0]", "a, b, d['x']")
            return [f"{left} = {self.choose(self.expression(2), f'{self.expression(2)}, {self.expression(1)}')}"]
        if kind == "item":
            place = self.choose("c", "d", "c", "e")
            return [f"{place}[{self.expression(1)}] {self.choose('=', '+=', '*=')} {self.expression(2)}"]
        if kind == "append":
            return [f"append(c, {self.expression(2)})"]
        if kind == "if":
            lines = [f"if {self.expression(2)}:", *self.block(depth, in_def, in_loop)]
            if self.random.random() < 0.5:
                lines += [f"elif {self.expression(2)}:", *self.block(depth, in_def, in_loop)]
            if self.random.random() < 0.5:
                lines += ["else:", *self.block(depth, in_def, in_loop)]
            return lines
        if kind == "for":
            target = self.choose("i", "i", "a", "i, j", "(i, j)", "c[0]")
            lines = [f"for {target} in {self.iterable(2)}:", *self.block(depth, in_def, True)]
            if self.random.random() < 0.3:
                lines += ["else:", *self.block(depth, in_def, in_loop)]
            return lines
        if kind == "def":
            return [*self.definition("h", depth), f"{self.choose(*VARIABLES)} = h({self.expression(1)}, {self.expression(1)})"]
        if kind == "return":
            return [self.choose("return", f"return {self.expression(2)}")]
        return [kind]

    def iterable(self, depth: int) -> str:
        """An expression that can often be iterated over."""
        return self.random.choice(
            [
                f"range({self.random.randint(0, 4)})",
                "c",
                "d",
                "e",
                "'abc'",
                "zip(c, e)",
                "enumerate(c)",
                "items(d)",
                "reversed(c)",
                "[(1, 2), (3, 4)]",
                self.expression(depth),
            ]
        )

    def literal(self) -> str:
        """A literal."""
        return self.choose(
            "0", "1", "2", "7", "-3", "0.5", "-2.25", "1e3", "True", "False", "None", "'x'", "'ab'", "''", "0.0", "-0.0",
            "(1, 2)", "[]", "()", "{}", "[1, 2, 3]", "'line\\n'", "0x1f", "1_000", "'é'",
        )  # fmt: skip

    def expression(self, depth: int) -> str:
        """Any expression."""
        if depth <= 0:
            return self.choose(*self.names, *self.names, "i", self.literal(), self.literal())
        inner = [self.expression(depth - 1) for _ in range(4)]
        w, x, y, z = inner
        op = self.choose("+", "-", "*", "/", "//", "%", "+", "*")
        compare = self.choose("<", "<=", ">", ">=", "==", "!=", "in", "not in")
        forms = [
            w,
            f"({x} {op} {y})",
            f"({x} {op} {y} {self.choose('+', '-', '*')} {z})",
            f"({x} ** {self.choose('0', '1', '2', '-1', '0.5')})",
            f"({self.choose('-', '+', 'not ')}{x})",
            f"({x} {compare} {y})",
            f"({x} {self.choose('<', '<=', '==')} {y} {self.choose('<', '>', '!=')} {z})",
            f"({x} {self.choose('is', 'is not')} None)",
            f"({x} {self.choose('and', 'or')} {y} {self.choose('and', 'or')} {z})",
            f"({x} if {y} else {z})",
            f"{self.choose(*self.names)}[{y}]",
            f"{self.choose('c', 'e', 'b')}[{self.choose('', x)}:{self.choose('', y)}{self.choose('', ':-1', ':2')}]",
            f"({x}, {y})",
            f"[{x}, {y}, *{self.choose('c', 'e', 'd')}]",
            f"{{{self.choose('1', repr('k'), x)}: {y}}}",
            f"{self.choose(*NUMBER_FUNCTIONS)}({x})",
            f"{self.choose('min', 'max')}({x}, {y})",
            f"{self.choose(*LIST_FUNCTIONS)}({self.iterable(depth - 1)})",
            f"{self.choose('list', 'tuple', 'sorted')}({self.choose('zip', 'enumerate')}({self.iterable(depth - 1)}))",
            f"sorted({self.iterable(0)}, key=lambda v: {self.choose('str(v)', '-v', 'v')}, reverse={self.choose('True', 'False')})",
            f"{self.choose('min', 'max')}({self.iterable(0)}, key=lambda v: str(v), default={x})",
            f"{self.choose('sum', 'list', 'any', 'all', 'max')}({self.element(depth)} for i in {self.iterable(0)})",
            f"[{self.element(depth)} for i in {self.iterable(0)}{self.choose('', f' if {x}')}]",
            f"[(i, j) for i in {self.iterable(0)} for j in {self.iterable(0)}{self.choose('', f' if {y}')}]",
            f"{{{self.choose('i', 'str(i)')}: {x} for i in {self.iterable(0)}}}",
            f"[k(1) for k in [(lambda m: {self.element(0)}) for i in range(3)]]",
            f"{self.choose(*self.functions)}({x}, {y})",
            f"{self.choose(*self.functions)}({x}{self.choose('', f', q={y}')})",
            f"{self.choose(*self.functions)}(*({x}, {y}))",
            f"f'{{{self.choose(*self.names)}}} and {{{self.choose('a', 'b')}:{self.choose('.2f', '03d', 'g', '5.1f', '4')}}}'",
            f"round({x}, {self.choose('1', '2', '-1', '0')})",
            f"{self.choose('keys', 'values', 'items')}(d)",
            f"lerp({x}, {y}, 0.5)",
        ]
        return self.random.choice(forms)

    def element(self, depth: int) -> str:
        """An expression in which i is likely to occur."""
        return self.choose("i", "i * 2", "(i, a)", "[i]", f"({self.expression(depth - 1)}, i)", "str(i) + 'x'")
