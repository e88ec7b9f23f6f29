# SPDX-License-Identifier: GPL-3.0-or-later
"""Hand edits always win: what the artist changed is applied after every automatic step."""

from __future__ import annotations

from collections.abc import Sequence

from ..artifacts.analysis import Finding
from ..artifacts.layout import Layout, LayoutEdit
from ..program.patch import apply_edits


def apply_hand_edits(layout: Layout, edits: Sequence[LayoutEdit]) -> tuple[Layout, list[Finding]]:
    """The layout with the artist's edits on top; an edit of something that is not placed (yet) is skipped silently."""
    present = {p.id for p in layout.proxies}
    usable = []
    for edit in edits:
        if edit.op == "add" and edit.id in present:
            continue
        if edit.op != "add" and edit.id not in present:
            continue
        usable.append(edit)
        if edit.op == "add":
            present.add(edit.id)
        elif edit.op == "remove":
            present.discard(edit.id)
        elif edit.op == "rename" and edit.new_id:
            present.discard(edit.id)
            present.add(edit.new_id)
    return apply_edits(layout, usable)
