# SPDX-License-Identifier: GPL-3.0-or-later
"""Which surface of which thing carries an object, and where on it. (Paper, stage 7.)

An object's box in the picture is lifted to the height of every surface in question; the surface that explains box and
metres with the least moving wins. Frame of the room: metres, z up; yaw in degrees counter-clockwise.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..artifacts.analysis import Calibration, DetectedObject
from ..artifacts.layout import ProxyLine
from ..layout.initial import proxy_of
from ..objects.cloths import is_lying_cloth
from ..program.prelude.shape import Shape
from .cover import below, carried, lain
from .find import Surface, support_surfaces
from .frame import base_of, moved_along, to_local, to_room
from .rasters import Samples, sample
from .rays import room_beside
from .seat import CLOSE, ROUND, Seat, find_seat, occupied
from .settle import FINE, drop

REACH = 0.12
"""How far in metres beyond its own half length a thing is moved to find a place, before other surfaces are tried."""
MOVE_UNIT = 0.08
HEIGHT_UNIT = 0.2
HIDDEN_COST = 1.5
SHRINK_COST = 6.0
"""Costs of one `MOVE_UNIT` moved and one `HEIGHT_UNIT` off the stated height are 1; of a place that the picture cannot
show, and of being made smaller by its whole size, in the same unit."""
COVERS = 0.35
"""A thing whose outline covers this share of a surface lies spread over it (duvet, throw, tablecloth): others lie on it."""
THIN = 0.4
"""How high a spread thing is at most, as a share of its shorter side, unless it hangs down over an edge."""
LYING = 0.02
"""A thing stands on another when its base is within this many metres of the other's surface."""


NARROW, MOST_NARROWED = 0.001, 0.12
"""Metres that are left beside a thing between two boards, and the share of its width by which it is made to fit there."""
PUSHED, _RIM = 0.03, (-0.47, -0.3, 0.0, 0.3)
"""Metres by which a pillow that reaches into a board, or with its rim onto it, is pushed off; heights at which that is seen."""
_SOFT = re.compile(r"\b(pillows?|cushions?|bolsters?)\b", re.IGNORECASE)


@dataclass(frozen=True)
class Seated:
    """Where an object stands: its proxy line, and how it came there.

    Attributes:
        moved: metres from where the picture shows it; scale: what its size was multiplied with.
    """

    proxy: ProxyLine
    moved: float
    scale: float
    part: str


@dataclass
class Carriers:
    """The things of a room with the surfaces found on them; what is seated takes its place from then on.

    Attributes:
        shapes: parts of each thing in its own frame, by id; a bare proxy has its box.
    """

    shapes: Mapping[str, Sequence[Shape]]
    proxies: dict[str, ProxyLine] = field(default_factory=dict)
    _surfaces: dict[str, list[Surface]] = field(default_factory=dict)
    _bare: dict[str, list[Surface]] = field(default_factory=dict)
    _fine: dict[str, Samples | None] = field(default_factory=dict)

    def surfaces(self, name: str) -> list[Surface]:
        """The surfaces of one thing, highest first."""
        if name not in self._surfaces:
            self._surfaces[name] = support_surfaces(self.shapes.get(name, ()))
            self._bare[name] = list(self._surfaces[name])
        return self._surfaces[name]

    def _open_to(self, category: str, name: str) -> list[Surface]:
        """The surfaces of one thing as they are free for a thing: pillows lie on and lean against pillows."""
        surfaces = self.surfaces(name)
        return self._bare[name] if _is_soft(category) else surfaces

    def add(self, proxy: ProxyLine) -> None:
        """A thing that stands where it stands; what it stands on is occupied there."""
        self.proxies[proxy.id] = proxy
        parent = self.proxies.get(proxy.parent or "")
        if parent is not None and is_lying_cloth(proxy):
            self._cover(proxy, parent)
            return
        if proxy.placement != "surface" or parent is None or self.spread_on(proxy, parent) is not None:
            return
        self._take(proxy, parent)

    def _take(self, proxy: ProxyLine, parent: ProxyLine) -> None:
        """What a thing stands on is occupied there."""
        base = proxy.centre[2] - proxy.size[2] / 2 - base_of(parent)
        x, y = to_local(parent, proxy.centre[:2])
        for number, surface in enumerate(self.surfaces(parent.id)):
            if abs(surface.level - base) <= max(LYING, 0.05):
                cells = occupied(surface.grid, x, y, proxy.size[0], proxy.size[1], proxy.yaw - parent.yaw)
                self._surfaces[parent.id][number] = surface.taken(cells)
                if not _is_soft(proxy.category):
                    self._bare[parent.id][number] = self._bare[parent.id][number].taken(cells)

    def lain(self, proxy: ProxyLine) -> ProxyLine:
        """A cloth at the height at which it lies on what carries it."""
        return lain(proxy, self.shapes.get(proxy.id, ()), below(proxy, self.proxies, self.shapes))[0]

    def _cover(self, proxy: ProxyLine, parent: ProxyLine) -> None:
        """From now on a cloth belongs to the surface of what it lies on."""
        found = lain(proxy, self.shapes.get(proxy.id, ()), below(proxy, self.proxies, self.shapes))[1]
        covered = [*self.shapes.get(parent.id, ()), *carried(found, proxy, parent)]
        self.shapes = {**self.shapes, proxy.id: found, parent.id: covered}
        for name in (proxy.id, parent.id):
            self._surfaces.pop(name, None)
            self._bare.pop(name, None)
            self._fine.pop(name, None)
        for other in self.proxies.values():
            if other.parent == parent.id and other.placement == "surface" and not is_lying_cloth(other):
                self._take(other, parent)

    def spread_on(self, proxy: ProxyLine, parent: ProxyLine) -> Surface | None:
        """The surface over which a thing is spread, None where it stands on it, leans on it or hangs from it."""
        if _is_soft(proxy.category):
            return None
        outline = proxy.size[0] * proxy.size[1]
        wide = [s for s in self.surfaces(parent.id) if s.open_share > 0.3 and s.area >= 0.6 * outline]
        largest = max(wide, key=lambda s: s.area, default=None)
        if largest is None or outline < COVERS * largest.area:
            return None
        thin = proxy.size[2] <= THIN * min(proxy.size[:2])
        return largest if thin or _hangs_over(proxy, largest, proxy.yaw - parent.yaw) else None

    def spread(self, proxy: ProxyLine) -> ProxyLine | None:
        """A thing that is spread over its parent, at a height at which it touches it; None when it is no such thing."""
        parent = self.proxies.get(proxy.parent or "")
        surface = self.spread_on(proxy, parent) if parent is not None else None
        if parent is None or surface is None:
            return None
        level = base_of(parent) + surface.level
        base, height = base_of(proxy), proxy.size[2]
        # Its edge may hang down, so it may begin below the surface; it neither floats above it nor ends below.
        base = min(level, max(base, level + 0.02 - height))
        return proxy.model_copy(update={"centre": (*proxy.centre[:2], base + height / 2)})

    def seat(self, item: DetectedObject, calibration: Calibration, parent: str) -> Seated | None:
        """The best place for an object on one thing, or None when it cannot stand on it. Nothing is occupied yet."""
        carrier = self.proxies.get(parent)
        if carrier is None:
            return None
        offers = [
            offer
            for surface in self._open_to(item.category, parent)
            if surface.area >= 0.3 * item.size[0] * item.size[1]
            for offer in self._offers(item, calibration, carrier, surface)
        ]
        return self._settled(min(offers, key=lambda o: o[0])[1], carrier) if offers else None

    def _settled(self, seated: Seated, carrier: ProxyLine) -> Seated:
        """The same place, at the height at which the two meshes touch."""
        proxy = seated.proxy
        if carrier.id not in self._fine:
            self._fine[carrier.id] = sample(self.shapes.get(carrier.id, ()), FINE)
        below = self._fine[carrier.id]
        if below is None or proxy.id not in self.shapes:
            return seated
        soft = _is_soft(proxy.category)
        proxy = self._let_down(proxy if soft else self._narrowed(proxy, carrier), carrier, seated.scale, below)
        if soft and (pushed := self._pushed(proxy, carrier)) != proxy:
            proxy = self._let_down(pushed, carrier, seated.scale, below)
        return replace(seated, proxy=proxy)

    def _let_down(self, proxy: ProxyLine, carrier: ProxyLine, scale: float, below: Samples) -> ProxyLine:
        """A thing at the height at which its mesh touches the carrier's."""
        place = (*to_local(carrier, proxy.centre[:2]), base_of(proxy) - base_of(carrier))
        down = drop(self.shapes[proxy.id], scale, below, place, proxy.yaw - carrier.yaw)
        return proxy.model_copy(update={"centre": (*proxy.centre[:2], proxy.centre[2] - down)})

    def _narrowed(self, proxy: ProxyLine, carrier: ProxyLine) -> ProxyLine:
        """A thing that reaches into what is on both sides of it, between them: rasters are coarser than boards are thin."""
        size = np.array(proxy.size)
        turn = math.radians(proxy.yaw - carrier.yaw)
        for axis in (0, 1):
            x, y = to_local(carrier, proxy.centre[:2])
            middle = np.array((x, y, proxy.centre[2] - base_of(carrier)))
            before, after = room_beside(self.shapes.get(carrier.id, ()), middle, size, turn, axis)
            free = before + after - 2 * NARROW
            if not (1 - MOST_NARROWED) * size[axis] <= free < size[axis]:
                continue
            size[axis] = free
            width, depth, height = (float(v) for v in size)
            proxy = moved_along(proxy.model_copy(update={"size": (width, depth, height)}), axis, (after - before) / 2)
        return proxy

    def _pushed(self, proxy: ProxyLine, carrier: ProxyLine) -> ProxyLine:
        """A pillow that reaches into a board at one side of it, beside that board; pressed where there is no room behind it."""
        turn = math.radians(proxy.yaw - carrier.yaw)
        for axis in (0, 1):
            x, y = to_local(carrier, proxy.centre[:2])
            middle = np.array((x, y, proxy.centre[2] - base_of(carrier)))
            sides = room_beside(self.shapes.get(carrier.id, ()), middle, np.array(proxy.size), turn, axis, _RIM)
            half = proxy.size[axis] / 2 + NARROW
            near, far = sorted(sides)
            shift = half - near
            if not 0 < shift <= PUSHED:
                continue
            if far < half + shift:
                size = np.array(proxy.size)
                size[axis] -= shift
                width, depth, height = (float(v) for v in size)
                proxy, shift = proxy.model_copy(update={"size": (width, depth, height)}), shift / 2
            proxy = moved_along(proxy, axis, shift if sides[0] < sides[1] else -shift)
        return proxy

    def _offers(
        self, item: DetectedObject, calibration: Calibration, carrier: ProxyLine, surface: Surface
    ) -> list[tuple[float, Seated]]:
        level = base_of(carrier) + surface.level
        lifted, _ = proxy_of(item, calibration, level)
        wanted = to_local(carrier, lifted.centre[:2])
        turn = lifted.yaw - carrier.yaw
        near = REACH + max(lifted.size[:2]) / 2
        between = (ROUND + CLOSE) / 2
        tries = ((near, ROUND), (near, between), (near, CLOSE), (math.inf, ROUND), (math.inf, CLOSE))
        seats = (find_seat(surface, wanted, lifted.size, turn, *limits) for limits in tries)
        seat = next((s for s in seats if s is not None), None)
        if seat is None:
            return []
        stated = item.centre[2] - item.size[2] / 2
        column, row = surface.grid.index(seat.x, seat.y)
        shape = surface.grid.shape
        inside = 0 <= column < shape[0] and 0 <= row < shape[1]
        hidden = not inside or math.isfinite(float(surface.clearance[column, row]))
        cost = (
            seat.moved / MOVE_UNIT
            + abs(base_of(carrier) + seat.z - stated) / HEIGHT_UNIT
            + HIDDEN_COST * hidden
            + SHRINK_COST * (1 - seat.scale)
        )
        return [(cost, Seated(seated_proxy(lifted, carrier, seat), seat.moved, seat.scale, surface.part))]


def _hangs_over(proxy: ProxyLine, surface: Surface, turn: float) -> bool:
    """Whether a thing is longer or wider than a surface, so that it must hang down over its edges."""
    cells = np.isfinite(surface.heights)
    extent = [float(np.ptp(np.flatnonzero(cells.any(axis=axis))) + 1) * surface.grid.cell for axis in (1, 0)]
    cos, sin = abs(math.cos(math.radians(turn))), abs(math.sin(math.radians(turn)))
    reach = (proxy.size[0] * cos + proxy.size[1] * sin, proxy.size[0] * sin + proxy.size[1] * cos)
    return reach[0] > extent[0] + LYING or reach[1] > extent[1] + LYING


def _is_soft(category: str) -> bool:
    """Whether a thing gives way to others of its kind: cushions and pillows are piled where they are wanted."""
    return bool(_SOFT.search(category.replace("_", " ")))


def seated_proxy(lifted: ProxyLine, carrier: ProxyLine, seat: Seat) -> ProxyLine:
    """The object's proxy line on its seat."""
    x, y = to_room(carrier, (seat.x, seat.y))
    size = (lifted.size[0] * seat.scale, lifted.size[1] * seat.scale, lifted.size[2] * seat.scale)
    z = base_of(carrier) + seat.z
    update = {"centre": (x, y, z + size[2] / 2), "size": size, "parent": carrier.id, "placement": "surface"}
    return lifted.model_copy(update=update)


def carriers_under(point: Sequence[float], proxies: Sequence[ProxyLine], reach: float = 0.02) -> list[ProxyLine]:
    """The things whose outline holds a point, smallest first; flat things such as rugs come last."""
    found = []
    for proxy in proxies:
        x, y = to_local(proxy, point)
        if abs(x) <= proxy.size[0] / 2 + reach and abs(y) <= proxy.size[1] / 2 + reach and proxy.placement != "ceiling":
            found.append(proxy)
    return sorted(found, key=lambda p: (p.size[2] < 0.06, p.size[0] * p.size[1]))
