# SPDX-License-Identifier: GPL-3.0-or-later
"""What stages that change the room's program have in common: carrying it on, and keeping what objects are modelled with."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

from ..artifacts.analysis import Finding
from ..artifacts.layout import Layout, LayoutEdit, LayoutProgram, LedgerEntry
from ..artifacts.objects import Furnishing
from ..errors import ProgramError
from ..objects.text import relaid, without_statements
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout, print_layout
from .base import View

FURNISHING = ("s06_geometry", "s07_surfaces", "s08_materials", "s09_textures", "s10_finish")
"""Stages whose programs say what objects are modelled with."""
_FURNISHED = re.compile(r'^(furnish\(\s*")([^"\\]+)(")', re.MULTILINE)


def carried_on(
    view: View,
    before: LayoutProgram,
    stage: str,
    text: str,
    layout: Layout,
    findings: Sequence[Finding],
    ledger: Iterable[LedgerEntry],
    **more: Any,
) -> LayoutProgram:
    """The program that a stage writes: the one before with another text.

    Args:
        layout: what stands in the text. findings: what came of applying the hand edits; only what is lost is told again.
        ledger: what became of each detected object by now. more: other fields of the program that change.
    """
    lost = [f for f in findings if f.severity != "warning" or layout.proxy(f.about) is None]
    changes = {
        "text": text,
        "stage": stage,
        "ledger": list(ledger),
        "findings": [*before.findings, *(f for f in lost if f not in before.findings)],
        "hand_edits": len(view.hand_edits),
    }
    return before.model_copy(update=changes | more)


class Renames:
    """What objects that were renamed by hand since are called now.

    Args:
        layout: where everything has its present name.
    """

    def __init__(self, edits: Sequence[LayoutEdit], layout: Layout) -> None:
        self._present = {p.id for p in layout.proxies}
        self._renames = [(e.id, e.new_id) for e in edits if e.op == "rename" and e.new_id]

    def now(self, identifier: str) -> str:
        """The present id; the same one when nothing of that name is there any more."""
        at = identifier
        for old, new in self._renames:
            if at == old and at not in self._present and new is not None:
                at = new
        return at

    def in_text(self, text: str) -> str:
        """Furnish statements of a text under present ids."""
        return _FURNISHED.sub(lambda m: m[1] + self.now(m[2]) + m[3], text)


def furnished(view: View, layout: Layout) -> str:
    """The text of a layout in which objects that were modelled before keep what they were modelled with.

    Their functions take their size, so they fit whatever the layout makes of them. What has become another kind of thing,
    and everything where the old functions cannot be used any more, is a plain box again.
    """
    plain, standing = print_layout(layout), view.recall(Furnishing)
    if standing is None:
        return plain
    names = Renames(view.hand_edits[standing.hand_edits :], layout)
    try:
        former = {names.now(p.id): p.category for p in parse_layout(standing.text).proxies}
        others = [p.id for p in layout.proxies if former.get(p.id, p.category) != p.category]
        text = relaid(without_statements(names.in_text(standing.text), others), layout)
        evaluate(text, FINISHED_ROOM_LIMITS)
    except ProgramError:
        return plain
    return text
