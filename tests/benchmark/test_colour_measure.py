# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour benchmark measures what it says: base colours without light, the picture's without its light, by place."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.prelude.palette import linear_colour
from code_as_room.pipeline.scene.realise import realise_record

from benchmark.ciede import ciede2000, lab
from benchmark.colours import Sheet, sheet_of
from benchmark.shown_colours import Seen, see
from benchmark.true_boxes import Boxes

RED, GREY, WOOD = ((0.5, 0.05, 0.05), (0.4, 0.4, 0.4), (0.3, 0.15, 0.06))
ROOM = """room(size=(3, 3, 2.5), floor=[(-1.5, -1.5), (1.5, -1.5), (1.5, 1.5), (-1.5, 1.5)])
proxy("box_1", "box", centre=(-0.7, 0, 0.25), size=(1, 1, 0.5))
proxy("box_2", "box", centre=(0.7, 0, 0.25), size=(1, 1, 0.5))
furnish("box_1", box((1, 1, 0.5), at=(0, 0, 0.25)))
furnish("box_2", box((1, 1, 0.5), at=(0, 0, 0.25)))
finish("box_1", plastic("#A02020"))
finish("box_2", metal("#B0A080", finish="polished"))
finish("floor", principled(base="#806040"))
light("light_1", "area", at=(0, 0, 2.4), energy=60, size=2)
view("view", exposure=0.5, ceiling=2.5)
camera("reference", "perspective", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 6, 0, 0, 0, 1), fov_y=0.55, image_size=(400, 400))
build()
"""


def seen() -> Seen:
    """A floor of wood with a red box on its left half."""
    numbers = np.ones((40, 60), dtype=np.int64)
    numbers[10:30, 5:25] = 2
    base = np.where((numbers == 2)[..., None], RED, WOOD)
    return Seen(numbers, ("floor", "box"), ("floor", "proxy"), base, base * 0.5)


def measured(light: np.ndarray, gains: object = (1, 1, 1), boxes: dict[str, Boxes] | None = None) -> Sheet:
    return sheet_of("room", "picture.png", seen(), light, np.array(gains, dtype=float), boxes or {})


def test_a_picture_in_the_rooms_own_colours_differs_by_nothing() -> None:
    sheet = measured(seen().base)
    assert sheet.mean() == 0 and sheet.floor is not None and sheet.floor.base == 0


def test_light_is_taken_out_of_the_base_colours_and_left_in_what_is_shown() -> None:
    sheet = measured(seen().base * (0.5, 0.4, 0.3), (2, 2.5, 1 / 0.3))
    assert sheet.mean() == 0
    warm = float(ciede2000(lab(np.array(RED) * 0.5), lab(np.array(RED) * (0.5, 0.4, 0.3))))
    assert sheet.objects[0].shown == pytest.approx(warm, abs=0.01)


def test_another_colour_in_the_picture_counts_for_its_object_alone() -> None:
    light = seen().base.copy()
    light[10:30, 5:25] = GREY
    sheet = measured(light)
    (row,) = sheet.objects
    assert row.base == pytest.approx(float(ciede2000(lab(RED), lab(GREY))), abs=0.01)
    assert sheet.floor is not None and sheet.floor.base == 0 and row.place == "own"


def test_a_true_box_says_where_the_picture_shows_it() -> None:
    light = np.full((40, 60, 3), GREY)
    light[10:30, 35:55] = RED  # the room has it on the wrong side
    light[14:20, 40:46] = WOOD  # and something lies on it
    box, on_it = (35 / 60, 10 / 40, 55 / 60, 30 / 40), (40 / 60, 14 / 40, 46 / 60, 20 / 40)
    (row,) = measured(light, boxes={"box": Boxes(box, (on_it,))}).objects
    assert row.base == 0 and row.place == "true"


def test_a_room_is_seen_in_its_base_colours_without_light(tmp_path: Path) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    realise_record(evaluate(ROOM))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    found = see(tmp_path / "room.blend", 48, 4)
    assert found.base.shape == found.shown.shape == (48, 48, 3)
    for name, code in (("box_1", "A02020"), ("box_2", "B0A080"), ("floor", "806040")):
        mask = found.mask(name)
        assert mask.sum() > 100, name
        assert float(ciede2000(lab(np.median(found.base[mask], axis=0)), lab(linear_colour(code)[:3]))) < 1, name
    left, right = (np.nonzero(found.mask(name))[1].mean() for name in ("box_1", "box_2"))
    assert left < 24 < right and not found.mask("ceiling").any()
