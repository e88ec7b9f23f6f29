# SPDX-License-Identifier: GPL-3.0-or-later
"""Composes what is drawn over the picture as strokes, areas and texts in pixels of the region. No drawing here, so that
it can be looked at without a graphics card; `drawing.py` hands it to the card."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ...pipeline.geometry.handles import EdgeHit, Grip, Rectangle, spread_labels
from ...pipeline.geometry.polygon import Point
from .draft import Draft
from .shown import Shown, ShownBox

Colour = tuple[float, float, float, float]
INK: Colour = (0.06, 0.06, 0.07, 0.75)
PAPER: Colour = (1.0, 1.0, 1.0, 1.0)
FLOOR: Colour = (1.0, 0.72, 0.16, 1.0)
FAULT: Colour = (1.0, 0.25, 0.2, 1.0)
MEASURE: Colour = (0.25, 0.9, 1.0, 1.0)
NEW: Colour = (1.0, 1.0, 1.0, 1.0)
STATES: dict[str, Colour] = {
    "detected": (0.38, 0.68, 1.0, 1.0),
    "placed": (0.45, 0.86, 0.48, 1.0),
    "detailed": (0.35, 0.85, 0.78, 1.0),
    "deferred": (1.0, 0.83, 0.35, 1.0),
    "dropped": (1.0, 0.42, 0.38, 1.0),
    "left out": (0.62, 0.62, 0.62, 0.7),
}
"""Colours of the boxes by state; the panel's tooltip names them."""
THIN, THICK = 1.2, 2.6
HANDLE, HANDLE_HOT = 5.0, 7.0
"""Half the size of a handle and of the one under the pointer, pixels at a scale of 1."""
PADDING = 3.0
LINE_HEIGHT = 14.0


class Frame(NamedTuple):
    """The picture in the region: pixels of its upper left corner, and pixels for a thousandth of its width and height
    (the second is negative: y goes up in a region)."""

    x: float
    y: float
    across: float
    down: float

    def point(self, point: Sequence[float]) -> Point:
        """A point of the picture in the region."""
        return self.x + point[0] * self.across, self.y + point[1] * self.down

    def rectangle(self, box: Rectangle) -> Rectangle:
        """A box of the picture as x_min, y_min, x_max, y_max of the region (y up)."""
        left, top = self.point(box[:2])
        right, bottom = self.point(box[2:])
        return left, bottom, right, top

    def back(self, at: Sequence[float]) -> Point:
        """A position of the region as a point of the picture."""
        return (at[0] - self.x) / self.across, (at[1] - self.y) / self.down


class Hot(NamedTuple):
    """What is under the pointer: a corner's number, an edge where a corner can be added, or a box and how it is held."""

    corner: int = -1
    edge: EdgeHit | None = None
    box: str = ""
    grip: Grip | None = None


class Text(NamedTuple):
    """A text at its lower left corner."""

    x: float
    y: float
    text: str
    colour: Colour


class Line(NamedTuple):
    """A straight stroke."""

    start: Point
    end: Point
    colour: Colour


@dataclass
class Composition:
    """What is drawn, in this order: strokes of each width, areas (triangles), rims of areas, texts."""

    lines: dict[float, list[Line]] = field(default_factory=dict)
    triangles: list[tuple[Point, Colour]] = field(default_factory=list)
    rims: list[Line] = field(default_factory=list)
    texts: list[Text] = field(default_factory=list)

    def stroke(self, points: Sequence[Point], colour: Colour, width: float, closed: bool = False) -> None:
        """A line through points."""
        ends = [*points[1:], points[0]] if closed else list(points[1:])
        self.lines.setdefault(width, []).extend(Line(a, b, colour) for a, b in zip(points, ends, strict=False))

    def outlined(self, points: Sequence[Point], colour: Colour, width: float, closed: bool = False) -> None:
        """A line with a dark rim, so that it is seen on bright and on dark pictures."""
        self.stroke(points, (*INK[:3], INK[3] * colour[3]), width + 2.0, closed)
        self.stroke(points, colour, width, closed)

    def area(self, rectangle: Rectangle, colour: Colour) -> None:
        """A filled rectangle."""
        a, b, c, d = corners_of(rectangle)
        self.triangles += [(p, colour) for p in (a, b, c, a, c, d)]

    def knob(self, at: Point, radius: float, colour: Colour, rim: Colour = INK, sides: int = 20) -> None:
        """A handle: a disc, or a square of four sides, with a rim."""
        turn = math.pi / 4 if sides == 4 else 0.0
        reach = radius * (math.sqrt(2) if sides == 4 else 1.0)
        ring = [
            (at[0] + reach * math.cos(turn + i * math.tau / sides), at[1] + reach * math.sin(turn + i * math.tau / sides))
            for i in range(sides)
        ]  # fmt: skip
        for i, point in enumerate(ring):
            self.triangles += [(at, colour), (point, colour), (ring[(i + 1) % sides], colour)]
            self.rims.append(Line(point, ring[(i + 1) % sides], rim))

    def tag(self, at: Point, text: str, size: Sequence[float], scale: float, colour: Colour) -> None:
        """A text on a dark ground whose lower left corner is `at`."""
        self.area((at[0], at[1], at[0] + size[0], at[1] + size[1]), (0.07, 0.07, 0.08, 0.8))
        self.texts.append(Text(at[0] + PADDING * scale, at[1] + 3.5 * scale, text, colour))


def corners_of(rectangle: Rectangle) -> tuple[Point, Point, Point, Point]:
    """A rectangle's corners, counter-clockwise."""
    x_min, y_min, x_max, y_max = rectangle
    return (x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)


@dataclass(frozen=True)
class Wanted:
    """All that a composition depends on.

    Attributes:
        scale: Blender's resolution scale. handles: whether anything can be grabbed now.
    """

    shown: Shown
    frame: Frame
    draft: Draft | None = None
    hot: Hot = Hot()
    active: str = ""
    corners: bool = True
    boxes: bool = True
    handles: bool = True
    scale: float = 1.0


def label_of(box: ShownBox) -> str:
    """What is written at a box."""
    return box.category.replace("_", " ") or box.id


def label_size(text: str, scale: float, measure: Callable[[str], float]) -> tuple[float, float]:
    """Width and height of a tag with this text."""
    return measure(text) + 2 * PADDING * scale, LINE_HEIGHT * scale


_labels: tuple[Any, dict[str, Rectangle]] | None = None


def labels(wanted: Wanted, measure: Callable[[str], float]) -> dict[str, Rectangle]:
    """Where the boxes' labels are in the region, by id; those without a place have none. The active one has the right of
    way, then the larger ones. The last answer is kept: the pointer's every move asks for it."""
    global _labels
    if not wanted.boxes:
        return {}
    key = (wanted.shown, wanted.frame, wanted.active, wanted.scale, wanted.draft, measure)
    if _labels is None or _labels[0] != key:
        _labels = (key, _spread(wanted, measure))
    return _labels[1]


def _spread(wanted: Wanted, measure: Callable[[str], float]) -> dict[str, Rectangle]:
    boxes = sorted(wanted.shown.boxes, key=lambda b: (b.id != wanted.active, -b.image_box.area))
    places = [wanted.frame.rectangle(_present(b, wanted.draft)) for b in boxes]
    sizes = [label_size(label_of(b), wanted.scale, measure) for b in boxes]
    found = spread_labels(places, sizes)
    return {box.id: spot for box, spot in zip(boxes, found, strict=True) if spot is not None}


def compose(wanted: Wanted, measure: Callable[[str], float]) -> Composition:
    """Everything that is drawn. `measure` gives a text's width in pixels."""
    made = Composition()
    if wanted.boxes:
        _compose_boxes(made, wanted, measure)
    if wanted.corners or (wanted.draft is not None and wanted.draft.outline):
        _compose_floor(made, wanted)
    if wanted.shown.known is not None and wanted.corners and not (wanted.draft and wanted.draft.line):
        known = wanted.shown.known
        text = f"{known.metres:.2f} m"
        _compose_length(made, wanted, (known.start, known.end), text, measure)
    if wanted.draft is not None:
        _compose_draft(made, wanted, wanted.draft, measure)
    return made


def _present(box: ShownBox, draft: Draft | None) -> Rectangle:
    """Where a box is drawn: where it is being dragged to, or where it is."""
    return draft.box if draft is not None and draft.box is not None and draft.box_id == box.id else box.box


def _compose_boxes(made: Composition, wanted: Wanted, measure: Callable[[str], float]) -> None:
    scale, places = wanted.scale, labels(wanted, measure)
    ordered = sorted(wanted.shown.boxes, key=lambda b: (b.id == wanted.active, b.id == wanted.hot.box))
    for box in ordered:
        colour = STATES.get(box.state, STATES["detected"])
        active, hot = box.id == wanted.active, box.id == wanted.hot.box
        width = (THICK if active else THIN + 0.8 if hot else THIN) * scale
        ring = corners_of(wanted.frame.rectangle(_present(box, wanted.draft)))
        made.outlined(ring, colour, width, closed=True)
        if active and wanted.handles:
            for corner in ring:
                made.knob(corner, (HANDLE_HOT if hot else HANDLE) * 0.8 * scale, colour, sides=4)
        spot = places.get(box.id)
        if spot is not None:
            size = (spot[2] - spot[0], spot[3] - spot[1])
            made.tag(spot[:2], label_of(box), size, scale, PAPER if active or hot else colour)


def _compose_floor(made: Composition, wanted: Wanted) -> None:
    draft, scale = wanted.draft, wanted.scale
    outline = draft.outline if draft is not None and draft.outline else wanted.shown.corners
    if not outline:
        return
    colour = FAULT if draft is not None and draft.faulty else FLOOR
    ring = [wanted.frame.point(p) for p in outline]
    made.outlined(ring, colour, 2.0 * scale, closed=True)
    if not wanted.handles:
        return
    for index, point in enumerate(ring):
        hot = index == wanted.hot.corner
        made.knob(point, (HANDLE_HOT if hot else HANDLE) * scale, PAPER if hot else colour)
    if wanted.hot.edge is not None:
        at = wanted.hot.edge.point
        arm = 4.0 * scale
        made.knob(at, HANDLE_HOT * scale, PAPER)
        made.rims.append(Line((at[0] - arm, at[1]), (at[0] + arm, at[1]), INK))
        made.rims.append(Line((at[0], at[1] - arm), (at[0], at[1] + arm), INK))


def _compose_length(
    made: Composition, wanted: Wanted, ends: tuple[Point, Point], text: str, measure: Callable[[str], float]
) -> None:
    """A measured line with its ticks, and the length beside its middle."""
    start, end = (wanted.frame.point(p) for p in ends)
    scale, length = wanted.scale, math.dist(start, end)
    made.outlined([start, end], MEASURE, 2.0 * scale)
    if length > 1.0:
        tick = (-(end[1] - start[1]) / length * 7.0 * scale, (end[0] - start[0]) / length * 7.0 * scale)
        for x, y in (start, end):
            made.outlined([(x - tick[0], y - tick[1]), (x + tick[0], y + tick[1])], MEASURE, 2.0 * scale)
    if text:
        size = label_size(text, scale, measure)
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        made.tag((middle[0] - size[0] / 2, middle[1] + 6.0 * scale), text, size, scale, MEASURE)


def _compose_draft(made: Composition, wanted: Wanted, draft: Draft, measure: Callable[[str], float]) -> None:
    if draft.box is not None and not draft.box_id:
        ring = corners_of(wanted.frame.rectangle(draft.box))
        made.outlined(ring, NEW, THICK * wanted.scale, closed=True)
    if draft.line is not None:
        _compose_length(made, wanted, draft.line, draft.line_text, measure)
    if draft.pointer is not None:
        x, y = wanted.frame.point(draft.pointer)
        arm = 9.0 * wanted.scale
        made.outlined([(x - arm, y), (x + arm, y)], MEASURE, 1.5 * wanted.scale)
        made.outlined([(x, y - arm), (x, y + arm)], MEASURE, 1.5 * wanted.scale)
