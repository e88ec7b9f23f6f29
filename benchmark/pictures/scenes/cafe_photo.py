# SPDX-License-Identifier: GPL-3.0-or-later
"""A small cafe in the evening: dark, warm and full, with lamps that hang between the camera and the tables."""

from __future__ import annotations

import math
from typing import Any

from code_as_room.pipeline.geometry.camera import camera_looking_at

from ..model import Furnishing, Light, Look, Opening, Partition, Scene

HEIGHT = 3.0
FLOOR = ((-3.5, -2.7), (3.5, -2.7), (3.5, 2.7), (-3.5, 2.7))
DARK = "wood:#3a2417:#63402a"
TABLES = {"t1": (1.2, 1.72), "t2": (2.55, 0.95), "t3": (0.75, -0.55), "t4": (2.35, -0.95)}
CHAIRS = {"t1": (20, 150, 268), "t2": (75, 250), "t3": (42, 128, 222, 312), "t4": (150, 15, 285)}
PENDANTS = (
    ("pendant_1", -2.5, 1.25),
    ("pendant_2", -1.15, 1.25),
    ("pendant_3", 1.3, 1.5),
    ("pendant_4", 0.85, -0.8),
    ("pendant_5", 2.3, -0.7),
)
"""Where lamps hang, beside the middles of what is below them."""


def scene() -> Scene:
    """The cafe."""
    f = Furnishing()
    _counter(f)
    _tables(f)
    _bench(f)
    _window_bar(f)
    _rest(f)
    return Scene(
        id="cafe_photo",
        room_type="cafe",
        floor=FLOOR,
        height=HEIGHT,
        camera=camera_looking_at("perspective", (-0.35, -1.9, 9.8), (0.02, 0.6, 0.0), 50.0, (1120, 800)),
        items=f.all(),
        openings=(
            Opening("door", "door", 0, 5.95, 6.85, 2.15, hinge="end", degrees=62),
            Opening("window_south", "window", 0, 3.75, 5.6, 1.5, sill=1.05),
            Opening("window_west", "window", 3, 3.2, 4.9, 1.5, sill=0.95),
        ),
        partitions=(Partition("low_wall", (0.18, 2.7), (0.18, 1.0), 1.1, 0.12, "wood:#3c2619:#5b3a26"),),
        look=_look(),
        zones=(
            ("serving", "counter", ("counter", "back_counter", "fridge", "coffee_machine")),
            ("sitting", "t3", ("t1", "t2", "t3", "t4")),
            ("bench", "bench", ("bench", "bench_table_1", "bench_table_2")),
            ("window bar", "window_bar", ("window_bar", "window_stool_1", "window_stool_2", "window_stool_3")),
        ),
    )


def _look() -> Look:
    warm = "#ffc48a"
    lamps = tuple(Light("point", (x, y, 1.95), 32, warm, 0.08) for _, x, y in PENDANTS)
    return Look(
        floor="checker:#3d3832:#6a5f50:0.34",
        wall="plain:#5c4a3d:0.8",
        walls={2: "tiles:#35463f:#3f5349:0.2:#232b28"},
        cap="glow:#1f1a17:1.0",
        skirting="plain:#33261d:0.5",
        door="plain:#4a2f22:0.5",
        frame="plain:#3a2c22:0.5",
        lights=(
            *lamps,
            Light("area", (0, 0, 7.5), 230, "#ffdcb8", 6.0),
            Light("area", (1.2, -3.4, 2.3), 40, "#9fb8d8", 1.6, (1.2, 0.0, 0.6)),
            Light("point", (-1.4, 2.2, 2.3), 14, warm, 0.1),
        ),
        sky=("#ffdfc0", 0.30),
        paper="#4a4440",
        exposure=1.25,
        samples=16,
        vignette=0.45,
        fade=0.07,
        grain=2.4,
        roles={
            "wood": DARK,
            "fabric": "cloth:#5a3a2c:#7a5340",
            "leather": "cloth:#3b241a:#5c3a29",
            "shade": "glow:#ffd09a:2.2",
        },
    )


def _counter(f: Furnishing) -> None:
    f.major("counter", "service counter", "service_counter", (-1.85, 1.3), (2.9, 0.78, 1.25), 0, options={"front": "planks"},
            label="counter with a glass case")  # fmt: skip
    f.on("counter", "cake_stand", "cake stand", "cake_stand", (-0.15, 0.1), (0.3, 0.3, 0.26), symmetry=0, shape="round")
    f.major("back_counter", "kitchen counter", "kitchen_counter", (-1.3, 2.38), (2.5, 0.62, 1.08), 0,
            label="back counter with a sink", options={"sink": "right", "hob": "none"},
            colours={"painted": "plain:#2f3f3a:0.5", "stone": "wood:#5a3b27:#80583b"})  # fmt: skip
    f.on("back_counter", "coffee_machine", "coffee machine", "coffee_machine", (-0.55, 0.02), (0.72, 0.5, 0.5))
    f.on("back_counter", "kettle", "kettle", "kettle", (-1.08, -0.05), (0.23, 0.17, 0.25), 60)
    f.hang("shelf", "wall shelf", "wall_shelf", (0.9, 2.59), 1.5, (1.2, 0.22, 0.5), 0, options={"style": "brackets"})
    f.major("fridge", "display fridge", "display_fridge", (-3.08, 2.34), (0.8, 0.68, 1.9), 0)
    for number, x in enumerate((-2.75, -1.95, -1.12), 1):
        f.major(f"stool_{number}", "bar stool", "bar_stool", (x, 0.58), (0.42, 0.42, 0.9), 180 + 14 * (number - 2))
    f.on(
        "counter",
        "till",
        "cash register",
        "tablet",
        (-0.6, 0.12),
        (0.26, 0.22, 0.02),
        180,
        symmetry=1,
        label="till with a screen",
    )


def _tables(f: Furnishing) -> None:
    chair: dict[str, Any] = {"options": {"style": "spindle"}}
    for name, (x, y) in TABLES.items():
        wide = 0.78 if name == "t3" else 0.68
        f.major(name, "round table", "round_table", (x, y), (wide, wide, 0.75), symmetry=0, shape="round", label="small round cafe table",
                options={"base": "disc", "top": "marble" if name in ("t2", "t4") else "wood"})  # fmt: skip
        for number, angle in enumerate(CHAIRS[name], 1):
            t, away = math.radians(angle), wide / 2 + 0.27 + 0.02 * number
            at = (round(x + away * math.cos(t), 4), round(y + away * math.sin(t), 4))
            f.major(
                f"{name}_chair_{number}",
                "chair",
                "chair",
                at,
                (0.42, 0.46, 0.84),
                angle + 270 + 7 * (number - 2),
                **chair,
            )
    f.on("t1", "t1_cup", "cup", "cup", (-0.2, -0.06), (0.15, 0.15, 0.075), 20)
    f.on("t1", "t1_plate", "plate with pastries", "croissant_plate", (-0.1, 0.2), (0.24, 0.24, 0.07), 35, symmetry=2)
    f.on("t2", "t2_cup", "cup", "cup", (0.12, 0.14), (0.15, 0.15, 0.075), 200)
    f.on("t2", "t2_candle", "candle", "candle", (-0.13, -0.1), (0.09, 0.09, 0.12), symmetry=0, shape="round")
    f.on("t3", "laptop", "laptop", "laptop", (-0.14, -0.14), (0.33, 0.29, 0.21), -48)
    f.on("t3", "t3_cup", "cup", "cup", (-0.12, 0.22), (0.15, 0.15, 0.075), 120)
    f.on("t4", "t4_plate", "plate with pastries", "croissant_plate", (0.16, 0.08), (0.24, 0.24, 0.07), 80, symmetry=2)
    f.on("t4", "t4_cup", "cup", "cup", (0.02, -0.2), (0.15, 0.15, 0.075), -60)


def _bench(f: Furnishing) -> None:
    f.major(
        "bench",
        "bench",
        "bench",
        (-3.2, -1.42),
        (2.3, 0.56, 0.88),
        90,
        label="bench with a back",
        options={"style": "backrest"},
    )
    for number, y in ((1, -0.85), (2, -1.98)):
        f.major(f"bench_table_{number}", "table", "dining_table", (-2.52, y), (0.62, 0.66, 0.75), 90, symmetry=4,
                label="small square table",
                options={"legs": "metal"})  # fmt: skip
        f.major(f"bench_chair_{number}", "chair", "chair", (-1.9 + 0.08 * number, y + 0.03), (0.42, 0.46, 0.84), -90 + 16 * (number - 1.3),
                options={"style": "spindle"})  # fmt: skip
    f.on(
        "bench",
        "cushion_1",
        "cushion",
        "scatter_cushion",
        (-0.78, 0.02),
        (0.42, 0.22, 0.4),
        6,
        colours={"accent": "cloth:#8a6a25:#b08d3f"},
    )
    f.on("bench", "cushion_2", "cushion", "scatter_cushion", (0.82, 0.02), (0.42, 0.22, 0.4), -8, options={"seed": 5},
         colours={"accent": "cloth:#6b2e26:#8f463a"})  # fmt: skip
    f.on(
        "bench_table_1",
        "bench_plate",
        "plate with pastries",
        "croissant_plate",
        (0.06, -0.1),
        (0.24, 0.24, 0.07),
        symmetry=2,
    )
    f.on("bench_table_2", "bench_teapot", "teapot", "teapot", (0.1, 0.06), (0.25, 0.16, 0.16), 30)
    f.on("bench_table_2", "bench_cup", "cup", "cup", (-0.16, -0.16), (0.15, 0.15, 0.075), -30)


def _window_bar(f: Furnishing) -> None:
    f.major("window_bar", "bar table", "console_table", (1.15, -2.48), (2.0, 0.38, 1.05), 180, label="narrow bar table at the window",
            symmetry=2)  # fmt: skip
    for number, x in enumerate((0.5, 1.12, 1.8), 1):
        f.major(f"window_stool_{number}", "bar stool", "stool", (x, -2.02 + 0.04 * (number % 2)), (0.36, 0.36, 0.74), symmetry=0,
                shape="round", label="round bar stool", options={"padded": True})  # fmt: skip
    f.on(
        "window_bar",
        "bar_flowers",
        "flowers in a vase",
        "flower_vase",
        (0.2, 0.02),
        (0.24, 0.24, 0.36),
        symmetry=0,
        shape="round",
    )
    f.on("window_bar", "bar_books", "books", "book_pile", (-0.62, 0.03), (0.2, 0.24, 0.1), 10, symmetry=2)
    f.on("window_bar", "bar_cup", "cup", "cup", (0.7, -0.06), (0.15, 0.15, 0.075), 45)


def _rest(f: Furnishing) -> None:
    for name, x, y in PENDANTS:
        f.put(name, "pendant lamp", "pendant", (x, y), (0.34, 0.34, 0.8), base=2.0, placement="ceiling", symmetry=0, shape="round",
              options={"shape": "dome" if name in ("pendant_1", "pendant_2") else "cone"},
              colours={"metal": "plain:#24211e:0.4"})  # fmt: skip
    f.put(
        "ficus",
        "potted plant",
        "indoor_tree",
        (3.06, 2.24),
        (0.74, 0.74, 1.7),
        label="ficus",
        salience="major",
        symmetry=0,
        shape="round",
    )
    f.put("fern", "potted plant", "potted_plant", (-3.18, 0.08), (0.56, 0.56, 0.7), label="fern", salience="major", symmetry=0,
          shape="round", options={"kind": "fern"})  # fmt: skip
    f.put("sack_1", "coffee sack", "coffee_sack", (-0.28, 0.62), (0.44, 0.4, 0.56), symmetry=0, shape="round")
    f.put(
        "sack_2",
        "coffee sack",
        "coffee_sack",
        (-0.3, 0.1),
        (0.4, 0.38, 0.5),
        40,
        symmetry=0,
        shape="round",
        options={"seed": 3},
    )
    f.major("sideboard", "sideboard", "sideboard", (3.28, -0.05), (1.0, 0.4, 0.85), -90, label="sideboard with carafes")
    f.on("sideboard", "bottles", "bottles", "bottle_row", (0.12, 0.04), (0.5, 0.1, 0.3), 4, symmetry=2)
    f.put("doormat", "doormat", "striped_rug", (2.62, -2.1), (0.7, 0.44, 0.012), symmetry=2, options={"stripes": 5},
          colours={"rug": "cloth:#4a3a2a:#665240", "rug line": "cloth:#272320:#3d3731"})  # fmt: skip
    f.hang("menu", "blackboard", "whiteboard", (-1.75, 2.645), 1.55, (1.6, 0.1, 0.95), 0, options={"pens": 0},
           colours={"ceramic": "plain:#1d2321:0.9", "plastic": "plain:#d9d6c8:0.8", "accent": "plain:#d8a24a:0.8",
                    "rubber": "plain:#d9d6c8:0.8", "velvet": "plain:#d9d6c8:0.8",
                    "foliage": "plain:#9fb98a:0.8", "steel": DARK})  # fmt: skip
    f.hang("clock", "wall clock", "wall_clock", (3.473, 1.2), 1.8, (0.38, 0.05, 0.38), -90)
    f.hang(
        "picture",
        "framed picture",
        "picture_frame",
        (3.483, 0.2),
        1.35,
        (0.55, 0.03, 0.7),
        -90,
        options={"art": "portrait"},
    )
    f.put("bin", "waste bin", "waste_bin", (3.25, -1.55), (0.3, 0.3, 0.5), symmetry=0, shape="round",
          colours={"bin": "plain:#5d5a55:0.5"})  # fmt: skip
