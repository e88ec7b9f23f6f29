# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist changed in a program's text, as typed edits: the inverse of applying them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Sequence
from typing import Any

from ..artifacts.analysis import Finding
from ..artifacts.layout import Layout, LayoutEdit, ProxyLine, RoomLine, WallLine
from ..errors import ProgramError
from .assemble import room_part
from .edits import LISTS, ROOM, apply_edits
from .limits import FINISHED_ROOM_LIMITS
from .lines import LINE_TYPES, called_name, print_line, rounded_line
from .parse_safe import parse

REASON = "in the text"
_STATEMENT = re.compile(rf"^(?!(?:{'|'.join((*LINE_TYPES, 'build'))})\s*\()[A-Za-z_]", re.MULTILINE)
"""A line at the left margin that is neither a layout line nor the end."""


def differences(before: Layout, after: Layout) -> list[LayoutEdit]:
    """Edits that make the second layout from the first: `apply_edits(before, ...)` has the lines of `after`.

    Numbers are compared as they are printed. The order of the lines is not an edit. A line that goes while an equal one
    with another id comes was renamed.
    """
    edits: list[LayoutEdit] = []
    layout = before

    def do(more: Iterable[LayoutEdit]) -> None:
        nonlocal layout
        found = list(more)
        edits.extend(found)
        layout = apply_edits(layout, found)[0]

    wanted = {p.id: _rounded(p) for p in after.proxies}
    lines = _lines(after)
    former = _lines(before)
    others = {i: line for i, line in former.items() if i in wanted or (i in lines and type(lines[i]) is not type(line))}
    do(_removals(others))
    renames = _renames(layout, wanted, set(lines))
    do(_edit("remove", p.id) for p in layout.proxies if p.id not in wanted and p.id not in renames)
    do(_edit("rename", old, new_id=new) for old, new in renames.items())
    if rounded_line(after.room) != rounded_line(before.room):
        do([_edit("line", ROOM, line=print_line(after.room))])
    for walls in (True, False):
        now = _lines(layout)
        group = [line for line in lines.values() if isinstance(line, WallLine) is walls]
        do(_line_edit(line, now.get(line.id)) for line in group if _differs(line, now.get(line.id)))
    for proxy in _parents_first(wanted):
        do(_proxy_edits(layout.proxy(proxy.id), proxy))
    do(_removals({i: line for i, line in _lines(layout).items() if i not in lines}))
    return edits


def _removals(lines: dict[str, Any]) -> list[LayoutEdit]:
    """What is cut into a wall goes before the wall, which would take it along."""
    return [_edit("remove", i) for i in sorted(lines, key=lambda i: isinstance(lines[i], WallLine))]


def merged(typed: Sequence[LayoutEdit], seen: Sequence[LayoutEdit]) -> tuple[list[LayoutEdit], list[Finding]]:
    """What was edited in the scene meanwhile, to be applied after what was edited in the text.

    Where both changed one object the text wins, and a finding says so. Objects that the text only renamed keep the
    scene's edits, under their new ids.
    """
    renamed = {e.id: e.new_id for e in typed if e.op == "rename" and e.new_id}
    changed = {e.id for e in typed if e.op != "rename"}
    added = {e.id for e in typed if e.op == "add"}
    kept: list[LayoutEdit] = []
    lost: list[str] = []
    for edit in seen:
        name = renamed.get(edit.id, edit.id)
        if name in changed or (edit.op == "rename" and (edit.id in renamed or edit.new_id in added)):
            lost.append(name)
            continue
        parent = renamed.get(edit.parent, edit.parent) if edit.parent else edit.parent
        kept.append(edit.model_copy(update={"id": name, "parent": parent}))
    message = "It was changed in the text and in the scene; the text counts."
    return kept, [Finding(about=name, message=message, severity="warning") for name in dict.fromkeys(lost)]


def loses_code(before: str, after: str) -> bool:
    """Whether a whole room.py has functions or other statements of the artist's that the next one has not."""
    try:
        former = room_part(before)
    except ProgramError:
        return False
    if not _STATEMENT.search(former):
        return False  # quick: most programs have layout lines only
    return not set(own_code(former)) <= set(own_code(room_part(after)))


def own_code(text: str) -> tuple[str, ...]:
    """What an artist wrote into a room text beside its layout lines: functions, `furnish` and other statements.

    Comments do not count. A text that cannot be parsed has none.
    """
    try:
        tree = parse(text.removeprefix("\ufeff"), FINISHED_ROOM_LIMITS)
    except Exception:
        return ()
    return tuple(ast.unparse(node) for node in tree.body if called_name(node) not in (*LINE_TYPES, "build"))


def _edit(op: Any, identifier: str, **fields: Any) -> LayoutEdit:
    return LayoutEdit(op=op, id=identifier, origin="artist", reason=REASON, **fields)


def _rounded(proxy: ProxyLine) -> ProxyLine:
    line = rounded_line(proxy)
    assert isinstance(line, ProxyLine)
    return line


def _lines(layout: Layout) -> dict[str, Any]:
    """All lines but the room's and the proxies', by id, with rounded numbers."""
    return {line.id: rounded_line(line) for name in LISTS for line in getattr(layout, name)}


def _differs(line: Any, former: Any) -> bool:
    return former is None or line != former


def _line_edit(line: Any, former: Any) -> LayoutEdit:
    assert not isinstance(line, RoomLine)
    return _edit("add" if former is None else "line", line.id, line=print_line(line))


def _renames(layout: Layout, wanted: dict[str, ProxyLine], taken: set[str]) -> dict[str, str]:
    """Proxies that are there under another id, old id -> new id. Children of a renamed parent do not count as changed."""
    gone = [_rounded(p) for p in layout.proxies if p.id not in wanted]
    present = {p.id for p in layout.proxies}
    came = [p for i, p in wanted.items() if i not in present and i not in taken]
    found: dict[str, str] = {}
    for old in gone:
        same = next((p for p in came if _same_thing(old, p) and p.id not in found.values()), None)
        if same is not None:
            found[old.id] = same.id
    return found


def _same_thing(a: ProxyLine, b: ProxyLine) -> bool:
    fields = ("category", "centre", "size", "yaw", "label", "shape")
    return all(getattr(a, name) == getattr(b, name) for name in fields)


def _parents_first(proxies: dict[str, ProxyLine]) -> list[ProxyLine]:
    def depth(proxy: ProxyLine) -> int:
        steps, at = 0, proxy.parent
        while at in proxies and steps < len(proxies):
            steps, at = steps + 1, proxies[at].parent
        return steps

    return sorted(proxies.values(), key=depth)


def _proxy_edits(now: ProxyLine | None, wanted: ProxyLine) -> list[LayoutEdit]:
    if now is None:
        fields = wanted.model_dump(exclude={"id"})
        return [_edit("add", wanted.id, **fields)]
    name = wanted.id
    edits: list[LayoutEdit] = []
    if (now.parent, now.placement) != (wanted.parent, wanted.placement):
        edits.append(_edit("reparent", name, placement=wanted.placement, parent=wanted.parent))
    if now.size != wanted.size:
        edits.append(_edit("resize", name, size=wanted.size, centre=wanted.centre))
    elif now.centre != wanted.centre:
        edits.append(_edit("move", name, centre=wanted.centre))
    if now.yaw != wanted.yaw:
        edits.append(_edit("turn", name, yaw=wanted.yaw))
    said = {f: getattr(wanted, f) for f in ("label", "salience", "shape") if getattr(now, f) != getattr(wanted, f)}
    if now.category != wanted.category or said:
        edits.append(_edit("recategorise", name, category=wanted.category, **said))
    return edits
