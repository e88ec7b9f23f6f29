# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of objects measured in a picture: robust to shadow, light and what lies on top."""

from __future__ import annotations

import io

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine, RoomLine
from code_as_room.pipeline.artifacts.objects import MeasuredColour, ObjectDescription
from code_as_room.pipeline.objects.colours import (
    BRIGHTEST,
    ColourMeter,
    as_paint,
    clean_code,
    colour_distance,
    dominant,
    from_code,
)
from code_as_room.pipeline.objects.tinting import tints_for
from code_as_room.pipeline.picture import ReferencePicture, read_picture
from PIL import Image, ImageDraw

# Straight down, 5 m over 5 m in 500 pixels: 1 m is 100 pixels.
CAMERA = CameraModel(
    kind="orthographic",
    matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 10, 0, 0, 0, 1),
    ortho_height=5.0,
    image_size=(500, 500),
)
ROOM = RoomLine(size=(4, 4, 2.5), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])


def thing(
    name: str, at: tuple[float, float], size: tuple[float, float, float], z: float = 0.0, **more: object
) -> ProxyLine:
    values = {"id": name, "category": "table", "centre": (*at, z + size[2] / 2), "size": size, **more}
    return ProxyLine.model_validate(values)


def picture(*boxes: tuple[tuple[float, float, float, float], str], wall: str = "#EDEDED") -> ReferencePicture:
    """Boxes (x, y, width, depth in metres) in colours on a floor, in a light room."""
    image = Image.new("RGB", (500, 500), "white")
    draw = ImageDraw.Draw(image)
    draw.rectangle((50, 50, 450, 450), fill=wall)
    draw.rectangle((60, 60, 440, 440), fill="#A08060")
    draw.rectangle((60, 60, 440, 140), fill=wall)
    for (x, y, w, d), colour in boxes:
        draw.rectangle(
            (250 + 100 * (x - w / 2), 250 - 100 * (y + d / 2), 250 + 100 * (x + w / 2), 250 - 100 * (y - d / 2)),
            fill=colour,
        )
    buffer = io.BytesIO()
    image.save(buffer, "PNG")
    return read_picture(buffer.getvalue(), "room.png")


def measured(shown: ReferencePicture, *things: ProxyLine) -> tuple[list[MeasuredColour], float]:
    return ColourMeter(shown, CAMERA, Layout(room=ROOM, proxies=list(things))).measure(things[0])


def test_a_plain_object_has_its_colour() -> None:
    colours, seen = measured(picture(((0, 0, 1, 1), "#3A6EA5")), thing("a", (0, 0), (1, 1, 0.5)))
    assert colour_distance(colours[0].code, "3A6EA5") < 0.06 and seen > 0.95


def test_a_shadow_over_half_of_it_is_not_its_colour() -> None:
    shown = picture(((0, 0, 1, 1), "#C04030"), ((-0.25, 0, 0.5, 1), "#7E2A20"))
    colours, _ = measured(shown, thing("a", (0, 0), (1, 1, 0.5)))
    hue = from_code(colours[0].code)
    assert hue[0] > 3 * hue[2]
    assert colour_distance(colours[0].code, "C04030") < colour_distance("7E2A20", "C04030") or len(colours) == 2


def test_what_stands_on_it_is_not_measured() -> None:
    shown = picture(((0, 0, 1, 1), "#3A6EA5"), ((0, 0, 0.8, 0.8), "#D02020"))
    table, tray = thing("a", (0, 0), (1, 1, 0.5)), thing("b", (0, 0), (0.8, 0.8, 0.1), 0.5, parent="a")
    colours, seen = measured(shown, table, tray)
    assert colours and colour_distance(colours[0].code, "3A6EA5") < 0.08
    assert seen < 0.5
    on_it, _ = ColourMeter(shown, CAMERA, Layout(room=ROOM, proxies=[table, tray])).measure(tray)
    assert colour_distance(on_it[0].code, "D02020") < 0.08


def test_a_hidden_object_says_that_nothing_is_seen() -> None:
    shown = picture(((0, 0, 1.4, 1.4), "#D02020"))
    colours, seen = measured(shown, thing("a", (0, 0), (1, 1, 0.4)), thing("b", (0, 0), (1.4, 1.4, 0.1), 1.0))
    assert colours == [] and seen == 0.0


def test_warm_light_is_taken_out() -> None:
    def in_light(red: float, green: float, blue: float) -> ReferencePicture:
        shown = picture(((0, -0.5, 1, 1), "#909090"))
        pixels = shown.pixels().astype(float) * np.array((red, green, blue))
        buffer = io.BytesIO()
        Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8)).save(buffer, "PNG")
        return read_picture(buffer.getvalue(), "room.png")

    table = thing("a", (0, -0.5), (1, 1, 0.5))
    plain = np.ptp(from_code(measured(in_light(1, 0.94, 0.86), table)[0][0].code))
    raw = np.ptp(from_code("908778"[:6]))
    assert plain < 0.6 * raw


def test_pale_colours_keep_their_hue_when_they_are_brought_to_neutral_light() -> None:
    pink, burnt = np.array((0.9, 0.72, 0.66)), np.array((0.99, 0.97, 0.95))
    gains = np.array((1.3, 1.35, 1.4))
    paint = as_paint(pink, gains)
    assert paint.max() == pytest.approx(BRIGHTEST)
    assert np.allclose(paint / paint.max(), pink * gains / (pink * gains).max())
    assert as_paint(burnt, gains).tolist() == [1.0, 1.0, 1.0]
    dark = np.array((0.2, 0.3, 0.1))
    assert np.allclose(as_paint(dark, gains), dark * gains)


def test_a_round_thing_is_not_measured_as_the_floor_round_it() -> None:
    shown = picture()
    image = Image.open(io.BytesIO(shown.data)).convert("RGB")
    ImageDraw.Draw(image).ellipse((215, 215, 285, 285), fill="#2E7D32")
    buffer = io.BytesIO()
    image.save(buffer, "PNG")
    colours, _ = measured(read_picture(buffer.getvalue(), "room.png"), thing("a", (0, 0), (1, 1, 0.5)))
    assert colour_distance(colours[0].code, "2E7D32") < 0.12


def test_dominant_colours_come_with_their_shares() -> None:
    pixels = np.concatenate([np.tile(from_code("FFFFFF"), (700, 1)), np.tile(from_code("203040"), (300, 1))])
    found = dominant(pixels)
    assert [round(c.share, 1) for c in found] == [0.7, 0.3]


def test_large_colours_go_to_large_roles_and_glass_keeps_its_own() -> None:
    described = ObjectDescription(
        id="a", seen=0.9, measured=[MeasuredColour(code="F0F0F0", share=0.7), MeasuredColour(code="6B3A1E", share=0.3)]
    )
    tints = tints_for({"linen": 0.65, "wood": 0.3, "metal": 0.05}, described)
    assert set(tints) == {"linen", "wood"}
    assert colour_distance(tints["linen"][1:], "F0F0F0") < 0.1 and colour_distance(tints["wood"][1:], "6B3A1E") < 0.1


def test_leaves_never_take_the_colour_of_the_floor_between_them() -> None:
    described = ObjectDescription(id="a", seen=1.0, measured=[MeasuredColour(code="8A6A4A", share=1.0)])
    assert "foliage" not in tints_for({"foliage": 0.9, "terracotta": 0.1}, described)


@pytest.mark.parametrize(
    ("written", "code"), [("#a1b2c3", "A1B2C3"), ("A1B2C3", "A1B2C3"), ("red", ""), ("#12345", "")]
)
def test_what_a_model_writes_as_a_colour(written: str, code: str) -> None:
    assert clean_code(written) == code


def test_what_lies_on_it_a_little_elsewhere_is_not_measured_either() -> None:
    shown = picture(((0, 0, 0.4, 0.4), "#3A6EA5"), ((0.03, 0.02, 0.3, 0.3), "#F8F8F8"))
    table, book = thing("a", (0, 0), (0.4, 0.4, 0.5)), thing("b", (0, 0), (0.3, 0.3, 0.05), 0.5, parent="a")
    box = ImageBox(x_min=476, y_min=466, x_max=536, y_max=526)
    colours, _ = ColourMeter(shown, CAMERA, Layout(room=ROOM, proxies=[table, book]), {"b": box}).measure(table)
    assert colours and colour_distance(colours[0].code, "3A6EA5") < 0.08 and colours[0].share > 0.9


def test_a_small_thing_is_measured_where_it_was_found_and_in_its_inner_part() -> None:
    shown = picture(((0, 0, 1.2, 1.2), "#8A5A3C"), ((0.04, -0.03, 0.16, 0.16), "#2FA84F"))
    shelf, cup = thing("a", (0, 0), (1.2, 1.2, 0.5)), thing("b", (0, 0), (0.16, 0.16, 0.1), 0.5, parent="a")
    box = ImageBox(x_min=492, y_min=490, x_max=524, y_max=522)
    colours, _ = ColourMeter(shown, CAMERA, Layout(room=ROOM, proxies=[cup, shelf]), {"b": box}).measure(cup)
    assert colour_distance(colours[0].code, "2FA84F") < 0.08 and colours[0].share > 0.9


def test_a_box_of_something_else_does_not_move_what_is_measured() -> None:
    shown = picture(((0, 0, 0.6, 0.6), "#3A6EA5"), ((1.2, 1.2, 0.6, 0.6), "#C02020"))
    box = ImageBox(x_min=680, y_min=200, x_max=800, y_max=320)
    only = Layout(room=ROOM, proxies=[thing("a", (0, 0), (0.6, 0.6, 0.5))])
    colours, _ = ColourMeter(shown, CAMERA, only, {"a": box}).measure(only.proxies[0])
    assert colour_distance(colours[0].code, "3A6EA5") < 0.08
