# SPDX-License-Identifier: GPL-3.0-or-later
"""How a door stands in the picture: which end its hinge is at, which way it opens, and how far its leaf is open.

The analysis says it in a few words of its own; degrees that it does not say are measured: the leaf whose projection,
with that of its opening, fills the door's box in the picture best. Where neither tells, a door is closed.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..artifacts.analysis import ArchitectureItem, Calibration
from ..artifacts.common import Metres2
from ..artifacts.layout import WallLine
from ..geometry.camera import GeometryError, project
from ..geometry.polygon import Floats

SURE = 20.0
"""Degrees from which a box alone, without a word on it, says that a door is open."""
_STEP = 5.0  # degrees
_MOST = 90.0  # degrees: beyond, boxes of narrower and of wider leaves are alike
_BETTER = 0.6  # of the closed door's misfit: what an open one may have at most, where only the box speaks
_END = 0.1  # of its size: what an end's place in the picture must differ to be called by a side

_ENDS = {
    "left": (-1, 0), "right": (1, 0), "west": (-1, 0), "east": (1, 0),
    "upper": (0, -1), "top": (0, -1), "north": (0, -1), "back": (0, -1),
    "lower": (0, 1), "bottom": (0, 1), "south": (0, 1), "front": (0, 1),
}  # fmt: skip
_SIDES = "|".join(_ENDS)
_HINGE = re.compile(rf"\bhing\w*[^,;.]*?\b(?:{_SIDES})\b[^,;.]*|\b(?:{_SIDES})[- ](?:hung|hinged)\b")
_DEGREES = re.compile(r"(\d{1,3})(?:\.\d+)?\s*(?:°|deg)")
_RIGID = re.compile(r"\b(sliding|slides?|pocket|bi-?fold|folding|roller|revolving|curtain)\b")
_CLOSED = re.compile(r"\b(closed|shut|not open)\b")
_NEARLY = re.compile(r"\b(slightly|ajar|crack|partly|partially|a little|almost closed|nearly closed|almost shut)\b")
_HALF = re.compile(r"\b(half|halfway|half-way)\b")
_WIDE = re.compile(r"\b(wide|fully|completely|flat against)\b")
# "Opens into the room" and "swings open to the left" say how a door turns, not how it stands.
_OPEN = re.compile(
    r"\b(?:stand\w*|stood|is|left|leaf)\b[^,;.]{0,20}\bopen\b"
    r"|(?<!swings )(?<!swing )(?<!can )\bopen(?:ed)?\b(?! (?:in|into|inwards?|out|outwards?)\b)"
)
_OUT = re.compile(r"\b(out|outwards?|outside|out of)\b")
_IN = re.compile(r"\b(in|into|inwards?|inside)\b")


@dataclass(frozen=True)
class Said:
    """What a door's words say.

    Attributes:
        side: 1 opens into the room, -1 out of it, 0 unknown. hinge: direction of the hinge in the picture (x right, y
            down), None when unknown. degrees: stated, None when unknown. between: lowest, highest and usual degrees that a
            word such as "ajar" stands for, None when nothing says whether it is open.
    """

    side: int = 0
    hinge: tuple[int, int] | None = None
    degrees: float | None = None
    between: tuple[float, float, float] | None = None


def read_swing(words: str) -> Said:
    """What a model's words on a door say, such as "into the room, hinge at the right end, slightly open"."""
    text = words.lower()
    found = _HINGE.search(text)
    hinge = None
    if found:
        ways = [_ENDS[word] for word in re.findall(rf"\b({_SIDES})\b", found.group())]
        hinge = (sum(w[0] for w in ways), sum(w[1] for w in ways))
    rest = _HINGE.sub(" ", text)
    side = -1 if _OUT.search(rest) else 1 if _IN.search(rest) else 0
    if _RIGID.search(text):
        return Said(side, hinge, 0.0)
    stated = _DEGREES.findall(rest)
    if stated:
        return Said(side, hinge, min(170.0, float(stated[-1])))
    return Said(side, hinge, *_state(rest))


def _state(text: str) -> tuple[float | None, tuple[float, float, float] | None]:
    """Degrees, or between which degrees, the words on how a door stands mean."""
    if _NEARLY.search(text):
        return None, (10.0, 45.0, 25.0)
    if _CLOSED.search(text):
        return (None, (25.0, 65.0, 45.0)) if _HALF.search(text) else (0.0, None)
    if not _OPEN.search(text):
        return None, None
    if _HALF.search(text):
        return None, (25.0, 65.0, 45.0)
    return (None, (70.0, 90.0, 90.0)) if _WIDE.search(text) else (None, (30.0, 90.0, 80.0))


def opens_in(words: str) -> bool:
    """Whether a door's words say that its leaf comes into the room."""
    return read_swing(words).side > 0 and not _RIGID.search(words.lower())


def door_stands(
    item: ArchitectureItem, wall: WallLine, span: tuple[Metres2, Metres2], calibration: Calibration
) -> tuple[Metres2, Metres2, float]:
    """Start (the hinge's end), end and open degrees of a door's line.

    Args:
        span: the door's ends on its wall, in the wall's direction. wall: the room, or the side that positive degrees open
            into, is on its left.
    """
    said = read_swing(item.swing)
    hinges = _hinges(said, span, calibration)
    if said.degrees is not None and (said.degrees == 0.0 or not wall.partition or item.box is None):
        return (*_from(hinges[0], span), round((said.side or 1) * said.degrees, 1))
    fits = _fits(item, said, hinges, wall, span, calibration)
    if said.degrees is not None or said.between is not None:
        stated = said.degrees or 0.0
        low, high, usual = said.between or (stated, stated, stated)
        within = [f for f in fits if low - 1e-6 <= abs(f[2]) <= high + 1e-6]
        best = min(within, default=(0.0, hinges[0], (said.side or 1) * usual))
        return (*_from(best[1], span), round(best[2], 1))
    closed = min((f[0] for f in fits if f[2] == 0.0), default=0.0)
    best = min(fits, default=(0.0, hinges[0], 0.0))
    if abs(best[2]) < SURE or best[0] > _BETTER * closed:
        return (*_from(hinges[0], span), 0.0)
    return (*_from(best[1], span), round(best[2], 1))


def _from(hinge: int, span: tuple[Metres2, Metres2]) -> tuple[Metres2, Metres2]:
    return span if hinge == 0 else (span[1], span[0])


def _hinges(said: Said, span: tuple[Metres2, Metres2], calibration: Calibration) -> list[int]:
    """Which ends of the span the hinge may be at, likelier first."""
    if said.hinge is None or said.hinge == (0, 0):
        return [0, 1]
    try:
        ends = project(calibration.camera, [(*p, 0.0) for p in span])
    except GeometryError:
        return [0, 1]
    way = ends[1] - ends[0]
    reach = float(way @ np.array(said.hinge))
    if abs(reach) < _END * float(np.linalg.norm(way)):
        return [0, 1]
    return [1] if reach > 0 else [0]


def _fits(
    item: ArchitectureItem,
    said: Said,
    hinges: Sequence[int],
    wall: WallLine,
    span: tuple[Metres2, Metres2],
    calibration: Calibration,
) -> list[tuple[float, int, float]]:
    """(misfit, hinge, degrees) of leaves against the door's box, in thousandths of the picture; empty without a box."""
    if item.box is None:
        return []
    box = np.array((item.box.x_min, item.box.y_min, item.box.x_max, item.box.y_max))
    sides = (said.side or 1,) if not wall.partition else (1, -1)
    stated = [] if said.degrees is None else [said.degrees]
    found = []
    for degrees in stated or [i * _STEP for i in range(int(_MOST / _STEP) + 1)]:
        for hinge in hinges:
            for side in sides:
                leaf = _leaf(span, hinge, side * degrees, wall)
                # Where the walls are cut in the picture, openings go up to the cut.
                tops = {item.height, max(item.height, calibration.height)}
                misfit = min(_misfit(calibration, span, leaf, wall, item.height, top, box) for top in tops)
                found.append((misfit + _corner(hinge, span, wall), hinge, side * degrees))
    return [f for f in found if math.isfinite(f[0])]


def _leaf(span: tuple[Metres2, Metres2], hinge: int, degrees: float, wall: WallLine) -> tuple[Floats, Floats]:
    """Hinge and free edge of a leaf on the floor; positive degrees open to the wall's left."""
    start, end = (np.array(p, dtype=float) for p in _from(hinge, span))
    way = end - start
    along = np.array(wall.end, dtype=float) - np.array(wall.start, dtype=float)
    turn = math.radians(degrees if way @ along >= 0 else -degrees)
    c, s = math.cos(turn), math.sin(turn)
    return start, start + np.array((c * way[0] - s * way[1], s * way[0] + c * way[1]))


def _misfit(
    calibration: Calibration,
    span: tuple[Metres2, Metres2],
    leaf: tuple[Floats, Floats],
    wall: WallLine,
    height: float,
    top: float,
    box: Floats,
) -> float:
    """Sum of the four edges' differences between a door's projection and its box."""
    along = np.array(wall.end, dtype=float) - np.array(wall.start, dtype=float)
    outward = np.array((along[1], -along[0])) / max(1e-9, float(np.linalg.norm(along))) * wall.thickness
    points = [(*p, z) for p in leaf for z in (0.0, height)]
    for end in span:
        faces = (np.array(end) - outward / 2, np.array(end) + outward / 2) if wall.partition else (end, end + outward)
        points += [(float(f[0]), float(f[1]), z) for f in faces for z in (0.0, top)]
    try:
        shown = project(calibration.camera, points)
    except GeometryError:
        return math.inf
    edges = np.concatenate([shown.min(axis=0), shown.max(axis=0)])
    return float(np.abs(edges - box).sum())


def _corner(hinge: int, span: tuple[Metres2, Metres2], wall: WallLine) -> float:
    """A hair's difference: where boxes do not tell, a door opens against the wall that is nearer."""
    return 0.5 if math.dist(span[hinge], wall.end if hinge else wall.start) > math.dist(
        span[1 - hinge], wall.start if hinge else wall.end
    ) else 0.0  # fmt: skip
