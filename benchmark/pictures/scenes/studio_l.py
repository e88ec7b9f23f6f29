# SPDX-License-Identifier: GPL-3.0-or-later
"""An L-shaped studio flat: bed and wardrobe in the north, sofa in the west, kitchen and dining table in the east arm."""

from __future__ import annotations

from code_as_room.pipeline.geometry.camera import camera_straight_down

from ..model import Furnishing, Light, Look, Opening, Scene

HEIGHT = 2.6
FLOOR = ((-3.6, -2.8), (3.6, -2.8), (3.6, 0.6), (1.0, 0.6), (1.0, 2.8), (-3.6, 2.8))
OAK = "wood:#8f7150:#bf9f74"
ASH = "wood:#b59c78:#d6c2a0"


def scene() -> Scene:
    """The studio flat."""
    f = Furnishing()
    _sleeping(f)
    _living(f)
    _kitchen(f)
    _dining(f)
    return Scene(
        id="studio_l",
        room_type="studio flat",
        floor=FLOOR,
        height=HEIGHT,
        camera=camera_straight_down("perspective", 7.48, 5.88, (1240, 1000), fov_degrees=34, margin=0.035, top=HEIGHT),
        items=f.all(),
        openings=(
            Opening("door_entrance", "door", 0, 3.60, 4.50, 2.05, hinge="start", degrees=68),
            Opening("door_bath", "door", 3, 0.10, 0.85, 2.05, hinge="start", degrees=0),
            Opening("window_west", "window", 5, 2.9, 4.7, 1.45, sill=0.8),
            Opening("window_north", "window", 4, 3.55, 4.45, 1.3, sill=0.95),
            Opening("window_east", "window", 1, 1.25, 2.55, 1.1, sill=1.15),
        ),
        look=LOOK,
        zones=(
            (
                "sleeping",
                "bed",
                ("bed", "nightstand_west", "nightstand_east", "wardrobe", "pillow_west", "pillow_east"),
            ),
            ("living", "sofa", ("sofa", "armchair", "coffee_table", "rug", "tv_stand", "tv", "monstera")),
            ("kitchen", "counter_north", ("counter_north", "counter_east", "fridge")),
            ("dining", "table", ("table", "chair_nw", "chair_ne", "chair_sw", "chair_se", "pendant")),
        ),
    )


LOOK = Look(
    floor="boards:#87674a:#b8946c:0.15:1.5",
    wall="plain:#e6e2d9:0.85",
    walls={4: "plain:#8fa08f:0.85"},
    lights=(
        Light("sun", (-6, 2.5, 8), 3.6, "#ffe7c4", 0.05),
        Light("area", (-0.5, -0.2, 6.0), 240, "#fff6ea", 5.0),
    ),
    sky=("#e9f0ff", 0.75),
    exposure=0.1,
    samples=32,
    roles={"wood": OAK},
)


def _sleeping(f: Furnishing) -> None:
    f.major("bed", "double bed", "double_bed", (-1.35, 1.735), (1.66, 2.08, 1.0), 0,
            options={"pillows": 0, "throw": False, "headboard": "panel"}, colours={"fabric": "cloth:#9a9c99:#b5b7b2"})  # fmt: skip
    f.on("bed", "pillow_west", "pillow", "head_pillow", (-0.4, 0.68), (0.68, 0.46, 0.17), 4, symmetry=2)
    f.on("bed", "pillow_east", "pillow", "head_pillow", (0.4, 0.7), (0.68, 0.46, 0.17), -3, symmetry=2,
         options={"seed": 4})  # fmt: skip
    f.on("bed", "blanket", "blanket", "folded_throw", (0.12, -0.62), (1.15, 0.5, 0.09), 6, symmetry=2,
         label="folded mustard blanket", colours={"throw": "cloth:#a87a26:#cf9e43"})  # fmt: skip
    for name, x in (("west", -2.46), ("east", -0.26)):
        f.major(f"nightstand_{name}", "nightstand", "nightstand", (x, 2.58), (0.44, 0.4, 0.52))
        f.on(f"nightstand_{name}", f"lamp_{name}", "table lamp", "table_lamp", (0.02, 0.04), (0.28, 0.28, 0.44),
             symmetry=0, shape="round", options={"base": "sphere"})  # fmt: skip
    f.major("wardrobe", "wardrobe", "wardrobe", (0.68, 2.02), (1.46, 0.6, 2.1), -90, options={"style": "plain"},
            colours={"wood": "plain:#dcd7cc:0.45"})  # fmt: skip
    f.put("tree", "potted plant", "indoor_tree", (-3.12, 2.3), (0.78, 0.78, 1.6), label="fiddle-leaf fig in a basket",
          salience="major", symmetry=0, shape="round", options={"kind": "fiddle"})  # fmt: skip
    f.put("rug_bed", "rug", "striped_rug", (-0.12, 1.25), (0.7, 1.3, 0.012), 0, symmetry=2, label="striped bedside rug",
          options={"stripes": 5}, colours={"rug": "cloth:#c8beae:#e2dacb", "rug line": "cloth:#6d7f86:#8d9da2"})  # fmt: skip


def _living(f: Furnishing) -> None:
    f.major("divider", "shelf unit", "shelf_unit", (-1.75, 0.42), (1.6, 0.34, 1.15), 0, symmetry=2,
            label="low cube shelf that divides the room", colours={"wood": ASH})  # fmt: skip
    f.on(
        "divider",
        "divider_plant",
        "potted plant",
        "small_plant",
        (-0.55, 0),
        (0.26, 0.26, 0.34),
        symmetry=0,
        shape="round",
    )
    f.on("divider", "divider_books", "books", "book_pile", (0.42, 0.01), (0.24, 0.2, 0.11), 12, symmetry=2)
    f.major("sofa", "sofa", "sofa", (-1.75, -0.28), (2.12, 0.92, 0.82), 0, options={"arms": "straight", "seats": 2},
            colours={"fabric": "cloth:#4c6470:#6a838f"})  # fmt: skip
    f.on("sofa", "cushion_west", "cushion", "scatter_cushion", (-0.68, 0.03), (0.44, 0.24, 0.42), 5)
    f.on("sofa", "cushion_east", "cushion", "scatter_cushion", (0.66, 0.02), (0.44, 0.24, 0.42), -8,
         options={"seed": 3}, colours={"accent": "cloth:#c7bda9:#e3dccd"})  # fmt: skip
    f.put(
        "rug", "rug", "banded_rug", (-1.72, -1.32), (2.5, 1.75, 0.014), 0, symmetry=2, label="cream rug with a border"
    )
    f.major("coffee_table", "coffee table", "coffee_table", (-1.75, -1.36), (1.0, 0.56, 0.4), 0, symmetry=2,
            colours={"wood": "wood:#4d3524:#765238"})  # fmt: skip
    f.on("coffee_table", "magazine", "magazine", "open_magazine", (-0.24, -0.04), (0.4, 0.28, 0.012), 14)
    f.on("coffee_table", "tray", "tray", "tray", (0.27, 0.05), (0.34, 0.26, 0.05), -6, symmetry=2)
    f.on("tray", "mug", "mug", "mug", (0.06, 0.03), (0.12, 0.085, 0.095), 40)
    f.major("armchair", "armchair", "armchair", (-3.02, -1.55), (0.8, 0.8, 0.78), 68, options={"style": "barrel"},
            colours={"fabric": "cloth:#a5643f:#c48359"})  # fmt: skip
    f.put("floor_lamp", "floor lamp", "floor_lamp", (-3.28, -0.35), (0.42, 0.42, 1.55), label="tripod floor lamp",
          symmetry=0, shape="round", options={"style": "tripod"})  # fmt: skip
    f.major("tv_stand", "tv stand", "tv_stand", (-1.65, -2.57), (1.6, 0.42, 0.48), 180)
    f.on("tv_stand", "tv", "television", "television", (0, 0.05), (1.1, 0.22, 0.7), 0)
    f.put("monstera", "potted plant", "monstera", (-3.1, -2.42), (0.68, 0.68, 0.95), label="monstera in a white pot",
          salience="major", symmetry=0, shape="round")  # fmt: skip
    f.hang("curtain", "curtains", "curtain_pair", (-3.51, -1.0), 0.04, (2.4, 0.15, 2.45), 90,
           colours={"fabric": "sheer:#e9e2d4:0.4"}, options={"drawn": 0.35})  # fmt: skip
    f.put("doormat", "doormat", "striped_rug", (0.76, -2.36), (0.62, 0.42, 0.01), 0, symmetry=2, options={"stripes": 3},
          colours={"rug": "cloth:#5b4a39:#77624d", "rug line": "cloth:#3f3a36:#57504a"})  # fmt: skip
    f.hang("picture", "framed picture", "picture_frame", (1.9, -2.782), 1.2, (0.9, 0.03, 0.65), 180,
           options={"art": "abstract"})  # fmt: skip
    f.hang("clock", "wall clock", "wall_clock", (3.572, -2.35), 1.65, (0.34, 0.05, 0.34), -90)


def _kitchen(f: Furnishing) -> None:
    fronts = {"painted": "plain:#5f7466:0.4", "stone": "stone:#bdb9b1:#d9d6cf"}
    f.major("counter_north", "kitchen counter", "kitchen_counter", (1.97, 0.28), (1.84, 0.62, 1.1), 0,
            label="kitchen counter with sink and hob", options={"sink": "left", "hob": "gas"}, colours=fronts)  # fmt: skip
    f.on("counter_north", "pot", "cooking pot", "cooking_pot", (0.5, -0.12), (0.3, 0.22, 0.17), 20)
    f.major("fridge", "refrigerator", "refrigerator", (3.26, 0.25), (0.64, 0.68, 1.8), 0)
    f.major("counter_east", "kitchen counter", "kitchen_counter", (3.28, -0.86), (1.46, 0.62, 0.9), -90,
            label="kitchen counter", options={"sink": "none", "hob": "none"}, colours=fronts)  # fmt: skip
    f.on("counter_east", "coffee_machine", "coffee machine", "coffee_machine", (-0.42, 0.06), (0.42, 0.38, 0.4), 0)
    f.on("counter_east", "board", "cutting board", "cutting_board", (0.05, -0.1), (0.42, 0.26, 0.022), 10)
    f.on("counter_east", "kettle", "kettle", "kettle", (0.42, 0.1), (0.23, 0.17, 0.25), 40)
    f.on(
        "counter_east", "herbs", "herb pot", "small_plant", (0.6, -0.12), (0.18, 0.18, 0.22), symmetry=0, shape="round"
    )


def _dining(f: Furnishing) -> None:
    f.major("table", "dining table", "dining_table", (1.95, -1.72), (1.35, 0.82, 0.75), 0, symmetry=2,
            options={"legs": "round"}, colours={"wood": ASH})  # fmt: skip
    chair = {"options": {"style": "shell"}, "colours": {"*": "plain:#e3dfd6:0.45", "wood": ASH}}
    for name, x, y, yaw in (
        ("nw", 1.62, -1.03, 2),
        ("ne", 2.28, -1.0, -4),
        ("sw", 1.6, -2.38, 180),
        ("se", 2.34, -2.4, 163),
    ):
        f.major(f"chair_{name}", "chair", "chair", (x, y), (0.46, 0.5, 0.8), yaw, **chair)
    f.on("table", "fruit_bowl", "fruit bowl", "fruit_bowl", (-0.42, 0.08), (0.3, 0.3, 0.16), symmetry=0, shape="round")
    f.on("table", "plate_north", "plate", "plate", (0.33, 0.24), (0.25, 0.25, 0.024), symmetry=0, shape="round")
    f.on("table", "plate_south", "plate", "plate", (0.36, -0.24), (0.25, 0.25, 0.024), symmetry=0, shape="round")
    f.on(
        "table",
        "glass",
        "drinking glass",
        "drinking_glass",
        (0.56, 0.1),
        (0.075, 0.075, 0.12),
        symmetry=0,
        shape="round",
    )
    f.put("pendant", "pendant lamp", "pendant", (1.98, -1.72), (0.38, 0.38, 0.85), base=1.72, placement="ceiling",
          symmetry=0, shape="round", options={"shape": "dome"})  # fmt: skip
