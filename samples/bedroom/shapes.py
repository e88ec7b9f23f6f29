"""Solids, sheets and sweeps as numpy meshes. Every function returns a `Part` in its object's local frame, in metres."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass
class Part:
    """A piece of an object: vertices (N, 3), faces as index tuples, a material name."""

    verts: Array
    faces: list[tuple[int, ...]]
    material: str
    smooth: bool = True
    uv: Array | None = None
    """(N, 2) texture coordinates a vertex, or None."""
    name: str = "part"

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Part:
        self.verts = self.verts + np.array([x, y, z])
        return self

    def turned(self, degrees: float, axis: str = "z") -> Part:
        self.verts = self.verts @ rotation(degrees, axis).T
        return self

    def scaled(self, x: float = 1.0, y: float = 1.0, z: float = 1.0) -> Part:
        self.verts = self.verts * np.array([x, y, z])
        return self

    def bent(self, offset: Callable[[Array], Array]) -> Part:
        """Adds `offset(verts)` (N, 3) to the vertices."""
        self.verts = self.verts + offset(self.verts)
        return self


def rotation(degrees: float, axis: str = "z") -> Array:
    """Rotation matrix, counter-clockwise about an axis."""
    a = np.radians(degrees)
    c, s = np.cos(a), np.sin(a)
    return np.array(
        {
            "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
            "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
            "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
        }[axis]
    )


def join(parts: Sequence[Part]) -> Part:
    """One part from several of the same material."""
    faces: list[tuple[int, ...]] = []
    start = 0
    for p in parts:
        faces += [tuple(i + start for i in f) for f in p.faces]
        start += len(p.verts)
    return Part(np.vstack([p.verts for p in parts]), faces, parts[0].material, parts[0].smooth, name=parts[0].name)


def grid_faces(nu: int, nv: int, close_u: bool = False, close_v: bool = False) -> list[tuple[int, ...]]:
    """Quads of an nu x nv grid of vertices stored row by row (u outer), normals along u x v."""
    quads = []
    for i in range(nu if close_u else nu - 1):
        for j in range(nv if close_v else nv - 1):
            a, b = i * nv + j, (i + 1) % nu * nv + j
            c, d = (i + 1) % nu * nv + (j + 1) % nv, i * nv + (j + 1) % nv
            quads.append((a, b, c, d))
    return quads


def noise(points: Array, scale: float, seed: int = 0, octaves: int = 1) -> Array:
    """Smooth value noise in -1..1 at points (N, 3)."""
    total, weight = np.zeros(len(points)), 0.0
    for octave in range(octaves):
        q = points * scale * 2**octave + 17.3 * octave
        cell = np.floor(q).astype(np.int64)
        f = q - cell
        f = f * f * (3 - 2 * f)
        value = np.zeros(len(points))
        for corner in np.ndindex(2, 2, 2):
            h = (cell + corner) @ np.array([374761393, 668265263, 2147483647]) + seed * 974634777
            h = (h ^ (h >> 13)) * 1274126177
            r = ((h ^ (h >> 16)) & 0xFFFF) / 32767.5 - 1
            value += r * np.prod(np.where(np.array(corner), f, 1 - f), axis=1)
        total += value * 0.5**octave
        weight += 0.5**octave
    return total / weight


def box_axis(half: float, radius: float, segments: int, inner: int) -> Array:
    bevel = radius * np.tan(np.linspace(0, np.pi / 4, segments + 1))
    flat = half - radius
    hold = min(0.002, flat * 0.2)
    middle = np.linspace(-flat + hold, flat - hold, inner + 1) if inner > 1 else np.array([-flat + hold, flat - hold])
    return np.concatenate([-(flat + bevel[::-1]), middle, flat + bevel])


def box(
    size: Sequence[float],
    centre: Sequence[float],
    material: str,
    radius: float = 0.004,
    segments: int = 3,
    inner: int | tuple[int, int, int] = 1,
    name: str = "part",
) -> Part:
    """A box with rounded edges. `inner` subdivides the flat middle along each axis, for later bending."""
    half = np.array(size, float) / 2
    radius = min(radius, 0.999 * float(half.min()))
    inner3 = (inner,) * 3 if isinstance(inner, int) else inner
    axes = [box_axis(h, radius, segments, n) for h, n in zip(half, inner3, strict=True)]
    points: list[Array] = []
    faces: list[tuple[int, ...]] = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        uu, vv = np.meshgrid(axes[u], axes[v], indexing="ij")
        for sign in (-1, 1):
            p = np.empty((uu.size, 3))
            p[:, u], p[:, v], p[:, axis] = uu.ravel(), vv.ravel(), sign * half[axis]
            start = sum(len(q) for q in points)
            for f in grid_faces(len(axes[u]), len(axes[v])):
                f = f if sign > 0 else f[::-1]
                faces.append(tuple(start + i for i in f))
            points.append(p)
    cube = np.vstack(points)
    _, first, index = np.unique(np.round(cube, 7), axis=0, return_index=True, return_inverse=True)
    cube = cube[first]
    index = index.ravel()
    core = np.clip(cube, -(half - radius), half - radius)
    away = cube - core
    length = np.linalg.norm(away, axis=1, keepdims=True)
    verts = core + radius * away / np.maximum(length, 1e-12) + np.array(centre, float)
    return Part(verts, [tuple(int(index[i]) for i in f) for f in faces], material, name=name)


def cushion(
    size: Sequence[float],
    centre: Sequence[float],
    material: str,
    radius: float = 0.05,
    crown: float = 0.03,
    seed: int = 0,
    inner: int = 14,
) -> Part:
    """A soft upholstered box: rounded, its top crowned, its surface a little uneven."""
    part = box(size, centre, material, radius, 5, (inner, inner, 3))
    c, h = np.array(centre, float), np.array(size, float) / 2

    def soften(v: Array) -> Array:
        q = (v - c) / h
        bulge = (1 - q[:, 0] ** 2).clip(0) ** 0.6 * (1 - q[:, 1] ** 2).clip(0) ** 0.6
        out = np.zeros_like(v)
        out[:, 2] = crown * bulge * np.where(q[:, 2] > 0, 1, 0.15) * np.abs(q[:, 2])
        side = 0.35 * crown * (1 - q[:, 2] ** 2).clip(0)
        out[:, :2] = side[:, None] * q[:, :2] ** 3
        return out + 0.10 * crown * noise(v, 9.0, seed, 2)[:, None] * np.sign(q)

    return part.bent(soften)


def lathe(
    profile: Sequence[tuple[float, float]], material: str, centre: Sequence[float] = (0, 0, 0), segments: int = 40
) -> Part:
    """A surface of revolution about z from (radius, height) pairs; radius 0 at an end closes it."""
    p = np.array(profile, float)
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], 1)
    verts = np.empty((segments, len(p), 3))
    verts[..., :2] = ring[:, None, :] * np.maximum(p[None, :, :1], 1e-5)
    verts[..., 2] = p[None, :, 1]
    return Part(verts.reshape(-1, 3) + np.array(centre, float), grid_faces(segments, len(p), close_u=True), material)


def smooth_profile(points: Sequence[tuple[float, float]], steps: int = 8) -> list[tuple[float, float]]:
    """A Catmull-Rom curve through 2D points."""
    p = np.array([points[0], *points, points[-1]], float)
    out = []
    for i in range(1, len(p) - 2):
        for t in np.linspace(0, 1, steps, endpoint=False):
            a, b, c, d = p[i - 1 : i + 3]
            out.append(
                0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
            )
    out.append(p[-2])
    return [(float(x), float(y)) for x, y in out]


def tube(path: Array, radius: float | Array, material: str, sides: int = 10, closed: bool = False) -> Part:
    """A round tube along a path (N, 3); `radius` is one number or one a point. Ends are closed by a fan to a point."""
    path = np.asarray(path, float)
    n = len(path)
    radii = np.broadcast_to(np.asarray(radius, float), (n,))
    tangent = np.roll(path, -1, 0) - np.roll(path, 1, 0) if closed else np.gradient(path, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    side = np.cross(tangent[0], [0, 0, 1] if abs(tangent[0][2]) < 0.9 else [1, 0, 0])
    rings = []
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    for point, t, r in zip(path, tangent, radii, strict=True):
        side = side - t * (side @ t)
        side /= np.linalg.norm(side)
        up = np.cross(t, side)
        rings.append(point + r * (np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * up))
    if not closed:
        rings = [np.repeat(path[:1], sides, 0), *rings, np.repeat(path[-1:], sides, 0)]
    faces = [f[::-1] for f in grid_faces(len(rings), sides, close_u=closed, close_v=True)]
    return Part(np.vstack(rings), faces, material)


def leg(top: Sequence[float], bottom: Sequence[float], r_top: float, r_bottom: float, material: str) -> Part:
    """A straight tapered round leg."""
    t = np.linspace(0, 1, 5)[:, None]
    path = np.array(top, float) * (1 - t) + np.array(bottom, float) * t
    return tube(path, r_top + (r_bottom - r_top) * t[:, 0], material, 14)


def sweep_profile(path: Array, profiles: Array, material: str) -> Part:
    """Closed profiles (N, M, 2: across, up) placed along a plan path (N, 3), ends capped: rails, curved backs."""
    path = np.asarray(path, float)
    tangent = np.gradient(path, axis=0)
    tangent[:, 2] = 0
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    across = np.cross(tangent, [0, 0, 1.0])
    rings = path[:, None] + profiles[..., :1] * across[:, None] + profiles[..., 1:] * np.array([0, 0, 1.0])
    n, m = profiles.shape[:2]
    faces = grid_faces(n, m, close_v=True)
    faces += [tuple(range(m))[::-1], tuple(range((n - 1) * m, n * m))]
    return Part(rings.reshape(-1, 3), faces, material)


def rounded_rectangle(width: float, height: float, radius: float, steps: int = 6) -> Array:
    """Outline (M, 2) of a rounded rectangle centred on the origin, counter-clockwise."""
    radius = min(radius, width / 2 - 1e-4, height / 2 - 1e-4)
    out = []
    for k, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        a = np.radians(90 * k) + np.linspace(0, np.pi / 2, steps)
        out.append(
            np.stack(
                [sx * (width / 2 - radius) + radius * np.cos(a), sy * (height / 2 - radius) + radius * np.sin(a)], 1
            )
        )
    return np.vstack(out)


def prism(outline: Array, low: float, high: float, material: str) -> Part:
    """A plan outline (M, 2) extruded from z = low to z = high."""
    m = len(outline)
    verts = np.vstack([np.column_stack([outline, np.full(m, z)]) for z in (low, high)])
    faces: list[tuple[int, ...]] = [(i, (i + 1) % m, m + (i + 1) % m, m + i) for i in range(m)]
    faces += [tuple(range(m))[::-1], tuple(range(m, 2 * m))]
    return Part(verts, faces, material, smooth=False)


def bounds(parts: Sequence[Part]) -> tuple[Array, Array]:
    """Lowest and highest corner of all parts."""
    v = np.vstack([p.verts for p in parts])
    return v.min(0), v.max(0)


def fit(parts: Sequence[Part], size: Sequence[float], tolerance: float = 0.12) -> list[Part]:
    """Stretches the parts a little so that they fill exactly x, y in -size/2..size/2 and z in 0..height.

    Raises ValueError if an axis would need more than `tolerance`: then the model and its stated size disagree.
    """
    low, high = bounds(parts)
    factor = np.array(size, float) / (high - low)
    if np.abs(factor - 1).max() > tolerance:
        raise ValueError(f"modelled {np.round(high - low, 3)} but stated {tuple(size)}")
    offset = np.array([-size[0] / 2, -size[1] / 2, 0.0])
    for p in parts:
        p.verts = (p.verts - low) * factor + offset
    return list(parts)
