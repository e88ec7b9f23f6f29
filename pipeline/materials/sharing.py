# SPDX-License-Identifier: GPL-3.0-or-later
"""Near-equal looks become one, with one name; and the `finish` of each object says as little as it can."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence

from ..program.prelude.registry import RESERVED
from .choice import Choice
from .difference import difference
from .parts import Cell

SAME = 3.0
"""CIEDE2000 below which two looks of one family and the same parameters are one."""


def merged(wanted: Iterable[tuple[Choice, float]]) -> dict[Choice, Choice]:
    """Which look stands for each, given with its weight: the weightier ones stay, what is near one of them becomes it."""
    weights: dict[Choice, float] = {}
    for choice, weight in wanted:
        weights[choice] = weights.get(choice, 0.0) + weight
    kept: list[Choice] = []
    found: dict[Choice, Choice] = {}
    for choice in sorted(weights, key=lambda c: -weights[c]):
        same = next((k for k in kept if _same(k, choice)), None)
        if same is None:
            kept.append(choice)
        found[choice] = same or choice
    return found


def _same(a: Choice, b: Choice) -> bool:
    if a.program or b.program:
        return a.expression == b.expression
    return (a.family, a.options) == (b.family, b.options) and difference(a.code, b.code) < SAME


def named(choices: Iterable[Choice], taken: Collection[str], before: Mapping[str, str]) -> dict[str, str]:
    """A name for each look, by its expression: `oak_1`. A look that had a name before keeps it.

    Args:
        taken: names that the program uses for something else. before: expressions by the names of the last run.
    """
    former = {expression: name for name, expression in before.items()}
    found: dict[str, str] = {}
    used = {*taken, *before}
    for choice in choices:
        expression = choice.expression
        if expression in found:
            continue
        name = former.get(expression, "")
        if not name or name in taken:
            base = re.sub(r"\W+", "_", (choice.word or choice.family).lower().encode("ascii", "ignore").decode()).strip(
                "_"
            )
            base = re.sub(r"_?\d+$", "", base)[:30] or choice.family
            base = f"look_{base}" if base[0].isdigit() else base
            number = 1
            while (name := f"{base}_{number}") in used or name in RESERVED:
                number += 1
        used.add(name)
        found[expression] = name
    return found


def finish_of(cells: Sequence[Cell], looks: Sequence[str]) -> dict[str, str]:
    """The keys of a `finish` that give each cell its look: by role where that is enough, else by part or material."""
    found: dict[str, str] = {}
    parts: dict[str, set[str]] = {}
    for cell, look in zip(cells, looks, strict=True):
        parts.setdefault(cell.part, set()).add(look)
    for role in dict.fromkeys(cell.role for cell in cells):
        own = [(c, look) for c, look in zip(cells, looks, strict=True) if c.role == role]
        usual: dict[str, float] = {}
        for cell, look in own:
            usual[look] = usual.get(look, 0.0) + cell.share + 0.01
        common = max(usual, key=lambda look: usual[look])
        found[role] = common
        for cell, look in own:
            if look == common:
                continue
            # A part's name counts before every role, so it may stand only for a part that has one look.
            key = cell.part if cell.part and len(parts[cell.part]) == 1 else cell.material
            if key == role or found.get(key, look) != look:
                continue
            found[key] = look
    return {key: found[key] for key in sorted(found, key=lambda k: (k == "", 0))}
