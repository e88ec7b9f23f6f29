# SPDX-License-Identifier: GPL-3.0-or-later
"""Typed edits of a layout. What cannot be done is reported in a plain sentence and changes nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from ..artifacts.analysis import Finding
from ..artifacts.layout import (
    CameraLine,
    DoorLine,
    Layout,
    LayoutEdit,
    LightLine,
    Line,
    OpeningLine,
    ProxyLine,
    RoomLine,
    ViewLine,
    WallLine,
    WindowLine,
    WorldLine,
)
from ..errors import ProgramError
from .lines import checked_fields, name_of, parse_line, rounded_line
from .prelude.recorder import MOST_LINES, Recorder

LISTS: dict[str, type[Any]] = {
    "walls": WallLine,
    "doors": DoorLine,
    "windows": WindowLine,
    "openings": OpeningLine,
    "lights": LightLine,
    "worlds": WorldLine,
    "views": ViewLine,
    "cameras": CameraLine,
}
"""The fields of a layout that hold what is no proxy, and the type of their lines."""
ROOM = "room"
"""What the room line is called by in edits."""


class _Unusable(Exception):
    """Why an edit cannot be done."""


@dataclass
class Edited:
    """A layout after edits, and what happened.

    Attributes:
        proxies: the proxies as they are now.
        lines: all other lines with an id as they are now, in their order. room: the room line.
        before: the proxies' ids before the edits. lines_before: the other lines.
        origins: for each proxy id of now, the id it had before the edits, or None when it was added.
        findings: unusable edits and side effects.
    """

    proxies: list[ProxyLine]
    lines: dict[str, Any]
    room: RoomLine
    before: set[str]
    lines_before: dict[str, Any]
    origins: dict[str, str | None] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)

    def index(self, identifier: str) -> int:
        """Where the proxy with this id is. Raises _Unusable when there is none."""
        for index, proxy in enumerate(self.proxies):
            if proxy.id == identifier:
                return index
        raise _Unusable(f"there is no object {identifier!r}")

    def change(self, identifier: str, **values: Any) -> None:
        """Set fields of a proxy, checked as the program's line is when it runs."""
        index = self.index(identifier)
        self.proxies[index] = _checked(self.proxies[index].model_copy(update=values))

    def note(self, edit: LayoutEdit, message: str, severity: Any = "note") -> None:
        """Report something about an edit."""
        self.findings.append(Finding(about=edit.id, message=message, severity=severity))

    def layout(self) -> Layout:
        """The layout as it is now."""
        groups = {name: [x for x in self.lines.values() if type(x) is kind] for name, kind in LISTS.items()}
        return Layout(room=self.room, proxies=self.proxies, **groups)


def apply_edits(layout: Layout, edits: list[LayoutEdit]) -> tuple[Layout, list[Finding]]:
    """The layout after the edits, one after the other; unusable ones are reported and left out.

    - `move` sets the centre, `turn` the yaw, of this object alone. `resize` keeps the base of what stands and the top
      of what hangs where it is, unless the edit gives a centre too.
    - `add` needs category, centre and size; a new object comes after the last one of its salience. With a `line` it
      adds a wall, door, window, opening, light or camera, or puts the line in the place of the one with this id.
    - `remove` gives the object's children to its own parent. A wall takes what is cut into it along, and a lamp or window
      the light that shines from it. `rename` follows into an object's children and lights.
    - `reparent` sets the placement, where given, and the parent (None: no parent).
    - `line` puts a line in the place of the one with this id, which must be of the same kind.

    Numbers of changed lines are rounded as they are printed. The layout that is given is not changed.
    """
    edited = edit_layout(layout, edits)
    return edited.layout().model_copy(deep=True), edited.findings


def edit_layout(layout: Layout, edits: list[LayoutEdit]) -> Edited:
    """As `apply_edits`, with the ids before and after."""
    lines: dict[str, Any] = {line.id: line for name in LISTS for line in getattr(layout, name)}
    state = Edited([p.model_copy() for p in layout.proxies], lines, layout.room, {p.id for p in layout.proxies}, lines)
    state.lines = dict(lines)
    state.origins = {p.id: p.id for p in state.proxies}
    for edit in edits:
        try:
            if edit.op not in ("add", "line", "remove"):
                state.index(edit.id)
            _OPERATIONS[edit.op](state, edit)
        except _Unusable as problem:
            state.note(edit, f"The edit {edit.op!r} of {edit.id!r} was left out: {problem}.", "warning")
    return state


def _move(state: Edited, edit: LayoutEdit) -> None:
    state.change(edit.id, centre=_given(edit, "centre"))


def _resize(state: Edited, edit: LayoutEdit) -> None:
    size = _given(edit, "size")
    proxy = state.proxies[state.index(edit.id)]
    x, y, z = proxy.centre
    rise = (size[2] - proxy.size[2]) / 2
    z += {"floor": rise, "surface": rise, "ceiling": -rise, "wall": 0.0}[proxy.placement]
    state.change(edit.id, size=size, centre=edit.centre or (x, y, z))


def _turn(state: Edited, edit: LayoutEdit) -> None:
    state.change(edit.id, yaw=_given(edit, "yaw"))


def _recategorise(state: Edited, edit: LayoutEdit) -> None:
    values = {"category": _given(edit, "category")}
    values |= {name: v for name in ("label", "salience", "shape") if (v := getattr(edit, name)) is not None}
    state.change(edit.id, **values)


def _add(state: Edited, edit: LayoutEdit) -> None:
    if edit.line is not None:
        line = _line_of(state, edit)
        former = state.lines.get(edit.id)
        if isinstance(line, RoomLine) or (former is None and edit.id in state.origins):
            raise _Unusable(f"the id {edit.id!r} is taken")
        if former is not None and type(former) is not type(line):
            raise _Unusable(f"the id {edit.id!r} is taken")
        if former is None:
            _room_for_more(state)
        state.lines[edit.id] = line
        return
    _free(state, edit.id)
    _known_parent(state, edit.id, edit.parent)
    _room_for_more(state)
    centre, size, category = (_given(edit, name) for name in ("centre", "size", "category"))
    proxy = ProxyLine(id=edit.id, category=category, centre=centre, size=size, yaw=edit.yaw or 0.0, parent=edit.parent)
    proxy.placement = edit.placement or ("floor" if edit.parent is None else "surface")
    proxy.salience, proxy.label, proxy.shape = edit.salience or "major", edit.label or "", edit.shape or "box"
    state.proxies.insert(place_for(state.proxies, proxy), _checked(proxy))
    state.origins[edit.id] = None


def place_for(proxies: list[ProxyLine], proxy: ProxyLine) -> int:
    """Where a new proxy goes: after the last of its salience; else majors first, minors last."""
    same = [index for index, other in enumerate(proxies) if other.salience == proxy.salience]
    return same[-1] + 1 if same else 0 if proxy.salience == "major" else len(proxies)


def _line(state: Edited, edit: LayoutEdit) -> None:
    line = _line_of(state, edit)
    if isinstance(line, RoomLine):
        state.room = line
        return
    former = state.lines.get(edit.id)
    if former is None:
        raise _Unusable(f"there is no wall, door, window, opening, light, world, view or camera {edit.id!r}")
    if type(former) is not type(line):
        raise _Unusable(f"{edit.id!r} is a {name_of(former)}, not a {name_of(line)}")
    state.lines[edit.id] = line


def _line_of(state: Edited, edit: LayoutEdit) -> Line:
    """The line that an edit brings, with rounded numbers."""
    try:
        line = rounded_line(parse_line(_given(edit, "line")))
    except ProgramError as error:
        raise _Unusable(error.message) from None
    if isinstance(line, ProxyLine):
        raise _Unusable("the line of an object is changed by other edits")
    if (ROOM if isinstance(line, RoomLine) else line.id) != edit.id:
        raise _Unusable("its line has another id")
    if isinstance(line, DoorLine | WindowLine | OpeningLine) and not isinstance(state.lines.get(line.wall), WallLine):
        raise _Unusable(f"there is no wall {line.wall!r}")
    if isinstance(line, LightLine):
        _known_parent(state, edit.id, line.parent)
    return line


def _remove(state: Edited, edit: LayoutEdit) -> None:
    if edit.id in state.lines and edit.id not in state.origins:
        _remove_line(state, edit)
        return
    gone = state.proxies.pop(state.index(edit.id))
    del state.origins[gone.id]
    _leave_children(state, edit, gone.id, gone.parent)


def _remove_line(state: Edited, edit: LayoutEdit) -> None:
    cut = [i for i, line in state.lines.items() if getattr(line, "wall", None) == edit.id]
    for identifier in (*cut, edit.id):
        del state.lines[identifier]
        if identifier in cut:
            state.note(edit, f"{identifier!r} was in {edit.id!r}, which was removed, and went with it.")
        _leave_children(state, edit, identifier, None)


def _leave_children(state: Edited, edit: LayoutEdit, gone: str, parent: str | None) -> None:
    """What stood on or hung from something that was removed belongs to its parent now, or to nothing."""
    for proxy in list(state.proxies):
        if proxy.parent == gone:
            state.change(proxy.id, parent=parent)
            to = f"now belongs to {parent!r}" if parent else "now has no parent"
            state.note(edit, f"{proxy.id!r} stood on {gone!r}, which was removed; it {to}.")
    for light in [line for line in state.lines.values() if isinstance(line, LightLine) and line.parent == gone]:
        del state.lines[light.id]
        state.note(edit, f"The light {light.id!r} shone from {gone!r}, which was removed, and went with it.")


def _rename(state: Edited, edit: LayoutEdit) -> None:
    new = _given(edit, "new_id")
    if new == edit.id:
        return
    _free(state, new)
    state.change(edit.id, id=new)
    state.origins[new] = state.origins.pop(edit.id)
    for proxy in list(state.proxies):
        if proxy.parent == edit.id:
            state.change(proxy.id, parent=new)
    for name, line in state.lines.items():
        if isinstance(line, LightLine) and line.parent == edit.id:
            state.lines[name] = line.model_copy(update={"parent": new})


def _reparent(state: Edited, edit: LayoutEdit) -> None:
    if edit.placement is None and edit.parent is None:
        raise _Unusable("it gives neither a placement nor a parent")
    _known_parent(state, edit.id, edit.parent)
    values: dict[str, Any] = {"parent": edit.parent}
    if edit.placement is not None:
        values["placement"] = edit.placement
    state.change(edit.id, **values)


_OPERATIONS = {
    "move": _move,
    "resize": _resize,
    "turn": _turn,
    "add": _add,
    "remove": _remove,
    "recategorise": _recategorise,
    "rename": _rename,
    "reparent": _reparent,
    "line": _line,
}


def _given(edit: LayoutEdit, name: str) -> Any:
    value = getattr(edit, name)
    if value is None:
        raise _Unusable(f"it gives no {name}")
    return value


def _free(state: Edited, identifier: str) -> None:
    if identifier in state.origins or identifier in state.lines:
        raise _Unusable(f"the id {identifier!r} is taken")


def _room_for_more(state: Edited) -> None:
    if len(state.proxies) + len(state.lines) >= MOST_LINES:
        raise _Unusable(f"a room has at most {MOST_LINES} layout lines")


def _known_parent(state: Edited, identifier: str, parent: str | None) -> None:
    parents = {proxy.id: proxy.parent for proxy in state.proxies}
    shell = (WallLine, DoorLine, WindowLine, OpeningLine)
    if parent is not None and parent not in parents and not isinstance(state.lines.get(parent), shell):
        raise _Unusable(f"the parent {parent!r} does not exist")
    at = parent
    for _ in range(len(parents) + 1):
        if at == identifier:
            raise _Unusable("the parents would run in a circle")
        at = parents.get(at) if at is not None else None


def _checked(proxy: ProxyLine) -> ProxyLine:
    """The proxy with rounded numbers, if its line would be accepted when the program runs."""
    if not all(math.isfinite(value) for value in (*proxy.centre, *proxy.size, proxy.yaw)):
        raise _Unusable("all numbers must be finite")
    line = rounded_line(proxy)
    try:
        checked_fields(Recorder(), "proxy", [], line.model_dump())
    except ValueError as error:
        raise _Unusable(str(error)) from None
    assert isinstance(line, ProxyLine)
    return line
