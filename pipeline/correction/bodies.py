# SPDX-License-Identifier: GPL-3.0-or-later
"""A finished room for the correction: its lines, and every object's mesh where it stands. Nothing here changes in place."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..artifacts.common import Metres3
from ..artifacts.layout import Layout, ProxyLine, WallLine
from ..geometry.placement import Rect
from ..layout.faces import partition_body
from ..layout.standing import FLAT
from ..objects.cloths import is_lying_cloth
from ..program.lines import rounded_line
from ..program.prelude.palette import category_family
from ..program.prelude.proxies import proxy_shapes
from ..program.prelude.record import Record
from ..program.prelude.shape import Shape
from .columns import Columns, Floats, columns_of, turned


@dataclass(frozen=True, eq=False)
class Body:
    """One object's mesh in the room's frame.

    Attributes:
        own: its parts in its own frame. cloth: lies on what carries it, in its folds, and is not held against others.
        known: what was worked out of its parts, for all objects that have the same ones and wherever they are moved.
    """

    line: ProxyLine
    own: Sequence[Shape]
    cloth: bool = False
    known: dict[Any, Any] = field(default_factory=dict)

    @property
    def id(self) -> str:
        """Of its line."""
        return self.line.id

    @functools.cached_property
    def base(self) -> Metres3:
        """Middle of its box's underside."""
        x, y, z = self.line.centre
        return x, y, z - self.line.size[2] / 2

    @functools.cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of its vertices in its own frame."""
        if "bounds" not in self.known:
            points = np.concatenate([s.vertices for s in self.own])
            self.known["bounds"] = points.min(axis=0), points.max(axis=0)
        found: tuple[Floats, Floats] = self.known["bounds"]
        return found

    @functools.cached_property
    def rect(self) -> Rect:
        """The rectangle round its vertices seen from above, turned as it is."""
        low, high = self.bounds
        middle = turned(np.array([[*((low + high) / 2)]]), self.line.yaw, self.base)[0]
        return Rect(float(middle[0]), float(middle[1]), float(high[0] - low[0]), float(high[1] - low[1]), self.line.yaw)

    @functools.cached_property
    def low(self) -> float:
        """Height of its lowest vertex."""
        return self.base[2] + float(self.bounds[0][2])

    @functools.cached_property
    def high(self) -> float:
        """Height of its highest vertex."""
        return self.base[2] + float(self.bounds[1][2])

    @functools.cached_property
    def box(self) -> tuple[Metres3, Metres3]:
        """Lowest and highest corner of the upright box round its rectangle."""
        corners = self.rect.corners()
        (x0, y0), (x1, y1) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
        return (x0, y0, self.low), (x1, y1, self.high)

    @functools.cached_property
    def flat(self) -> bool:
        """Whether it lies on the floor as rugs do, and others may stand on it."""
        return self.line.placement == "floor" and self.high - self.low < FLAT

    @functools.cached_property
    def soft(self) -> bool:
        """Whether it gives way where it touches, as cushions do."""
        return category_family(self.line.category) == "textile"

    @functools.cached_property
    def shapes(self) -> list[Shape]:
        """Its parts in the room's frame."""
        return [replace(s, vertices=turned(s.vertices, self.line.yaw, self.base)) for s in self.own]

    @functools.cached_property
    def columns(self) -> Columns | None:
        """Its solid seen from above, rastered once however often it is moved."""
        key = "columns", self.line.yaw
        if key not in self.known:
            own = [replace(s, vertices=turned(s.vertices, self.line.yaw, (0.0, 0.0, 0.0))) for s in self.own]
            self.known[key] = columns_of(own)
        found: Columns | None = self.known[key]
        return found.moved(*self.base) if found is not None else None

    def moved(self, centre: Metres3) -> Body:
        """The same object with its box's middle elsewhere, rounded as it is printed."""
        line = rounded_line(self.line.model_copy(update={"centre": centre}))
        assert isinstance(line, ProxyLine)
        return replace(self, line=line)


@dataclass(frozen=True, eq=False)
class Room:
    """A room as the correction sees it.

    Attributes:
        layout: its lines. bodies: objects by id, in their order. partitions: walls inside of the room, as bodies.
        record: what the room's text was evaluated to; finishes are read from it. pictures: names of images that exist,
            None where that is not known.
    """

    layout: Layout
    bodies: Mapping[str, Body]
    partitions: tuple[Body, ...]
    record: Record
    pictures: frozenset[str] | None = None

    @property
    def height(self) -> float:
        """Of the room, metres."""
        return self.layout.room.size[2]

    def below(self, identifier: str) -> list[str]:
        """Ids of all that stands on or hangs from an object, directly or not."""
        found = [identifier]
        for at in found:
            found += [child for child in self._carried.get(at, ()) if child not in found]
        return found[1:]

    @functools.cached_property
    def flat(self) -> list[Body]:
        """What lies on the floor as rugs do."""
        return [body for body in self.bodies.values() if body.flat]

    @functools.cached_property
    def _carried(self) -> dict[str, list[str]]:
        """What stands on or hangs from each object itself."""
        found: dict[str, list[str]] = {}
        for identifier, body in self.bodies.items():
            if body.line.parent is not None:
                found.setdefault(body.line.parent, []).append(identifier)
        return found

    def above(self, identifier: str) -> list[str]:
        """Ids of what carries an object, the next one first."""
        found: list[str] = []
        at = self.bodies[identifier].line.parent
        while at in self.bodies and at not in found:
            found.append(str(at))
            at = self.bodies[str(at)].line.parent
        return found

    def with_moved(self, identifier: str, centre: Metres3) -> Room:
        """The room with an object elsewhere, and all that it carries and the lights that shine from these."""
        body = self.bodies[identifier]
        shift = np.subtract(centre, body.line.centre)
        ids = {identifier, *self.below(identifier)}
        bodies = {
            i: b.moved(_shifted(b.line.centre, shift)) if i in ids else b for i, b in self.bodies.items()
        }  # fmt: skip
        lights = []
        for light in self.layout.lights:
            if light.parent in ids:
                target = light.target and _shifted(light.target, shift)
                light = rounded_line(light.model_copy(update={"at": _shifted(light.at, shift), "target": target}))  # type: ignore[assignment]
            lights.append(light)
        proxies = [bodies[p.id].line for p in self.layout.proxies]
        layout = self.layout.model_copy(update={"proxies": proxies, "lights": lights})
        return replace(self, layout=layout, bodies=bodies)

    def with_lines(self, **lists: object) -> Room:
        """The room with other lists of lines (`lights=...`); not for objects."""
        return replace(self, layout=self.layout.model_copy(update=lists))


def _shifted(at: Metres3, shift: Floats) -> Metres3:
    x, y, z = (float(v) for v in np.add(at, shift))
    return x, y, z


def room_of(layout: Layout, record: Record, pictures: frozenset[str] | None = None) -> Room:
    """The room of a text's lines and what it was evaluated to."""
    alike: dict[tuple[int, ...], dict[Any, Any]] = {}
    bodies = {}
    for p in layout.proxies:
        own = record.furnished.get(p.id) or proxy_shapes(p.model_dump())
        known = alike.setdefault(tuple(id(shape) for shape in own), {})
        bodies[p.id] = Body(p, own, p.id in record.plain or _drapes(p), known)
    partitions = tuple(_partition(w) for w in layout.walls if w.partition)
    return Room(layout, bodies, partitions, record, pictures)


def _drapes(line: ProxyLine) -> bool:
    """Whether something lies or hangs in folds: cloths spread over things, curtains before a wall."""
    return is_lying_cloth(line) or (line.placement == "wall" and category_family(line.category) == "textile")


def _partition(wall: WallLine) -> Body:
    rect = partition_body(wall)
    line = ProxyLine(
        id=wall.id,
        category="wall",
        centre=(rect.x, rect.y, wall.height / 2),
        size=(rect.width, rect.depth, wall.height),
        yaw=rect.yaw,
    )
    return Body(line, proxy_shapes(line.model_dump()))
