# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiled statements and flow of control.

A compiled statement returns None, or what ends the block around it: BREAK, CONTINUE, or a tuple that holds the value
of a return. Whoever runs a block counts its steps at once, before it runs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .arithmetic import OPERATIONS, in_place
from .items import get_item, put_item
from .limits import Meter
from .refusals import located
from .values import LARGEST_FLOAT, Code, Frame

BREAK = object()
CONTINUE = object()
NOTHING: tuple[None] = (None,)
Statement = Callable[[Frame], Any]


@dataclass(frozen=True)
class Block:
    """Compiled statements.

    Attributes:
        statements: in order.
        lines: their lines.
        cost: steps of running each statement's own part once.
        simple: whether none of them can end the block early.
    """

    statements: tuple[Statement, ...]
    lines: tuple[int, ...]
    cost: int
    simple: bool


def line_of(block: Block, statement: Statement | None) -> int:
    """The line of one of the block's statements."""
    return block.lines[block.statements.index(statement)] if statement is not None else 0


def single(statement: Statement, line: int) -> Statement:
    """A block of one statement."""

    def run(f: Frame) -> Any:
        try:
            return statement(f)
        except Exception as error:
            raise located(error, line) from None

    return run


def straight(before: Block, value: Code, line: int) -> Code:
    """A function's body of statements that never end early, and a last return."""
    statements = before.statements
    if not statements:

        def only(f: Frame) -> Any:
            try:
                return value(f)
            except Exception as error:
                raise located(error, line) from None

        return only

    def run(f: Frame) -> Any:
        statement = None
        try:
            for statement in statements:
                statement(f)
            statement = None
            return value(f)
        except Exception as error:
            raise located(error, line if statement is None else line_of(before, statement)) from None

    return run


def assign(slot: int, value: Code) -> Statement:
    """name = value"""

    def run(f: Frame) -> None:
        f[slot] = value(f)

    return run


def augment(meter: Meter, name: str, slot: int, load: Code, value: Code) -> Statement:
    """name op= value"""
    compute = OPERATIONS[name][1]

    def run(f: Frame) -> None:
        a = load(f)
        b = value(f)
        if a.__class__ is list:
            f[slot] = in_place(meter, name, a, b)
        else:
            f[slot] = compute(meter, a, b)

    def run_add(f: Frame) -> None:
        a = load(f)
        b = value(f)
        if a.__class__ is float:
            r = a + b
            if -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
                f[slot] = r
                return
        f[slot] = in_place(meter, name, a, b)

    return run_add if name == "Add" else run


def augment_item(meter: Meter, name: str, container: Code, index: Code, value: Code) -> Statement:
    """container[index] op= value"""

    def run(f: Frame) -> None:
        place = container(f)
        key = index(f)
        a = get_item(meter, place, key)
        put_item(meter, place, key, in_place(meter, name, a, value(f)))

    return run


def choose(
    meter: Meter,
    branches: tuple[tuple[Code, Statement, int, int], ...],
    other: Statement | None,
    other_cost: int,
) -> Statement:
    """if, elif, else"""

    def run(f: Frame) -> Any:
        for test, block, cost, line in branches:
            try:
                chosen = test(f)
            except Exception as error:
                raise located(error, line) from None
            if chosen:
                meter.left -= cost
                if meter.left < 0:
                    meter.refill()
                return block(f)
        if other is None:
            return None
        meter.left -= other_cost
        if meter.left < 0:
            meter.refill()
        return other(f)

    return run


def plain_loop(meter: Meter, source: Code, slot: int, body: Block, cost: int) -> Statement:
    """A for over one name whose body has no break, continue or return."""
    statements = body.statements

    def run(f: Frame) -> None:
        values = iter(source(f))
        statement = None
        try:
            for value in values:
                f[slot] = value
                meter.left -= cost
                if meter.left < 0:
                    meter.refill()
                for statement in statements:
                    statement(f)
        except Exception as error:
            raise located(error, line_of(body, statement)) from None

    return run


def full_loop(
    meter: Meter,
    source: Code,
    store: Callable[[Frame, Any], None],
    body: Statement,
    cost: int,
    other: Statement | None,
) -> Statement:
    """Any for."""

    def run(f: Frame) -> Any:
        for value in iter(source(f)):
            meter.left -= cost
            if meter.left < 0:
                meter.refill()
            store(f, value)
            result = body(f)
            if result is not None:
                if result is BREAK:
                    return None
                if result is not CONTINUE:
                    return result
        return other(f) if other is not None else None

    return run
