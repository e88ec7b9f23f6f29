# SPDX-License-Identifier: GPL-3.0-or-later
"""Truth and result drawn over one another: `python -m benchmark.overlays RUN TRUTH OUT.png [--picture FILE] [--style S]`.

RUN is a run's folder. On the left the picture, where one is given, on the right the plan with the rooms' rectangles laid
over one another (`--metres`: centres over one another, the result in its own metres). The truth is green, red where
nothing was found for it; the result is blue, orange where the truth has nothing for it. A tick shows where the front is.
Large things are labelled, and all that is wrong. `--direct` draws the direct answer instead of the result.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

from code_as_room.pipeline.geometry.polygon import area, bounding_rectangle
from PIL import Image, ImageDraw, ImageFont

from .metrics import BY_NAME, Comparison, Thing, compare, load_truth, score_comparison
from .metrics.areas import Polygon
from .metrics.runs import read_run

TRUE, MISSED, FOUND, EXTRA, WALL = "#1a8f3c", "#d62728", "#1f5fd0", "#e8820c", "#444444"
HEADLINES = (
    "object_recall",
    "layout_iou",
    "layout_iou_metres",
    "footprint_iou",
    "relations",
    "rotation",
    "support",
    "outside",
)
_MARGIN = 0.35


class Plan:
    """A drawing of the floor, y up.

    Args:
        frame: what must be visible, in metres; height: of the drawing in pixels.
    """

    def __init__(self, frame: Sequence[tuple[float, float]], height: int) -> None:
        x0, y0, x1, y1 = bounding_rectangle(list(frame))
        self.left, self.upper = x0 - _MARGIN, y1 + _MARGIN
        self.scale = height / (y1 - y0 + 2 * _MARGIN)
        self.image = Image.new("RGB", (round((x1 - x0 + 2 * _MARGIN) * self.scale), height), "white")
        self.draw = ImageDraw.Draw(self.image, "RGBA")
        self.font = ImageFont.load_default(size=max(11, height / 62))

    def place(self, point: Sequence[float]) -> tuple[float, float]:
        """Pixels of a point in metres."""
        return (point[0] - self.left) * self.scale, (self.upper - point[1]) * self.scale

    def outline(self, polygon: Polygon, colour: str, width: int, fill: str = "") -> None:
        """Draw a closed outline."""
        points = [self.place(p) for p in polygon]
        if fill:
            self.draw.polygon(points, fill=fill)
        self.draw.line([*points, points[0]], fill=colour, width=width, joint="curve")

    def tick(self, thing: Thing, colour: str) -> None:
        """A line from the centre over the middle of the front."""
        if thing.yaw is None or thing.symmetry == 0:
            return
        (ax, ay), (bx, by) = thing.rectangle[:2]
        x, y = thing.centre
        turn = math.radians(thing.yaw)
        reach = abs(((ax + bx) / 2 - x) * math.sin(turn) - ((ay + by) / 2 - y) * math.cos(turn)) + 0.1
        end = (x + reach * math.sin(turn), y - reach * math.cos(turn))
        self.draw.line([self.place((x, y)), self.place(end)], fill=colour, width=2)

    def label(self, text: str, point: Sequence[float], colour: str, anchor: str = "mm") -> None:
        """A short text on white."""
        place = self.place(point)
        self.draw.text(place, text, fill=colour, font=self.font, anchor=anchor, stroke_width=2, stroke_fill="white")


def draw_plan(comparison: Comparison, height: int = 900, metres: bool = False) -> Image.Image:
    """The plan of truth and result."""
    truth = comparison.truth
    room = comparison.own if metres else comparison.aligned
    plan = Plan([*truth.floor, *room.floor], height)
    plan.outline(truth.floor, WALL, 5)
    plan.outline(room.floor, FOUND, 2)
    for segments, colour in ((truth.partitions, WALL), (room.partitions, FOUND)):
        for start, end in segments:
            plan.draw.line([plan.place(start), plan.place(end)], fill=colour, width=3 if colour == WALL else 1)
    extra = {thing.id for thing in comparison.extra}
    for thing in sorted(truth.things, key=lambda t: -area(t.rectangle)):
        missed = thing.shown and thing.id not in comparison.pairs
        colour = MISSED if missed else TRUE
        plan.outline(comparison.footprint(thing), colour, 2, colour + "22")
        plan.tick(thing, colour)
    for thing in room.things:
        colour = EXTRA if thing.id in extra else FOUND
        plan.outline(comparison.footprint(thing), colour, 2)
        plan.tick(thing, colour)
    for thing in truth.things:
        pair = comparison.pairs.get(thing.id)
        if pair is None and thing.shown:
            plan.label(thing.id, thing.centre, MISSED)
        elif pair is not None and (thing.major or not pair.strict):
            said = pair.own.id if pair.strict else f"{thing.category}: {pair.own.category}"
            plan.label(said, thing.centre, FOUND if pair.strict else MISSED)
    for thing in room.things:
        if thing.id in extra:
            plan.label(thing.id, thing.centre, EXTRA)
    return plan.image


def draw_overlay(comparison: Comparison, picture: Image.Image | None, title: str, metres: bool = False) -> Image.Image:
    """The picture and the plan side by side under a line with the main figures."""
    plan = draw_plan(comparison, metres=metres)
    parts = [plan]
    if picture is not None:
        shown = picture.convert("RGB")
        parts.insert(0, shown.resize((round(shown.width * plan.height / shown.height), plan.height)))
    figures = score_comparison(comparison)
    told = [f"{BY_NAME[name].title} {100 * v:.1f}" for name in HEADLINES if (v := figures[name]) is not None]
    head = 60
    page = Image.new(
        "RGB", (max(1100, sum(p.width for p in parts) + 10 * (len(parts) - 1)), plan.height + head), "white"
    )
    draw = ImageDraw.Draw(page)
    draw.text((8, 6), title, fill="black", font=ImageFont.load_default(size=18))
    draw.text((8, 33), "   ".join(told), fill="black", font=ImageFont.load_default(size=15))
    x = 0
    for part in parts:
        page.paste(part, (x, head))
        x += part.width + 10
    return page


def main() -> None:
    """Draw one run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path)
    parser.add_argument("truth", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--style", default="")
    parser.add_argument("--metres", action="store_true", help="the result in its own metres")
    parser.add_argument("--direct", action="store_true", help="the direct answer instead of the result")
    options = parser.parse_args()
    outcome = read_run(options.run)
    room = outcome.direct if options.direct else outcome.result
    if room is None:
        raise SystemExit(f"{options.run} holds no room to draw. {outcome.problem}")
    comparison = compare(load_truth(options.truth, options.style), room)
    picture = Image.open(options.picture) if options.picture else None
    title = f"{options.run.parent.name} {options.run.name}: {'direct answer' if options.direct else 'result'}"
    draw_overlay(comparison, picture, title, options.metres).save(options.out)


if __name__ == "__main__":
    main()
