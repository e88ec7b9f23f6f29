"""The room itself: boards, walls with their openings, baseboards, door and window."""

from __future__ import annotations

import numpy as np
from description import DOOR, DOOR_OPEN_DEGREES, ROOM_SIZE, WALL_THICKNESS, WINDOW, Opening
from shapes import Part, box, grid_faces, lathe, tube

W, D, H = ROOM_SIZE
T = WALL_THICKNESS


def floor_boards() -> tuple[Part, np.ndarray]:
    """Boards along x in random lengths, bevelled joints between them; and the tone 0..1 of each vertex's board."""
    rng = np.random.default_rng(7)
    parts: list[Part] = []
    tones: list[np.ndarray] = []
    breadth, gap = 0.130, 0.0008
    low_y, high_y = -D / 2 - T - 0.01, D / 2 + 0.01
    for y in np.arange(low_y, high_y, breadth):
        x = -W / 2 - 0.02 - rng.uniform(0, 1.2)
        while x < W / 2 + 0.02:
            length = rng.uniform(0.9, 1.9)
            a, b = max(x, -W / 2 - 0.02), min(x + length, W / 2 + 0.02)
            x += length
            if b - a < 0.01:
                continue
            c, d = y, min(y + breadth, high_y)
            e = 0.0018
            ring = [
                (a + gap / 2, b - gap / 2, c + gap / 2, d - gap / 2, -0.002),
                (a + gap / 2 + e, b - gap / 2 - e, c + gap / 2 + e, d - gap / 2 - e, 0.0),
            ]
            verts = np.array(
                [[px, py, z] for x0, x1, y0, y1, z in ring for px, py in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
            )
            faces = [(4, 5, 6, 7), *[(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]]
            shift = rng.uniform(0, 40, 2)
            parts.append(Part(verts, faces, "floor", False, uv=verts[:, :2] - [a, c] + shift))
            tones.append(np.full(8, rng.beta(2.2, 2.2)))
    start, faces = 0, []
    for p in parts:
        faces += [tuple(i + start for i in f) for f in p.faces]
        start += 8
    boards = Part(
        np.vstack([p.verts for p in parts]),
        faces,
        "floor",
        False,
        uv=np.vstack([p.uv for p in parts if p.uv is not None]),
        name="boards",
    )
    return boards, np.concatenate(tones)


def rectangle(
    a: tuple[float, float, float], b: tuple[float, float, float], c: tuple[float, float, float], material: str
) -> Part:
    """The rectangle with corners a, b, c, a + c - b."""
    p = np.array([a, b, c], float)
    return Part(np.vstack([p, p[0] + p[2] - p[1]]), [(0, 1, 2, 3)], material, False)


def wall_face(
    start: tuple[float, float], end: tuple[float, float], opening: Opening | None, material: str
) -> list[Part]:
    """The inner face of a wall from start to end, with a hole, and the hole's reveals."""
    s, e = np.array(start), np.array(end)
    along = (e - s) / np.linalg.norm(e - s)
    out = np.array([along[1], -along[0]])
    length = float(np.linalg.norm(e - s))

    def at(t: float, z: float, depth: float = 0.0) -> tuple[float, float, float]:
        p = s + along * t + out * depth
        return (float(p[0]), float(p[1]), z)

    if opening is None:
        return [rectangle(at(0, 0), at(length, 0), at(length, H), material)]
    t0, t1 = sorted(float((np.array(p) - s) @ along) for p in (opening.start, opening.end))
    z0, z1 = opening.sill, opening.sill + opening.height
    pieces = [(0, t0, 0, H), (t1, length, 0, H), (t0, t1, z1, H)] + ([(t0, t1, 0, z0)] if z0 > 0 else [])
    parts = [rectangle(at(a, c), at(b, c), at(b, d), material) for a, b, c, d in pieces]
    for t in (t0, t1):
        parts.append(rectangle(at(t, z0), at(t, z0, T), at(t, z1, T), "trim"))
    for z in (z0, z1) if z0 > 0 else (z1,):
        parts.append(rectangle(at(t0, z), at(t1, z), at(t1, z, T), "trim"))
    return parts


def walls() -> list[tuple[str, list[Part]]]:
    """(wall id, parts) with the inner faces seen from inside counter-clockwise, the baseboards and the outside."""
    x, y = W / 2, D / 2
    corners = {
        "wall_south": ((-x, -y), (x, -y)),
        "wall_east": ((x, -y), (x, y)),
        "wall_north": ((x, y), (-x, y)),
        "wall_west": ((-x, y), (-x, -y)),
    }
    holes = {DOOR.wall: DOOR, WINDOW.wall: WINDOW}
    out = []
    for name, (start, end) in corners.items():
        parts = wall_face(start, end, holes.get(name), "wall_accent" if name == "wall_west" else "wall")
        s, e = np.array(start), np.array(end)
        along = (e - s) / np.linalg.norm(e - s)
        normal = np.array([-along[1], along[0]])
        spans = [(0.0, float(np.linalg.norm(e - s)))]
        if name == DOOR.wall:
            spans = [(0.0, DOOR.start[0] - 0.06 + x), (DOOR.end[0] + 0.06 + x, spans[0][1])]
        for a, b in spans:
            middle = s + along * (a + b) / 2 + normal * 0.007
            size = np.abs(along) * (b - a) + np.abs(normal) * 0.014
            parts.append(box((*size, 0.09), (*middle, 0.045), "trim", 0.004))
        out.append((name, parts))
    return out


def wall_tops() -> Part:
    """The cut faces: a flat ring at the top of the walls, 0.2 mm above them."""
    z = H + 0.0002
    rings = [[(-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)] for x, y in ((W / 2, D / 2), (W / 2 + T, D / 2 + T))]
    return Part(
        np.array(rings[0] + rings[1]), [f[::-1] for f in grid_faces(2, 4, close_v=True)], "cut", False, name="wall_tops"
    )


def outside() -> list[Part]:
    """Opaque outer faces, so that light comes in by the openings only."""
    x, y = W / 2 + T, D / 2 + T
    corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
    parts: list[Part] = []
    for i, (name, hole) in enumerate((("s", DOOR), ("e", None), ("n", WINDOW), ("w", None))):
        start, end = np.array(corners[i]), np.array(corners[(i + 1) % 4])
        parts += wall_face(tuple(start), tuple(end), hole, "wall")[
            : 1 if hole is None else (3 if hole.sill == 0 else 4)
        ]
        parts[-1].name = name
    return parts


def architrave(opening: Opening, inward: float, width: float = 0.06) -> list[Part]:
    """Flat trim around an opening, on the inner face of a wall along x."""
    a, b = sorted((opening.start[0], opening.end[0]))
    y = opening.start[1] + inward * 0.008
    z0, z1 = opening.sill, opening.sill + opening.height
    tall = z1 - z0 + width
    parts = [box((width, 0.016, tall), (x, y, z0 + tall / 2), "trim", 0.004) for x in (a - width / 2, b + width / 2)]
    return [*parts, box((b - a, 0.016, width), ((a + b) / 2, y, z1 + width / 2), "trim", 0.004)]


def door() -> list[Part]:
    """A panelled leaf, hinged at the east end and ajar into the room, with lever handles."""
    wide = DOOR.end[0] - DOOR.start[0] - 0.01
    tall = DOOR.height - 0.012
    leaf = [box((wide, 0.040, tall), (-wide / 2, 0, 0.008 + tall / 2), "door", 0.004)]
    for z, height in ((0.52, 0.72), (1.45, 0.92)):
        for side in (-1, 1):
            for s in (-1, 1):
                leaf.append(
                    box((0.025, 0.012, height), (-wide / 2 + s * (wide / 2 - 0.13), side * 0.021, z), "door", 0.005)
                )
                leaf.append(
                    box((wide - 0.26, 0.012, 0.025), (-wide / 2, side * 0.021, z + s * height / 2), "door", 0.005)
                )
    for side in (-1, 1):
        plate = lathe([(0, 0), (0.026, 0), (0.024, 0.008), (0, 0.009)], "brass", segments=24).turned(-90 * side, "x")
        leaf.append(plate.moved(-wide + 0.07, side * 0.020, 1.02))
        y = side * 0.052
        leaf.append(
            tube(
                np.array(
                    [
                        [-wide + 0.07, side * 0.022, 1.02],
                        [-wide + 0.07, y, 1.02],
                        [-wide + 0.10, y, 1.02],
                        [-wide + 0.19, y, 1.02],
                    ]
                ),
                0.009,
                "brass",
                12,
            )
        )
    hinge = (DOOR.end[0] - 0.005, -D / 2 - 0.02, 0.0)
    return [p.turned(-DOOR_OPEN_DEGREES).moved(*hinge) for p in leaf] + architrave(DOOR, 1)


def window() -> list[Part]:
    """Two casements with glass, in the outer half of the reveal, and an inner sill board."""
    a, b = WINDOW.start[0], WINDOW.end[0]
    z0, z1 = WINDOW.sill, WINDOW.sill + WINDOW.height
    y = D / 2 + T - 0.04
    middle, bar = (a + b) / 2, 0.055
    parts = [box((b - a + 0.10, T + 0.03, 0.03), (middle, D / 2 + T / 2 - 0.02, z0 + 0.005), "trim", 0.008)]
    for x0, x1 in ((a, middle), (middle, b)):
        parts += [box((bar, 0.05, z1 - z0), (x, y, (z0 + z1) / 2), "trim", 0.006) for x in (x0 + bar / 2, x1 - bar / 2)]
        parts += [
            box((x1 - x0, 0.05, bar), ((x0 + x1) / 2, y, z), "trim", 0.006) for z in (z0 + bar / 2 + 0.02, z1 - bar / 2)
        ]
        parts.append(box((x1 - x0 - bar, 0.012, 0.022), ((x0 + x1) / 2, y, z0 + 0.62 * (z1 - z0)), "trim", 0.004))
    pane = rectangle((a, y, z0), (b, y, z0), (b, y, z1), "glass")
    return [*parts, *architrave(WINDOW, -1, 0.05), pane]
