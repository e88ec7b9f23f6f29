"""What stands where in the sample bedroom: plain data, no modelling.

Metres, Z up, floor at z = 0, origin at the centre of the floor, +X picture right, +Y picture up. Yaw is in degrees
counter-clockwise; an object at yaw 0 faces -Y. `size` is (width along local x, depth along local y, height); `x`, `y`
and `base` are the centre of the box on the plan and the height of its underside.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

ROOM_SIZE = (4.6, 3.9, 2.6)
WALL_THICKNESS = 0.12
IMAGE_SIZE = (1200, 1040)
CAMERA_HEIGHT = 13.0
# What the picture shows at the height of the floor, bottom to top: the wall tops and a margin of about 5 %.
VIEW_HEIGHT_ON_FLOOR = 5.70


@dataclass(frozen=True)
class Item:
    """One object of the room."""

    id: str
    category: str
    label: str
    x: float
    y: float
    size: tuple[float, float, float]
    yaw: float = 0.0
    base: float = 0.0
    placement: str = "floor"
    parent: str | None = None
    salience: str = "minor"
    model: str = ""
    measured: bool = False
    """True for cloth that is simulated: its box is measured from the finished mesh instead of being stated here."""
    options: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Opening:
    """A door or a window in a wall; start and end lie on the wall's inner face."""

    id: str
    kind: str
    wall: str
    start: tuple[float, float]
    end: tuple[float, float]
    height: float
    sill: float


DOOR = Opening("door", "door", "wall_south", (1.17, -1.95), (2.05, -1.95), 2.05, 0.0)
DOOR_OPEN_DEGREES = 24.0
WINDOW = Opening("window", "window", "wall_north", (-0.42, 1.95), (1.08, 1.95), 1.55, 0.75)

ITEMS: tuple[Item, ...] = (
    Item(
        "bed",
        "double bed",
        "double bed with a channelled headboard and a white duvet",
        -1.19,
        0.15,
        (1.78, 2.20, 1.10),
        90.0,
        salience="major",
        model="bed",
    ),
    Item(
        "nightstand_north",
        "nightstand",
        "oak nightstand with two drawers",
        -2.07,
        1.365,
        (0.46, 0.42, 0.50),
        90.0,
        salience="major",
        model="nightstand",
    ),
    Item(
        "nightstand_south",
        "nightstand",
        "oak nightstand with two drawers",
        -2.07,
        -1.065,
        (0.46, 0.42, 0.50),
        90.0,
        salience="major",
        model="nightstand",
    ),
    Item(
        "bench",
        "bench",
        "upholstered bench on wooden legs",
        0.20,
        0.11,
        (1.22, 0.42, 0.46),
        90.0,
        salience="major",
        model="bench",
    ),
    Item(
        "wardrobe",
        "wardrobe",
        "three-door wardrobe",
        -0.85,
        -1.63,
        (1.70, 0.60, 2.20),
        180.0,
        salience="major",
        model="wardrobe",
    ),
    Item(
        "desk",
        "desk",
        "oak writing desk with drawers",
        1.98,
        -0.22,
        (1.28, 0.60, 0.75),
        -90.0,
        salience="major",
        model="desk",
    ),
    Item(
        "desk_chair",
        "chair",
        "wooden chair with a seat pad",
        1.29,
        -0.30,
        (0.48, 0.52, 0.80),
        66.0,
        salience="major",
        model="chair",
    ),
    Item(
        "armchair",
        "armchair",
        "green tub armchair",
        1.46,
        1.08,
        (0.78, 0.75, 0.76),
        -38.0,
        salience="major",
        model="armchair",
    ),
    Item("rug", "rug", "cream rug with a lozenge pattern", -0.13, 0.13, (2.06, 2.46, 0.014), 0.0, model="rug"),
    Item(
        "floor_lamp", "floor lamp", "floor lamp with a drum shade", 2.03, 1.67, (0.40, 0.40, 1.56), model="floor_lamp"
    ),
    Item("plant", "potted plant", "fiddle-leaf fig in a clay pot", -1.24, 1.50, (0.67, 0.62, 1.04), model="plant"),
    Item(
        "pillow_north",
        "pillow",
        "white pillow",
        -1.93,
        0.565,
        (0.74, 0.50, 0.20),
        93.0,
        0.53,
        "surface",
        "bed",
        model="pillow",
    ),
    Item(
        "pillow_south",
        "pillow",
        "white pillow",
        -1.92,
        -0.255,
        (0.74, 0.50, 0.20),
        86.0,
        0.53,
        "surface",
        "bed",
        model="pillow",
        options={"seed": 2},
    ),
    Item(
        "throw",
        "throw blanket",
        "terracotta throw",
        -0.66,
        0.14,
        (1.80, 0.52, 0.35),
        88.0,
        0.30,
        "surface",
        "bed",
        model="throw",
        measured=True,
    ),
    Item(
        "table_lamp_north",
        "table lamp",
        "ceramic table lamp",
        -2.08,
        1.39,
        (0.30, 0.30, 0.46),
        0.0,
        0.50,
        "surface",
        "nightstand_north",
        model="table_lamp",
    ),
    Item(
        "table_lamp_south",
        "table lamp",
        "ceramic table lamp",
        -2.10,
        -1.09,
        (0.30, 0.30, 0.46),
        0.0,
        0.50,
        "surface",
        "nightstand_south",
        model="table_lamp",
    ),
    Item(
        "laptop",
        "laptop",
        "open laptop",
        1.95,
        -0.30,
        (0.34, 0.31, 0.215),
        -84.0,
        0.75,
        "surface",
        "desk",
        model="laptop",
    ),
    Item(
        "vase",
        "vase",
        "vase with eucalyptus branches",
        2.06,
        0.22,
        (0.29, 0.29, 0.44),
        0.0,
        0.75,
        "surface",
        "desk",
        model="vase",
    ),
    Item(
        "curtain_west", "curtain", "linen curtain", -0.66, 1.878, (0.56, 0.13, 2.47), 0.0, 0.03, "wall", model="curtain"
    ),
    Item(
        "curtain_east",
        "curtain",
        "linen curtain",
        1.29,
        1.878,
        (0.50, 0.13, 2.47),
        0.0,
        0.03,
        "wall",
        model="curtain",
        options={"seed": 5},
    ),
    Item(
        "picture",
        "framed picture",
        "framed abstract print",
        -2.282,
        0.15,
        (1.05, 0.03, 0.70),
        90.0,
        1.38,
        "wall",
        model="picture",
    ),
    Item(
        "mirror",
        "mirror",
        "arched full-length mirror",
        0.56,
        -1.93,
        (0.62, 0.035, 1.55),
        180.0,
        0.30,
        "wall",
        model="mirror",
    ),
)
