# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark's own rooms: what their truth says is what their pictures show, and one could stand in them."""

from __future__ import annotations

import json
from functools import cache
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.geometry.camera import project
from code_as_room.pipeline.geometry.polygon import (
    area,
    intersection_area,
    nearest_wall,
    outside_fraction,
    rectangle_corners,
)
from PIL import Image

from benchmark.metrics import load_truth
from benchmark.metrics.rooms import outline_of
from benchmark.pictures import make
from benchmark.pictures.model import outset

Truth = dict[str, Any]
rooms = pytest.mark.parametrize("room", make.ROOMS)
FLAT = 0.02


@cache
def truth(room: str) -> Truth:
    found: Truth = json.loads((make.FOLDER / room / "truth.json").read_text(encoding="utf-8"))
    return found


@cache
def pixels(room: str) -> np.ndarray:
    with Image.open(make.FOLDER / room / truth(room)["image"]) as image:
        assert list(image.size) == truth(room)["camera"]["image_size"]
        return np.asarray(image.convert("RGB")).astype(float)


def camera(room: str) -> CameraModel:
    return CameraModel(**truth(room)["camera"])


def outline(item: Truth) -> Any:
    return item.get("footprint") or outline_of(item["centre"], item["size"], item["yaw"], item["shape"])


def ends(item: Truth) -> tuple[float, float]:
    half = item["size"][2] / 2
    return item["centre"][2] - half, item["centre"][2] + half


def projected(room: str, item: Truth) -> list[float]:
    """The box around an object's oriented box in the picture."""
    plan = rectangle_corners(item["centre"], item["size"], item["yaw"]).tolist()
    points = project(camera(room), [(x, y, z) for x, y in plan for z in ends(item)])
    return [*points.min(axis=0), *points.max(axis=0)]


def sides(box: dict[str, float]) -> list[float]:
    return [box["x_min"], box["y_min"], box["x_max"], box["y_max"]]


def within(inner: list[float], outer: list[float], slack: float) -> bool:
    return all(a >= b - slack for a, b in zip(inner[:2], outer[:2], strict=True)) and all(
        a <= b + slack for a, b in zip(inner[2:], outer[2:], strict=True)
    )


@rooms
def test_the_stated_camera_puts_every_object_where_the_picture_shows_it(room: str) -> None:
    for item in truth(room)["objects"]:
        whole, box, seen = projected(room, item), sides(item["box"]), sides(item["visible_box"])
        assert within(box, whole, 2.5), item["id"]
        assert within(seen, box, 2.5), item["id"]
        width, depth = whole[2] - whole[0], whole[3] - whole[1]
        # Round and soft things fill their oriented boxes less than square ones, turned ones least.
        assert (box[2] - box[0]) * (box[3] - box[1]) > 0.25 * width * depth, item["id"]
        assert item["visible"] >= 0.15, item["id"]


@rooms
def test_floor_and_cut_walls_are_where_the_camera_says(room: str) -> None:
    """A wall's top has one colour all along, and beyond it the paper begins."""
    floor, wall = truth(room)["room"]["floor"], truth(room)["architecture"][0]
    high = 0.0 if make.scene_of(room).plan else truth(room)["room"]["size"][2]

    def colours(away: float) -> np.ndarray:
        places = []
        line = outset(tuple(map(tuple, floor)), away)
        for (ax, ay), (bx, by), opening in zip(line, line[1:] + line[:1], range(len(line)), strict=True):
            shares = [s for s in (0.04, 0.97) if high or not blocked(room, opening, s)]
            places += [(ax + (bx - ax) * s, ay + (by - ay) * s, high) for s in shares]
        picture = pixels(room)
        height, width = picture.shape[:2]
        spots = project(camera(room), places) * (width / 1000, height / 1000)
        return np.array([picture[int(y) - 1 : int(y) + 2, int(x) - 1 : int(x) + 2].mean(axis=(0, 1)) for x, y in spots])

    cap, paper = colours(wall["thickness"] / 2), colours(wall["thickness"] + 0.06)
    assert np.ptp(cap, axis=0).max() < 30
    assert np.abs(cap.mean(axis=0) - paper.mean(axis=0)).max() > 12


def blocked(room: str, number: int, share: float) -> bool:
    """Whether a plan's wall has an opening there."""
    a, b = (np.array(truth(room)["architecture"][number][end]) for end in ("start", "end"))
    holes = [o for o in truth(room)["architecture"] if o["wall"] == f"wall_{number + 1}"]
    at = share * np.linalg.norm(b - a)
    spans = [(np.linalg.norm(np.array(o["start"]) - a), np.linalg.norm(np.array(o["end"]) - a)) for o in holes]
    return any(low - 0.1 < at < high + 0.1 for low, high in spans)


@rooms
def test_everything_is_in_the_room_and_rests_on_something(room: str) -> None:
    size, floor = truth(room)["room"]["size"], truth(room)["room"]["floor"]
    by_id = {o["id"]: o for o in truth(room)["objects"]}
    for item in by_id.values():
        low, top = ends(item)
        assert outside_fraction(outline(item), floor) < 0.01, item["id"]
        assert low >= -1e-6 and top <= size[2] + 1e-6, item["id"]
        if item["placement"] == "floor":
            assert low == pytest.approx(0, abs=1e-6), item["id"]
        elif item["placement"] == "surface":
            parent = by_id[item["parent"]]
            shared = intersection_area(outline(item), outline(parent)) / area(outline(item))
            assert shared > 0.75, item["id"]
            assert 0 < low <= ends(parent)[1] + 0.01, item["id"]
        elif item["placement"] == "wall":
            assert nearest_wall(item["centre"][:2], floor).distance < item["size"][1] / 2 + 0.03, item["id"]
        else:
            assert item["placement"] == "ceiling", item["id"]
        assert (item["placement"] == "surface") == (item["parent"] is not None), item["id"]


@rooms
def test_nothing_stands_in_anything_else(room: str) -> None:
    """But for what lies on another thing, and chairs that are said to be pushed under a table."""
    for a, b in combinations(truth(room)["objects"], 2):
        if a["id"] in (b["parent"], b.get("under")) or b["id"] in (a["parent"], a.get("under")):
            continue
        if min(a["size"][2], b["size"][2]) < FLAT:  # rugs and papers
            continue
        if "curtains" in (a["category"], b["category"]):  # cloth gives way
            continue
        (low_a, top_a), (low_b, top_b) = ends(a), ends(b)
        if min(top_a, top_b) - max(low_a, low_b) > 0.02:
            shared = intersection_area(outline(a), outline(b))
            # Round things do not reach into the corners of their boxes.
            assert shared <= 0.05 * min(area(outline(a)), area(outline(b))), (a["id"], b["id"])


@rooms
def test_things_keep_clear_of_partitions_and_openings_lie_on_their_walls(room: str) -> None:
    items = [o for o in truth(room)["objects"] if o["size"][2] > FLAT and o["placement"] == "floor"]
    for line in truth(room)["architecture"]:
        start, end = np.array(line["start"]), np.array(line["end"])
        if line["kind"] == "partition":
            along = (end - start) / np.linalg.norm(end - start)
            side = np.array([-along[1], along[0]]) * line["thickness"] / 2
            wall = [tuple(p) for p in (start - side, end - side, end + side, start + side)]
            for item in items:
                assert intersection_area(outline(item), wall) < 1e-3, item["id"]
        elif line["wall"]:
            for point in (start, end):
                assert nearest_wall(point, truth(room)["room"]["floor"]).distance < 1e-3, line["id"]


@rooms
def test_the_files_are_those_of_the_description(room: str) -> None:
    """Who changes a room's description has to make its picture again."""
    scene = make.scene_of(room)
    stated = {o["id"]: o for o in truth(room)["objects"]}
    assert list(stated) == [item.id for item in scene.items]
    for item in scene.items:
        kept = stated[item.id]
        assert kept["category"] == item.category and kept["placement"] == item.placement
        assert kept["size"] == pytest.approx(item.size, abs=1e-4)
        assert kept["centre"][:2] == pytest.approx((item.x, item.y), abs=1e-4)
        assert (kept["yaw"] - item.yaw + 180) % 360 == pytest.approx(180, abs=0.01)
    assert camera(room) == scene.camera
    for zone in truth(room)["zones"]:
        assert {zone["anchor"], *zone["objects"]} <= set(stated)


@rooms
def test_pictures_are_bright_enough_and_small_enough(room: str) -> None:
    assert (make.FOLDER / room / "picture.png").stat().st_size < 1_500_000
    inner = project(camera(room), [(x * 0.9, y * 0.9, 0.0) for x, y in truth(room)["room"]["floor"]])
    height, width = pixels(room).shape[:2]
    (x0, y0), (x1, y1) = inner.min(axis=0), inner.max(axis=0)
    middle = pixels(room)[
        int(y0 * height / 1000) : int(y1 * height / 1000), int(x0 * width / 1000) : int(x1 * width / 1000)
    ]
    assert (middle.max(axis=2) < 12).mean() < 0.1
    assert middle.std() > 12


def test_the_benchmark_reads_them() -> None:
    studio = load_truth(make.FOLDER / "studio_l" / "truth.json")
    assert len(studio.floor) == 6 and studio.size == pytest.approx((7.2, 5.6))
    assert sum(thing.major for thing in studio.things) >= 12


def test_a_plan_is_drawn_again_as_it_is_kept(tmp_path: Any) -> None:
    assert make.make("flat_plan", tmp_path) == truth("flat_plan")
    with Image.open(tmp_path / "picture.png") as new, Image.open(make.FOLDER / "flat_plan" / "picture.png") as kept:
        # Fonts may be drawn a little otherwise by another Pillow.
        difference = np.abs(np.asarray(new.convert("L"), dtype=float) - np.asarray(kept.convert("L"), dtype=float))
    assert (difference > 64).mean() < 0.001
