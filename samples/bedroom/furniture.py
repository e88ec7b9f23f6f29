"""The pieces of furniture of the sample. Each function takes the box's size and returns parts in the local frame:
x and y around the middle of the footprint, z from 0 to the height, front towards -y."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import soft
from shapes import (
    Array,
    Part,
    box,
    cushion,
    fit,
    lathe,
    leg,
    noise,
    rounded_rectangle,
    smooth_profile,
    sweep_profile,
    tube,
)

Size = tuple[float, float, float]


def bed(size: Size) -> list[Part]:
    """Oak frame, channelled upholstered headboard, mattress and duvet."""
    w, d, h = size
    back = d / 2
    parts = [soft.mattress(), *soft.duvet()]
    parts += [box((1.68, 0.05, 0.20), (0, -1.02, 0.24), "oak_x", 0.008)]
    parts += [box((0.05, 2.05, 0.20), (s * 0.815, 0.0, 0.24), "oak_y", 0.008) for s in (-1, 1)]
    parts += [box((1.60, 2.0, 0.03), (0, 0, 0.26), "oak_y")]
    parts += [
        leg((sx * 0.74, y, 0.16), (sx * 0.76, y, 0.0), 0.032, 0.024, "oak_z") for sx in (-1, 1) for y in (-0.92, 0.9)
    ]
    board = 1.74
    channels = 9
    step = board / channels
    for i in range(channels):
        x = -board / 2 + step * (i + 0.5)
        panel = box((step, 0.075, h - 0.18), (x, back - 0.075, 0.18 + (h - 0.18) / 2), "headboard", 0.034, 5, (4, 1, 8))
        parts.append(panel)
    parts.append(box((board, 0.04, h - 0.20), (0, back - 0.02, (h - 0.20) / 2 + 0.10), "headboard", 0.015))
    return fit(parts, size, 0.06)


def drawer_front(width: float, height: float, centre: tuple[float, float, float], material: str) -> list[Part]:
    """A drawer front facing -y, with a small round knob."""
    x, y, z = centre
    knob = (
        lathe(
            [(0, 0), (0.006, 0), (0.006, 0.012), (0.014, 0.016), (0.015, 0.022), (0.010, 0.027), (0, 0.028)],
            "brass",
            segments=20,
        )
        .turned(90, "x")
        .moved(x, y - 0.009, z)
    )
    return [box((width, 0.018, height), centre, material, 0.004), knob]


def nightstand(size: Size) -> list[Part]:
    w, d, h = size
    body_d = d - 0.037
    y = (d - body_d) / 2
    parts = [
        box((w, body_d + 0.008, 0.024), (0, y - 0.004, h - 0.012), "oak_x", 0.006),
        box((w - 0.02, body_d, 0.32), (0, y, h - 0.024 - 0.16), "oak_x", 0.006),
    ]
    for z in (h - 0.105, h - 0.262):
        parts += drawer_front(w - 0.05, 0.148, (0, -d / 2 + 0.028, z), "oak_x")
    for sx in (-1, 1):
        for sy in (-1, 1):
            parts.append(
                leg(
                    (sx * (w / 2 - 0.05), y + sy * (body_d / 2 - 0.05), 0.165),
                    (sx * (w / 2 - 0.035), y + sy * (body_d / 2 - 0.035), 0),
                    0.019,
                    0.011,
                    "oak_z",
                )
            )
    return fit(parts, size)


def bench(size: Size) -> list[Part]:
    w, d, h = size
    parts = [
        cushion((w - 0.012, d - 0.012, 0.10), (0, 0, h - 0.065), "bench", 0.035, 0.016, 4, 20),
        soft.piping(w - 0.03, d - 0.03, h - 0.035, 0.006, "bench"),
        soft.piping(w - 0.03, d - 0.03, h - 0.105, 0.006, "bench"),
        box((w - 0.06, d - 0.06, 0.05), (0, 0, h - 0.14), "walnut_x", 0.006),
    ]
    for i in range(1, 5):  # stitched channels across the pad
        x = -w / 2 + w * i / 5
        parts.append(
            tube(
                np.array(
                    [
                        [x, -d / 2 + 0.02, h - 0.028],
                        [x, -0.1, h - 0.003],
                        [x, 0.1, h - 0.003],
                        [x, d / 2 - 0.02, h - 0.028],
                    ]
                ),
                0.004,
                "bench",
                8,
            )
        )
    for sx in (-1, 1):
        for sy in (-1, 1):
            parts.append(
                leg(
                    (sx * (w / 2 - 0.09), sy * (d / 2 - 0.07), h - 0.15),
                    (sx * (w / 2 - 0.05), sy * (d / 2 - 0.045), 0),
                    0.024,
                    0.014,
                    "walnut_z",
                )
            )
    return fit(parts, size)


def wardrobe(size: Size) -> list[Part]:
    w, d, h = size
    front = 0.05
    y = front / 2
    depth = d - front
    parts = [
        box((w, depth, h - 0.10), (0, y, 0.08 + (h - 0.10) / 2), "lacquer", 0.006),
        box((w - 0.06, depth - 0.04, 0.09), (0, y + 0.02, 0.045), "lacquer_dark", 0.004),
        box((w, depth + 0.026, 0.03), (0, y - 0.013, h - 0.015), "oak_x", 0.005),
    ]
    leaf = (w - 0.012) / 3
    for i in range(3):
        x = (i - 1) * leaf
        tall = h - 0.13
        parts.append(box((leaf - 0.008, 0.024, tall), (x, -d / 2 + front - 0.012, 0.09 + tall / 2), "lacquer", 0.004))
        for s in (-1, 1):  # a raised frame on each door
            parts.append(
                box(
                    (0.05, 0.010, tall - 0.06),
                    (x + s * (leaf / 2 - 0.055), -d / 2 + front - 0.027, 0.09 + tall / 2),
                    "lacquer",
                    0.004,
                )
            )
        for z in (0.15, tall + 0.03):
            parts.append(box((leaf - 0.06, 0.010, 0.05), (x, -d / 2 + front - 0.027, z), "lacquer", 0.004))
        side = -1 if i == 1 else (1 if i == 0 else -1)
        hx = x + side * (leaf / 2 - 0.055)
        parts.append(tube(np.array([[hx, -d / 2 + 0.008, 0.95], [hx, -d / 2 + 0.008, 1.35]]), 0.008, "brass", 12))
        parts += [
            tube(np.array([[hx, -d / 2 + 0.008, z], [hx, -d / 2 + 0.03, z]]), 0.006, "brass", 10) for z in (0.98, 1.32)
        ]
    return fit(parts, size)


def desk(size: Size) -> list[Part]:
    w, d, h = size
    parts = [
        box((w, d, 0.032), (0, 0, h - 0.016), "oak_x", 0.010, 4),
        box((w - 0.10, d - 0.08, 0.10), (0, 0.01, h - 0.032 - 0.05), "oak_x", 0.006),
    ]
    for x in (-0.37, 0.0, 0.37):
        parts += drawer_front(0.35, 0.085, (x, -d / 2 + 0.045, h - 0.083), "oak_x")
    for sx in (-1, 1):
        for sy in (-1, 1):
            parts.append(
                leg(
                    (sx * (w / 2 - 0.08), sy * (d / 2 - 0.08), h - 0.05),
                    (sx * (w / 2 - 0.03), sy * (d / 2 - 0.04), 0),
                    0.027,
                    0.015,
                    "oak_z",
                )
            )
    return fit(parts, size)


def chair(size: Size) -> list[Part]:
    """A wooden chair with a curved top rail and a seat pad."""
    w, d, h = size
    seat_z = 0.44
    parts = [
        box((w - 0.03, d - 0.08, 0.028), (0, -0.03, seat_z), "walnut_x", 0.012, 4),
        cushion((w - 0.07, d - 0.12, 0.045), (0, -0.035, seat_z + 0.032), "seat", 0.02, 0.012, 6, 10),
    ]
    for sx in (-1, 1):
        parts.append(
            leg(
                (sx * (w / 2 - 0.06), -d / 2 + 0.07, seat_z),
                (sx * (w / 2 - 0.02), -d / 2 + 0.02, 0),
                0.018,
                0.012,
                "walnut_z",
            )
        )
        parts.append(
            leg(
                (sx * (w / 2 - 0.06), d / 2 - 0.10, seat_z),
                (sx * (w / 2 - 0.03), d / 2 - 0.02, 0),
                0.018,
                0.012,
                "walnut_z",
            )
        )
        parts.append(
            leg((sx * 0.17, d / 2 - 0.045, h - 0.07), (sx * 0.17, d / 2 - 0.09, seat_z), 0.012, 0.014, "walnut_z")
        )
    a = np.radians(np.linspace(-62, 62, 30))
    path = np.column_stack(
        [
            np.sin(a) * (w / 2 - 0.012) / np.sin(np.radians(62)),
            d / 2 - 0.03 - 0.20 * (1 - np.cos(a)) / (1 - np.cos(np.radians(62))),
            np.full(30, h - 0.06),
        ]
    )
    profile = np.repeat(rounded_rectangle(0.026, 0.12, 0.012)[None], 30, 0)
    parts.append(sweep_profile(path, profile, "walnut_x"))
    return fit(parts, size)


def armchair(size: Size) -> list[Part]:
    """A tub chair: one curved back that runs out into the arms, a loose seat cushion and a small back cushion."""
    w, d, h = size
    ends = 1 - 0.07 * (1 - np.cos(np.linspace(0, np.pi / 2, 9)))  # closer rings where the arms round off
    t = np.concatenate([-ends, np.linspace(-0.92, 0.92, 64), ends[::-1]])
    n = len(t)
    a = np.radians(118) * t
    rx, ry = w / 2 - 0.075, d / 2 - 0.085
    path = np.column_stack([np.sin(a) * rx, np.cos(a) * ry + 0.0, np.zeros(n)])
    # Straighten the arms so that they run to the front.
    front = np.abs(a) > np.pi / 2
    path[front, 0] = np.sign(a[front]) * rx
    path[front, 1] = -np.abs(np.abs(a[front]) - np.pi / 2) * ry * 1.9
    top = 0.56 + (h - 0.56) * np.cos(np.clip(np.abs(t) * 1.25, 0, 1) * np.pi / 2) ** 1.1
    end = np.clip((1 - np.abs(t)) / 0.07, 0.0, 1.0)
    profiles = []
    for k in range(n):
        tall, thick = (top[k] - 0.14), 0.13
        inset = 0.052 * (1 - np.sqrt(1 - (1 - end[k]) ** 2))
        outline = rounded_rectangle(thick - 2 * inset, tall - 2 * inset, 0.062, 7)
        outline[:, 1] += 0.14 + tall / 2
        lean = (outline[:, 1] - 0.14) / 0.62
        outline[:, 0] += 0.03 * lean * np.cos(t[k] * 1.2)
        profiles.append(outline)
    shell = sweep_profile(path, np.array(profiles), "velvet")
    shell.bent(lambda v: 0.004 * noise(v, 7.0, 2, 2)[:, None] * np.ones(3))
    inner_w = 2 * rx - 0.12
    seat = cushion((inner_w, d - 0.20, 0.16), (0, -0.07, 0.36), "velvet", 0.06, 0.035, 3, 16)
    base = box((inner_w + 0.04, d - 0.20, 0.16), (0, -0.04, 0.22), "velvet", 0.03, 4)
    lumbar = cushion((0.44, 0.13, 0.30), (0, 0, 0), "seat", 0.06, 0.0, 7, 10)
    lumbar.verts *= 1 - 0.12 * np.abs(lumbar.verts[:, :1] / 0.22) ** 2
    lumbar.turned(-20, "x").turned(7, "z").moved(0.02, d / 2 - 0.25, 0.57)
    parts = [shell, seat, base, lumbar]
    for sx in (-1, 1):
        for sy, y in ((-1, -d / 2 + 0.12), (1, d / 2 - 0.16)):
            parts.append(
                leg((sx * (w / 2 - 0.17), y, 0.16), (sx * (w / 2 - 0.14), y + sy * 0.03, 0), 0.02, 0.013, "walnut_z")
            )
    return fit(parts, size)


def drum_shade(top: float, bottom: float, low: float, high: float) -> list[Part]:
    """An open lamp shade with a thickness, its rings and a bulb with a warm glow."""
    t = 0.003
    wall = lathe([(bottom, low), (top, high), (top - t, high), (bottom - t, low), (bottom, low)], "shade", segments=64)
    middle = low + 0.5 * (high - low)
    bulb = lathe(
        [(0, -0.045), (0.012, -0.045), (0.014, -0.02), (0.03, 0.01), (0.032, 0.03), (0.02, 0.052), (0, 0.058)],
        "bulb",
        (0, 0, middle),
    )
    a = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    ring = tube(
        np.column_stack([np.cos(a) * (top - 0.002), np.sin(a) * (top - 0.002), np.full(48, high)]),
        0.003,
        "brass",
        8,
        closed=True,
    )
    arms = [
        tube(
            np.array([[0, 0, high - 0.03], [np.cos(b) * (top - 0.004), np.sin(b) * (top - 0.004), high - 0.005]]),
            0.002,
            "brass",
            6,
        )
        for b in np.radians([30, 150, 270])
    ]
    stem = tube(np.array([[0, 0, low - 0.04], [0, 0, middle - 0.04]]), 0.008, "brass")
    wall.name, bulb.name = "shade", "bulb"
    return [wall, bulb, ring, *arms, stem]


def table_lamp(size: Size) -> list[Part]:
    w, _, h = size
    profile = smooth_profile(
        [(0.055, 0.0), (0.072, 0.012), (0.085, 0.06), (0.088, 0.10), (0.066, 0.155), (0.026, 0.195), (0.018, 0.225)]
    )
    base = lathe([(0, 0), *profile, (0, 0.228)], "ceramic")
    return fit([base, *drum_shade(w / 2 * 0.80, w / 2, h - 0.205, h)], size)


def floor_lamp(size: Size) -> list[Part]:
    w, _, h = size
    base = lathe(
        [(0, 0), (0.145, 0), (0.15, 0.006), (0.15, 0.016), (0.14, 0.024), (0.02, 0.03), (0, 0.03)], "black_metal"
    )
    pole = tube(np.array([[0, 0, 0.02], [0, 0, h - 0.24]]), 0.011, "black_metal", 12)
    return fit([base, pole, *drum_shade(w / 2 * 0.84, w / 2, h - 0.26, h)], size)


def laptop(size: Size) -> list[Part]:
    w, d, h = size
    deep = 0.23
    y = -d / 2 + deep / 2
    parts = [
        box((w, deep, 0.014), (0, y, 0.007), "aluminium", 0.006),
        box((w - 0.05, 0.10, 0.002), (0, y + 0.035, 0.0145), "keys", 0.0008),
        box((0.11, 0.065, 0.001), (0, y - 0.065, 0.0145), "lacquer_dark", 0.0004),
    ]
    lid = [
        box((w, 0.007, 0.225), (0, 0, 0.1125), "aluminium", 0.0034),
        box((w - 0.012, 0.002, 0.205), (0, -0.004, 0.114), "keys", 0.0008),
        box((w - 0.026, 0.002, 0.185), (0, -0.005, 0.116), "screen", 0.0008),
    ]
    parts += [p.turned(-22, "x").moved(0, y + deep / 2 - 0.006, 0.012) for p in lid]
    return fit(parts, size)


def vase(size: Size) -> list[Part]:
    """A bulbous vase with a few eucalyptus branches."""
    w, d, h = size
    outside = smooth_profile(
        [(0.035, 0.0), (0.062, 0.03), (0.075, 0.08), (0.06, 0.135), (0.03, 0.17), (0.026, 0.19), (0.033, 0.21)]
    )
    inside = [(r - 0.004, z) for r, z in reversed(outside[len(outside) // 2 :])]
    parts: list[Part] = [lathe([(0, 0), *outside, *inside], "ceramic_blue")]
    rng = np.random.default_rng(11)
    for k in range(7):
        angle = 2 * np.pi * (k + rng.uniform(-0.3, 0.3)) / 7
        reach, rise = rng.uniform(0.10, 0.17), rng.uniform(0.16, 0.26)
        s = np.linspace(0, 1, 14)
        path = np.column_stack([np.cos(angle) * reach * s**1.6, np.sin(angle) * reach * s**1.6, 0.16 + rise * s])
        parts.append(tube(path, 0.002, "bark", 6))
        for i in range(3, 14):
            for side in (-1, 1):
                turn = np.degrees(angle) + side * 75
                disc = leaf_shape(0.044 - 0.0012 * i, 0.036 - 0.001 * i, 0.15, "eucalyptus", 6, 4)
                parts.append(disc.turned(-18, "y").turned(turn).moved(*path[i]))
    return fit(parts, size, 0.35)


def leaf_shape(length: float, width: float, droop: float, material: str, nu: int = 12, nv: int = 7) -> Part:
    """One leaf from the origin along +x: folded at its rib and drooping."""
    sheet = soft.sheet(1, 1, nu, nv, material)
    u, v = sheet.uv[:, 0], sheet.uv[:, 1] * 2 - 1
    outline = np.sin(np.pi * u**0.85) ** 0.75 * (0.80 + 0.2 * u)
    x = length * u
    y = width / 2 * v * outline
    z = (
        0.22 * width * np.abs(v) * outline
        + length * (0.25 * u - droop * 2.2 * u**2)
        + 0.03 * length * np.sin(9 * u) * v**2
    )
    sheet.verts = np.column_stack([x, y, z])
    return sheet


def plant(size: Size) -> list[Part]:
    """A fiddle-leaf fig: three stems with broad leaves in a spiral, in a clay pot with earth."""
    w, d, h = size
    pot = lathe(
        [
            (0, 0),
            (0.115, 0),
            (0.12, 0.01),
            (0.155, 0.25),
            (0.17, 0.255),
            (0.17, 0.29),
            (0.158, 0.292),
            (0.15, 0.25),
            (0, 0.25),
        ],
        "clay",
        segments=56,
    )
    soil = lathe([(0, 0.262), (0.08, 0.266), (0.153, 0.258), (0.153, 0.24)], "soil")
    parts = [pot, soil]
    rng = np.random.default_rng(4)
    for stem in range(3):
        a = np.radians(120 * stem + 20)
        tall = (0.66, 0.52, 0.42)[stem]
        s = np.linspace(0, 1, 12)
        path = np.column_stack([np.cos(a) * (0.03 + 0.09 * s), np.sin(a) * (0.03 + 0.09 * s), 0.25 + tall * s])
        parts.append(tube(path, 0.010 - 0.005 * s, "bark", 8))
        for k in range(11):
            at = 0.30 + 0.68 * k / 10
            point = [np.interp(at, s, path[:, i]) for i in range(3)]
            size_k = (0.27 - 0.011 * k) * rng.uniform(0.88, 1.1)
            tilt = -8 - 5.5 * k + rng.uniform(-6, 6)
            one = leaf_shape(size_k, size_k * 0.66, rng.uniform(0.10, 0.22), "leaf").turned(tilt, "y")
            parts.append(one.turned(137.5 * k + 70 * stem + rng.uniform(-12, 12)).moved(*point))
    return fit(parts, size, 0.30)


def framed(width: float, height: float, depth: float, face: str, material: str, bar: float) -> list[Part]:
    """A frame with a flat face and UV 0..1 on it, standing on z = 0, facing -y."""
    z = height / 2
    parts = [box((bar, depth, height), (s * (width - bar) / 2, 0, z), material, 0.004) for s in (-1, 1)]
    parts += [box((width - 2 * bar, depth, bar), (0, 0, z + s * (height - bar) / 2), material, 0.004) for s in (-1, 1)]
    pane = soft.sheet(width - 2 * bar, height - 2 * bar, 2, 2, face).turned(90, "x").moved(0, -depth / 2 + 0.012, z)
    return [*parts, pane]


def picture(size: Size) -> list[Part]:
    w, d, h = size
    parts = framed(w, h, d, "paper", "walnut_x", 0.025)
    art = soft.sheet(w - 0.20, h - 0.19, 2, 2, "print").turned(90, "x").moved(0, -d / 2 + 0.010, h / 2)
    parts += [art, box((w - 0.02, 0.006, h - 0.02), (0, d / 2 - 0.003, h / 2), "paper", 0.002)]
    return fit(parts, size)


def mirror(size: Size) -> list[Part]:
    """A full-length mirror with an arched top in a thin brass frame."""
    w, d, h = size
    r = w / 2
    a = np.linspace(0, np.pi, 40)
    outline: Array = np.vstack([[[-r, 0.0]], [[r, 0.0]], np.column_stack([np.cos(a) * r, h - r + np.sin(a) * r])])
    inner = outline.copy()
    inner[:, 0] *= (r - 0.018) / r
    inner[:, 1] = 0.018 + inner[:, 1] * (h - 0.036) / h
    m = len(outline)
    plate = Part(
        np.column_stack([inner[:, 0], np.full(m, -d / 2 + 0.010), inner[:, 1]]), [tuple(range(m))], "mirror", False
    )
    rings = np.stack(
        [
            np.column_stack([o[:, 0], np.full(m, y), o[:, 1]])
            for o, y in ((outline, d / 2), (outline, -d / 2), (inner, -d / 2), (inner, d / 2))
        ],
        1,
    )
    frame = [
        (i * 4 + j, i * 4 + (j + 1) % 4, ((i + 1) % m) * 4 + (j + 1) % 4, ((i + 1) % m) * 4 + j)
        for i in range(m)
        for j in range(4)
    ]
    return fit([plate, Part(rings.reshape(-1, 3), frame, "brass", False)], size)


MODELS: dict[str, Callable[..., list[Part]]] = {
    "bed": bed,
    "nightstand": nightstand,
    "bench": bench,
    "wardrobe": wardrobe,
    "desk": desk,
    "chair": chair,
    "armchair": armchair,
    "rug": soft.rug,
    "floor_lamp": floor_lamp,
    "table_lamp": table_lamp,
    "laptop": laptop,
    "vase": vase,
    "plant": plant,
    "picture": picture,
    "mirror": mirror,
    "pillow": soft.pillow,
    "curtain": soft.curtain,
}
