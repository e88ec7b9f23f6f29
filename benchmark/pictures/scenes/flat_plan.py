# SPDX-License-Identifier: GPL-3.0-or-later
"""A living and dining room with one corner cut off, as an architect draws it."""

from __future__ import annotations

import math

from code_as_room.pipeline.geometry.camera import camera_from

from ..model import Furnishing, Look, Opening, Scene

FLOOR = ((-3.4, -2.6), (3.4, -2.6), (3.4, 0.9), (1.5, 2.6), (-3.4, 2.6))
IMAGE = (1240, 1000)
PIXELS_A_METRE = 146.0


def scene() -> Scene:
    """The plan."""
    f = Furnishing()
    _living(f)
    _dining(f)
    _music(f)
    return Scene(
        id="flat_plan",
        room_type="living and dining room",
        floor=FLOOR,
        height=2.7,
        thickness=0.22,
        camera=camera_from("orthographic", (-0.2, -0.14, 12.0), _DOWN, PIXELS_A_METRE, IMAGE),
        items=f.all(),
        openings=(
            Opening("door", "door", 0, 0.45, 1.33, 2.05, hinge="start", degrees=90),
            Opening("window_east", "window", 1, 1.95, 3.1, 1.4, sill=0.9),
            Opening("window_corner", "window", 2, 0.45, 2.1, 1.6, sill=0.7),
            Opening("window_north", "window", 3, 1.2, 3.0, 1.4, sill=0.9),
            Opening("passage", "opening", 4, 2.4, 3.4, 2.1),
        ),
        look=Look(floor="plain:#ffffff"),
        zones=(
            ("living", "sofa", ("sofa", "armchair_north", "armchair_east", "coffee_table", "rug", "tv_stand", "tv")),
            ("dining", "table", ("table", "chair_1", "chair_2", "chair_3", "chair_4")),
            ("music and reading", "piano", ("piano", "piano_stool", "bookcase_1", "bookcase_2", "reading_chair")),
        ),
        plan=True,
    )


_DOWN = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def _living(f: Furnishing) -> None:
    f.put("rug", "rug", "rug", (-1.75, 0.92), (2.8, 1.9, 0.01), 0, symmetry=2, label="rug with fringes")
    f.major("sofa", "sofa", "sofa", (-1.75, -0.55), (2.2, 0.92, 0.8), 180, label="three-seater sofa")
    f.on("sofa", "cushion_west", "cushion", "cushion", (0.68, 0.05), (0.42, 0.4, 0.3), 12, base=0.45, symmetry=2)
    f.on("sofa", "cushion_east", "cushion", "cushion", (-0.66, 0.04), (0.4, 0.38, 0.3), -14, base=0.45, symmetry=2)
    f.major("coffee_table", "coffee table", "coffee_table", (-1.75, 0.88), (1.1, 0.6, 0.42), 0, symmetry=2)
    f.on("coffee_table", "books", "books", "books", (0.28, 0.06), (0.3, 0.22, 0.06), 18, base=0.42, symmetry=2)
    f.on("coffee_table", "bowl", "bowl", "vase", (-0.32, 0.02), (0.24, 0.24, 0.1), base=0.42, symmetry=0, shape="round")
    f.major("armchair_east", "armchair", "armchair", (0.08, 1.28), (0.8, 0.82, 0.8), -66)
    f.major("tv_stand", "tv stand", "sideboard", (-2.45, 2.38), (1.5, 0.4, 0.5), 0)
    f.on("tv_stand", "tv", "television", "television", (0, 0), (1.15, 0.2, 0.7), 0, base=0.5)
    f.put(
        "plant_west",
        "potted plant",
        "plant",
        (-3.02, -1.28),
        (0.6, 0.6, 1.3),
        salience="major",
        symmetry=0,
        shape="round",
    )
    f.major("side_table", "side table", "round_table", (-0.28, -0.5), (0.46, 0.46, 0.5), symmetry=0, shape="round")
    f.on("side_table", "lamp", "table lamp", "lamp", (0.0, 0.0), (0.3, 0.3, 0.5), base=0.5, symmetry=0, shape="round")
    f.major("armchair_north", "armchair", "armchair", (-3.0, 1.12), (0.72, 0.76, 0.8), 82)


def _dining(f: Furnishing) -> None:
    x, y = 1.62, 0.78
    f.major("table", "round table", "round_table", (x, y), (1.25, 1.25, 0.75), symmetry=0, shape="round",
            label="round dining table")  # fmt: skip
    for number, angle in enumerate((12, 102, 192, 282), 1):
        t = math.radians(angle)
        at = (round(x + 0.78 * math.cos(t), 4), round(y + 0.78 * math.sin(t), 4))
        f.major(f"chair_{number}", "chair", "chair", at, (0.46, 0.5, 0.85), angle + 270, under="table")
    f.on("table", "vase", "vase", "vase", (0.05, -0.08), (0.22, 0.22, 0.3), base=0.75, symmetry=0, shape="round")
    f.put(
        "plant_corner",
        "potted plant",
        "plant",
        (1.16, 2.2),
        (0.52, 0.52, 1.0),
        salience="major",
        symmetry=0,
        shape="round",
    )


def _music(f: Furnishing) -> None:
    f.major("sideboard", "sideboard", "sideboard", (-0.78, -2.37), (1.6, 0.44, 0.8), 180)
    f.on(
        "sideboard",
        "sideboard_lamp",
        "table lamp",
        "lamp",
        (0.58, 0),
        (0.32, 0.32, 0.5),
        base=0.8,
        symmetry=0,
        shape="round",
    )
    f.major("piano", "piano", "piano", (1.1, -2.28), (1.5, 0.62, 1.2), 180, label="upright piano")
    f.major("piano_stool", "piano stool", "stool", (1.06, -1.62), (0.56, 0.36, 0.5), 4, symmetry=2)
    f.major("bookcase_1", "bookcase", "bookcase", (3.22, -2.12), (0.9, 0.34, 2.0), -90)
    f.major("bookcase_2", "bookcase", "bookcase", (3.22, -1.2), (0.9, 0.34, 2.0), -90)
    f.major("reading_chair", "armchair", "armchair", (2.38, -1.12), (0.78, 0.8, 0.85), -148)
    f.put(
        "floor_lamp",
        "floor lamp",
        "lamp",
        (2.92, -0.42),
        (0.42, 0.42, 1.6),
        salience="minor",
        symmetry=0,
        shape="round",
    )
