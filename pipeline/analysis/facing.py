# SPDX-License-Identifier: GPL-3.0-or-later
"""Which way things face, checked against what else is known: the words of the front, sizes, walls, tables.

A direction that a model gives is one witness among several: by what it recognised the front, which of its sizes it called
width, at which wall the thing stands, at which table a seat stands. Each speaks for one of four directions with a
weight. A direction is changed only where the witnesses outweigh the model's word clearly and the model was unsure or
contradicts itself; what merely looks odd becomes a finding. What looks the same from all sides is left alone.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace

from ..artifacts.analysis import Calibration, DetectedObject, Finding, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.layout import WallLine
from ..geometry.camera import GeometryError
from ..geometry.footprint import image_box_of
from ..layout.standing import FLAT, Placed, footprint_gap, wall_gap
from ..layout.walls import along, shell


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


BACKED = _words(
    "sofa couch settee loveseat bed crib cot daybed headboard wardrobe closet armoire cupboard cabinet dresser drawers chest "
    "commode sideboard credenza buffet bookcase bookshelf shelf shelves shelving desk vanity console toilet television tv "
    "monitor screen sink basin washbasin stove oven cooker fridge refrigerator freezer dishwasher washer nightstand "
    "fireplace radiator piano armchair recliner"
)
"""Words for things with a back that goes to a wall; others are judged by their front's words alone."""
VAGUE = _words("unit stand table set console")
"""Last words that leave it to the word before them to name the thing ("tv stand")."""
SEATS = _words("chair armchair stool seat")
TABLES = _words("table desk worktop counter island bar vanity workbench")
BACK_WORDS = _words("back backrest headboard head pillow pillows cushions tank cistern rear")
FRONT_WORDS = _words(
    "front door doors drawer drawers screen handle handles foot footboard opening open seat face faces facing looks shelves keyboard "
    "knob knobs bowl glass"
)
DIRECTIONS = {
    "up": 180.0, "top": 180.0, "upper": 180.0, "above": 180.0, "north": 180.0,
    "down": 0.0, "bottom": 0.0, "lower": 0.0, "below": 0.0, "south": 0.0,
    "left": 270.0, "west": 270.0, "right": 90.0, "east": 90.0,
}  # fmt: skip

SAID, GUESSED = 2.0, 1.0
"""What the model's direction weighs when it could say by what it knew the front, and when it could not."""
WORDS, SIZES, AT_WALL, INTO_WALL, AT_TABLE = 2.0, 2.0, 1.5, -3.0, 2.5
"""What each other witness weighs, in the same units."""
DECISIVE = 1.5
"""By so much the witnesses must outweigh the model's word."""
NEAR_WALL = 0.18
NEAR_TABLE = 0.35
TURNED = 12.0
"""Degrees off a wall's direction from which on a thing counts as turned on purpose."""
OBLONG = 1.3
CLEARER = 0.15
"""By so much sizes must fit the box better one way than the other to tell the direction."""


def checked_facings(analysis: SceneAnalysis, calibration: Calibration) -> SceneAnalysis:
    """The analysis with directions that cannot be right changed, and with findings on those that look wrong.

    Args:
        analysis: metres in the frame of the calibration's floor.
    """
    walls = shell(analysis, calibration)[1]
    tables = [_placed(o) for o in analysis.objects if o.placement == "floor" and _is(o, TABLES)]
    findings: list[Finding] = []
    objects = [_checked(o, walls, tables, calibration, findings) for o in analysis.objects]
    if not findings:
        return analysis
    return analysis.model_copy(update={"objects": objects, "findings": [*analysis.findings, *findings]})


def _checked(
    item: DetectedObject,
    walls: Sequence[WallLine],
    tables: Sequence[Placed],
    calibration: Calibration,
    findings: list[Finding],
) -> DetectedObject:
    if item.placement == "wall":
        return _into_the_room(item, walls, findings)
    if item.placement == "ceiling" or item.shape == "round" or item.size[2] < FLAT:
        return item
    quarter = round(item.yaw / 90.0) * 90.0
    if abs(item.yaw - quarter) > TURNED:
        return item
    said = quarter % 360.0
    worded = direction_of(item.front)
    witnesses = _witnesses(item, walls, tables, calibration, worded)
    votes = {yaw: (SAID if item.front else GUESSED) * (yaw == said) for yaw in (0.0, 90.0, 180.0, 270.0)}
    for yaw, weight, _ in witnesses:
        votes[yaw] += weight
    best = max(votes, key=lambda yaw: (votes[yaw], yaw == said))
    if best == said:
        return item
    # The model's own words, or its own sizes, speak for another direction than the one that it gave.
    contradicts = (worded is not None and worded != said) or any(w[2] == "sizes" and w[0] != said for w in witnesses)
    unsure = not item.front or item.confidence < 0.5
    if votes[best] - votes[said] >= DECISIVE and (contradicts or unsure):
        why = ", ".join(sorted({name for yaw, weight, name in witnesses if (yaw == best) == (weight > 0)}))
        message = f"It was said to face {_word(said)}, but faces {_word(best)}: {why} tell so."
        findings.append(Finding(about=item.id, message=message))
        return item.model_copy(update={"yaw": best})
    if any(name == "the wall before it" and yaw == said for yaw, _, name in witnesses):
        message = "It seems to face the wall that it stands at. Turn it if that is wrong."
        findings.append(Finding(about=item.id, message=message, severity="warning"))
    elif worded is not None and worded != said:
        message = f"It is said to face {_word(said)}, but was recognised by: {item.front[:60]}."
        findings.append(Finding(about=item.id, message=message, severity="warning"))
    return item


def _witnesses(
    item: DetectedObject,
    walls: Sequence[WallLine],
    tables: Sequence[Placed],
    calibration: Calibration,
    worded: float | None,
) -> list[tuple[float, float, str]]:
    """(direction, weight, what speaks) beside the model's own direction."""
    found: list[tuple[float, float, str]] = []
    if worded is not None:
        found.append((worded, WORDS, "its front"))
    if _is(item, BACKED):
        found += _by_walls(item, walls)
    if worded is not None or _is(item, BACKED):
        found += _by_sizes(item, calibration)
    if _is(item, SEATS) and not item.front:
        found += _by_table(item, tables)
    return found


def direction_of(front: str) -> float | None:
    """The yaw that words such as "headboard at the top" or "doors below" speak of; None when they do not say.

    Words of the back's parts turn the direction round. Where several directions are named, they do not say.
    """
    words = re.findall(r"[a-z]+", front.lower())
    yaws = {DIRECTIONS[w] for w in words if w in DIRECTIONS}
    if len(yaws) != 1:
        return None
    backs, fronts = BACK_WORDS.intersection(words), FRONT_WORDS.intersection(words)
    if bool(backs) == bool(fronts):
        return None
    yaw = yaws.pop()
    return (yaw + 180.0) % 360.0 if backs else yaw


def faces_its_wall(item: DetectedObject, walls: Sequence[WallLine]) -> bool:
    """Whether a thing with a back has its front at a wall, so that nobody could use it."""
    if not _is(item, BACKED):
        return False
    quarter = round(item.yaw / 90.0) * 90.0 % 360.0
    return any(yaw == quarter and weight < 0 for yaw, weight, _ in _by_walls(item, walls))


def _by_walls(item: DetectedObject, walls: Sequence[WallLine]) -> list[tuple[float, float, str]]:
    """The back goes to a wall; the front does not touch one, unless the thing is wedged between two."""
    touched = sorted({yaw for wall in walls if (yaw := _backed_by(item, wall)) is not None})
    found = [(yaw, AT_WALL, "the wall behind it") for yaw in touched]
    opposite = [(yaw + 180.0) % 360.0 for yaw in touched]
    return found + [(yaw, INTO_WALL, "the wall before it") for yaw in opposite if yaw not in touched]


def _backed_by(item: DetectedObject, wall: WallLine) -> float | None:
    """The direction of a thing that has its back to this wall, if it stands there, whichever size is its depth."""
    inward = _inward(wall, item)
    quarter = round(inward / 90.0) * 90.0
    if abs(inward - quarter) > TURNED:
        return None
    placed = _placed(item)
    gaps = [abs(wall_gap(replace(placed, yaw=yaw), wall)) for yaw in (quarter, quarter + 90.0)]
    return quarter % 360.0 if min(gaps) <= NEAR_WALL else None


def _by_sizes(item: DetectedObject, calibration: Calibration) -> list[tuple[float, float, str]]:
    """The picture shows along which axis the thing's width lies, if it is oblong; two directions go with each."""
    width, depth, height = item.size
    if item.box is None or max(width, depth) < OBLONG * min(width, depth):
        return []
    fits = []
    for yaw in (0.0, 90.0):
        try:
            seen = image_box_of(calibration.camera, item.centre, (width, depth, height), yaw, item.shape)
        except GeometryError:
            return []
        fits.append(_same_size(seen, item.box))
    if abs(fits[0] - fits[1]) < CLEARER:
        return []
    first = 0.0 if fits[0] > fits[1] else 90.0
    return [(first, SIZES, "sizes"), (first + 180.0, SIZES, "sizes")]


def _same_size(a: ImageBox, b: ImageBox) -> float:
    """IoU of two boxes laid centre on centre: compares sizes only."""
    shared = min(a.x_max - a.x_min, b.x_max - b.x_min) * min(a.y_max - a.y_min, b.y_max - b.y_min)
    return shared / max(1e-9, a.area + b.area - shared)


def _by_table(item: DetectedObject, tables: Sequence[Placed]) -> list[tuple[float, float, str]]:
    """A seat of which nothing else is said faces the table that it stands at."""
    seat = _placed(item)
    near = [(gap, t) for t in tables if t.id != item.id and (gap := footprint_gap(seat, t)) <= NEAR_TABLE]
    if not near:
        return []
    table = min(near, key=lambda pair: pair[0])[1]
    xs, ys = zip(*table.corners, strict=True)
    dx = max(min(xs) - seat.centre[0], 0.0, seat.centre[0] - max(xs)) * (1 if seat.centre[0] < min(xs) else -1)
    dy = max(min(ys) - seat.centre[1], 0.0, seat.centre[1] - max(ys)) * (1 if seat.centre[1] < min(ys) else -1)
    if max(abs(dx), abs(dy)) < 1e-6 or min(abs(dx), abs(dy)) > 0.5 * max(abs(dx), abs(dy)):
        return []
    if abs(dx) > abs(dy):
        return [(90.0 if dx > 0 else 270.0, AT_TABLE, "the table before it")]
    return [(180.0 if dy > 0 else 0.0, AT_TABLE, "the table before it")]


def _into_the_room(item: DetectedObject, walls: Sequence[WallLine], findings: list[Finding]) -> DetectedObject:
    """What hangs on a wall looks away from it."""
    near = [(abs(along(w, item.centre[:2])[1]), n) for n, w in enumerate(walls) if _beside(w, item)]
    if not near or min(near)[0] > NEAR_WALL + item.size[1]:
        return item
    inward = _inward(walls[min(near)[1]], item)
    if abs((item.yaw - inward + 180.0) % 360.0 - 180.0) <= 45.0:
        return item
    findings.append(Finding(about=item.id, message="It hangs on a wall and was turned to look into the room."))
    return item.model_copy(update={"yaw": inward})


def _beside(wall: WallLine, item: DetectedObject) -> bool:
    return -0.1 <= along(wall, item.centre[:2])[0] <= math.dist(wall.start, wall.end) + 0.1


def _inward(wall: WallLine, item: DetectedObject) -> float:
    """Yaw of what has its back to this wall, on the thing's side of it."""
    length = max(1e-9, math.dist(wall.start, wall.end))
    nx, ny = -(wall.end[1] - wall.start[1]) / length, (wall.end[0] - wall.start[0]) / length
    side = -1.0 if wall.partition and along(wall, item.centre[:2])[1] < 0 else 1.0
    return math.degrees(math.atan2(nx * side, -ny * side)) % 360.0


def _is(item: DetectedObject, words: frozenset[str]) -> bool:
    """Whether a category's last word, which names the thing, is one of these ("desk lamp" is a lamp)."""
    said = re.findall(r"[a-z]+", re.split(r"\b(?:of|with|for|on)\b", item.category.lower())[0])
    named = said[-2:] if said[-1:] and said[-1] in VAGUE else said[-1:]
    return any(w in words or (w.endswith("s") and w[:-1] in words) for w in named)


def _word(yaw: float) -> str:
    return {0.0: "down", 90.0: "right", 180.0: "up", 270.0: "left"}[yaw]


def _placed(item: DetectedObject) -> Placed:
    return Placed(item.id, item.centre, item.size, item.yaw, item.placement, item.parent, bool(item.front))
