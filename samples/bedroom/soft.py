"""Bedding and other cloth of the sample: duvet, throw, pillows, curtains, rug."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from cloth import simulate, thicken
from shapes import Array, Part, box, fit, grid_faces, noise, rounded_rectangle, tube

MATTRESS_TOP = 0.53
MATTRESS = (1.62, 1.98)


def sheet(width: float, depth: float, nu: int, nv: int, material: str) -> Part:
    """A flat grid centred on the origin, with UV 0..1."""
    u, v = np.meshgrid(np.linspace(0, 1, nu), np.linspace(0, 1, nv), indexing="ij")
    uv = np.stack([u.ravel(), v.ravel()], 1)
    verts = np.column_stack([(uv[:, 0] - 0.5) * width, (uv[:, 1] - 0.5) * depth, np.zeros(len(uv))])
    return Part(verts, grid_faces(nu, nv), material, uv=uv)


def mattress() -> Part:
    return box((*MATTRESS, 0.25), (0, -0.03, MATTRESS_TOP - 0.125), "cotton", 0.06, 5, 8, name="mattress")


def bed_obstacles() -> list[Part]:
    """What the cloth falls on: the mattress, and the bed frame below it."""
    return [
        box((*MATTRESS, 0.27), (0, -0.03, MATTRESS_TOP - 0.135), "cotton", 0.07, 4, 12),
        box((1.66, 2.02, 0.24), (0, -0.03, 0.22), "cotton", 0.02, 2, 10),
    ]


@lru_cache(maxsize=1)
def duvet_surface() -> tuple[Array, int, int]:
    """The inner surface of the duvet on the bed: (nu * nv, 3) vertices and the grid's size. v = 1 is the head end."""
    nu, nv, width, depth = 96, 84, 2.06, 1.66
    flat = sheet(width, depth, nu, nv, "cotton")
    flat.moved(0, -0.43, MATTRESS_TOP + 0.05)
    # Uneven from the start, so that it settles into folds rather than into a flat board.
    flat.verts[:, 2] += 0.030 * noise(flat.verts, 3.2, 3, 2) + 0.02
    flat.verts[:, 0] += 0.020 * noise(flat.verts, 2.5, 8)
    verts = simulate(flat, bed_obstacles(), 46, shrink=-0.045, bending=0.35, stiffness=9.0)
    # Where it flares out at the corners it is tucked in, to hang close to the frame.
    for axis, limit in ((0, 0.84), (1, 1.05)):
        over = (np.abs(verts[:, axis]) - limit).clip(0)
        verts[:, axis] -= np.sign(verts[:, axis]) * 0.7 * over
    return verts, nu, nv


def creased(verts: Array) -> Array:
    """The duvet's surface with soft creases, mostly along its length, and quilting swells between them."""
    bent = verts + 0.10 * np.column_stack([noise(verts, 3.0, 21), noise(verts, 3.0, 22), np.zeros(len(verts))])
    stretched = bent * np.array([1.0, 0.45, 1.0])
    ridge = (1 - np.abs(noise(stretched, 5.5, 31))) ** 4 - 0.35
    fine = (1 - np.abs(noise(bent * np.array([0.6, 1.0, 1.0]), 9.0, 32))) ** 5 - 0.25
    out = verts.copy()
    out[:, 2] += 0.034 * ridge + 0.013 * fine + 0.014 * noise(verts, 2.2, 33)
    return out


def duvet() -> list[Part]:
    """Duvet with its top edge turned down."""
    verts, nu, nv = duvet_surface()
    flat = sheet(1, 1, nu, nv, "cotton")
    body = thicken(Part(creased(verts), flat.faces, "cotton", uv=flat.uv, name="duvet"), 0.035)
    keep = int(nv * 0.80)
    fold = creased(verts).reshape(nu, nv, 3)[:, keep:].copy()
    fold[..., 2] += 0.040
    fold[..., 1] += 0.018 * noise(fold.reshape(-1, 3) * [1, 0, 0], 3.0, 41).reshape(nu, -1)
    side = np.abs(fold[..., 0]).clip(0.78, None) - 0.78
    fold[..., 0] += np.sign(fold[..., 0]) * (side > 0) * 0.012
    v = np.linspace(0, 1, nv - keep)
    # The front edge of the turn-down comes down to the duvet in a round roll.
    fold[..., 2] -= 0.028 * np.exp(-v * 14)[None]
    m = nv - keep
    turned = Part(fold.reshape(-1, 3), grid_faces(nu, m), "duvet_fold", name="duvet_fold")
    return [body, thicken(turned, 0.03)]


def throw() -> list[Part]:
    """A knitted throw across the foot of the bed, simulated on the duvet. In the bed's local frame."""
    verts, nu, nv = duvet_surface()
    inner = sheet(1, 1, nu, nv, "cotton")
    under = thicken(Part(creased(verts), inner.faces, "cotton"), 0.04, smooth=0)
    flat = sheet(2.22, 0.50, 100, 26, "terracotta").turned(-2.5)
    flat.moved(0.01, -0.58, 0.0)
    # Laid down by hand: its edges wander and it is gathered here and there.
    flat.verts[:, 1] += 0.035 * noise(flat.verts * [1, 0.4, 1], 2.4, 12) + 0.012 * noise(flat.verts, 7.0, 13)
    gather = 0.020 * (1 - np.abs(noise(flat.verts * [1, 0.25, 1], 7.0, 14))) ** 3
    flat.verts[:, 2] = verts[:, 2].max() + 0.09 + gather
    settled = simulate(flat, [under, *bed_obstacles()], 40, bending=0.25, stiffness=9.0, distance=0.008)
    part = thicken(Part(settled, flat.faces, "terracotta", uv=flat.uv, name="throw"), 0.012)
    return [part]


@lru_cache(maxsize=4)
def inflated(width: float, depth: float, seed: int) -> tuple[Array, tuple[tuple[int, ...], ...]]:
    """A pillow blown up from two flat sheets, wrinkled at its seams; lies flat, centred on the origin."""
    n = (40, 30)
    one = sheet(width, depth, *n, "pillowcase")
    border = (one.uv == 0).any(1) | (one.uv == 1).any(1)
    inner = np.flatnonzero(~border)
    index = np.arange(len(one.verts))
    index[inner] = len(one.verts) + np.arange(len(inner))
    verts = np.vstack([one.verts, one.verts[inner]])
    # Rounded corners and slightly bowed edges: a square sheet would blow up into a star.
    q = verts[:, :2] / (np.array([width, depth]) / 2)
    verts[:, :2] *= 1 + 0.10 * (1 - q[:, ::-1] ** 2) - 0.075 * (np.abs(q[:, :1] * q[:, 1:]) ** 3)
    verts[:, 2] += 0.004 * noise(verts, 9.0, seed)
    verts[len(one.verts) :, 2] -= 0.012
    verts[inner, 2] += 0.012
    faces = list(one.faces) + [tuple(int(index[i]) for i in f[::-1]) for f in one.faces]
    settled = simulate(
        Part(verts, faces, "pillowcase"), [], 26, pressure=1.6, gravity=0.0, bending=0.3, stiffness=14.0, shrink=-0.03
    )
    return settled, tuple(faces)


def pillow(
    size: tuple[float, float, float], seed: int = 1, material: str = "pillowcase", lean: float = 13.0
) -> list[Part]:
    """A sleeping pillow leaning a little against the headboard."""
    verts, faces = inflated(size[0] + 0.06, size[1] + 0.06, seed)
    part = Part(verts.copy(), [tuple(f) for f in faces], material, name="pillow")
    low, high = part.verts.min(0), part.verts.max(0)
    part.verts = (part.verts - (low + high) / 2) * np.array(
        [size[0] / (high - low)[0], size[1] / (high - low)[1], 0.15 / (high - low)[2]]
    )
    # A dent where a head has been.
    part.verts[:, 2] -= (
        0.012 * np.exp(-((part.verts[:, 0] / 0.16) ** 2 + (part.verts[:, 1] / 0.12) ** 2)) * (part.verts[:, 2] > 0)
    )
    return fit([part.turned(lean, "x")], size, 0.35)


def curtain(size: tuple[float, float, float], seed: int = 1) -> list[Part]:
    """A pleated curtain, pleats regular at the top and looser below, hanging from a short ceiling track."""
    width, depth, height = size
    nu, nv = 150, 40
    part = sheet(1, 1, nu, nv, "curtain")
    u, down = part.uv[:, 0], 1 - part.uv[:, 1]
    pleats = 7.5
    wander = 0.35 * noise(np.column_stack([u * 2, down * 1.5, u * 0]), 1.3, seed)
    phase = 2 * np.pi * (pleats * u + down * wander)
    loose = 0.72 + 0.28 * noise(np.column_stack([u * 7, down * 2, u * 0]), 1.0, seed + 3) * down
    swing = np.sin(phase) * loose
    x = (u - 0.5) * width * (0.90 + 0.10 * down**2) + 0.010 * np.sin(2 * phase) * down
    part.verts = np.column_stack([x, swing * depth / 2 * 0.9, part.uv[:, 1] * (height - 0.02)])
    track = box((width * 0.92, 0.03, 0.02), (0, 0, height - 0.01), "trim", 0.004, name="track")
    cloth = thicken(part, 0.003, smooth=0)
    cloth.name = "curtain"
    return fit([cloth, track], size, 0.2)


def rug(size: tuple[float, float, float]) -> list[Part]:
    """A rug: the pile with an uneven edge, on a backing."""
    width, depth, height = size
    part = sheet(width, depth, 90, 100, "rug")
    lift = 0.0025 * (1 + noise(part.verts, 5.0, 4, 2))
    rim = np.minimum(
        np.minimum(part.uv[:, 0], 1 - part.uv[:, 0]) * width, np.minimum(part.uv[:, 1], 1 - part.uv[:, 1]) * depth
    )
    part.verts[:, 2] = height - 0.006 + lift - 0.006 * np.exp(-rim / 0.006)
    part.name = "pile"
    return fit([part, box((width, depth, 0.006), (0, 0, 0.003), "rug_side", 0.003, name="backing")], size, 0.3)


def piping(width: float, depth: float, z: float, radius: float, material: str) -> Part:
    """A cord around a seat pad with rounded corners."""
    outline = rounded_rectangle(width, depth, 0.05, 8)
    return tube(np.column_stack([outline, np.full(len(outline), z)]), radius, material, 8, closed=True)
