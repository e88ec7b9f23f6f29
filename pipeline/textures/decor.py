# SPDX-License-Identifier: GPL-3.0-or-later
"""Rugs, covers, pictures and screens from the reference picture: cut out straight on, edges found, holes filled."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ..artifacts.textures import TextureKind, TextureQuality
from .holes import filled
from .pixels import Mask, Pixels, perceived
from .planes import Face, Rectified, detail_of
from .shading import flattened
from .shown import Flat, NotUsable, Shown
from .structure import contrast_of, direction_of

MARGIN = 0.12
"""Share of a side that is looked at beyond it, since places are not exact."""
LEAST_SEEN = 0.25
MOST_GUESSED: dict[TextureKind, float] = {"rug": 0.65, "cloth": 0.35, "picture": 0.25, "screen": 0.25}
"""What stands on a rug hides it in the room as in the picture; what hangs on a wall is looked at from elsewhere."""
LEAST_ACROSS: dict[TextureKind, float] = {"rug": 36.0, "cloth": 36.0, "picture": 20.0, "screen": 40.0}
"""Pixels of the reference picture that the shorter side must have, where the picture is least clear."""
_STRIPED = 0.06
_SHADOWED = 5
_PLAIN_COVER = 0.045
_LIGHT: dict[TextureKind, float] = {"rug": 0.5, "cloth": 0.5, "picture": 0.3, "screen": 0.0}
"""How much of what changes slowly over it is light, and taken out."""
_LARGE, _LIGHT_ON_LARGE = 1.5, 0.9
"""Over rugs whose shorter side is so many metres, what changes slowly is the room's light; patterns are smaller."""


def decor_texture(shown: Shown, face: Face, kind: TextureKind, without: Collection[str], round_: bool = False) -> Flat:
    """A flat thing as the picture shows it, to fill its face once.

    Args:
        without: ids of the thing and of what it belongs to.

    Raises:
        NotUsable: says why the picture does not give one.
    """
    if shown.drawn:
        raise NotUsable("The picture is a drawing, so it shows no material.")
    clear, unclear = detail_of(shown.camera, face)
    # The less clear direction may run along either side.
    short = unclear * min(face.size)
    if clear <= 0 or short < LEAST_ACROSS[kind]:
        raise NotUsable(f"The picture shows it too small or too flat: {max(0.0, short):.0f} pixels across.")
    pad = max(0.03, MARGIN * min(face.size))
    wide = shown.see(face.widened(pad, pad, pad, pad), without)
    wide, share = _cut_out(wide, pad, round_)
    inside = _core(wide.seen, round_)
    seen = wide.seen & inside
    known = float(seen.sum() / max(1, int(inside.sum())))
    if known < LEAST_SEEN:
        raise NotUsable(f"Other things hide {100 - 100 * known:.0f} % of it.")
    light = _LIGHT_ON_LARGE if kind == "rug" and min(face.size) > _LARGE and not round_ else _LIGHT[kind]
    even = flattened(wide.pixels, seen, 0.4 * min(seen.shape), light)
    whole = filled(even, seen, round_, kind in ("rug", "cloth"))
    if whole.guessed > MOST_GUESSED[kind]:
        raise NotUsable("Too much of it is hidden, and it does not repeat itself.")
    contrast = contrast_of(even, seen, wide.scale)
    quality = TextureQuality(
        seen=round(known, 3),
        detail=round(unclear, 1),
        contrast=round(contrast, 4),
        filled=round(min(1.0, whole.mirrored + whole.guessed), 3),
    )
    striped = contrast > _STRIPED and direction_of(even, seen).lines > 0.4
    if kind in ("rug", "cloth") and not striped and _is_one_colour(even, seen):
        raise NotUsable("It is of one colour, which a made material shows better.")
    size = face.size[0] * share[0], face.size[1] * share[1]
    return Flat(shown.balanced(whole.pixels), size, 0.0, quality)


def _core(seen: Mask, round_: bool) -> Mask:
    """What belongs to the thing itself: its disc where it is round."""
    rows, columns = seen.shape
    if not round_:
        return np.ones_like(seen)
    y, x = np.mgrid[:rows, :columns]
    found: Mask = ((x + 0.5) / columns * 2 - 1) ** 2 + ((y + 0.5) / rows * 2 - 1) ** 2 <= 0.97
    return found


def _is_one_colour(pixels: Pixels, seen: Mask) -> bool:
    lab = perceived(pixels[seen])
    return bool(np.abs(lab - np.median(lab, axis=0)).mean(axis=0).sum() < _PLAIN_COVER)


def _cut_out(wide: Rectified, pad: float, as_placed: bool) -> tuple[Rectified, tuple[float, float]]:
    """The thing cut along its edges as they are seen near where it was placed, and its size over the placed one's."""
    rows, columns = wide.seen.shape
    margin = round(pad * wide.scale)
    left = right = top = bottom = margin
    if not as_placed:
        lab = perceived(wide.pixels)
        left = _edge(lab, wide.seen, margin)
        right = _edge(lab[:, ::-1], wide.seen[:, ::-1], margin)
        top = _edge(lab.swapaxes(0, 1), wide.seen.T, margin)
        bottom = _edge(lab[::-1].swapaxes(0, 1), wide.seen[::-1].T, margin)
    kept = (slice(top, rows - bottom), slice(left, columns - right))
    share = (columns - left - right) / max(1, columns - 2 * margin), (rows - top - bottom) / max(1, rows - 2 * margin)
    return Rectified(wide.pixels[kept], wide.seen[kept], wide.scale, wide.detail), share


def _edge(lab: Pixels, seen: Mask, margin: int) -> int:
    """Where a thing's left edge lies: the first column from outside that no longer looks like what is round it.

    `margin` where nothing is found.
    """
    reach = min(2 * margin, seen.shape[1] // 3)
    core = slice(margin, seen.shape[0] - margin)
    lines = []
    for column in range(reach):
        there = seen[core, column]
        lines.append(np.median(lab[core, column][there], axis=0) if there.sum() > 0.12 * len(there) else None)
    outside = [line for line in lines[: max(2, margin // 3)] if line is not None]
    if len(outside) < 2:
        return margin
    ground = np.median(np.array(outside), axis=0)
    away = np.array([np.linalg.norm(line - ground) if line is not None else np.nan for line in lines])
    noise = float(np.nanmax(away[: max(2, margin // 3)]))
    inner = away[margin // 2 :]
    usual = float(np.nanpercentile(inner, 75)) if np.isfinite(inner).any() else 0.0
    least = max(0.03, 2.5 * noise, 0.35 * usual)
    # What follows decides how large a step is: a line further in may differ much more from the ground.
    after = [np.nanmedian(part) if np.isfinite(part := away[i + 1 : i + 5]).any() else 0.0 for i in range(reach)]
    over = np.flatnonzero((np.array(after) > least) & (np.nan_to_num(away) > 0.5 * np.array(after)))
    if not len(over):
        return margin
    # A contact shadow lies before the edge; the edge itself is the largest step.
    first = int(over[0])
    steps = [
        float(np.linalg.norm(b - a)) if (a := lines[i]) is not None and (b := lines[i + 1]) is not None else 0.0
        for i in range(max(0, first - 1), min(reach - 1, first + _SHADOWED))
    ]
    largest = max(0, first - 1) + int(np.argmax(steps)) if steps else first
    # A little further in: the edge's own pixels are mixtures.
    return min(reach, largest + 3)
