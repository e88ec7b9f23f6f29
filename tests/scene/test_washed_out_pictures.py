# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders that were shown through a filmic transform give back the colours that things had; other pictures stay as they are."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from code_as_room.pipeline.light.developed import developed, tone_of, wash
from code_as_room.pipeline.light.tone import AGX, MEDIUM_HIGH, NEUTRAL, coloured_light, linear
from code_as_room.pipeline.picture import ReferencePicture, load_picture
from PIL import Image

PAINTS = ((201, 185, 154), (40, 90, 165), (160, 95, 50), (90, 140, 70), (190, 60, 50), (120, 120, 120), (225, 225, 222))
"""sRGB of carpet, blue cloth, wood, leaves, red paint, grey and white."""
LIGHT = 1.7


def shown_in_blender(colours: np.ndarray, transform: str, look: str, path: Path) -> ReferencePicture:
    """A picture of large patches, made of linear light by Blender's own view transform."""
    grid = np.repeat(np.repeat(colours[None], 80, axis=0), 40, axis=1)
    high, wide = grid.shape[:2]
    image = bpy.data.images.new("patches", wide, high, float_buffer=True)
    image.colorspace_settings.name = "Linear Rec.709"
    pixels = np.ones((high, wide, 4), dtype=np.float32)
    pixels[..., :3] = grid
    image.pixels.foreach_set(pixels.ravel())
    scene = bpy.context.scene
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform, scene.view_settings.look = transform, look
    image.save_render(str(path), scene=scene)
    bpy.data.images.remove(image)
    return load_picture(path)


def patches(pixels: np.ndarray) -> np.ndarray:
    """The middle of each patch."""
    return pixels[40, 20::40].astype(float)


@pytest.fixture
def clean() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)


@pytest.mark.parametrize(("look", "left"), [(MEDIUM_HIGH, 0.45), ("None", 0.75)])
def test_colours_come_back_from_behind_agx(clean: None, tmp_path: Path, look: str, left: float) -> None:
    base = linear(np.array(PAINTS) / 255.0)
    picture = shown_in_blender(base * LIGHT, AGX, look, tmp_path / "agx.png")
    assert wash(picture) > 0.8
    washed, meant = linear(patches(picture.pixels()) / 255.0), linear(patches(developed(picture)) / 255.0)
    for paint, before, after in zip(base, washed, meant, strict=True):
        # What a colour is beside its brightness: the shares of red, green and blue.
        off_before = np.abs(before / before.sum() - paint / paint.sum()).max()
        off_after = np.abs(after / after.sum() - paint / paint.sum()).max()
        assert off_after < max(0.04, left * off_before), (paint, before, after)
    ratio = meant[-1].mean() / meant[0].mean()
    assert ratio == pytest.approx(base[-1].mean() / base[0].mean(), rel=0.25)  # white beside carpet


def test_pictures_of_full_range_stay_as_they_are(clean: None, tmp_path: Path) -> None:
    base = linear(np.array(((4, 4, 5), *PAINTS, (252, 252, 252))) / 255.0)
    picture = shown_in_blender(base, "Standard", "None", tmp_path / "standard.png")
    assert wash(picture) == 0.0
    assert np.array_equal(developed(picture), picture.pixels())


def test_drawings_stay_as_they_are(tmp_path: Path) -> None:
    plan = np.full((300, 400, 3), 255, dtype=np.uint8)
    plan[60:64, 40:360] = plan[240:244, 40:360] = 40
    Image.fromarray(plan).save(tmp_path / "plan.png")
    picture = load_picture(tmp_path / "plan.png")
    assert np.array_equal(developed(picture), picture.pixels())


def test_a_picture_with_nothing_white_in_it_tells_nothing(tmp_path: Path) -> None:
    boards = np.full((300, 400, 3), (150, 120, 90), dtype=np.uint8)
    boards[::20] = (100, 75, 55)
    Image.fromarray(boards).save(tmp_path / "boards.png")
    picture = load_picture(tmp_path / "boards.png")
    assert np.array_equal(developed(picture), picture.pixels())


def test_a_room_is_shown_as_its_picture_was(clean: None, tmp_path: Path) -> None:
    """Shown through another transform, the colours that were led back would be stronger than anything in the picture."""
    base = linear(np.array(PAINTS) / 255.0)
    picture = shown_in_blender(base * LIGHT, AGX, MEDIUM_HIGH, tmp_path / "agx.png")
    assert tone_of(picture) == (AGX, MEDIUM_HIGH)
    again = shown_in_blender(
        coloured_light(linear(patches(picture.pixels()) / 255.0), AGX), *tone_of(picture), tmp_path / "again.png"
    )
    assert np.abs(patches(again.pixels()) - patches(picture.pixels())).mean() < 8
    full = linear(np.array(((4, 4, 5), *PAINTS, (252, 252, 252))) / 255.0)
    assert tone_of(shown_in_blender(full, "Standard", "None", tmp_path / "standard.png")) == (NEUTRAL, "")
