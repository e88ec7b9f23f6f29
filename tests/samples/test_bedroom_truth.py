"""The sample's ground truth is a room one could live in, and its camera sees all of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

FOLDER = Path(__file__).parents[2] / "samples" / "bedroom"
Points = np.ndarray


@pytest.fixture(scope="module")
def truth() -> dict[str, Any]:
    data: dict[str, Any] = json.loads((FOLDER / "truth.json").read_text(encoding="utf-8"))
    return data


def footprint(item: dict[str, Any]) -> Points:
    """Corners (4, 2) of an object's footprint, counter-clockwise."""
    a = np.radians(item["yaw"])
    turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    half = np.array(item["size"][:2]) / 2
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    return corners @ turn.T + item["centre"][:2]


def area(polygon: Points) -> float:
    x, y = polygon.T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


def common_area(a: Points, b: Points) -> float:
    """Area shared by two convex counter-clockwise polygons (Sutherland-Hodgman clipping)."""
    shape = list(a)
    for p, q in zip(b, np.roll(b, -1, 0), strict=True):
        edge = q - p
        side = [float(edge[0] * (v - p)[1] - edge[1] * (v - p)[0]) for v in shape]
        clipped = []
        for i, v in enumerate(shape):
            w, s, t = shape[i - 1], side[i - 1], side[i]
            if s * t < 0:
                clipped.append(w + (v - w) * s / (s - t))
            if t >= 0:
                clipped.append(v)
        if len(clipped) < 3:
            return 0.0
        shape = clipped
    return area(np.array(shape))


def project(camera: dict[str, Any], points: Points) -> Points:
    """Pixels (N, 2), y down, of world points (N, 3)."""
    to_camera = np.linalg.inv(np.array(camera["matrix"]).reshape(4, 4))
    local = points @ to_camera[:3, :3].T + to_camera[:3, 3]
    width, height = camera["image_size"]
    focal = height / 2 / np.tan(camera["fov_y"] / 2)
    return np.column_stack(
        [width / 2 + focal * local[:, 0] / -local[:, 2], height / 2 - focal * local[:, 1] / -local[:, 2]]
    )


def test_document_is_complete(truth: dict[str, Any]) -> None:
    assert truth["format"] == "code-as-room/scene/1"
    assert 18 <= len(truth["objects"]) <= 24
    ids = [o["id"] for o in truth["objects"] + truth["architecture"]]
    assert len(set(ids)) == len(ids)
    for item in truth["objects"]:
        assert min(item["size"]) > 0
        assert np.isfinite(item["centre"] + item["size"] + [item["yaw"]]).all()
        assert item["placement"] in {"floor", "wall", "surface", "ceiling"}
        assert item["salience"] in {"major", "minor"}
    kinds = [a["kind"] for a in truth["architecture"]]
    assert kinds.count("wall") == 4 and "door" in kinds and "window" in kinds


def test_parents_exist_and_carry_what_stands_on_them(truth: dict[str, Any]) -> None:
    by_id = {o["id"]: o for o in truth["objects"]}
    for item in truth["objects"]:
        assert (item["parent"] is not None) == (item["placement"] == "surface")
        if item["parent"] is not None:
            middle = footprint(item).mean(0) + np.array([[0, 0], [0.01, 0], [0, 0.01]])
            assert common_area(middle, footprint(by_id[item["parent"]])) > 0.9 * area(middle)


def test_majors_keep_clear_of_each_other(truth: dict[str, Any]) -> None:
    majors = [o for o in truth["objects"] if o["salience"] == "major"]
    assert len(majors) >= 6
    for i, a in enumerate(majors):
        for b in majors[:i]:
            fa, fb = footprint(a), footprint(b)
            assert common_area(fa, fb) <= 0.02 * min(area(fa), area(fb)), (a["id"], b["id"])


def test_everything_is_inside_the_room(truth: dict[str, Any]) -> None:
    floor = np.array(truth["room"]["floor"])
    for item in truth["objects"]:
        corners = footprint(item)
        assert (corners >= floor.min(0) - 0.005).all() and (corners <= floor.max(0) + 0.005).all(), item["id"]
        low = item["centre"][2] - item["size"][2] / 2
        assert low >= -0.005 and low + item["size"][2] <= truth["room"]["size"][2], item["id"]
        if item["placement"] == "floor":
            assert low == pytest.approx(0, abs=0.005), item["id"]


def test_openings_lie_on_their_walls(truth: dict[str, Any]) -> None:
    walls = {a["id"]: a for a in truth["architecture"] if a["kind"] == "wall"}
    for opening in truth["architecture"]:
        if opening["kind"] == "wall":
            continue
        wall = walls[opening["wall"]]
        start, end = np.array(wall["start"]), np.array(wall["end"])
        along = (end - start) / np.linalg.norm(end - start)
        for point in (opening["start"], opening["end"]):
            away = np.array(point) - start
            assert abs(along[0] * away[1] - along[1] * away[0]) < 1e-6
            assert 0 <= away @ along <= np.linalg.norm(end - start)
        assert opening["sill"] + opening["height"] <= wall["height"]


def test_camera_sees_floor_and_wall_tops(truth: dict[str, Any]) -> None:
    camera = truth["camera"]
    floor = np.array(truth["room"]["floor"])
    for z in (0.0, truth["room"]["size"][2]):
        pixels = project(camera, np.column_stack([floor, np.full(len(floor), z)]))
        assert (pixels > 0).all() and (pixels < camera["image_size"]).all()
    north_west = project(camera, np.array([[floor[:, 0].min(), floor[:, 1].max(), 0.0]]))[0]
    assert north_west[0] < camera["image_size"][0] / 2 and north_west[1] < camera["image_size"][1] / 2


def test_picture_shows_the_room_where_the_camera_says(truth: dict[str, Any]) -> None:
    """Just outside the inner edge of the wall tops is the light grey cut, well outside is paper."""
    with Image.open(FOLDER / truth["image"]) as image:
        assert list(image.size) == truth["camera"]["image_size"]
        pixels = np.asarray(image.convert("RGB")).astype(float)
    w, d, h = truth["room"]["size"]
    cut = project(
        truth["camera"],
        np.array([[w / 2 + 0.06, 0, h], [-w / 2 - 0.06, 0, h], [0, d / 2 + 0.06, h], [0, -d / 2 - 0.06, h]]),
    )
    colours = np.array([pixels[int(y), int(x)] for x, y in cut])
    assert np.ptp(colours, axis=0).max() < 12
    paper = pixels[4, 4]
    assert paper.min() > 240
    assert (np.abs(colours - paper).max(1) > 15).all()
