# SPDX-License-Identifier: GPL-3.0-or-later
"""Random programs of the room language, for comparing the interpreter with plain Python."""

from __future__ import annotations

import re
from collections.abc import Callable
from random import Random

VARIABLES = ("a", "b", "c", "d", "e")
FUNCTIONS = ("f", "g")
LITERALS = (
    "0", "1", "2", "7", "-3", "0.5", "-2.25", "1e3", "True", "False", "None", "'x'", "'ab'", "''", "0.0", "-0.0",
    "(1, 2)", "[]", "()", "{}", "[1, 2, 3]", "'line\\n'", "0x1f", "1_000", "'é'",
)  # fmt: skip
ITERABLES = (
    "range(<0~1~3>)", "c", "d", "e", "'abc'", "zip(c, e)", "enumerate(c)", "items(d)", "reversed(c)", "[(1, 2), (3, 4)]", "<E>"
)  # fmt: skip
ELEMENTS = ("i", "i * 2", "(i, a)", "[i]", "(<E>, i)", "str(i) + 'x'")
# A place is <option~option>; a capital letter is what `Writer.fill` makes of it. Signs < and > are written LT and GT.
FORMS = (
    "<E>",
    "(<E> <+~-~*~/~//~%~+~*> <E>)",
    "(<E> <+~-~*~/> <E> <+~-~*> <E>)",
    "(<N> <+~-~*~/> <1~2~0.5~N>)",
    "(<E> ** <0~1~2~-1~0.5>)",
    "(<-~+~not > <E>)",
    "(<E> <LT~LT=~GT~GT=~==~!=~in~not in> <E>)",
    "(<E> <LT~LT=~==> <E> <LT~GT~!=> <E>)",
    "(<E> <is~is not> None)",
    "(<E> <and~or> <E> <and~or> <E>)",
    "(<E> if <E> else <E>)",
    "<N>[<E>]",
    "<c~e~'hello'~N>[<E~>:<E~~1>:<~-1~2>]",
    "(<E>, <E>)",
    "[<E>, <E>, *<c~e~d>]",
    "{<1~'k'~E>: <E>}",
    "<abs~sin~cos~floor~round~int~float~sqrt~str~bool~len>(<E>)",
    "<min~max>(<E>, <E>)",
    "<sum~min~max~sorted~list~tuple~len~any~all>(<I>)",
    "<list~tuple~sorted>(<zip~enumerate~reversed>(<I>))",
    "sorted(<I>, key=lambda v: <str(v)~-v~v>, reverse=<True~False>)",
    "<min~max>(<I>, key=lambda v: str(v), default=<E>)",
    "<sum~list~any~all~max>(<G> for i in <I>)",
    "[<G> for i in <I>]",
    "[<G> for i in <I> if <E>]",
    "[(i, j) for i in <I> for j in <I>]",
    "[(i, j) for i in <I> if <E> for j in <(i, a)~range(2)> if <E>]",
    "{<i~str(i)>: <E> for i in <I>}",
    "[k(1) for k in [(lambda m: <G>) for i in range(3)]]",
    "<F>(<E>, <E>)",
    "<F>(<E>, q=<E>)",
    "<F>(<E>)",
    "<F>(*(<E>, <E>))",
    "f'{<N>} and {<a~b>:<.2f~03d~g~5.1f~4>}'",
    "round(<E>, <1~2~-1~0>)",
    "<keys~values~items>(d)",
    "lerp(<E>, <E>, 0.5)",
)


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

    def pieces(self) -> list[str]:
        """Whole statements that follow each other; the last defines result()."""
        pieces = ["a = 1\nb = 2.5\nc = [3, 4, 5]\nd = {'x': 1, 2: 'y'}\ne = (1, 'two', 3.0)\ni, j = 0, 1"]
        for name in FUNCTIONS:
            pieces.append("\n".join(self.definition(name, 0)))
            self.functions = [*FUNCTIONS[: FUNCTIONS.index(name) + 1]]
        for _ in range(self.random.randint(3, 9)):
            pieces.append("\n".join(self.statement(0, in_def=False, in_loop=False)))
        return [*pieces, "def result():\n    return [a, b, c, d, e, i, j]"]

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
            return [
                f"{self.choose(*VARIABLES)} {self.choose('+=', '-=', '*=', '/=', '//=', '%=')} {self.expression(1)}"
            ]
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
            # A copy: a list that grows while it is read would keep plain Python busy for ever.
            source = self.choose(f"list({self.iterable(2)})[:5]", "range(3)", "d", "'abc'", "zip('ab', range(3))")
            lines = [f"for {target} in {source}:", *self.block(depth, in_def, True)]
            if self.random.random() < 0.3:
                lines += ["else:", *self.block(depth, in_def, in_loop)]
            return lines
        if kind == "def":
            return [
                *self.definition("h", depth),
                f"{self.choose(*VARIABLES)} = h({self.expression(1)}, {self.expression(1)})",
            ]
        if kind == "return":
            return [self.choose("return", f"return {self.expression(2)}")]
        return [kind]

    def iterable(self, depth: int) -> str:
        """An expression that can often be iterated over."""
        return self.fill(self.random.choice(ITERABLES), depth)

    def expression(self, depth: int) -> str:
        """Any expression."""
        if depth <= 0:
            return self.choose(*self.names, "i", *LITERALS[: self.random.randint(1, len(LITERALS))])
        return self.fill(self.random.choice(FORMS), depth - 1)

    def fill(self, form: str, depth: int) -> str:
        """The form with its places filled: E expression, N name, F function, I iterable, G element of i."""
        makers: dict[str, Callable[[], str]] = {
            "E": lambda: self.expression(depth),
            "N": lambda: self.choose(*self.names),
            "F": lambda: self.choose(*self.functions),
            "I": lambda: self.iterable(0),
            "G": lambda: self.fill(self.random.choice(ELEMENTS), 0),
        }

        def part(match: re.Match[str]) -> str:
            options = match.group(1).split("~")
            option = self.random.choice(options)
            return makers[option]() if option in makers else option

        return re.sub("<([^<>]*)>", part, form).replace("LT", "<").replace("GT", ">")
