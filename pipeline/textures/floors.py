# SPDX-License-Identifier: GPL-3.0-or-later
"""The floor from the picture: its own planks or tiles, in their direction and size, as a tile that repeats."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..artifacts.textures import TextureQuality
from ..geometry.polygon import edges
from .pixels import Pixels, resized
from .planes import Face, Rectified, floor_face, inside_polygon
from .quality import seam_error, sharpness
from .quilting import Tile, quilted
from .shading import flattened, foreign, typical_colour, unevenness
from .shown import Flat, NotUsable, Shown
from .structure import Direction, Period, contrast_of, direction_of, is_plain, periods_of, snapped

TILE = 2.4
"""Metres that a tile wants to be: large enough for the eye not to find the repeat at once."""
SURE_PERIOD = 0.12
WORST_SEAM = 1.5
LEAST_DETAIL = 40.0
"""Picture pixels for a metre below which a floor is only a blur."""
_LOOKED_AT = 120.0
"""Pixels for a metre at which the pattern is looked for."""
_STRAIGHT = 0.5
_CERTAIN = 0.35
_TRIES = 3
_GOOD_SEAM = 1.1


def floor_texture(shown: Shown) -> Flat:
    """The floor as a tile.

    Raises:
        NotUsable: says why the picture does not give one.
    """
    if shown.drawn:
        raise NotUsable("The picture is a drawing, so it shows no material.")
    floor = shown.layout.room.floor
    seen = _seen_floor(shown, floor_face(floor))
    if seen.detail[0] < LEAST_DETAIL:
        raise NotUsable(f"The picture shows the floor with only {seen.detail[0]:.0f} pixels a metre.")
    even = flattened(seen.pixels, seen.seen, 0.45 * seen.scale)
    contrast = contrast_of(even, seen.seen, seen.scale)
    direction = direction_of(even, seen.seen)
    turn = _frame_turn(direction, floor)
    face = floor_face(floor, turn)
    if turn:
        seen = _seen_floor(shown, face)
        even = flattened(seen.pixels, seen.seen, 0.45 * seen.scale)
    periods = periods_of(even, seen.seen, seen.scale)
    lines = _lines_in_frame(direction, turn)
    # Along planks nothing repeats: their ends lie anywhere.
    if lines == "x" and periods[0].sure < _CERTAIN:
        periods = (Period(0.0, 0.0), periods[1])
    elif lines == "y" and periods[1].sure < _CERTAIN:
        periods = (periods[0], Period(0.0, 0.0))
    if is_plain(contrast) or not _has_pattern(direction, periods, contrast):
        raise NotUsable("The floor shows no pattern that a made material would not show better.")
    return _tile(shown, _in_full(shown, face, seen), lines, turn, periods, contrast)


def _seen_floor(shown: Shown, face: Face) -> Rectified:
    """The floor, coarse enough to be looked through quickly, without what does not belong to it."""
    seen = shown.see(face, scale=_LOOKED_AT)
    seen = shown.part(seen, inside_polygon(face, seen.seen.shape, shown.layout.room.floor))
    if seen.seen.mean() < 0.02:
        raise NotUsable("Hardly anything of the floor is seen.")
    return shown.part(seen, ~foreign(seen.pixels, seen.seen, seen.scale))


def _in_full(shown: Shown, face: Face, looked: Rectified) -> Rectified:
    """The same as sharp as the picture has it."""
    if looked.scale < _LOOKED_AT - 1e-9:
        return looked  # a large floor, or a coarse picture: there is no more to be seen
    seen = shown.see(face)
    kept = resized(looked.seen.astype(np.float32), (seen.seen.shape[1], seen.seen.shape[0])) > 0.75
    return shown.part(seen, kept)


def _frame_turn(direction: Direction, floor: Sequence[Sequence[float]]) -> float:
    """Degrees, -45 to 45, by which the pattern lies turned in the room; 0 where it has no direction."""
    if not (direction.has_lines or direction.has_grid):
        return 0.0
    walls = [math.degrees(math.atan2(b[1] - a[1], b[0] - a[0])) for a, b in edges(floor)]
    turn = (snapped(direction.turn, walls) + 45.0) % 90.0 - 45.0
    return 0.0 if abs(turn) < _STRAIGHT else turn


def _has_pattern(direction: Direction, periods: tuple[Period, Period], contrast: float) -> bool:
    regular = max(p.sure for p in periods) > SURE_PERIOD
    return regular or direction.has_lines or (direction.has_grid and contrast > 0.05)


def _tile(
    shown: Shown,
    seen: Rectified,
    lines: str,
    turn: float,
    periods: tuple[Period, Period],
    contrast: float,
) -> Flat:
    across, along = (p.metres if p.sure > SURE_PERIOD else 0.0 for p in periods)
    longest = max(across, along)
    even = flattened(seen.pixels, seen.seen, max(0.3, longest) * seen.scale)
    uneven = unevenness(even, seen.seen, seen.scale, longest)
    size = tuple(max(1, round(TILE / p)) * p if p else TILE for p in (across, along))
    tile, seam = _sewn(even, seen, uneven, (size[0], size[1]), (across, along), lines)
    covers = tile.pixels.shape[1] / seen.scale, tile.pixels.shape[0] / seen.scale
    if seam > WORST_SEAM:
        raise NotUsable("No pieces of the floor were found that fit each other without a seam.")
    whole = np.ones(tile.pixels.shape[:2], dtype=bool)
    made = flattened(tile.pixels, whole, max(0.3 * min(whole.shape), longest * seen.scale), 0.8, wrap=True)
    # Flattening chose the usual light; the floor's colour is what is neither in shadow nor glossy.
    wanted = typical_colour(seen.pixels, seen.seen)
    made = made * (wanted / np.maximum(typical_colour(made, whole), 1e-3))
    quality = TextureQuality(
        seen=round(seen.share, 3),
        detail=round(seen.detail[1], 1),
        sharpness=round(sharpness(tile.pixels, even, seen.seen), 3),
        seam=round(seam, 3),
        contrast=round(contrast, 4),
        period=(round(across, 4), round(along, 4)),
        sure=round(max((p.sure for p in periods), default=0.0), 3),
    )
    return Flat(shown.balanced(made.astype(np.float32)), covers, turn, quality)


def _lines_in_frame(direction: Direction, turn: float) -> str:
    """Which way the lines run in the turned frame, "" for none."""
    if not direction.has_lines:
        return ""
    away = (direction.turn - turn + 90.0) % 180.0 - 90.0
    return "x" if abs(away) < 45.0 else "y"


def _sewn(
    even: Pixels,
    seen: Rectified,
    uneven: Pixels,
    size: tuple[float, float],
    periods: tuple[float, float],
    lines: str,
) -> tuple[Tile, float]:
    """A tile from what is lit evenly, else from all that is seen; the one of a few tries whose seams show least.

    Raises:
        NotUsable: too little is seen.
    """
    limit = max(0.06, float(np.percentile(uneven[seen.seen], 68)))
    best: tuple[Tile, float] | None = None
    for mask, tries in ((seen.seen & (uneven < limit), _TRIES), (seen.seen, 1)):
        for seed in range(tries):
            tile = quilted(even, mask, uneven, seen.scale, size, periods, lines, seed)
            if tile is None:
                break
            seam = seam_error(tile.pixels, tile.owners)
            best = (tile, seam) if best is None or seam < best[1] else best
            if seam < _GOOD_SEAM:
                return best
        if best is not None:
            return best
    raise NotUsable("Too little of the floor is seen in one piece.")
