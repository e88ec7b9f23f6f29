# SPDX-License-Identifier: GPL-3.0-or-later
"""An office with six desks and a meeting corner behind a partition, seen at an angle from off the middle."""

from __future__ import annotations

from typing import Any

from code_as_room.pipeline.geometry.camera import camera_looking_at

from ..model import Furnishing, Light, Look, Opening, Partition, Scene

HEIGHT = 2.8
FLOOR = ((-3.8, -3.1), (3.8, -3.1), (3.8, 3.1), (-3.8, 3.1))
MAPLE = "wood:#b4946a:#dcc198"


def scene() -> Scene:
    """The office."""
    f = Furnishing()
    _desks(f)
    _meeting(f)
    _storage(f)
    _lounge(f)
    return Scene(
        id="office_tilted",
        room_type="office",
        floor=FLOOR,
        height=HEIGHT,
        camera=camera_looking_at("perspective", (0.2, -3.95, 9.4), (-0.1, 1.04, 0.0), 50.5, (1180, 800)),
        items=f.all(),
        openings=(
            Opening("door", "door", 1, 2.45, 3.35, 2.1, hinge="end", degrees=35),
            Opening("window_north", "window", 2, 4.9, 6.9, 1.4, sill=0.95),
            Opening("window_meeting", "window", 2, 0.35, 1.15, 1.4, sill=0.95),
            Opening("window_west", "window", 3, 0.9, 3.1, 1.5, sill=0.9),
        ),
        partitions=(Partition("partition", (1.45, 3.1), (1.45, 0.75), 2.8, 0.1, "plain:#6f8791:0.8"),),
        look=LOOK,
        zones=(
            ("desks", "desk_nw", ("desk_nw", "desk_ne", "desk_sw", "desk_se", "desk_window", "desk_standing")),
            ("meeting", "meeting_table", ("meeting_table", "meeting_chair_1", "meeting_chair_2", "meeting_chair_3")),
            ("lounge", "sofa", ("sofa", "coffee_table", "rug")),
        ),
    )


LOOK = Look(
    floor="carpet:#4f5960:#79848b",
    wall="plain:#e9e8e4:0.85",
    cap="glow:#8f959a:1.0",
    skirting="plain:#cfd1d2:0.5",
    door="wood:#9a6f47:#c0946a",
    lights=(
        Light("sun", (-5, 4, 9), 2.6, "#fff1dc", 0.08),
        Light("area", (0, 0, 7.5), 330, "#f6faff", 6.0),
    ),
    sky=("#eef3ff", 0.8),
    paper="#ffffff",
    exposure=0.05,
    samples=20,
    roles={"wood": MAPLE, "fabric": "cloth:#3c4550:#566170", "velvet": "cloth:#3d5460:#5b7482"},
)


def _desks(f: Furnishing) -> None:
    metal: dict[str, Any] = {"options": {"legs": "metal", "drawers": "none"}}
    for name, x, y, yaw in (
        ("nw", -2.42, 0.53, 180),
        ("ne", -0.98, 0.53, 180),
        ("sw", -2.42, -0.21, 0),
        ("se", -0.98, -0.21, 0),
    ):
        f.major(f"desk_{name}", "desk", "desk", (x, y), (1.4, 0.7, 0.74), yaw, symmetry=1, **metal)
    f.put("screen", "desk divider", "desk_screen", (-1.7, 0.16), (2.8, 0.03, 1.18), label="felt screen between the desks",
          symmetry=2)  # fmt: skip
    f.major(
        "desk_window", "desk", "desk", (-2.35, 2.72), (1.5, 0.7, 0.74), 0, options={"legs": "panel", "drawers": "left"}
    )
    f.major("desk_standing", "standing desk", "standing_desk", (-3.4, -1.95), (1.4, 0.72, 0.98), 90)
    chairs = {"nw": (-2.36, 1.28, 8), "ne": (-1.1, 1.33, -22), "sw": (-2.5, -0.98, 176), "se": (-0.8, -1.08, 214)}
    for name, (x, y, yaw) in chairs.items():
        f.major(
            f"chair_{name}", "office chair", "office_chair", (x, y), (0.62, 0.62, 1.0), yaw, options={"back": "low"}
        )
    f.major("chair_window", "office chair", "office_chair", (-2.2, 1.98), (0.64, 0.64, 1.12), 168,
            options={"seat": "leather"}, colours={"leather": "cloth:#5b3a26:#7f5437"})  # fmt: skip
    f.major("chair_standing", "stool", "stool", (-2.68, -2.0), (0.4, 0.4, 0.66), 0, symmetry=0, shape="round",
            options={"padded": True})  # fmt: skip
    for name in ("nw", "ne", "sw", "se", "window"):
        f.on(f"desk_{name}", f"monitor_{name}", "monitor", "monitor", (0.05, 0.2), (0.6, 0.19, 0.44), -3)
        f.on(f"desk_{name}", f"keyboard_{name}", "keyboard", "keyboard", (0.02, -0.13), (0.44, 0.14, 0.03), 4)
    f.on("desk_standing", "monitor_standing", "monitor", "monitor", (-0.3, 0.18), (0.6, 0.19, 0.44), 12)
    f.on("desk_standing", "laptop", "laptop", "laptop", (0.34, -0.05), (0.33, 0.29, 0.21), -14)
    f.on("desk_nw", "papers_nw", "papers", "paper_stack", (-0.5, -0.05), (0.24, 0.32, 0.03), 10, symmetry=2)
    f.on("desk_ne", "mug_ne", "mug", "mug", (0.5, -0.05), (0.12, 0.085, 0.095), 30)
    f.on("desk_sw", "lamp_sw", "desk lamp", "desk_lamp", (-0.55, 0.08), (0.17, 0.38, 0.44), 20)
    f.on("desk_se", "plant_se", "small plant", "small_plant", (0.55, 0.16), (0.2, 0.2, 0.26), symmetry=0, shape="round")
    f.on("desk_se", "notebook_se", "notebook", "notebook", (-0.42, -0.12), (0.16, 0.22, 0.022), 16, symmetry=2)
    f.on("desk_window", "pens", "pencil cup", "pencil_cup", (-0.55, 0.12), (0.1, 0.1, 0.19), symmetry=0, shape="round")
    f.put("bin", "waste bin", "waste_bin", (-0.02, 0.2), (0.28, 0.28, 0.34), symmetry=0, shape="round")


def _meeting(f: Furnishing) -> None:
    f.major("meeting_table", "round table", "round_table", (2.72, 1.72), (1.15, 1.15, 0.74), symmetry=0, shape="round",
            options={"base": "disc"}, colours={"wood": "plain:#e8e5de:0.4"})  # fmt: skip
    chair: dict[str, Any] = {"options": {"style": "shell"}, "colours": {"*": "plain:#c98a2f:0.5", "wood": MAPLE}}
    for number, x, y, yaw in ((1, 2.72, 2.55, 0), (2, 3.46, 1.47, -72), (3, 2.35, 0.92, 154)):
        f.major(
            f"meeting_chair_{number}", "chair", "chair", (x, y), (0.48, 0.5, 0.82), yaw, under="meeting_table", **chair
        )
    f.on("meeting_table", "meeting_laptop", "laptop", "laptop", (-0.2, -0.12), (0.33, 0.29, 0.21), -20)
    f.on("meeting_table", "meeting_cup", "cup", "cup", (0.28, 0.14), (0.14, 0.14, 0.075), symmetry=1)
    f.hang("whiteboard", "whiteboard", "whiteboard", (2.06, 3.045), 0.9, (1.1, 0.1, 1.0), 0)
    f.put("palm", "potted plant", "palm", (3.35, 2.66), (0.8, 0.8, 1.6), label="areca palm", salience="major", symmetry=0,
          shape="round")  # fmt: skip


def _storage(f: Furnishing) -> None:
    for number, x in ((1, -0.75), (2, 0.2)):
        f.major(
            f"bookcase_{number}",
            "bookcase",
            "bookcase",
            (x, 2.93),
            (0.92, 0.32, 1.9),
            0,
            options={"fullness": 0.9 - 0.3 * (number - 1)},
        )
    f.put("snake_plant", "potted plant", "snake_plant", (0.98, 2.82), (0.34, 0.34, 0.85), label="snake plant", symmetry=0,
          shape="round")  # fmt: skip
    f.major("cabinet_1", "filing cabinet", "filing_cabinet", (3.48, -1.42), (0.46, 0.6, 1.05), -90)
    f.major("cabinet_2", "filing cabinet", "filing_cabinet", (3.48, -1.9), (0.46, 0.6, 1.05), -90)
    f.on(
        "cabinet_2", "printer", "printer", "printer", (-0.01, 0.04), (0.42, 0.36, 0.24), 0, options={"tray_open": False}
    )
    f.put("monstera", "potted plant", "monstera", (-3.38, 1.42), (0.7, 0.7, 1.0), label="monstera", salience="major",
          symmetry=0, shape="round")  # fmt: skip
    f.hang("clock", "wall clock", "wall_clock", (-0.3, 3.073), 2.2, (0.36, 0.05, 0.36), 0)
    f.hang(
        "poster", "poster", "picture_frame", (3.783, 0.85), 1.2, (0.6, 0.03, 0.85), -90, options={"art": "botanical"}
    )
    f.hang("radiator", "radiator", "radiator", (-3.72, 0.42), 0.12, (1.2, 0.13, 0.6), 90)


def _lounge(f: Furnishing) -> None:
    f.put("rug", "rug", "round_rug", (1.25, -1.35), (1.9, 1.9, 0.014), symmetry=0, shape="round",
          colours={"rug": "cloth:#a08a55:#c9b27a", "rug line": "cloth:#4d4b3c:#6b6853"})  # fmt: skip
    f.major("sofa", "sofa", "sofa", (1.2, -2.3), (1.7, 0.84, 0.76), 180, options={"seats": 2, "legs": "metal", "arms": "straight"},
            colours={"fabric": "cloth:#59725f:#7a957f"})  # fmt: skip
    f.on("sofa", "cushion", "cushion", "scatter_cushion", (-0.5, 0.04), (0.42, 0.24, 0.4), 6)
    f.major("coffee_table", "coffee table", "coffee_table", (1.2, -1.3), (0.75, 0.75, 0.4), symmetry=0, shape="round",
            options={"style": "block", "shape": "round"}, colours={"wood": "wood:#4f3a28:#74563c"})  # fmt: skip
    f.on("coffee_table", "magazine", "magazine", "open_magazine", (0.1, 0.05), (0.4, 0.28, 0.012), 24)
    f.major("armchair", "armchair", "armchair", (2.5, -0.95), (0.76, 0.76, 0.76), -68, options={"style": "barrel"},
            colours={"fabric": "cloth:#b0a89a:#cfc8ba"})  # fmt: skip
    f.put("planter", "planter box", "planter_box", (1.45, 0.45), (0.36, 0.36, 0.8), symmetry=4)
    f.put("floor_lamp", "floor lamp", "arc_lamp", (-0.28, -2.2), (1.0, 0.36, 1.75), 155, label="arc floor lamp")
