# SPDX-License-Identifier: GPL-3.0-or-later
"""Fills what is hidden of a flat thing: by its own symmetry where it has one, else smoothly from what lies round it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .pixels import DARKEST, Mask, Pixels, blurred, blurred_inside, grown, resized

Turn = Callable[[Pixels], Pixels]
_LEAST_SHARED = 0.08
_ALIKE = 0.62
"""Difference between a thing and its mirror image, over its own variation, below which it counts as symmetric."""
_PLAIN = 0.05
_SHADOW, _COPIES = 0.03, 4
_FITS = 0.36
_LEAST_RINGS = 0.3
_COARSE, _FINE = 56, 168
_DENIED, _UNKNOWN = 1.1, 9.0


@dataclass(frozen=True)
class Filled:
    """A surface without holes.

    Attributes:
        mirrored: share of it that came from its own symmetry; guessed: share that was filled from what lies round it.
    """

    pixels: Pixels
    mirrored: float
    guessed: float


def filled(pixels: Pixels, seen: Mask, round_: bool = False, symmetric: bool = True) -> Filled:
    """The surface with its holes filled.

    Args:
        round_: a disc: what is alike after any turn is looked for, and its corners need not be right.
        symmetric: whether it may be made symmetric, as woven things are and pictures are not.
    """
    logs = np.log(np.maximum(pixels, DARKEST)).astype(np.float32)
    inside = _disc(seen.shape) if round_ else np.ones_like(seen)
    rings = _rings(logs, seen) if round_ and symmetric else None
    if rings is not None:
        return _from_rings(logs, seen, inside, rings)
    known, made = seen.copy(), logs.copy()
    turns = _good_turns(logs, seen) if symmetric else []
    if turns:
        logs = made = _without_shadows(logs, seen, turns)
    for turn in turns:
        if known.all():
            break
        made, known = _filled_from(made, known, seen, logs, turn)
    mirrored = float((known & ~seen & inside).sum() / inside.sum())
    guessed = float((~known & inside).sum() / inside.sum())
    return Filled(np.exp(smoothly_filled(made, known)).astype(np.float32), mirrored, guessed)


def _radius(shape: tuple[int, ...]) -> NDArray[np.float64]:
    """The distance of each pixel from the middle, 1 at the edge of the disc that fills the image."""
    rows, columns = shape[:2]
    y, x = np.mgrid[:rows, :columns]
    found: NDArray[np.float64] = np.hypot((x + 0.5) / columns * 2 - 1, (y + 0.5) / rows * 2 - 1)
    return found


def _rings(logs: Pixels, seen: Mask) -> Pixels | None:
    """The disc as rings of one colour each, None where it has another pattern or its rings are not seen."""
    number = max(8, min(seen.shape) // 3)
    ring = np.minimum((_radius(seen.shape) * number).astype(int), number)
    profile = np.full((number + 1, 3), np.nan)
    for i in range(number):
        there = seen & (ring == i)
        if there.sum() >= 8:
            # Shadows lie on some of a ring; its own colour is that of the lighter part.
            colours = logs[there]
            light = colours.mean(axis=1)
            profile[i] = colours[light >= np.percentile(light, 40)].mean(axis=0)
    known = np.isfinite(profile[:, 0])
    if known[:number].mean() < _LEAST_RINGS:
        return None
    index = np.arange(number + 1)
    for channel in range(3):
        profile[:, channel] = np.interp(index, index[known], profile[known, channel])
    found: Pixels = profile[ring].astype(np.float32)
    core = seen & (_radius(seen.shape) < 0.97)
    if not core.any():
        return None
    sigma = 0.01 * max(seen.shape)
    gap = blurred_inside((logs - found).astype(np.float32), seen, sigma)
    gap = gap - blurred_inside(gap, seen, 0.15 * max(seen.shape))
    spread = np.abs(found[core] - np.median(found[core], axis=0)).mean()
    return found if float(np.abs(gap[core]).mean()) < _ALIKE * (float(spread) + _PLAIN) else None


def _from_rings(logs: Pixels, seen: Mask, inside: Mask, rings: Pixels) -> Filled:
    """The disc with its holes and shadows taken from its rings, and its own grain where it is seen."""
    sigma = max(2.0, _SHADOW * min(seen.shape))
    core = ~grown(~seen, 2)
    light = blurred_inside((rings - logs).astype(np.float32), core, sigma)
    share = blurred(core.astype(np.float32), 1.0)[..., None]
    mixed: Pixels = ((logs + light) * share + rings * (1 - share)).astype(np.float32)
    made = smoothly_filled(mixed, inside)
    hidden = float((~seen & inside).sum() / inside.sum())
    return Filled(np.exp(made).astype(np.float32), hidden, 0.0)


def _good_turns(logs: Pixels, seen: Mask) -> list[Turn]:
    """The turns after which the thing looks the same, the best first, each with the small shift that fits best.

    Where one is found and none is denied, a mirror image that cannot be compared, since its other half is hidden, is
    believed too: what is woven symmetric one way is so the other way as well.
    """
    turns = _turns(seen.shape)
    close = [_closest(logs, seen, turn) for turn in turns]
    good = sorted((score, i) for i, (score, _) in enumerate(close) if score < _ALIKE)
    found = [_shifted(turns[i], close[i][1]) for _, i in good]
    mirrors = [score for score, _ in close[:3]]
    if good and not any(_DENIED < score < _UNKNOWN for score in mirrors):
        found += [turns[i] for i in range(3) if mirrors[i] >= _UNKNOWN]
    return found


def _without_shadows(logs: Pixels, seen: Mask, turns: list[Turn]) -> Pixels:
    """What is darker than its own mirror images lies in shadow, since patterns are symmetric and shadows are not."""
    sigma = max(2.0, _SHADOW * min(seen.shape))
    light = logs.mean(axis=2)
    own = blurred_inside(light, seen, sigma)
    core = ~grown(~seen, 2)
    best = own.copy()
    for turn in turns[:_COPIES]:
        there = turn(core.astype(np.float32)) > 0.98
        other = blurred_inside(turn(light), there, sigma)
        best = np.where(there, np.maximum(best, other), best)
    lift = blurred(np.clip(best - own, 0.0, 0.9), sigma)
    found: Pixels = (logs + lift[..., None]).astype(np.float32)
    return found


def _shifted(turn: Turn, shift: tuple[float, float]) -> Turn:
    """A turn and then a shift by shares of the height (down) and the width (right); nothing comes in from outside."""

    def both(values: Pixels) -> Pixels:
        return _moved(turn(values), round(shift[0] * values.shape[0]), round(shift[1] * values.shape[1]))

    return both


def _moved(values: Pixels, down: int, right: int) -> Pixels:
    if not down and not right:
        return values
    rows, columns = values.shape[:2]
    found = np.zeros_like(values)
    target = slice(max(0, down), rows + min(0, down)), slice(max(0, right), columns + min(0, right))
    source = slice(max(0, -down), rows + min(0, -down)), slice(max(0, -right), columns + min(0, -right))
    found[target] = values[source]
    return found


def _disc(shape: tuple[int, ...]) -> Mask:
    """The ellipse that fills an image."""
    found: Mask = _radius(shape) <= 1.0
    return found


def _turns(shape: tuple[int, ...]) -> list[Turn]:
    found: list[Turn] = [
        lambda a: a[:, ::-1],
        lambda a: a[::-1],
        lambda a: a[::-1, ::-1],
    ]
    rows, columns = shape[0], shape[1]
    if abs(rows - columns) <= 0.08 * max(rows, columns):
        found.append(lambda a: _fitted(np.swapaxes(a, 0, 1), a.shape[1], a.shape[0]))
        found.append(lambda a: _fitted(np.swapaxes(a, 0, 1)[::-1, ::-1], a.shape[1], a.shape[0]))
        found.append(lambda a: _fitted(np.rot90(a), a.shape[1], a.shape[0]))
        found.append(lambda a: _fitted(np.rot90(a, 3), a.shape[1], a.shape[0]))
    return found


def _fitted(values: Pixels, columns: int, rows: int) -> Pixels:
    return values if values.shape[:2] == (rows, columns) else resized(np.ascontiguousarray(values), (columns, rows))


def _closest(logs: Pixels, seen: Mask, turn: Turn) -> tuple[float, tuple[float, float]]:
    """How much what is seen differs from itself after a turn and the best small shift, over its variation; the shift.

    The middle of a thing is not known exactly where some of its edges are hidden. `_UNKNOWN` where too little is shared.
    """
    best, shift = _UNKNOWN, (0.0, 0.0)
    for side, reach in ((_COARSE, 3), (_FINE, 2)):
        step = max(1.0, max(seen.shape) / side)
        small = max(8, round(seen.shape[1] / step)), max(8, round(seen.shape[0] / step))
        weight = resized(seen.astype(np.float32), small)
        values = resized((logs * seen[..., None]).astype(np.float32), small) / np.maximum(weight, 1e-3)[..., None]
        values = values - blurred_inside(values, weight > 0.5, 0.5 * max(small))
        there = values[weight > 0.9]
        away = np.abs(values - (np.median(there, axis=0) if len(there) else 0.0)).mean(axis=2)
        other, share = turn(values), turn(weight)
        middle = round(shift[0] * small[1]), round(shift[1] * small[0])
        scores = {}
        for down in range(middle[0] - reach, middle[0] + reach + 1):
            for right in range(middle[1] - reach, middle[1] + reach + 1):
                scores[down, right] = _roughly(
                    values, weight, _moved(other, down, right), _moved(share, down, right), away
                )
        place = min(scores, key=lambda key: (scores[key], abs(key[0]) + abs(key[1])))
        best = _difference(values, weight, _moved(other, *place), _moved(share, *place))
        shift = (place[0] / small[1], place[1] / small[0])
        if best > _ALIKE * 1.4:
            break
    return best, shift


def _roughly(values: Pixels, weight: Pixels, other: Pixels, share: Pixels, away: Pixels) -> float:
    """About what `_difference` says, quickly; `away` is how far each pixel is from what is usual in the whole image."""
    both = (weight > 0.9) & (share > 0.9)
    count = int(both.sum())
    if count < _LEAST_SHARED * both.size:
        return _UNKNOWN
    gap = float((np.abs(values - other).sum(axis=2) * both).sum()) / (3 * count)
    return gap / (float((away * both).sum()) / count + _PLAIN)


def _difference(values: Pixels, weight: Pixels, other: Pixels, share: Pixels) -> float:
    both = (weight > 0.9) & (share > 0.9)
    if both.mean() < _LEAST_SHARED:
        return _UNKNOWN
    gap = np.abs(values[both] - other[both]).mean()
    spread = np.abs(values[both] - np.median(values[both], axis=0)).mean()
    return float(gap / (spread + _PLAIN))


def _filled_from(made: Pixels, known: Mask, seen: Mask, logs: Pixels, turn: Turn) -> tuple[Pixels, Mask]:
    """Holes filled with what lies there after a turn, in the light of what lies beside them."""
    other, there = turn(logs), turn(seen.astype(np.float32)) > 0.98
    new = there & ~known
    if not new.any():
        return made, known
    both = known & there
    sigma = max(3.0, 0.06 * max(known.shape))
    # The same pattern may lie in another light on the other side.
    light = blurred_inside(np.where(both[..., None], made - other, 0.0).astype(np.float32), both, sigma)
    value = other + np.clip(light, -0.5, 0.5)
    rim = grown(new, max(3.0, 0.02 * max(known.shape))) & both
    if rim.sum() > 50 and _mismatch(made, value, both, rim) > _FITS:
        return made, known
    result = made.copy()
    result[new] = value[new]
    rim = grown(new, 3) & both
    share = blurred(new.astype(np.float32), 1.5)[..., None]
    result[rim] = (made * (1 - share) + value * share)[rim]
    return result, known | new


def _mismatch(made: Pixels, value: Pixels, both: Mask, rim: Mask) -> float:
    """How badly what is put in would continue what is there, over the variation there."""
    sigma = max(1.0, 0.006 * max(both.shape))
    gap = blurred_inside((made - value).astype(np.float32), both, sigma)
    spread = np.abs(made[rim] - np.median(made[rim], axis=0)).mean()
    return float(np.abs(gap[rim]).mean() / (spread + _PLAIN))


def smoothly_filled(values: Pixels, known: Mask) -> Pixels:
    """Unknown pixels from coarser and coarser averages of the known ones."""
    if known.all():
        return values
    if not known.any():
        return values
    rows, columns = known.shape
    if min(rows, columns) <= 2:
        mean = values[known].mean(axis=0)
        return np.where(known[..., None], values, mean).astype(np.float32)
    small = (max(1, columns // 2), max(1, rows // 2))
    weight = resized(known.astype(np.float32), small)
    sums = resized((values * known[..., None]).astype(np.float32), small)
    coarse = smoothly_filled((sums / np.maximum(weight, 1e-3)[..., None]).astype(np.float32), weight > 0.2)
    found: Pixels = np.where(known[..., None], values, resized(coarse, (columns, rows))).astype(np.float32)
    return found
