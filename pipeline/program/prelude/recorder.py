# SPDX-License-Identifier: GPL-3.0-or-later
"""What the layout lines, `furnish` and `build` do when a room program runs: check, and write a `Record`."""

from __future__ import annotations

import math
from typing import Any

from .checks import choice, fail, flag, number, point, positive, sizes, text, whole
from .covers import lay_covers
from .looks import Look
from .record import Record
from .shape import Shape, flat_shapes

MOST_LINES = 2000
MOST_CORNERS = 500
PLACEMENTS = ("floor", "wall", "ceiling", "surface")
SALIENCES = ("major", "minor")
PROXY_SHAPES = ("box", "round", "l_shape")
LIGHT_KINDS = ("sun", "area", "point", "spot")
VIEW_TRANSFORMS = ("AgX", "Filmic", "Standard", "Khronos PBR Neutral")
HOTTEST = 40_000.0
CAMERA_KINDS = ("perspective", "orthographic")
SURFACES = ("floor", "walls", "wall_tops", "ceiling", "skirting", "doors", "windows")
"""What `finish` may name beside ids: all surfaces of a kind."""
MOST_LOOKS = 60


class Recorder:
    """Fills `record` as the lines of one room run. Every method raises ValueError with a plain sentence.

    Ids are unique over the whole room. References (a door's wall, a proxy's parent, the proxy that is furnished) may
    come in any order and are checked by `build`.
    """

    def __init__(self) -> None:
        self.record = Record()
        self._ids: set[str] = set()
        self._lying: list[str] = []

    def _start(self, where: str) -> None:
        if self.record.built:
            raise fail(where, "build() must be the last statement")

    def _new(self, where: str, identifier: Any) -> str:
        self._start(where)
        name = text(where, "the id", identifier, 100, empty=False)
        if name in self._ids:
            raise fail(where, f"the id {name!r} is used twice; every line needs an id of its own")
        if len(self._ids) >= MOST_LINES:
            raise fail(where, f"a room has at most {MOST_LINES} layout lines")
        self._ids.add(name)
        return name

    def room(self, size: Any, floor: Any) -> None:
        """Bounding size (width, depth, height) and floor outline, counter-clockwise; once in a program."""
        self._start("room")
        if self.record.room is not None:
            raise fail("room", "there is already a room line; write it once")
        if not isinstance(floor, (list, tuple)) or not 3 <= len(floor) <= MOST_CORNERS:
            raise fail("room", f"floor must be a list of 3 to {MOST_CORNERS} corners (x, y)")
        corners = [point("room", "each corner of the floor", corner, 2) for corner in floor]
        turns = zip(corners, corners[1:] + corners[:1], strict=True)
        if sum(a[0] * b[1] - a[1] * b[0] for a, b in turns) <= 0:
            raise fail("room", "the floor's corners must run counter-clockwise round an area")
        self.record.room = {"size": sizes("room", "size", size), "floor": corners}

    def wall(self, id: Any, start: Any, end: Any, height: Any, thickness: Any = 0.12, partition: Any = False) -> None:
        """A wall along its inner face, thickness outside; a partition along its centre line."""
        line = self._segment("wall", id, start, end)
        line["height"] = positive("wall", "height", height)
        line["thickness"] = positive("wall", "thickness", thickness)
        line["partition"] = flag("wall", "partition", partition)
        self.record.walls.append(line)

    def door(self, id: Any, wall: Any, start: Any, end: Any, height: Any = 2.05, open: Any = 0.0) -> None:
        """A door leaf in a wall: hinge at `start`, `open` degrees into the room."""
        line = self._segment("door", id, start, end, wall)
        line["height"] = positive("door", "height", height)
        line["open"] = number("door", "open", open, -180.0, 180.0)
        self.record.doors.append(line)

    def window(self, id: Any, wall: Any, start: Any, end: Any, sill: Any = 0.9, height: Any = 1.3) -> None:
        """Glazing in a wall; height is measured from the sill."""
        self.record.windows.append(self._hole("window", id, wall, start, end, sill, height))

    def opening(self, id: Any, wall: Any, start: Any, end: Any, sill: Any = 0.0, height: Any = 2.2) -> None:
        """A hole in a wall without leaf or glass."""
        self.record.openings.append(self._hole("opening", id, wall, start, end, sill, height))

    def _segment(self, where: str, identifier: Any, start: Any, end: Any, wall: Any = None) -> dict[str, Any]:
        line: dict[str, Any] = {"id": self._new(where, identifier)}
        if where != "wall":
            line["wall"] = text(where, "wall", wall, 100, empty=False)
        line["start"] = point(where, "start", start, 2)
        line["end"] = point(where, "end", end, 2)
        if math.dist(line["start"], line["end"]) < 1e-3:
            raise fail(where, "start and end are the same point")
        return line

    def _hole(
        self, where: str, identifier: Any, wall: Any, start: Any, end: Any, sill: Any, height: Any
    ) -> dict[str, Any]:
        line = self._segment(where, identifier, start, end, wall)
        line["sill"] = number(where, "sill", sill, 0.0)
        line["height"] = positive(where, "height", height)
        return line

    def proxy(
        self,
        id: Any,
        category: Any,
        centre: Any,
        size: Any,
        yaw: Any = 0.0,
        placement: Any = "floor",
        parent: Any = None,
        salience: Any = "major",
        label: Any = "",
        shape: Any = "box",
    ) -> None:
        """The oriented box that stands in for an object; yaw in degrees counter-clockwise, 0 faces -Y."""
        line = {
            "id": self._new("proxy", id),
            "category": text("proxy", "category", category, empty=False),
            "centre": point("proxy", "centre", centre),
            "size": sizes("proxy", "size", size),
            "yaw": number("proxy", "yaw", yaw, -36000.0, 36000.0),
            "placement": choice("proxy", "placement", placement, PLACEMENTS),
            "parent": None if parent is None else text("proxy", "parent", parent, 100, empty=False),
            "salience": choice("proxy", "salience", salience, SALIENCES),
            "label": text("proxy", "label", label, 2000),
            "shape": choice("proxy", "shape", shape, PROXY_SHAPES),
        }
        self.record.proxies.append(line)

    def light(
        self,
        id: Any,
        kind: Any,
        at: Any,
        energy: Any,
        color: Any = (1.0, 1.0, 1.0),
        size: Any = 0.1,
        target: Any = None,
        size_y: Any = 0.0,
        kelvin: Any = 0.0,
        parent: Any = None,
    ) -> None:
        """A light: linear colour times that of `kelvin`, energy in Blender's watts; an area is size x size_y."""
        line = {
            "id": self._new("light", id),
            "kind": choice("light", "kind", kind, LIGHT_KINDS),
            "at": point("light", "at", at),
            "energy": number("light", "energy", energy, 0.0, 1e7),
            "color": point("light", "color", color),
            "size": number("light", "size", size, 0.0),
            "target": None if target is None else point("light", "target", target),
            "size_y": number("light", "size_y", size_y, 0.0),
            "kelvin": number("light", "kelvin", kelvin, 0.0, HOTTEST),
            "parent": None if parent is None else text("light", "parent", parent, 100, empty=False),
        }
        self.record.lights.append(line)

    def world(
        self,
        id: Any,
        color: Any = (1.0, 1.0, 1.0),
        strength: Any = 0.5,
        kelvin: Any = 0.0,
        background: Any = (1.0, 1.0, 1.0),
    ) -> None:
        """The light from all around (linear colour times that of `kelvin`), and what a camera sees outside; once."""
        self._once("world", self.record.worlds)
        line = {
            "id": self._new("world", id),
            "color": point("world", "color", color),
            "strength": number("world", "strength", strength, 0.0, 1e5),
            "kelvin": number("world", "kelvin", kelvin, 0.0, HOTTEST),
            "background": point("world", "background", background),
        }
        self.record.worlds.append(line)

    def view(
        self, id: Any, exposure: Any = 0.0, transform: Any = "AgX", look: Any = "", ceiling: Any = 0.0, cut: Any = 0.0
    ) -> None:
        """How the room is shown: exposure in stops, view transform and look, a one-sided ceiling, a section; once."""
        self._once("view", self.record.views)
        line = {
            "id": self._new("view", id),
            "exposure": number("view", "exposure", exposure, -32.0, 32.0),
            "transform": choice("view", "transform", transform, VIEW_TRANSFORMS),
            "look": text("view", "look", look, 100),
            "ceiling": number("view", "ceiling", ceiling, 0.0),
            "cut": number("view", "cut", cut, 0.0),
        }
        self.record.views.append(line)

    def _once(self, where: str, before: list[dict[str, Any]]) -> None:
        if before:
            raise fail(where, f"there is already a {where} line; write it once")

    def camera(
        self,
        id: Any,
        kind: Any,
        matrix: Any,
        fov_y: Any = 0.0,
        ortho_height: Any = 0.0,
        image_size: Any = (1024, 1024),
        principal: Any = (500.0, 500.0),
        near: Any = 0.02,
        stops: Any = 0.0,
    ) -> None:
        """A camera: camera-to-world matrix row by row, vertical field of view in radians or height in metres."""
        if not isinstance(image_size, (list, tuple)) or len(image_size) != 2:
            raise fail("camera", "image_size must be (width, height) in pixels")
        line = {
            "id": self._new("camera", id),
            "kind": choice("camera", "kind", kind, CAMERA_KINDS),
            "matrix": point("camera", "matrix", matrix, 16),
            "fov_y": number("camera", "fov_y", fov_y, 0.0, math.pi - 1e-3),
            "ortho_height": number("camera", "ortho_height", ortho_height, 0.0),
            "image_size": tuple(whole("camera", "image_size", side, 1, 100_000) for side in image_size),
            "principal": point("camera", "principal", principal, 2),
            "near": positive("camera", "near", near),
            "stops": number("camera", "stops", stops, -20.0, 20.0),
        }
        if kind == "perspective" and not line["fov_y"]:
            raise fail("camera", "a perspective camera needs fov_y, its vertical field of view in radians")
        if kind == "orthographic" and not line["ortho_height"]:
            raise fail("camera", "orthographic cameras need ortho_height, the metres that its picture's height spans")
        self.record.cameras.append(line)

    def furnish(self, id: Any, shapes: Any, lying: Any = False) -> None:
        """Put shapes in the place of proxy `id`; they are in its local frame, origin at the centre of its base.

        A function of the proxy's size (width, depth, height) may be given instead; so the shapes follow the size. A cloth
        that is `lying` follows the heights of what carries it, and hangs down over its edges.
        """
        self._start("furnish")
        name = text("furnish", "the id", id, 100, empty=False)
        if name in self.record.furnished:
            raise fail("furnish", f"{name!r} is furnished twice")
        if callable(shapes):
            size = self.size_of(name)
            if size is None:
                raise fail("furnish", f"the proxy line of {name!r} must stand above, since a function is given")
            shapes = shapes(size)
        found: list[Shape] = flat_shapes("furnish", shapes)
        if not found:
            raise fail("furnish", f"there are no shapes for {name!r}")
        self.record.furnished[name] = found
        if flag("furnish", "lying", lying):
            self._lying.append(name)

    def finish(self, id: Any, looks: Any) -> None:
        """Say what an object, a wall or fitting, or all surfaces of a kind ("floor", "walls", ...) look like.

        `looks` is one look, or looks by part name, by material role, and by "" for everything else.
        """
        self._start("finish")
        name = text("finish", "the id", id, 100, empty=False)
        if name in self.record.finishes:
            raise fail("finish", f"{name!r} is finished twice; put all its looks into one finish")
        given = {"": looks} if isinstance(looks, Look) else looks
        if not isinstance(given, dict) or not given or len(given) > MOST_LOOKS:
            raise fail("finish", 'looks must be a dict such as {"frame": wood("#6A4A32"), "": linen("#EFEAE0")}')
        for key, look in given.items():
            text("finish", "each part or material", key, 60)
            if not isinstance(look, Look):
                raise fail("finish", f'{key!r} must be given a look, such as wood("#6A4A32") or principled(...)')
        self.record.finishes[name] = dict(given)

    def size_of(self, name: str) -> tuple[float, float, float] | None:
        """The size of a proxy whose line was read already, None for others."""
        return next((line["size"] for line in self.record.proxies if line["id"] == name), None)

    def build(self) -> None:
        """The last statement: checks what refers to what."""
        self._start("build")
        record = self.record
        if record.room is None:
            raise fail("build", "the room line is missing")
        walls = {line["id"] for line in record.walls}
        for line in record.doors + record.windows + record.openings:
            if line["wall"] not in walls:
                raise fail("build", f"{line['id']!r} lies in {line['wall']!r}, which is not a wall of this room")
        parents = {line["id"]: line["parent"] for line in record.proxies}
        fixed = walls | {line["id"] for line in record.doors + record.windows + record.openings}
        check_parents(parents, fixed)
        for line in record.lights:
            if line["parent"] is not None and line["parent"] not in parents and line["parent"] not in fixed:
                raise fail("build", f"the light {line['id']!r} shines from {line['parent']!r}, which does not exist")
        for name in record.furnished:
            if name not in parents:
                raise fail("build", f"furnish names {name!r}, which is not a proxy of this room")
        lay_covers(record, self._lying)
        known = {*parents, *fixed, *SURFACES}
        for name in record.finishes:
            if name not in known:
                raise fail(
                    "build", f"finish names {name!r}, which is nothing in this room; surfaces are {', '.join(SURFACES)}"
                )
        record.built = True


def check_parents(parents: dict[str, Any], fixed: set[str]) -> None:
    """Refuse unknown parents and parents in a circle. `fixed` are ids of walls and what is in them."""
    for name, parent in parents.items():
        if parent is not None and parent not in parents and parent not in fixed:
            raise fail("build", f"the parent {parent!r} of {name!r} does not exist")
    sound: set[str] = set()
    for name in parents:
        chain: set[str] = set()
        at: str | None = name
        while at is not None and at in parents and at not in sound:
            if at in chain:
                raise fail("build", f"the parents of {at!r} run in a circle")
            chain.add(at)
            at = parents[at]
        sound |= chain
