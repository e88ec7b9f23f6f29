# SPDX-License-Identifier: GPL-3.0-or-later
"""Vendors' habits of giving places in a picture are read as what was asked for, and honest answers stay as they are."""

from __future__ import annotations

import copy
import json
import random
from pathlib import Path

import pytest
from code_as_room.pipeline.artifacts.replies import AnalysisReply
from code_as_room.pipeline.models.coordinates import as_asked
from code_as_room.pipeline.models.validate import validate_reply
from hypothesis import given, settings
from hypothesis import strategies as st

SIZE = (1568, 1176)
SAMPLE = Path(__file__).parents[2] / "samples" / "bedroom" / "replies" / "replies.json"


def room(count=12, seed=3):
    """An honest analysis: things in a room of 5 x 4 m, seen straight from above."""
    rnd = random.Random(seed)
    objects = []
    for n in range(count):
        x, y = rnd.uniform(-2.3, 2.3), rnd.uniform(-1.8, 1.8)
        px, py = 500 + x * 180, 500 - y * 220
        box = {"x_min": px - 40, "y_min": py - 30, "x_max": px + 40, "y_max": py + 30}
        size = {"width": 0.4, "depth": 0.3, "height": 0.5}
        objects.append({"id": f"o{n}", "category": "box", "box": box, "centre_m": {"x_m": x, "y_m": y}, "size_m": size})
    corners = [{"x": x, "y": y} for x, y in ((50, 940), (950, 940), (950, 60), (50, 60))]
    return {"view": "orthographic", "room_width_m": 5, "room_depth_m": 4, "floor_polygon": corners, "objects": objects}


def read(data, model="m"):
    return validate_reply(json.dumps(data), AnalysisReply, mend=lambda d: as_asked(d, model, [SIZE]))


def mapped(data, change_box, change_point):
    data = copy.deepcopy(data)
    for thing in data["objects"]:
        change_box(thing)
    data["floor_polygon"] = [change_point(corner) for corner in data["floor_polygon"]]
    return data


def lists(y_first):
    def box(thing):
        b = thing.pop("box")
        values = [b["y_min"], b["x_min"], b["y_max"], b["x_max"]] if y_first else list(b.values())
        thing["box_2d" if y_first else "bbox_2d"] = values

    return box, lambda p: [p["y"], p["x"]] if y_first else [p["x"], p["y"]]


def scaled(by_x, by_y):
    def box(thing):
        thing["box"] = {k: v * (by_x if k[0] == "x" else by_y) for k, v in thing["box"].items()}

    return box, lambda p: {"x": p["x"] * by_x, "y": p["y"] * by_y}


def exchanged():
    def box(thing):
        b = thing["box"]
        thing["box"] = {"x_min": b["y_min"], "y_min": b["x_min"], "x_max": b["y_max"], "y_max": b["x_max"]}

    return box, lambda p: {"x": p["y"], "y": p["x"]}


def cornered():
    def box(thing):
        b = thing["box"]
        thing["box"] = {
            "x": b["x_min"],
            "y": b["y_min"],
            "width": b["x_max"] - b["x_min"],
            "height": b["y_max"] - b["y_min"],
        }

    return box, lambda p: p


@pytest.mark.parametrize(
    ("habit", "model", "said"),
    [
        (lists(True), "gemini-2.5-pro", "lists of y and x"),
        (lists(False), "qwen3-vl-8b", ""),
        (scaled(1e-3, 1e-3), "m", "fractions"),
        (scaled(SIZE[0] / 1000, SIZE[1] / 1000), "claude-opus-5", "pixels"),
        (exchanged(), "m", "the other way round"),
        (cornered(), "m", ""),
    ],
    ids=["y first", "lists", "fractions", "pixels", "axes exchanged", "x y width height"],
)
def test_habits_are_read_as_what_was_asked_for(habit, model, said):
    honest = room()
    reply, notes = read(mapped(honest, *habit), model)
    for thing, wanted in zip(reply.objects, honest["objects"], strict=True):
        assert thing.box.model_dump() == pytest.approx(wanted["box"], abs=0.01)
    for corner, wanted in zip(reply.floor_polygon, honest["floor_polygon"], strict=True):
        assert corner.model_dump() == pytest.approx(wanted, abs=0.01)
    assert said in " ".join(notes)


def test_honest_answers_stay_as_they_are():
    honest = room()
    # Corners may lie outside of a cropped picture, and one box may be a slip.
    honest["floor_polygon"][1]["x"] = 1400.0
    honest["objects"][0]["box"]["x_max"] = 1300.0
    assert as_asked(honest, "gemini-2.5-pro", [SIZE]) == (honest, ())
    few = room(3)
    assert as_asked(mapped(few, *exchanged()), "m", [SIZE])[1] == ()
    assert (
        as_asked({"edits": [{"box": {"x_min": 0.2, "y_min": 0.1, "x_max": 0.9, "y_max": 1.0}}]}, "m", [SIZE])[1] == ()
    )


def test_the_samples_recorded_answers_are_not_changed():
    replies = json.loads(SAMPLE.read_text(encoding="utf-8"))["replies"]
    for key, entry in replies.items():
        for model in ("gemini-3-pro", "m"):
            assert as_asked(entry["reply"], model, [SIZE, (1200, 1040)]) == (entry["reply"], ()), key


def test_pixels_of_the_picture_as_claude_sees_it_are_tried_first():
    small = (1238, 929)
    honest = room(40)
    data = mapped(honest, *scaled(small[0] / 1000, small[1] / 1000))
    result, notes = as_asked(data, "claude-sonnet-4-5", [small, SIZE])
    assert "pixels" in notes[0]
    assert result["objects"][0]["box"]["x_min"] == pytest.approx(honest["objects"][0]["box"]["x_min"])


NUMBERS = st.one_of(st.integers(-(10**400), 10**400), st.floats(), st.text(max_size=3), st.none(), st.booleans())
NAMES = st.sampled_from(
    ["box", "box_2d", "bbox", "objects", "floor_polygon", "x_min", "x", "y", "centre_m", "x_m", "a"]
)
ANYTHING = st.recursive(
    NUMBERS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(NAMES, inner, max_size=5), max_leaves=40
)


@settings(max_examples=150, deadline=None)
@given(ANYTHING)
def test_nothing_that_a_model_may_write_breaks_it(data):
    before = copy.deepcopy(data)
    result, notes = as_asked(data, "gemini", [SIZE, (0, 0)])
    assert repr(data) == repr(before) and type(result) is type(data) and isinstance(notes, tuple)
