# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls, doors, windows, openings, lights and cameras that the artist changed by hand, as their new layout lines.

A line says less than an object can do, so what was done is brought back to what it says: a door stands in the wall it
is nearest to, a wall stands on the floor. The floor itself and the reference camera follow from the calibration.
"""

from __future__ import annotations

import functools
import json
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..artifacts.analysis import Finding
from ..artifacts.layout import DoorLine, Layout, LayoutEdit, LightLine, WallLine
from ..errors import ProgramError
from ..program.lines import parse_line, print_line, rounded_line
from ..program.prelude.walls import wall_runs
from .boxes import BOUNDS, mesh_edited
from .fitted_lines import camera_line, door_swing, fitting_line, light_line, new_light_line, wall_line
from .holding import SEEN, SEEN_LOCAL, local_matrix
from .measure import mesh_points
from .naming import free_id, id_from_name, next_id
from .reference_camera import REFERENCE
from .tags import BUILT_LINES, COPIED, ID, KIND, LINE, PART, world_matrix

STILL = 1e-5  # metres and radians; what differs by less was not touched
MOVED = 1e-4  # metres: smaller differences are float noise
_SHELL = ("walls", "doors", "windows", "openings")
_FROM_CALIBRATION = {
    "floor": "The floor follows from the calibration: drag its corners there. It is put back by the next build.",
    "camera": "The reference camera follows from the calibration, and is put back by the next build. "
    "Add a camera of your own for other views.",
}


@dataclass
class LinesRead:
    """What was read.

    Attributes:
        edits: in an order in which they can be applied. adopted: copied or added objects with their new ids.
        held: objects that were edited. put_back: objects that a build is to put where their line says.
    """

    edits: list[LayoutEdit] = field(default_factory=list)
    adopted: list[tuple[Any, str]] = field(default_factory=list)
    held: list[Any] = field(default_factory=list)
    put_back: list[Any] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)


def built_layout(room: Any) -> tuple[Layout, frozenset[str]] | None:
    """The layout that the room was last built with, and the ids of its lines that have no object.

    None for a room that was built by an earlier version.
    """
    text = str(room.get(BUILT_LINES, ""))
    return _built(text) if text else None


@functools.lru_cache(maxsize=4)
def _built(text: str) -> tuple[Layout, frozenset[str]] | None:
    """The same text is read many times between two builds. What comes back is shared: nobody may change it."""
    try:
        data = json.loads(text)
        return Layout.model_validate({k: v for k, v in data.items() if k != "left_out"}), frozenset(data["left_out"])
    except (ValueError, TypeError, KeyError):
        return None


def read_lines(
    room: Any,
    built: Layout,
    left_out: frozenset[str],
    tagged: dict[tuple[str, str], list[Any]],
    taken: set[str],
    used: set[str],
) -> LinesRead:
    """Compare the shell, lights and cameras with their lines as they were built.

    Args:
        tagged: the room's objects by (id, part). taken: ids of all lines of the program.
        used: ids that new things must not get; theirs are added.
    """
    reader = _Reader(LinesRead(), tagged, used, list(built.walls))
    lines = {line.id: line for name in (*_SHELL, "lights", "cameras") for line in getattr(built, name)}
    sources = _sources(tagged, lines)
    for identifier, line in lines.items():
        if identifier in left_out or identifier not in taken:
            continue
        first = next((o for o in tagged.get((identifier, ""), []) if LINE in o), None)
        if first is None:
            reader.gone(identifier)
        else:
            reader.changed(line, first, built)
    for obj, source in sources:
        reader.copied(lines[source], obj)
    for obj in room.all_objects:
        is_new = ID not in obj and (obj.parent is None or ID in obj.parent)
        if obj.type == "LIGHT" and (is_new or (LINE not in obj and COPIED not in obj and obj.get(ID) not in taken)):
            reader.added_light(obj)
    _check_floor(reader.read, tagged)
    reader.finish()
    return reader.read


def _sources(tagged: dict[tuple[str, str], list[Any]], lines: dict[str, Any]) -> list[tuple[Any, str]]:
    """Objects that are copies of a line's object, each with that line's id."""
    found = []
    for (identifier, part), objects in tagged.items():
        if part:
            continue
        for place, obj in enumerate(objects):
            source = str(obj.get(COPIED, identifier))
            pending = LINE not in obj and COPIED in obj
            if source in lines and obj.get(KIND) != "proxy" and (pending or (place and identifier in lines)):
                found.append((obj, source))
    return found


@dataclass
class _Reader:
    """Collects edits: walls first, then what may be in them, removals last."""

    read: LinesRead
    tagged: dict[tuple[str, str], list[Any]]
    used: set[str]
    walls: list[WallLine]
    fittings: list[tuple[LayoutEdit, Any]] = field(default_factory=list)
    removals: list[LayoutEdit] = field(default_factory=list)

    def gone(self, identifier: str) -> None:
        """The object of a line was deleted."""
        self.removals.append(LayoutEdit(op="remove", id=identifier, reason="deleted by hand", origin="artist"))
        self.walls = [w for w in self.walls if w.id != identifier]

    def changed(self, line: Any, obj: Any, built: Layout) -> None:
        """The object of a line, wherever it is now."""
        if obj.get(KIND) == "camera" and line.id == REFERENCE:
            if touched(obj) or camera_line(line, obj) is not None:
                self.put_back(obj, "camera")
            return
        new = self._line_now(line, obj, built)
        if new is None:
            return
        follows = followed(obj) and not isinstance(line, WallLine) and obj.type in ("MESH", "LIGHT")
        edit = self._edit("line", line.id, new, "changed by hand")
        if edit is not None and follows:
            reason = f"moved along with {line.parent if isinstance(line, LightLine) else line.wall}"
            edit = edit.model_copy(update={"origin": "parent", "reason": reason})
        elif edit is not None:
            self.read.held.append(obj)
        self._keep(edit, new)

    def copied(self, line: Any, obj: Any) -> None:
        """A copy of a line's object."""
        name = str(obj[ID]) if COPIED in obj else next_id(line.id, self.used)
        self.used.add(name)
        new = self._line_now(line, obj, None) or line
        edit = self._edit("add", name, new.model_copy(update={"id": name}), "copied by hand")
        self.read.adopted.append((obj, name))
        for leaf in [o for o in obj.children if o.get(PART) == "leaf"]:
            self.read.adopted.append((leaf, name))
        self._keep(edit, new.model_copy(update={"id": name}))

    def added_light(self, obj: Any) -> None:
        """A lamp of the artist's."""
        name = str(obj[ID]) if ID in obj else free_id(id_from_name(obj.name) or "light_1", self.used)
        self.used.add(name)
        self.read.adopted.append((obj, name))
        line = new_light_line(name, obj)
        self._keep(self._edit("add", name, line, "added by hand"), line)

    def put_back(self, obj: Any, what: str) -> None:
        """Something that is not edited this way."""
        self.read.put_back.append(obj)
        message = _FROM_CALIBRATION[what]
        self.read.findings.append(Finding(about=str(obj[ID]), message=message, severity="warning"))

    def finish(self) -> None:
        """Put all edits in their order; what is in a wall is put in the wall it is nearest to."""
        for edit, line in self.fittings:
            if hasattr(line, "wall"):
                if not self.walls:
                    continue
                fitted = self._edit(edit.op, edit.id, fitting_line(line, self.walls), edit.reason)
                if fitted is None:
                    continue
                edit = fitted.model_copy(update={"origin": edit.origin})
            self.read.edits.append(edit)
        self.read.edits += self.removals

    def _keep(self, edit: LayoutEdit | None, line: Any) -> None:
        if edit is None:
            return
        if isinstance(line, WallLine):
            self.walls = [*(w for w in self.walls if w.id != line.id), line]
            self.read.edits.append(edit)
        else:
            self.fittings.append((edit, line))

    def _line_now(self, line: Any, obj: Any, built: Layout | None) -> Any | None:
        """The line as the object stands, None when it stands as it was built."""
        if obj.type == "LIGHT":
            return light_line(line, obj)
        if obj.type == "CAMERA":
            return camera_line(line, obj)
        new = None
        if touched(obj):
            change = motion(obj)
            new = wall_line(line, change) if isinstance(line, WallLine) else moved_fitting(line, change)
            new = None if new is None or _same(new, line) else new
        leaf = next(iter(self.tagged.get((line.id, "leaf"), [])), None)
        if isinstance(line, DoorLine) and built is not None and leaf is not None and SEEN_LOCAL in leaf:
            swing = door_swing(leaf)
            if abs(swing) > 0.1:
                side = _room_side(line, built)
                new = (new or line).model_copy(update={"open": _open(line.open + swing * side)})
        return new

    def _edit(self, op: Any, name: str, line: Any, reason: str) -> LayoutEdit | None:
        try:
            text = print_line(rounded_line(line))
            parse_line(text)
        except (ProgramError, ValueError) as error:
            why = getattr(error, "message", str(error))
            message = f"What was done to it by hand cannot be taken over: {why}."
            self.read.findings.append(Finding(about=name, message=message, severity="warning"))
            return None
        return LayoutEdit(op=op, id=name, line=text, reason=reason, origin="artist")


def touched(obj: Any) -> bool:
    """Whether the object is elsewhere, or its mesh another one, than when it was built."""
    if SEEN not in obj:
        return False
    now = np.array(world_matrix(obj), dtype=float).ravel()
    return bool(np.abs(now - np.array(obj[SEEN], dtype=float)).max() > STILL) or mesh_edited(obj)


def followed(obj: Any) -> bool:
    """Whether the object only moved along with its parent."""
    if SEEN_LOCAL not in obj or obj.parent is None or mesh_edited(obj):
        return False
    now = np.array(local_matrix(obj), dtype=float).ravel()
    return bool(np.abs(now - np.array(obj[SEEN_LOCAL], dtype=float)).max() < STILL)


def motion(obj: Any) -> Any:
    """The 4 x 4 matrix that takes what was built to where it is now, with a mesh that was stretched in Edit mode."""
    built = np.array(obj[SEEN], dtype=float).reshape(4, 4)
    stretch = np.eye(4)
    former = np.array(obj.get(BOUNDS, ()), dtype=float)
    if mesh_edited(obj) and len(former) == 6 and len(obj.data.vertices):
        points = mesh_points(obj.data)
        low, high = points.min(axis=0), points.max(axis=0)
        sizes = former[3:] - former[:3]
        factors = np.where(sizes > 1e-6, (high - low) / np.maximum(sizes, 1e-6), 1.0)
        stretch[:3, :3] = np.diag(factors)
        stretch[:3, 3] = low - factors * former[:3]
    result: Any = np.array(world_matrix(obj), dtype=float) @ stretch @ np.linalg.pinv(built)
    return result


def moved_fitting(line: Any, change: Any) -> Any:
    """A door, window or opening as it was moved, not yet put in a wall."""
    low = getattr(line, "sill", 0.0)
    middle = [(a + b) / 2 for a, b in zip(line.start, line.end, strict=True)]
    foot, top = (change @ (*middle, z, 1.0) for z in (low, low + line.height))
    ends = {name: tuple(float(v) for v in (change @ (*getattr(line, name), low, 1.0))[:2]) for name in ("start", "end")}
    height = max(0.05, float(np.linalg.norm((top - foot)[:3])))
    values: dict[str, Any] = {**ends, "height": height}
    if hasattr(line, "sill"):
        values["sill"] = max(0.0, float(min(foot[2], top[2])))
    return line.model_copy(update=values)


def _same(new: Any, line: Any) -> bool:
    """Whether two lines say the same within float noise."""
    a, b = new.model_dump(), line.model_dump()
    for key, value in a.items():
        if isinstance(value, (tuple, float)) and not isinstance(value, bool):
            if np.abs(np.array(value, dtype=float) - np.array(b[key], dtype=float)).max() > MOVED:
                return False
        elif value != b[key]:
            return False
    return True


def _room_side(line: DoorLine, built: Layout) -> float:
    """1 when a door's line runs with its wall (the room to its left), else -1."""
    runs = wall_runs([w.model_dump() for w in built.walls], list(built.room.floor))
    run = next((r for r in runs if r.id == line.wall), None)
    return 1.0 if run is None or run.along(line.start) <= run.along(line.end) else -1.0


def _open(degrees: float) -> float:
    return max(-180.0, min(180.0, math.remainder(degrees, 360.0)))


def _check_floor(read: LinesRead, tagged: dict[tuple[str, str], list[Any]]) -> None:
    for objects in tagged.values():
        if objects[0].get(KIND) == "floor" and touched(objects[0]):
            read.put_back.append(objects[0])
            message = _FROM_CALIBRATION["floor"]
            read.findings.append(Finding(about="floor", message=message, severity="warning"))
