# SPDX-License-Identifier: GPL-3.0-or-later
"""Footprints taken off each other, off obstacles and into the floor by the least weighted sum of squared moves.

Once it is settled on which side of each other two rectangles stand, "apart" is one linear inequality of their moves, and
"inside" is one for each wall that is in the way. The least squares under such inequalities is a small quadratic program,
solved by row actions (Hildreth 1957). Sides are first chosen by the shallowest overlap; then other sides are tried for
each pair that pushes, and kept where the sum gets smaller. Inequalities are added as they turn out to be needed, so that
what was apart and inside is not touched at all.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from .placement import TOUCH, Rect, is_inside, penetration, push_inside, support
from .polygon import Point, PolygonLike, ensure_ccw

MARGIN = 2e-6
"""Metres that are left between what was taken apart, so that rounding does not join it again."""
SWEEPS = 250
ROUNDS = 25
TRIALS = 12
"""Other sides that are tried in all."""
FEW = 12
"""Pairs that push, beyond which no other sides are tried: it would take too long."""


@dataclass(frozen=True)
class Body:
    """Something on the floor that moves as a whole.

    Attributes:
        rect: its envelope, which stays inside the floor.
        parts: what it really covers, in place; the envelope itself when empty.
        weight: how strongly it holds its place; infinite for what does not move.
        held: unit directions along which it does not move (it stands flush at a wall there).
    """

    rect: Rect
    parts: tuple[Rect, ...] = ()
    weight: float = 1.0
    held: tuple[Point, ...] = ()

    @property
    def give(self) -> float:
        """How readily it moves, 0 for what does not."""
        return 0.0 if math.isinf(self.weight) else 1.0 / max(1e-9, self.weight)

    @property
    def covers(self) -> tuple[Rect, ...]:
        """What it covers."""
        return self.parts or (self.rect,)


class Moves(NamedTuple):
    """The moves, one a body; whether everything is apart and inside after them; their weighted sum of squares."""

    moves: list[Point]
    feasible: bool
    cost: float


class _Row(NamedTuple):
    """sum of (normal . move) over the terms >= least, or = least."""

    terms: tuple[tuple[int, float, float], ...]
    least: float
    equal: bool = False


Key = tuple[int, int, int, int]
"""A pair of parts: body, part, body, part."""


def least_moves(
    bodies: Sequence[Body], floor: PolygonLike | None = None, allowed: Collection[tuple[int, int]] = ()
) -> Moves:
    """The least weighted moves after which no two bodies overlap and all that move are inside the floor.

    Where there are none, or none were found, `feasible` is False and the moves are of no use.

    Args:
        allowed: pairs of indices that may overlap, in either order.
    """
    problem = _Problem(bodies, None if floor is None else ensure_ccw(floor), {frozenset(p) for p in allowed})
    best, sides = problem.solve({})
    pushing = [k for k in sides if len(sides) <= FEW]
    trials = 0
    improved = True
    while improved and trials < TRIALS:
        improved = False
        for key in pushing:
            for side in problem.sides(key):
                if side == sides.get(key) or trials >= TRIALS:
                    continue
                trials += 1
                other, other_sides = problem.solve({**sides, key: side})
                if other.feasible and (not best.feasible or other.cost < best.cost * (1 - 1e-6) - 1e-12):
                    best, sides, improved = other, other_sides, True
    return best


@dataclass
class _Problem:
    bodies: Sequence[Body]
    floor: list[Point] | None
    allowed: set[frozenset[int]]
    pairs: list[tuple[int, int]] = field(init=False)

    def __post_init__(self) -> None:
        count = len(self.bodies)
        self.pairs = [
            (i, j)
            for i in range(count)
            for j in range(i + 1, count)
            if frozenset((i, j)) not in self.allowed and (self.bodies[i].give or self.bodies[j].give)
        ]

    def sides(self, key: Key) -> list[Point]:
        """All directions in which the first part of a pair may leave the second."""
        a, b = self.bodies[key[0]].covers[key[1]], self.bodies[key[2]].covers[key[3]]
        angles = sorted({round(r.yaw % 90.0, 9) + quarter for r in (a, b) for quarter in (0.0, 90.0, 180.0, 270.0)})
        return [_unit(angle) for angle in angles]

    def solve(self, chosen: Mapping[Key, Point]) -> tuple[Moves, dict[Key, Point]]:
        """Moves for these sides, and the sides of all pairs that were in each other's way."""
        sides: dict[Key, Point] = {}
        rows = [_Row(((i, x, y),), 0.0, True) for i, body in enumerate(self.bodies) if body.give for x, y in body.held]
        duals: list[float] = [0.0] * len(rows)
        moves: list[Point] = [(0.0, 0.0)] * len(self.bodies)
        feasible = False
        for _ in range(ROUNDS):
            new = self._pair_rows(moves, chosen, sides) + self._floor_rows(moves)
            if not new:
                feasible = True
                break
            if any(all(n == 0.0 for n in self._gives(row)) for row in new):
                break
            rows += new
            duals += [0.0] * len(new)
            settled = self._sweep(rows, duals, moves)
            if not settled:
                break
        cost = sum(body.weight * (x * x + y * y) for body, (x, y) in zip(self.bodies, moves, strict=True) if body.give)
        return Moves(moves, feasible, cost), sides

    def _gives(self, row: _Row) -> list[float]:
        return [self.bodies[i].give for i, _, _ in row.terms]

    def _pair_rows(self, moves: Sequence[Point], chosen: Mapping[Key, Point], sides: dict[Key, Point]) -> list[_Row]:
        rows: list[_Row] = []
        for i, j in self.pairs:
            for m, a in enumerate(self.bodies[i].covers):
                for n, b in enumerate(self.bodies[j].covers):
                    found = penetration(a.moved(*moves[i]), b.moved(*moves[j]))
                    if found is None:
                        continue
                    key = (i, m, j, n)
                    if key in sides and found[0] < 10 * TOUCH:
                        continue
                    if key not in sides:
                        # Where they overlapped before anything moved, that decides on which side they belong.
                        before = penetration(a, b)
                        sides[key] = chosen.get(key) or (before or found)[1]
                    rows.append(_pair_row(i, a, j, b, sides[key]))
        return rows

    def _floor_rows(self, moves: Sequence[Point]) -> list[_Row]:
        if self.floor is None:
            return []
        rows: list[_Row] = []
        for i, body in enumerate(self.bodies):
            now = body.rect.moved(*moves[i])
            if not body.give or is_inside(now, self.floor):
                continue
            pushed = push_inside(now, self.floor)
            length = math.hypot(*pushed.shift)
            if pushed.outside > 0 or length < TOUCH / 10:
                rows.append(_Row(((i, 0.0, 0.0),), 1.0))
                continue
            x, y = pushed.shift[0] / length, pushed.shift[1] / length
            rows.append(_Row(((i, x, y),), x * moves[i][0] + y * moves[i][1] + length))
        return rows

    def _sweep(self, rows: Sequence[_Row], duals: list[float], moves: list[Point]) -> bool:
        """Row actions until all rows hold, in place; False when they do not come to hold."""
        work = [[x, y] for x, y in moves]
        scale = [sum(self.bodies[i].give * (x * x + y * y) for i, x, y in row.terms) for row in rows]
        worst = math.inf
        for _ in range(SWEEPS):
            worst = 0.0
            for k, row in enumerate(rows):
                lack = row.least - sum(x * work[i][0] + y * work[i][1] for i, x, y in row.terms)
                if scale[k] <= 0:
                    if lack > TOUCH:
                        return False
                    continue
                step = lack / scale[k]
                if not row.equal:
                    step = max(step, -duals[k])
                if step == 0.0:
                    continue
                duals[k] += step
                for i, x, y in row.terms:
                    work[i][0] += step * self.bodies[i].give * x
                    work[i][1] += step * self.bodies[i].give * y
                worst = max(worst, abs(step) * scale[k])
            if worst < TOUCH / 20:
                break
        moves[:] = [(x, y) for x, y in work]
        return worst < 10 * TOUCH


def _pair_row(i: int, a: Rect, j: int, b: Rect, side: Point) -> _Row:
    x, y = side
    reach = support(a, side) + support(b, side) + MARGIN
    return _Row(((i, x, y), (j, -x, -y)), reach - (x * (a.x - b.x) + y * (a.y - b.y)))


def _unit(angle: float) -> Point:
    quarter = angle / 90.0
    if quarter == round(quarter):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarter) % 4]
    return math.cos(math.radians(angle)), math.sin(math.radians(angle))
