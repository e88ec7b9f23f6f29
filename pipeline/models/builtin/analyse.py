# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole picture analysis: a working picture in, an answer to prompt 01_analysis out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .decode import WorkPicture
from .depth import fit_floor, radial_excess
from .furnish import Item, furnish, measured_scale, nest
from .grid import Bools, Floats, polygon_mask
from .grouping import Thing, group_things, joined
from .openings import Opening, on_wall, ring_gaps
from .outline import Outline, find_outline
from .place import TYPICAL_AREA, Frame
from .plan import is_plan, sort_plan
from .regions import Sorted, sort_areas

FLOOR_SCORE = 0.12
RADIAL_EXCESS = 0.01


@dataclass(frozen=True)
class Analysis:
    """What was seen, in the form that the overlay and the answer are made from."""

    view: str
    outline: Outline
    frame: Frame
    items: list[Item]
    openings: list[Opening]
    notes: list[str]


def _frame(picture: WorkPicture, outline: Outline, drawing: bool) -> tuple[str, Frame]:
    """View kind and floor frame at the scale of a typical room."""
    inner = outline.inner
    height, width = picture.lab.shape[:2]
    view, floor, shrink, vanishing = "plan" if drawing else "orthographic", inner, 1.0, (width / 2, height / 2)
    if outline.found and not drawing and min(inner.max(0) - inner.min(0)) > 40:
        fit = fit_floor(picture.lab, inner)
        if fit is not None and fit.score > FLOOR_SCORE and radial_excess(picture.lab, inner, fit) > RADIAL_EXCESS:
            view, floor, shrink, vanishing = "perspective", fit.floor, fit.shrink, fit.vanishing
    x, y = floor[:, 0], floor[:, 1]
    area = abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2
    scale = float(np.sqrt(TYPICAL_AREA / max(area, 1.0)))
    return view, Frame(floor, inner, vanishing, shrink, scale)


def _split_walls(things: list[Thing], frame: Frame, inside: Bools, light: float) -> tuple[list[Thing], list[Opening]]:
    """Part the things of a perspective view into what stands in the room and what is on the wall faces."""
    standing = [thing for thing in things if _reaches_floor(thing, inside)]
    walls = []
    for thing in things:
        if any(thing is other for other in standing):
            continue
        under = next((i for i, other in enumerate(standing) if leans_from(thing, other, frame.vanishing)), None)
        if under is not None:
            standing[under] = joined(standing[under], thing)
            continue
        opening = on_wall(frame, thing, inside, light)
        if opening is not None:
            walls.append(opening)
    return standing, walls


def leans_from(upper: Thing, lower: Thing, vanishing: tuple[float, float]) -> bool:
    """True when `upper` can be the top of the tall thing whose front is `lower`: right behind it, and as wide."""
    point = np.array(vanishing)
    ray = np.array(lower.box.centre) - point
    axis = 0 if abs(ray[0]) > abs(ray[1]) else 1
    sign = float(np.sign(ray[axis])) or 1.0
    behind = float((upper.hull[:, axis] * sign).min() - (lower.hull[:, axis] * sign).max())
    reach = float(np.ptp(lower.hull[:, axis]))
    a, b = upper.hull[:, 1 - axis], lower.hull[:, 1 - axis]
    shared = float(min(a.max(), b.max()) - max(a.min(), b.min()))
    return -0.3 * reach - 2 < behind < 4 and shared > 0.75 * max(float(np.ptp(a)), float(np.ptp(b)))


def _reaches_floor(thing: Thing, inside: Bools) -> bool:
    points = np.concatenate([thing.hull, np.array([thing.box.centre])])
    rows = np.clip(points[:, 1].astype(int), 0, inside.shape[0] - 1)
    columns = np.clip(points[:, 0].astype(int), 0, inside.shape[1] - 1)
    return bool(inside[rows, columns].mean() > 0.1)


def _plausible(things: list[Thing], frame: Frame, floor_colour: Floats | None) -> list[Thing]:
    """Leave out what is too small, too thin or too ragged to be a thing, and odd floor planks."""
    kept = []
    for thing in things:
        foot = frame.footprint(thing.box, 0.3)
        long, short = max(foot.length, foot.breadth), min(foot.length, foot.breadth)
        if short < 0.1 or long * short < 0.02 or long * short > 0.7 * frame.size[0] * frame.size[1]:
            continue
        if floor_colour is not None and long * short < 0.35 and short < 0.35 and _is_plank(thing, floor_colour):
            continue
        if thing.fill < 0.3 and long * short < 1.5 or short < 0.16 and long / short > 3.5:
            continue
        kept.append(thing)
    return kept


def _is_plank(thing: Thing, floor: Floats) -> bool:
    """The floor's hue, a little lighter or darker."""
    if abs(float(thing.colour[0] - floor[0])) > 16:
        return False
    tint = thing.colour[1:] * (max(float(floor[0]), 1.0) / max(float(thing.colour[0]), 1.0)) - floor[1:]
    return float(np.linalg.norm(tint)) < 5


def see(
    picture: WorkPicture, known_width: float | None = None, progress: Callable[[str], None] | None = None
) -> Analysis:
    """Analyse a picture.

    Args:
        known_width: the room's inner width in metres, where the artist measured it.
        progress: told what is being done.
    """
    tell = progress or (lambda text: None)
    tell("looking for the room's outline")
    lab = picture.lab
    shape = (lab.shape[0], lab.shape[1])
    drawing = is_plan(lab)
    outline = find_outline(lab)
    view, frame = _frame(picture, outline, drawing)
    notes = []
    if not outline.found:
        notes.append("No walls were seen; the whole picture was taken as the floor.")
    tell("looking for furniture")
    inside = polygon_mask(shape, frame.floor)
    areas: Sorted
    if drawing:
        areas = sort_plan(lab, picture.ink, outline)
    else:
        areas = sort_areas(picture.rgb, lab, outline.inner, frame.floor, view == "perspective")
    things = group_things(areas.labels, areas.foreground, lab, float(max(inside.sum(), 1)))
    openings: list[Opening] = []
    if view == "perspective":
        ring = polygon_mask(shape, outline.inner) & ~inside & ~areas.foreground
        light = float(np.median(lab[ring][:, 0])) if ring.any() else 80.0
        things, openings = _split_walls(things, frame, inside, light)
    elif outline.found:
        openings = ring_gaps(lab, picture.ink, outline, frame)
    things = _plausible(things, frame, None if drawing else areas.floor_colour)
    nest(things, frame, not drawing)
    doors = [o.along[1] - o.along[0] for o in openings if o.kind == "door"]
    if known_width is not None and known_width > 0:
        factor, said = known_width / max(frame.size[0], 1e-6), "The scale comes from the room's width as given."
    else:
        factor, said = measured_scale(things, frame, max(doors, default=None))
    notes.append(said)
    frame = frame.rescaled(factor)
    openings = [_rescaled(o, factor) for o in openings]
    things = _plausible(things, frame, None if drawing else areas.floor_colour)
    nest(things, frame, not drawing)
    return Analysis(view, outline, frame, furnish(things, frame), openings, notes)


def _rescaled(opening: Opening, factor: float) -> Opening:
    """An opening after the scale changed; heights on wall faces come from the assumed wall height and stay."""
    along = (opening.along[0] * factor, opening.along[1] * factor)
    return Opening(opening.kind, opening.wall, along, opening.sill, opening.height, opening.bounds)
