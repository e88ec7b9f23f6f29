# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines of the room language that a draft's lines mean: the shell, and a proxy for each thing."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import TYPE_CHECKING

from ..artifacts.analysis import ArchitectureItem, Calibration, SceneAnalysis
from ..artifacts.common import ImagePoint
from ..artifacts.layout import Layout, ProxyLine
from ..geometry.camera import camera_straight_down
from ..layout.walls import shell
from .things import Fixed, RoomSaid, Thing

if TYPE_CHECKING:
    from .reading import Draft

_MARGIN = 0.3


def shell_of(room: RoomSaid, fixed: Iterable[Fixed]) -> Layout:
    """The room's line, its walls, and what is in them; no things."""
    analysis = SceneAnalysis(
        image_size=(1000, 1000),
        view="orthographic",
        room_size=room.size,
        floor=list(room.floor),
        floor_polygon=[ImagePoint(x=0, y=0)],
        architecture=[_item(f) for f in fixed],
    )
    over = camera_straight_down("orthographic", room.size[0], room.size[1], (1000, 1000), margin=0.1)
    standing = Calibration(camera=over, floor=list(room.floor), height=room.size[2], error_px=0.0, scale_source="model")
    line, walls, doors, windows, openings, _ = shell(analysis, standing)
    return Layout(room=line, walls=walls, doors=doors, windows=windows, openings=openings)


def names_in(shell: Layout) -> set[str]:
    """The ids of walls and of what is in them."""
    return {line.id for group in (shell.walls, shell.doors, shell.windows, shell.openings) for line in group}


def _item(fixed: Fixed) -> ArchitectureItem:
    return ArchitectureItem.model_validate(
        {
            "id": fixed.id,
            "kind": fixed.kind,
            "start": fixed.start,
            "end": fixed.end,
            "height": fixed.height,
            "sill": fixed.sill,
            "thickness": fixed.thickness,
            "wall": fixed.wall,
            "swing": fixed.swing,
        }
    )


def proxy_line(thing: Thing) -> ProxyLine:
    """A thing as the line of the room language; its parent may not be there."""
    x, y, z = thing.at
    return ProxyLine(
        id=thing.id,
        category=thing.category,
        centre=(x, y, z + thing.size[2] / 2),
        size=(round(thing.size[0], 4), round(thing.size[1], 4), round(thing.size[2], 4)),
        yaw=thing.yaw,
        placement=thing.placement,
        parent=thing.parent,
        salience=thing.salience,
        label=thing.label,
        shape=thing.shape,
    )


def parents_of(things: Sequence[Thing], fixed: Collection[str]) -> dict[str, str | None]:
    """What carries each thing, where that is there and does not run in a circle."""
    parents = {thing.id: thing.parent for thing in things}
    for name, parent in list(parents.items()):
        seen, at = {name}, parent
        while at in parents and at not in seen:
            seen.add(at)
            at = parents[at]
        sound = (at is None or at not in seen) and (parent in parents or parent in fixed)
        parents[name] = parent if sound else None
    return parents


def room_of(draft: Draft) -> RoomSaid | None:
    """A room line for a draft that has none: round its walls, else round its things; None where there is neither."""
    points = [p for f in [*draft.outer, *draft.fixed.values()] for p in (f.start, f.end)]
    margin = 0.0
    if len(points) < 3:
        margin = _MARGIN
        points += [
            (t.at[0] + a * t.size[0] / 2, t.at[1] + b * t.size[1] / 2)
            for t in draft.things.values()
            for a in (-1, 1)
            for b in (-1, 1)
        ]
    if not points:
        return None
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    x0, x1, y0, y1 = min(xs) - margin, max(xs) + margin, min(ys) - margin, max(ys) + margin
    if x1 - x0 < 0.5:
        x0, x1 = x0 - 1.0, x1 + 1.0
    if y1 - y0 < 0.5:
        y0, y1 = y0 - 1.0, y1 + 1.0
    height = max([2.6, *(f.height for f in draft.outer)])
    return RoomSaid((x1 - x0, y1 - y0, min(8.0, height)), ((x0, y0), (x1, y0), (x1, y1), (x0, y1)))
