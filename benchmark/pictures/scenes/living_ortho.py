# SPDX-License-Identifier: GPL-3.0-or-later
"""A living room without perspective, its furniture turned to odd angles."""

from __future__ import annotations

import math
from typing import Any

from code_as_room.pipeline.geometry.camera import camera_straight_down

from ..model import Furnishing, Item, Light, Look, Opening, Point, Scene

HEIGHT = 2.7
FLOOR = ((-3.3, -2.7), (3.3, -2.7), (3.3, 2.7), (-3.3, 2.7))
WALNUT = "wood:#4b3323:#7d583c"
TURN = 27.0


def scene() -> Scene:
    """The living room."""
    f = Furnishing()
    _seats(f)
    _table(f)
    _along_the_walls(f)
    return Scene(
        id="living_ortho",
        room_type="living room",
        floor=FLOOR,
        height=HEIGHT,
        camera=camera_straight_down("orthographic", 6.88, 5.68, (1200, 1000), margin=0.04, top=HEIGHT),
        items=f.all(),
        openings=(
            Opening("door", "door", 1, 0.4, 1.3, 2.05, hinge="end", degrees=80),
            Opening("window_north", "window", 2, 3.0, 5.0, 1.5, sill=0.75),
            Opening("terrace_door", "window", 3, 2.8, 4.2, 2.15, sill=0.05),
        ),
        look=LOOK,
        zones=(
            ("seating", "sofa", ("sofa", "coffee_table", "armchair", "rug", "pouf", "side_table", "floor_lamp")),
            ("dining", "table", ("table", "chair_1", "chair_2", "chair_3", "chair_4", "round_rug")),
            ("reading", "wing_chair", ("wing_chair", "bookcase_1", "bookcase_2")),
        ),
    )


LOOK = Look(
    floor="boards:#a99a86:#d3c6b2:0.2:1.9:90",
    wall="plain:#dfdcd5:0.85",
    cap="glow:#4b4a49:1.0",
    skirting="plain:#e9e6e0:0.5",
    lights=(
        Light("sun", (-5, 3.5, 7), 3.4, "#ffe9cf", 0.06),
        Light("area", (0.5, -0.5, 6.5), 260, "#fffaf2", 5.0),
    ),
    sky=("#eef2ff", 0.8),
    paper="#e4e4e2",
    exposure=0.05,
    samples=20,
    roles={"wood": WALNUT},
)


def _beside(item: Item, at: Point) -> Point:
    """A place in an item's own axes."""
    (place,) = item.to_room([at])
    return round(place[0], 4), round(place[1], 4)


def _seats(f: Furnishing) -> None:
    w, d, run, wing = 2.7, 1.65, 0.91, 1.0
    inner = (-w / 2 + wing, d / 2 - run)
    outline = ((-w / 2, -d / 2), (inner[0], -d / 2), inner, (w / 2, inner[1]), (w / 2, d / 2), (-w / 2, d / 2))
    f.put("rug", "rug", "banded_rug", (-1.22, 0.12), (2.9, 2.0, 0.014), TURN, symmetry=2, label="dark blue rug with a border",
          colours={"rug": "cloth:#2f4156:#4b627b", "rug line": "cloth:#c3b594:#ddd1b5"})  # fmt: skip
    sofa = f.major("sofa", "l-shaped sofa", "corner_sofa", (-1.62, 0.95), (w, d, 0.8), TURN, shape="l_shape", outline=outline,
                   options={"side": "left"}, colours={"fabric": "cloth:#a39a8c:#c5bdaf"})  # fmt: skip
    cushions = (
        (0.92, 0.42, "cloth:#8c4f33:#b26f4c"),
        (0.42, 0.44, "cloth:#c9bd9f:#e3d9c0"),
        (-0.85, 0.42, "cloth:#38545c:#557881"),
    )
    for number, (x, y, cloth) in enumerate(cushions, 1):
        f.on("sofa", f"cushion_{number}", "cushion", "scatter_cushion", (x, y), (0.44, 0.24, 0.42), 8 - 6 * number,
             options={"seed": number}, colours={"accent": cloth})  # fmt: skip
    f.on("sofa", "throw", "blanket", "folded_throw", (-0.85, -0.42), (0.55, 0.4, 0.07), 10, symmetry=2,
         colours={"throw": "cloth:#b98d3a:#d8b162"})  # fmt: skip
    f.major("coffee_table", "coffee table", "coffee_table", _beside(sofa, (0.42, -0.72)), (1.0, 0.58, 0.4), TURN, symmetry=2,
            options={"style": "drawers"})  # fmt: skip
    f.on("coffee_table", "books", "books", "book_pile", (-0.26, 0.06), (0.26, 0.2, 0.09), 14, symmetry=2)
    f.on(
        "coffee_table", "bowl", "fruit bowl", "fruit_bowl", (0.22, -0.02), (0.28, 0.28, 0.15), symmetry=0, shape="round"
    )
    f.major("armchair", "armchair", "armchair", (-0.72, -1.42), (0.82, 0.82, 0.78), 180 + TURN - 14, options={"style": "barrel"},
            colours={"fabric": "cloth:#3f5a47:#5d7a62"})  # fmt: skip
    f.put("pouf", "pouf", "ottoman", (-2.0, -0.75), (0.56, 0.56, 0.4), symmetry=0, shape="round", salience="major",
          options={"style": "knitted"}, colours={"*": "cloth:#b39c74:#d5c19b"})  # fmt: skip
    f.major("side_table", "side table", "side_table", (0.42, 1.85), (0.42, 0.42, 0.5), symmetry=0, shape="round",
            options={"style": "drum"})  # fmt: skip
    f.on("side_table", "lamp", "table lamp", "table_lamp", (0, 0), (0.3, 0.3, 0.46), symmetry=0, shape="round")


def _table(f: Furnishing) -> None:
    x, y = 1.95, 0.55
    f.put("round_rug", "rug", "round_rug", (x, y), (2.1, 2.1, 0.012), symmetry=0, shape="round", label="round jute rug",
          colours={"rug": "cloth:#9b8358:#bda678", "rug line": "cloth:#7d6740:#9a8358"})  # fmt: skip
    f.major("table", "round table", "round_table", (x, y), (1.12, 1.12, 0.75), symmetry=0, shape="round", options={"base": "tulip"},
            colours={"wood": "plain:#ece9e3:0.3"})  # fmt: skip
    chair: dict[str, Any] = {"options": {"style": "spindle"}, "salience": "major"}
    for number, angle in enumerate((35, 122, 218, 305), 1):
        t, away = math.radians(angle), 0.84 + (0.1 if number == 3 else 0.0)
        at = (round(x + away * math.cos(t), 4), round(y + away * math.sin(t), 4))
        f.put(f"chair_{number}", "chair", "chair", at, (0.45, 0.5, 0.84), angle + 270 + 5 * (number - 2), **chair)
    f.on(
        "table",
        "flowers",
        "flowers in a vase",
        "flower_vase",
        (-0.12, 0.1),
        (0.3, 0.3, 0.42),
        symmetry=0,
        shape="round",
    )
    for number, angle in ((1, 35), (2, 218)):
        t = math.radians(angle)
        f.on("table", f"plate_{number}", "plate", "plate", (round(0.38 * math.cos(t), 3), round(0.38 * math.sin(t), 3)),
             (0.24, 0.24, 0.024), symmetry=0, shape="round", colours={"ceramic": "plain:#5f7f8a:0.3"})  # fmt: skip


def _along_the_walls(f: Furnishing) -> None:
    f.major("tv_stand", "tv stand", "tv_stand", (-2.47, -2.07), (1.5, 0.42, 0.5), 180 - 33, options={"style": "slats"})
    f.on("tv_stand", "tv", "television", "television", (0, 0.05), (1.05, 0.22, 0.66))
    f.major("bookcase_1", "bookcase", "bookcase", (0.72, -2.51), (0.95, 0.34, 1.9), 180)
    f.major("bookcase_2", "bookcase", "bookcase", (1.7, -2.51), (0.95, 0.34, 1.9), 180, options={"fullness": 0.5})
    f.major("wing_chair", "armchair", "wing_chair", (1.42, -1.32), (0.76, 0.82, 1.05), 128, label="wing chair",
            colours={"fabric": "cloth:#7f3f33:#a45a4a"})  # fmt: skip
    f.put("floor_lamp", "floor lamp", "floor_lamp", (0.42, -1.78), (0.4, 0.4, 1.55), symmetry=0, shape="round")
    f.major("sideboard", "sideboard", "sideboard", (2.2, 2.46), (1.6, 0.44, 0.78), 0, options={"style": "cane"})
    f.on("sideboard", "record_player", "record player", "game_console", (0.42, 0), (0.44, 0.34, 0.13), 6)
    f.on(
        "sideboard",
        "sideboard_plant",
        "small plant",
        "small_plant",
        (-0.6, 0.02),
        (0.26, 0.26, 0.34),
        symmetry=0,
        shape="round",
    )
    f.on(
        "sideboard",
        "frame",
        "picture frame",
        "picture_frame",
        (-0.12, 0.1),
        (0.3, 0.05, 0.38),
        12,
        label="standing photograph",
    )
    f.put("tree", "potted plant", "indoor_tree", (-2.85, 2.25), (0.8, 0.8, 1.7), label="olive tree", salience="major",
          symmetry=0, shape="round", options={"kind": "olive", "pot": "cylinder"})  # fmt: skip
    f.put("monstera", "potted plant", "monstera", (2.9, 1.72), (0.72, 0.72, 1.0), label="monstera", salience="major",
          symmetry=0, shape="round")  # fmt: skip
    f.put("basket", "basket", "basket", (-0.35, 2.28), (0.42, 0.42, 0.4), symmetry=0, shape="round")
    f.hang("curtain", "curtains", "curtain_pair", (-0.7, 2.62), 0.04, (2.5, 0.15, 2.5), 0, options={"drawn": 0.3},
           colours={"fabric": "cloth:#a9a79c:#c9c7bb"})  # fmt: skip
