# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers for modelling: interpolation, repeatable randomness, noise; and list and dict helpers without attributes."""

from __future__ import annotations

import math
from typing import Any

from .checks import fail, is_number

MASK = (1 << 64) - 1


def lerp(a: Any, b: Any, t: Any) -> Any:
    """From a (t = 0) to b (t = 1): numbers or tuples."""
    if isinstance(a, (tuple, list)):
        if not isinstance(b, (tuple, list)) or len(a) != len(b):
            raise fail("lerp", "a and b must both be numbers or have the same length")
        return tuple(x + (y - x) * t for x, y in zip(a, b, strict=True))
    return a + (b - a) * t


def clamp(value: Any, low: Any = 0.0, high: Any = 1.0) -> Any:
    """Kept within low and high."""
    return low if value < low else high if value > high else value


def smoothstep(low: Any, high: Any, value: Any) -> float:
    """From 0 at low to 1 at high, smoothly."""
    if low == high:
        return 0.0 if value < low else 1.0
    t = (value - low) / (high - low)
    t = 0.0 if t < 0.0 else 1.0 if t > 1.0 else t
    return t * t * (3.0 - 2.0 * t)


def mixed(state: int) -> int:
    """One round of the splitmix64 mixer (Steele, Lea, Flood 2014): 64 well-stirred bits."""
    state = (state + 0x9E3779B97F4A7C15) & MASK
    state = ((state ^ (state >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    state = ((state ^ (state >> 27)) * 0x94D049BB133111EB) & MASK
    return state ^ (state >> 31)


def seed_bits(seed: Any) -> int:
    """64 bits from a number, a string or a tuple of them; equal numbers give equal bits (1 and 1.0)."""
    if isinstance(seed, (int, float)) and math.isfinite(seed):
        if seed == int(seed):
            return mixed(int(seed) & MASK)
        mantissa, exponent = math.frexp(seed)
        return mixed((int(mantissa * (1 << 53)) & MASK) ^ mixed(exponent & MASK))
    state = 0
    if isinstance(seed, str):
        for code in seed.encode("utf-8", "surrogatepass"):
            state = mixed(state ^ code)
        return mixed(state ^ 0x5EED)
    if isinstance(seed, (tuple, list)):
        for item in seed:
            if isinstance(item, (tuple, list)):
                raise fail("rand", "the seed may be a tuple of numbers and texts, not of tuples")
            state = mixed(state ^ seed_bits(item))
        return mixed(state ^ len(seed))
    raise fail("rand", "the seed must be a number, a text or a tuple of them")


def rand(seed: Any, low: float = 0.0, high: float = 1.0) -> float:
    """The same for the same seed (number, text or tuple)."""
    if not (is_number(low) and is_number(high)):
        raise fail("rand", "low and high must be finite numbers")
    return low + (high - low) * ((seed_bits(seed) >> 11) / (1 << 53))


def permutation() -> tuple[int, ...]:
    """0..255 in a fixed random order, twice (Perlin's table)."""
    order = list(range(256))
    for i in range(255, 0, -1):
        j = mixed(i) % (i + 1)
        order[i], order[j] = order[j], order[i]
    return tuple(order + order)


ORDER = permutation()
ANGLES = tuple(math.pi * (i + 0.5) / 8 for i in range(256))
DIRECTIONS_2 = tuple((1.4 * math.cos(angle), 1.4 * math.sin(angle)) for angle in ANGLES)
EDGES = [(a, b, 0) for a in (1, -1) for b in (1, -1)]
EDGES += [(a, 0, b) for a in (1, -1) for b in (1, -1)] + [(0, a, b) for a in (1, -1) for b in (1, -1)]
DIRECTIONS_3 = tuple((EDGES + EDGES[:4]) * 16)


def noise(x: Any, y: Any = 0.0, z: Any = None, seed: Any = 0) -> float:
    """Smooth noise, about -1..1, features one unit wide.

    Gradient noise, 0 where all coordinates are whole numbers. Source: K. Perlin, "Improving Noise", SIGGRAPH 2002.
    """
    if seed:
        shift = seed_bits(seed)
        x, y = x + (shift & 255) + 0.37, y + ((shift >> 8) & 255) + 0.71
    i, j = math.floor(x), math.floor(y)
    u, v = x - i, y - j
    i, j = i & 255, j & 255
    s, t = u * u * u * (u * (u * 6 - 15) + 10), v * v * v * (v * (v * 6 - 15) + 10)
    left, right = ORDER[i], ORDER[i + 1]
    if z is not None:
        return noise_3(u, v, s, t, left, right, j, z)
    a, b = DIRECTIONS_2[ORDER[left + j]]
    c, d = DIRECTIONS_2[ORDER[right + j]]
    low = a * u + b * v
    low += s * (c * (u - 1) + d * v - low)
    a, b = DIRECTIONS_2[ORDER[left + j + 1]]
    c, d = DIRECTIONS_2[ORDER[right + j + 1]]
    high = a * u + b * (v - 1)
    high += s * (c * (u - 1) + d * (v - 1) - high)
    result: float = low + t * (high - low)
    return result


def noise_3(u: float, v: float, s: float, t: float, left: int, right: int, j: int, z: float) -> float:
    """The eight corners of three-dimensional noise; arguments as `noise` names them."""
    k = math.floor(z)
    w = z - k
    k &= 255
    corners = []
    for row in (j, j + 1):
        for column, across in ((left, u), (right, u - 1)):
            hashed = ORDER[column + row] + k
            up = v if row == j else v - 1
            a, b, c = DIRECTIONS_3[ORDER[hashed]]
            d, e, f = DIRECTIONS_3[ORDER[hashed + 1]]
            near = a * across + b * up + c * w
            corners.append((near, d * across + e * up + f * (w - 1) - near))
    r = w * w * w * (w * (w * 6 - 15) + 10)
    one, two, three, four = (near + r * step for near, step in corners)
    low, high = one + s * (two - one), three + s * (four - three)
    return low + t * (high - low)


def append(items: Any, value: Any) -> None:
    """Add to the end of a list."""
    if not isinstance(items, list):
        raise fail("append", "the first argument must be a list")
    items.append(value)


def keys(table: Any) -> list[Any]:
    """The keys of a dict, as a list."""
    return list(dict_of("keys", table))


def values(table: Any) -> list[Any]:
    """The values of a dict, as a list."""
    return list(dict_of("values", table).values())


def items(table: Any) -> list[tuple[Any, Any]]:
    """The (key, value) pairs of a dict, as a list."""
    return list(dict_of("items", table).items())


def dict_of(where: str, table: Any) -> dict[Any, Any]:
    """The value if it is a dict. Raises ValueError otherwise."""
    if not isinstance(table, dict):
        raise fail(where, "the argument must be a dict")
    return table
