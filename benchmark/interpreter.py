# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the room language's interpreter and prints plain lines: steps a second, and a grid by a language function.

Run with `python benchmark/interpreter.py`. A step is one statement, operator, call or turn of a loop; reading variables
and literals is not counted. The step counts are the interpreter's own.
"""

from __future__ import annotations

import time

from code_as_room.pipeline.program.evaluate import Evaluation, Limits
from code_as_room.pipeline.program.vocabulary import room_vocabulary

TURNS = 100_000
GRID = 100
LIMITS = Limits(steps=50_000_000, seconds=60)

ARITHMETIC = """
def run(n):
    total = 0.0
    a = 1.5
    for i in range(n):
        total = total * 0.5 + a
        total = total - i * 0.25
    return total
"""
BRANCHES = """
def run(n):
    count = 0
    for i in range(n):
        if i % 3 == 0:
            count += 1
        elif i > 10 and count < 5:
            count -= 1
    return count
"""
CALLS = """
def inner(x, y):
    return x * y + 1
def run(n):
    total = 0
    for i in range(n):
        total = inner(i, 2)
    return total
"""
LISTS = """
def run(n):
    points = [(i * 0.1, sin(i), 0.0) for i in range(n)]
    return sum([p[0] for p in points])
"""
SURFACE = """
def height(u, v):
    return sin(u * 6.0) * 0.1 + noise(u * 4.0, v * 4.0) * lerp(0.05, 0.2, v)
def run(n):
    return [[height(i / n, j / n) for i in range(n)] for j in range(n)]
"""


def measure(text: str, argument: int) -> tuple[float, int]:
    """The best time of three runs in seconds of processor time, and the steps of one run."""
    best, steps = float("inf"), 0
    for _ in range(3):
        evaluation = Evaluation(room_vocabulary(), None, LIMITS)
        evaluation.feed(text)
        before = evaluation.meter.used
        start = time.process_time()
        evaluation.call("run", [argument])
        best = min(best, time.process_time() - start)
        steps = evaluation.meter.used - before
    return best, steps


def main() -> None:
    """Print one line for each measurement."""
    for name, text in (("arithmetic", ARITHMETIC), ("branches", BRANCHES), ("calls", CALLS), ("lists", LISTS)):
        seconds, steps = measure(text, TURNS)
        print(f"{name}: {steps / seconds / 1e6:.2f} million steps a second ({steps:,} steps in {seconds:.3f} s)")
    seconds, steps = measure(SURFACE, GRID)
    print(f"grid of {GRID} x {GRID} by sin, noise and lerp: {seconds:.3f} s ({steps:,} steps)")


if __name__ == "__main__":
    main()
