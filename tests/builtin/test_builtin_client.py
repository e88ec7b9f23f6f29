# SPDX-License-Identifier: GPL-3.0-or-later
"""The built-in picture analysis on rooms painted with known content, and on pictures that show no room."""

from __future__ import annotations

import json
import threading
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.replies import (
    AnalysisReply,
    AuxiliaryReply,
    CritiqueReply,
    GraphReply,
    SecondLookReply,
)
from code_as_room.pipeline.errors import Cancelled, ModelError, PictureError
from code_as_room.pipeline.models.base import Prompt
from code_as_room.pipeline.models.builtin.client import BuiltinClient
from code_as_room.pipeline.models.schema import strict_schema
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image, ImageDraw

WHITE = {"surround": (255, 255, 255), "wall": (205, 205, 205), "floor": (226, 224, 220), "wood": 0.0}
DARK = {"surround": (20, 20, 22), "wall": (62, 62, 66), "face": (80, 80, 84), "floor": (48, 44, 41), "wood": 4.0}
STYLES: dict[str, dict[str, Any]] = {
    "plain": {"wood": 0.0},
    "planks": {},
    "dark": DARK,
    "grey_perspective": {"shrink": 0.85, "wood": 0.0, "floor": (140, 140, 145)},
    "deep_perspective": {"shrink": 0.7},
    "noisy": {"noise": 12.0},
    "notched": {"notch": True},
    "notched_perspective": {"notch": True, "shrink": 0.75},
}


@pytest.fixture(scope="module")
def bedrooms(studio: Any) -> dict[str, tuple[Any, AnalysisReply, Any]]:
    """Every style of the bedroom, analysed once."""
    result = {}
    for number, (name, options) in enumerate(STYLES.items()):
        painted = studio.bedroom(studio.style(**options), seed=number)
        reply, _ = studio.ask(painted.png())
        result[name] = (painted, reply, studio.compare(painted, reply))
    return result


@pytest.mark.parametrize("name", STYLES)
def test_outline_view_and_corner_count(bedrooms: Any, name: str) -> None:
    painted, reply, match = bedrooms[name]
    assert match.outline_error < 20
    assert reply.view == ("perspective" if STYLES[name].get("shrink", 1.0) < 1 else "orthographic")
    assert len(reply.floor_polygon) == len(painted.floor)
    assert (reply.wall_top_polygon is not None) == (reply.view == "perspective")


@pytest.mark.parametrize("name", STYLES)
def test_most_furniture_is_found_and_little_is_invented(bedrooms: Any, name: str) -> None:
    _, _, match = bedrooms[name]
    assert match.recall >= 0.7, match.found
    assert len(match.phantoms) <= 2, match.phantoms


def test_recall_and_precision_over_all_bedrooms(bedrooms: Any) -> None:
    matches = [match for _, _, match in bedrooms.values()]
    assert np.mean([m.recall for m in matches]) >= 0.9
    assert np.mean([m.precision for m in matches]) >= 0.85


@pytest.mark.parametrize("options", [{"wood": 0.0, "floor": (150, 155, 160)}, {}, DARK, {"shrink": 0.8}])
def test_office_categories_and_scale(studio: Any, options: dict[str, Any]) -> None:
    painted = studio.office(studio.style(**options))
    reply, notes = studio.ask(painted.png())
    match = studio.compare(painted, reply)
    assert match.recall >= 0.8 and len(match.phantoms) <= 1
    kinds = {o.category for o in reply.objects}
    assert "sofa" in kinds
    assert kinds & {"desk", "dining_table", "table"}
    assert reply.room_width_m / reply.room_depth_m == pytest.approx(4.6 / 3.4, rel=0.03)
    assert any("scale" in note.lower() or "square metres" in note for note in notes)


def test_bed_rug_and_nightstands_are_told_apart(bedrooms: Any) -> None:
    _, reply, _ = bedrooms["planks"]
    by_kind = {o.category: o for o in reply.objects}
    assert {"double_bed", "rug", "nightstand", "potted_plant"} <= set(by_kind)
    bed, rug = by_kind["double_bed"], by_kind["rug"]
    assert rug.size_m.height < 0.05 and rug.placement == "floor"
    assert bed.size_m.depth == pytest.approx(2.05, abs=0.12) and bed.size_m.width == pytest.approx(1.6, abs=0.15)
    assert bed.facing == "down"
    pillows = [o for o in reply.objects if o.category == "pillow"]
    assert all(p.parent == bed.id and p.placement == "surface" and p.salience == "minor" for p in pillows)


def test_turned_armchair_keeps_its_angle(bedrooms: Any) -> None:
    _, reply, _ = bedrooms["plain"]
    chair = next(o for o in reply.objects if o.category == "armchair")
    assert min((chair.yaw_deg + 32) % 90, (-chair.yaw_deg - 32) % 90) < 6  # turned 32 degrees clockwise as seen
    assert max(chair.size_m.width, chair.size_m.depth) < 1.0


def test_perspective_footprints_stand_back_to_the_wall(studio: Any) -> None:
    painter = studio.painter(4.2, 3.8, studio.style(shrink=0.75, wood=0.0), 700, 1)
    painter.thing("wardrobe", 1.78, 0.2, 0.6, 1.6, (120, 80, 60), 0.8)
    painter.thing("desk", -1.0, -1.55, 1.4, 0.7, (60, 60, 110), 0.28)
    reply, _ = studio.ask(painter.finish().png(), known_width_m=4.2)
    wardrobe = max(reply.objects, key=lambda o: o.centre_m.x_m)
    assert wardrobe.centre_m.x_m == pytest.approx(1.78, abs=0.12)
    assert wardrobe.centre_m.y_m == pytest.approx(-0.2, abs=0.12)
    assert wardrobe.size_m.width == pytest.approx(1.6, abs=0.2)
    assert reply.room_width_m == pytest.approx(4.2, abs=1e-3)


@pytest.mark.parametrize("make", ["jpeg", "tiny", "portrait"])
def test_poor_pictures_still_give_the_room(studio: Any, make: str) -> None:
    painted = studio.bedroom(studio.style(), seed=3, long_side=160 if make == "tiny" else 600)
    if make == "portrait":
        painted.image = painted.image.transpose(Image.Transpose.ROTATE_90)
        painted.floor = [(y, 1000 - x) for x, y in painted.floor]
        painted.boxes = {k: (b[1], 1000 - b[2], b[3], 1000 - b[0]) for k, b in painted.boxes.items()}
    reply, _ = studio.ask(painted.jpeg(35) if make == "jpeg" else painted.png())
    match = studio.compare(painted, reply)
    assert match.outline_error < 20
    assert match.recall >= 0.7 and len(match.phantoms) <= 2


def test_white_on_white(studio: Any) -> None:
    painted = studio.bedroom(studio.style(**WHITE), seed=4)
    reply, _ = studio.ask(painted.png())
    match = studio.compare(painted, reply)
    assert match.outline_error < 40
    assert match.recall >= 0.7 and len(match.phantoms) <= 2


def _line_plan() -> tuple[Image.Image, dict[str, tuple[float, float, float, float]]]:
    image = Image.new("L", (900, 800), 255)
    draw = ImageDraw.Draw(image)
    draw.rectangle([50, 50, 850, 750], fill=0)
    draw.rectangle([75, 75, 825, 725], fill=255)
    draw.rectangle([300, 50, 480, 75], fill=255, outline=0)  # window
    draw.rectangle([600, 725, 770, 750], fill=255)  # door gap
    boxes = {
        "bed": (90.0, 78.0, 400.0, 470.0),
        "wardrobe": (700.0, 200.0, 822.0, 520.0),
        "table": (420.0, 560.0, 560.0, 690.0),
    }
    for x0, y0, x1, y1 in boxes.values():
        draw.rectangle([x0, y0, x1, y1], outline=0, width=2)
    draw.rectangle([120, 100, 230, 170], outline=0, width=2)
    draw.rectangle([260, 100, 370, 170], outline=0, width=2)
    return image, {k: (b[0] / 0.9, b[1] / 0.8, b[2] / 0.9, b[3] / 0.8) for k, b in boxes.items()}


def test_line_plan_with_door_and_window(studio: Any) -> None:
    image, boxes = _line_plan()
    reply, _ = studio.ask(studio.encode(image, "PNG"))
    assert reply.view == "plan" and reply.wall_top_polygon is None
    xs, ys = [p.x for p in reply.floor_polygon], [p.y for p in reply.floor_polygon]
    assert (min(xs), min(ys)) == pytest.approx((83.3, 93.8), abs=12)
    assert (max(xs), max(ys)) == pytest.approx((916.7, 906.3), abs=12)
    for name, box in boxes.items():
        close = [o for o in reply.objects if np.allclose(list(o.box.model_dump().values()), box, atol=15)]
        assert close, name
    kinds = {a.kind: a for a in reply.architecture}
    assert set(kinds) == {"door", "window"}
    assert kinds["window"].wall == "top" and kinds["door"].wall == "bottom"


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    width=st.integers(1, 90),
    height=st.integers(1, 90),
    seed=st.integers(0, 10**6),
    kind=st.sampled_from(["noise", "flat", "stripes", "blocks", "blobs"]),
)
def test_any_picture_gives_a_valid_answer(studio: Any, width: int, height: int, seed: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    if kind == "noise":
        values = rng.integers(0, 256, (height, width, 3))
    elif kind == "flat":
        values = np.ones((height, width, 3)) * rng.integers(0, 256, 3)
    elif kind == "stripes":
        values = np.ones((height, width, 3)) * rng.integers(0, 256, (1, width, 3))
    elif kind == "blocks":
        values = np.kron(rng.integers(0, 256, (height // 9 + 1, width // 9 + 1, 3)), np.ones((9, 9, 1)))
        values = values[:height, :width]
    else:
        ys, xs = np.mgrid[0:height, 0:width]
        values = np.stack([127 + 120 * np.sin(xs / rng.uniform(2, 20) + c) * np.cos(ys / 9) for c in range(3)], -1)
    reply, _ = studio.ask(studio.encode(Image.fromarray(np.asarray(values, dtype=np.uint8)), "PNG"))
    assert len(reply.floor_polygon) >= 4
    assert reply.room_width_m > 0 and reply.room_depth_m > 0
    for item in reply.objects:
        box = item.box
        assert 0 <= box.x_min < box.x_max <= 1000 and 0 <= box.y_min < box.y_max <= 1000
        assert min(item.size_m.width, item.size_m.depth, item.size_m.height) > 0
    ids = [o.id for o in reply.objects]
    assert len(ids) == len(set(ids))
    assert all(o.parent is None or o.parent in ids or o.placement == "wall" for o in reply.objects)


@pytest.mark.parametrize("mode", ["RGBA", "LA", "CMYK", "P", "1", "L", "I;16"])
def test_picture_modes(studio: Any, mode: str) -> None:
    image = studio.bedroom(studio.style(), long_side=200).image
    if mode == "I;16":
        image = Image.fromarray(np.asarray(image.convert("L")).astype(np.uint16) * 257)
    else:
        image = image.convert(mode)
    reply, _ = studio.ask(studio.encode(image, "TIFF"))
    assert len(reply.floor_polygon) >= 4


def test_a_picture_without_a_room_says_so(studio: Any) -> None:
    reply, notes = studio.ask(studio.encode(Image.new("RGB", (300, 200), (90, 90, 90)), "PNG"))
    assert not reply.objects
    assert {(p.x, p.y) for p in reply.floor_polygon} == {(0, 0), (1000, 0), (1000, 1000), (0, 1000)}
    assert any("No walls were seen" in note for note in notes)


@pytest.mark.parametrize("data", [b"", b"not a picture", b"\x89PNG\r\n\x1a\n" + b"\0" * 40])
def test_unreadable_bytes_are_a_plain_error(studio: Any, data: bytes) -> None:
    with pytest.raises(PictureError, match="cannot be read"):
        studio.ask(data)


def test_no_picture_and_cancel() -> None:
    prompt = Prompt("s01_analysis", "01_analysis", "", (), "AnalysisReply", {}, "")
    with pytest.raises(ModelError, match="no picture"):
        BuiltinClient().answer(prompt, threading.Event())
    stop = threading.Event()
    stop.set()
    with pytest.raises(Cancelled):
        BuiltinClient().answer(prompt, stop)


def test_cancel_while_at_work(studio: Any) -> None:
    stop = threading.Event()
    data = studio.bedroom(studio.style(), long_side=200).png()
    prompt = Prompt("s01_analysis", "01_analysis", "", (data,), "AnalysisReply", {}, "")
    with pytest.raises(Cancelled):
        BuiltinClient().answer(prompt, stop, lambda text: stop.set())


@pytest.mark.parametrize(
    ("key", "reply"),
    [
        ("01_second_look", SecondLookReply),
        ("02_graph", GraphReply),
        ("03_critique/2", CritiqueReply),
        ("04_auxiliary", AuxiliaryReply),
    ],
)
def test_other_requests_get_an_empty_valid_answer(key: str, reply: Any) -> None:
    prompt = Prompt("s", key, "", (), reply.__name__, strict_schema(reply), "")
    answer = reply.model_validate(json.loads(BuiltinClient().answer(prompt, threading.Event()).text))
    assert all(not value for value in answer.model_dump().values())


def test_same_picture_same_answer(studio: Any) -> None:
    data = studio.bedroom(studio.style(), long_side=240).png()
    assert studio.ask(data)[0] == studio.ask(data)[0]
