# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of the reference image, and boxes drawn into it."""

import io

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.errors import PictureError
from code_as_room.pipeline.picture import read_picture
from PIL import Image

LEFT, RIGHT = (200, 40, 30), (20, 60, 210)


def halves(width, height):
    pixels = np.empty((height, width, 3), np.uint8)
    pixels[:, : width // 2], pixels[:, width // 2 :] = LEFT, RIGHT
    return Image.fromarray(pixels)


def picture_of(image):
    buffer = io.BytesIO()
    image.save(buffer, "PNG")
    return read_picture(buffer.getvalue(), "x.png")


def opened(data):
    image = Image.open(io.BytesIO(data))
    image.load()
    return image


def test_crops_are_never_enlarged_and_stay_inside_the_picture():
    picture = picture_of(halves(160, 100))
    assert opened(picture.crop(ImageBox(x_min=0, y_min=0, x_max=500, y_max=500), margin=0)).size == (80, 50)
    assert opened(picture.crop(ImageBox(x_min=-500, y_min=-500, x_max=2000, y_max=2000))).size == (160, 100)


def test_a_crop_is_the_part_with_its_margin():
    picture = picture_of(halves(400, 200))
    crop = opened(picture.crop(ImageBox(x_min=500, y_min=500, x_max=750, y_max=1000), margin=0.1))
    assert crop.size == (120, 110)
    assert crop.getpixel((2, 50)) == LEFT and crop.getpixel((60, 50)) == RIGHT
    swapped = picture.crop(ImageBox(x_min=750, y_min=1000, x_max=500, y_max=500), margin=0.1)
    assert opened(swapped).size == crop.size
    with pytest.raises(PictureError):
        picture.crop(ImageBox(x_min=1200, y_min=0, x_max=1300, y_max=100))


def test_boxes_are_drawn_thin_at_their_places_with_labels():
    picture = picture_of(Image.new("RGB", (800, 600), (128, 128, 128)))
    box = ImageBox(x_min=250, y_min=250, x_max=750, y_max=750)
    pixels = np.asarray(opened(picture.with_boxes_drawn([("12", box)]))).astype(int)
    changed = np.abs(pixels - 128).max(axis=2) > 20
    ys, xs = np.nonzero(changed)
    assert (
        abs(xs.min() - 200) <= 3 and abs(xs.max() - 600) <= 3 and abs(ys.min() - 150) <= 3 and abs(ys.max() - 450) <= 3
    )
    assert not changed[200:400, 300:500].any()
    assert changed[150:200, 200:260].sum() > 150
    assert np.array_equal(picture.pixels(), np.full((600, 800, 3), 128))


def test_labels_of_boxes_at_the_same_place_do_not_cover_each_other():
    picture = picture_of(Image.new("RGB", (800, 600), (128, 128, 128)))
    box = ImageBox(x_min=400, y_min=400, x_max=600, y_max=600)

    def dark(labels):
        pixels = np.asarray(opened(picture.with_boxes_drawn([(label, box) for label in labels])))
        return int((pixels.max(axis=2) < 10).sum())

    assert dark(["1", "2", "3"]) > dark(["1", "2"]) + 60 > dark(["1"]) + 120


def test_boxes_outside_inside_out_and_empty_are_survived():
    picture = picture_of(halves(160, 100))
    boxes = [
        ("a", ImageBox(x_min=-500, y_min=-500, x_max=2000, y_max=2000)),
        ("b", ImageBox(x_min=900, y_min=900, x_max=100, y_max=100)),
        ("", ImageBox(x_min=1500, y_min=1500, x_max=1600, y_max=1600)),
        ("a very long label that goes on and on", ImageBox(x_min=500, y_min=500, x_max=500, y_max=500)),
        ("größe 日", ImageBox(x_min=0, y_min=0, x_max=1, y_max=1)),
    ]
    assert opened(picture.with_boxes_drawn(boxes)).size == (160, 100)
    assert picture.with_boxes_drawn(boxes) == picture.with_boxes_drawn(boxes)


def test_the_grid_lies_on_every_hundred_and_leaves_the_rest_alone():
    buffer = io.BytesIO()
    Image.new("RGB", (1000, 800), (128, 128, 128)).save(buffer, "PNG")
    picture = read_picture(buffer.getvalue(), "grey.png")
    with Image.open(io.BytesIO(picture.with_grid())) as opened:
        drawn = np.asarray(opened.convert("RGB")).astype(int)
    changed = np.abs(drawn - 128).max(axis=2) > 10
    columns, rows = changed[60:740, 60:940].mean(axis=0), changed[60:740, 60:940].mean(axis=1)
    assert all(columns[100 * n - 60] > 0.9 and columns[100 * n - 10] < 0.1 for n in range(1, 9))
    assert all(rows[80 * n - 60] > 0.9 and rows[80 * n - 20] < 0.1 for n in range(1, 9))
    assert (picture.pixels() == 128).all()
