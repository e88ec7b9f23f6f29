# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole picture analysis: a working picture in, an answer to prompt 01_analysis out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .answer import answer_of
from .categories import FALLBACK
from .decode import WorkPicture
from .depth import fit_floor, radial_share
from .furnish import Item, furnish, measured_scale, nest
from .grid import Bools, polygon_mask
from .grouping import Thing, group_things
from .openings import Opening, on_wall, ring_gaps
from .outline import Outline, find_outline
from .place import TYPICAL_AREA, Frame
from .plan import is_plan, sort_plan
from .regions import Sorted, sort_areas

FLOOR_SCORE = 0.12
RADIAL_SHARE = 0.075


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
        if fit is not None and fit.score > FLOOR_SCORE and radial_share(picture.lab, inner, fit) > RADIAL_SHARE:
            view, floor, shrink, vanishing = "perspective", fit.floor, fit.shrink, fit.vanishing
    x, y = floor[:, 0], floor[:, 1]
    area = abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2
    scale = float(np.sqrt(TYPICAL_AREA / max(area, 1.0)))
    return view, Frame(floor, inner, vanishing, shrink, scale)


def _split_walls(things: list[Thing], frame: Frame, inside: Bools, light: float) -> tuple[list[Thing], list[Opening]]:
    """Part the things of a perspective view into what stands in the room and what is on the wall faces."""
    standing, walls = [], []
    for thing in things:
        opening = on_wall(frame, thing, inside, light)
        if opening is not None:
            walls.append(opening)
        elif _reaches_floor(thing, inside):
            standing.append(thing)
    return standing, walls


def _reaches_floor(thing: Thing, inside: Bools) -> bool:
    points = np.concatenate([thing.hull, np.array([thing.box.centre])])
    rows = np.clip(points[:, 1].astype(int), 0, inside.shape[0] - 1)
    columns = np.clip(points[:, 0].astype(int), 0, inside.shape[1] - 1)
    return bool(inside[rows, columns].mean() > 0.1)


def _plausible(things: list[Thing], frame: Frame, openings: list[Opening]) -> list[Thing]:
    """Leave out what is too small, too thin or too ragged to be a thing, and leaves of doors."""
    kept = []
    for thing in things:
        foot = frame.footprint(thing.box, 0.3)
        long, short = max(foot.length, foot.breadth), min(foot.length, foot.breadth)
        if short < 0.1 or long * short < 0.02 or long * short > 0.7 * frame.size[0] * frame.size[1]:
            continue
        if thing.fill < 0.3 and long * short < 1.5 or short < 0.16 and long / short > 3.5:
            continue
        kept.append(thing)
    return kept


def see(picture: WorkPicture, known_width: float | None = None,
        progress: Callable[[str], None] | None = None) -> Analysis:
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
        areas = sort_plan(lab, outline)
    else:
        areas = sort_areas(picture.rgb, lab, outline.inner, frame.floor, view == "perspective")
    things = group_things(areas.labels, areas.foreground, lab, float(max(inside.sum(), 1)))
    openings: list[Opening] = []
    if view == "perspective":
        ring = polygon_mask(shape, outline.inner) & ~inside & ~areas.foreground
        light = float(np.median(lab[ring][:, 0])) if ring.any() else 80.0
        things, openings = _split_walls(things, frame, inside, light)
    elif outline.found:
        openings = ring_gaps(lab, outline, frame)
    things = _plausible(things, frame, openings)
    nest(things, frame)
    doors = [o.along[1] - o.along[0] for o in openings if o.kind == "door"]
    if known_width is not None and known_width > 0:
        factor, said = known_width / max(frame.size[0], 1e-6), "The scale comes from the room's width as given."
    else:
        factor, said = measured_scale(things, frame, max(doors, default=None))
    notes.append(said)
    frame = frame.rescaled(factor)
    openings = [_rescaled(o, factor) for o in openings]
    things = _plausible(things, frame, openings)
    nest(things, frame)
    return Analysis(view, outline, frame, furnish(things, frame), openings, notes)


def _rescaled(opening: Opening, factor: float) -> Opening:
    """An opening after the scale changed; heights on wall faces come from the assumed wall height and stay."""
    along = (opening.along[0] * factor, opening.along[1] * factor)
    return Opening(opening.kind, opening.wall, along, opening.sill, opening.height, opening.bounds)


__all__ = ["FALLBACK", "Analysis", "answer_of", "see"]
