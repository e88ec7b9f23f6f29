# SPDX-License-Identifier: GPL-3.0-or-later
"""Hand edits always win: what the artist changed is applied after every automatic step.

Edits speak of ids as they were when the edit was made, and ids change hands: a chair is renamed, and its copy takes the
old name. So the history is followed object by object, and a layout that holds a part of it gets only the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ..artifacts.analysis import Finding
from ..artifacts.layout import Layout, LayoutEdit, ProxyLine
from ..program.edits import LISTS, ROOM, apply_edits


@dataclass
class _Thread:
    """What the artist did with one object.

    Attributes:
        added: whether the artist put it there; otherwise it was detected, or added by the critic.
        name: its id before the first edit (with which it was added); now: after the last, None when it was removed.
        steps: its edits, each with its place in the whole history.
    """

    added: bool
    name: str
    now: str | None
    steps: list[tuple[int, LayoutEdit]] = field(default_factory=list)

    def name_after(self, count: int) -> str | None:
        """Its id after the first `count` edits of the history, None when it was not there then."""
        name: str | None = None if self.added else self.name
        for index, edit in self.steps:
            if index >= count:
                break
            name = None if edit.op == "remove" else edit.new_id if edit.op == "rename" else edit.id
        return name


def _threads(edits: Sequence[LayoutEdit]) -> list[_Thread]:
    threads: list[_Thread] = []
    current: dict[str, _Thread] = {}
    for index, edit in enumerate(edits):
        thread = current.get(edit.id)
        if thread is None:
            thread = current[edit.id] = _Thread(edit.op == "add", edit.id, edit.id)
            threads.append(thread)
        thread.steps.append((index, edit))
        if edit.op == "remove":
            thread.now = None
            del current[edit.id]
        elif edit.op == "rename" and edit.new_id:
            thread.now = edit.new_id
            current[edit.new_id] = current.pop(edit.id)
    return threads


def name_now(edits: Sequence[LayoutEdit], identifier: str) -> str | None:
    """The id that a detected object has after the hand edits, None when the artist removed it."""
    thread = _detected(_threads(edits), identifier)
    return identifier if thread is None else thread.now


def _detected(threads: Sequence[_Thread], identifier: str) -> _Thread | None:
    return next((t for t in threads if not t.added and t.name == identifier), None)


def apply_hand_edits(layout: Layout, edits: Sequence[LayoutEdit], done: int = 0) -> tuple[Layout, list[Finding]]:
    """The layout with the artist's edits on top; edits of detected things that are not placed (yet) are skipped.

    Args:
        done: how many edits, from the beginning of the history, the layout holds already.
    """
    threads = _threads(edits)
    present = {p.id for p in layout.proxies} | {line.id for name in LISTS for line in getattr(layout, name)} | {ROOM}
    known = {name for t in threads if (name := t.name_after(done)) in present}
    todo: list[tuple[int, LayoutEdit]] = []
    for thread in threads:
        if thread.name_after(done) in present:
            todo += [(index, edit) for index, edit in thread.steps if index >= done]
        elif thread.added and thread.now is not None:
            # What was added by hand and was found since (another analysis saw it) is not added again.
            found = thread.name in present - known
            todo += [step for step in thread.steps if step[1].op != "add" or step[1].line or not found]
    return apply_edits(layout, [edit for _, edit in sorted(todo, key=lambda step: step[0])])


def place_edited(layout: Layout, proxy: ProxyLine, edits: Sequence[LayoutEdit]) -> tuple[Layout, list[Finding]]:
    """The layout with one more proxy, placed as it was detected and then edited as the artist edited it.

    Nothing is added when the artist removed it, or when its id belongs to something else by now.
    """
    threads = _threads(edits)
    thread = _detected(threads, proxy.id)
    name = proxy.id if thread is None else thread.now
    if name is None or layout.proxy(name) is not None:
        return layout, []
    new = layout.model_copy(update={"proxies": [*layout.proxies, proxy.model_copy(update={"id": name})]})
    if thread is None:
        return new, []
    steps = []
    for index, edit in thread.steps:
        parent = next((t.now for t in threads if edit.parent and t.name_after(index) == edit.parent), edit.parent)
        if edit.op != "rename":
            steps.append(edit.model_copy(update={"id": name, "parent": parent}))
    return apply_edits(new, steps)
