# SPDX-License-Identifier: GPL-3.0-or-later
"""Floors from the picture: period, direction, seams and colour; and what gives none says so."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine, RoomLine
from code_as_room.pipeline.picture import load_picture, read_picture
from code_as_room.pipeline.textures.floors import WORST_SEAM, floor_texture
from code_as_room.pipeline.textures.pixels import Pixels, brightness, perceived
from code_as_room.pipeline.textures.shown import NotUsable, Shown
from PIL import Image, ImageDraw

from .drawn_rooms import Pattern, box, camera, chequers, layout, plain, planks, seen_through

ROOT = Path(__file__).resolve().parents[2]
THINGS = (box("bed", (-1.2, 0.6), (1.2, 1.6, 0.6)), box("desk", (1.4, -1.0), (0.9, 0.5, 0.8), 20))


def shown(floor: Pattern, lens: CameraModel) -> Shown:
    return Shown(seen_through(lens, floor, THINGS), lens, layout(*THINGS))


def edge_steps(tile: Pixels) -> tuple[float, float]:
    """Mean difference across the tile's own edges, and the 90th percentile of all its other differences."""
    light = brightness(tile)
    across = [np.abs(light[:, 0] - light[:, -1]).mean(), np.abs(light[0] - light[-1]).mean()]
    own = [np.percentile(np.abs(np.diff(light, axis=axis)), 90) for axis in (0, 1)]
    return float(max(across)), float(max(own))


@pytest.mark.parametrize(("width", "turn", "tilt"), [(0.18, 0.0, 0.0), (0.14, 90.0, 20.0), (0.2, 30.0, 12.0)])
def test_planks_keep_their_width_and_direction(width: float, turn: float, tilt: float) -> None:
    flat = floor_texture(shown(planks(width, turn), camera(tilt, 5.0)))
    along, across = (flat.size[0], flat.size[1]) if abs((turn - flat.turned) % 180) < 45 else flat.size[::-1]
    assert along > 1.0
    # The tile holds whole planks, so that the repeat does not cut one.
    count = across / width
    assert count == pytest.approx(round(count), abs=0.08)
    away = (turn - flat.turned + 45.0) % 90.0 - 45.0
    assert abs(away) < 1.0
    assert flat.quality.seam <= WORST_SEAM
    seam, own = edge_steps(flat.pixels)
    assert seam < 1.3 * own


def test_chequers_keep_their_size() -> None:
    flat = floor_texture(shown(chequers(0.3), camera(18, -6)))
    assert flat.turned == 0.0
    for side, period in zip(flat.size, flat.quality.period, strict=True):
        assert period == pytest.approx(0.6, rel=0.02)
        assert side / 0.6 == pytest.approx(round(side / 0.6), abs=0.08)
    light = brightness(flat.pixels)
    half = round(0.3 / flat.size[0] * light.shape[1])
    # Half a period on, dark is where light was; a whole period on, all is the same.
    assert np.corrcoef(light.ravel(), np.roll(light, half, axis=1).ravel())[0, 1] < -0.6
    assert np.corrcoef(light.ravel(), np.roll(light, 2 * half, axis=1).ravel())[0, 1] > 0.6


def test_nothing_that_stands_on_it_is_in_the_tile() -> None:
    flat = floor_texture(shown(planks(0.18), camera(20, 10)))
    # The things are drawn in magenta; the floor is brown.
    assert not (flat.pixels[..., 2] > flat.pixels[..., 1]).any()


def test_the_floors_colour_stays() -> None:
    pattern = planks(0.18)
    flat = floor_texture(shown(pattern, camera(10)))
    x, y = np.random.default_rng(3).uniform(-1.5, 1.5, (2, 20_000))
    true = np.median(perceived(pattern(x, y).astype(np.float32)), axis=0)
    found = np.median(perceived(flat.pixels.reshape(-1, 3)), axis=0)
    assert np.linalg.norm(found - true) < 0.04


def test_light_that_falls_off_is_taken_out() -> None:
    even = planks(0.18)
    flat = floor_texture(shown(lambda x, y: even(x, y) * np.exp(0.25 * x)[:, None], camera(10)))
    light = brightness(flat.pixels)
    quarters = [part.mean() for half in np.array_split(light, 2) for part in np.array_split(half, 2, axis=1)]
    assert max(quarters) - min(quarters) < 0.12


def test_a_plain_floor_is_left_to_a_made_material() -> None:
    with pytest.raises(NotUsable, match="no pattern"):
        floor_texture(shown(plain, camera(10)))


def test_a_hidden_floor_gives_nothing() -> None:
    lens = camera()
    wide = box("bed", (0, 0), (4.2, 3.6, 0.5))
    with pytest.raises(NotUsable):
        floor_texture(Shown(seen_through(lens, planks(0.2), [wide]), lens, layout(wide)))


def plan(kind: str) -> bytes:
    image = Image.new("RGB", (900, 800), "white")
    draw = ImageDraw.Draw(image)
    if kind == "coloured":
        draw.rectangle((100, 100, 800, 700), fill="#E8D9B8")
        draw.rectangle((200, 200, 500, 400), fill="#9CB7D8", outline="black")
    draw.rectangle((100, 100, 800, 700), outline="black", width=9)
    for x in range(110, 800, 24):
        draw.line((x, 110, x, 690), fill="#777777" if kind == "hatched" else "#222222", width=1)
    buffer = io.BytesIO()
    image.save(buffer, "JPEG" if kind == "compressed" else "PNG", quality=60)
    return buffer.getvalue()


@pytest.mark.parametrize("kind", ("lines", "hatched", "coloured", "compressed"))
def test_nothing_is_taken_from_a_drawn_plan(kind: str) -> None:
    lens = camera(0, 0, perspective=False)
    with pytest.raises(NotUsable, match="drawing"):
        floor_texture(Shown(read_picture(plan(kind), "plan.png"), lens, layout()))


def of_truth(folder: Path) -> Shown:
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    fields = ("id", "category", "centre", "size", "yaw", "placement", "parent")
    proxies = [ProxyLine.model_validate({name: thing[name] for name in fields}) for thing in truth["objects"]]
    room = RoomLine(size=truth["room"]["size"], floor=truth["room"]["floor"])
    lens = CameraModel.model_validate(truth["camera"])
    return Shown(load_picture(folder / "picture.png"), lens, Layout(room=room, proxies=proxies))


def test_the_samples_boards_become_a_tile_without_seams() -> None:
    flat = floor_texture(of_truth(ROOT / "samples" / "bedroom"))
    assert flat.turned == 0.0 and min(flat.size) > 1.5
    assert flat.quality.seam <= WORST_SEAM and flat.quality.sharpness > 0.5
    seam, own = edge_steps(flat.pixels)
    assert seam < 1.5 * own


def test_the_benchmarks_plan_gives_nothing() -> None:
    assert of_truth(ROOT / "benchmark" / "pictures" / "flat_plan").drawn
