# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference image, from whatever file the artist has. All files are made here."""

import hashlib
import io
import os
import struct
import zlib

import numpy as np
import pytest
from code_as_room.pipeline.errors import PictureError
from code_as_room.pipeline.picture import KEEP_LONG_SIDE, load_picture, read_picture
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image, ImageCms

SRGB, LAB = ImageCms.createProfile("sRGB"), ImageCms.createProfile("LAB")
LEFT, RIGHT = (200, 40, 30), (20, 60, 210)


def halves(width=160, height=100):
    """Left half reddish, right half bluish, a white square in the upper left corner."""
    pixels = np.empty((height, width, 3), np.uint8)
    pixels[:, : width // 2], pixels[:, width // 2 :] = LEFT, RIGHT
    pixels[: height // 5, : height // 5] = 255
    return Image.fromarray(pixels)


def encoded(image, kind, **options):
    buffer = io.BytesIO()
    image.save(buffer, kind, **options)
    return buffer.getvalue()


def opened(data):
    image = Image.open(io.BytesIO(data))
    image.load()
    return image


def assert_is_halves(picture, tolerance=12):
    pixels = picture.pixels().astype(int)
    height, width = pixels.shape[:2]
    assert np.abs(pixels[height * 3 // 4, width // 4] - LEFT).max() <= tolerance
    assert np.abs(pixels[height * 3 // 4, width * 3 // 4] - RIGHT).max() <= tolerance
    assert pixels[height // 12, height // 12].min() > 225


def with_alpha(image):
    image = image.convert("RGBA")
    image.putalpha(255)
    return image


def upside_down(image, orientation):
    """The image stored as a camera would store it that was held in this EXIF orientation."""
    undo = {3: Image.Transpose.ROTATE_180, 6: Image.Transpose.ROTATE_90, 8: Image.Transpose.ROTATE_270}
    exif = Image.Exif()
    exif[0x0112] = orientation
    return encoded(image.transpose(undo[orientation]), "JPEG", quality=95, exif=exif)


FILES = {
    "png": lambda: encoded(halves(), "PNG"),
    "jpeg": lambda: encoded(halves(), "JPEG", quality=95),
    "webp": lambda: encoded(halves(), "WEBP", quality=95),
    "bmp": lambda: encoded(halves(), "BMP"),
    "tiff": lambda: encoded(halves(), "TIFF"),
    "palette": lambda: encoded(halves().quantize(16), "PNG"),
    "palette with transparency": lambda: encoded(halves().quantize(16), "PNG", transparency=15),
    "gif": lambda: encoded(halves().quantize(16), "GIF"),
    "opaque alpha": lambda: encoded(with_alpha(halves()), "PNG"),
    "cmyk jpeg": lambda: encoded(halves().convert("CMYK"), "JPEG", quality=95),
    "cmyk tiff": lambda: encoded(halves().convert("CMYK"), "TIFF"),
    "ycbcr tiff": lambda: encoded(halves().convert("YCbCr"), "TIFF"),
    "lab tiff": lambda: encoded(ImageCms.profileToProfile(halves(), SRGB, LAB, outputMode="LAB"), "TIFF"),
    "turned 180": lambda: upside_down(halves(), 3),
    "turned 90": lambda: upside_down(halves(), 6),
    "turned 270": lambda: upside_down(halves(), 8),
    "animated": lambda: encoded(halves(), "GIF", save_all=True, append_images=[Image.new("RGB", (160, 100))] * 3),
    "animated webp": lambda: encoded(
        halves(), "WEBP", save_all=True, append_images=[Image.new("RGB", (160, 100))] * 3, quality=95
    ),
    "interlaced 16 bit rgb": lambda: png_16_bit_rgb(halves()),
    "broken profile": lambda: encoded(halves(), "PNG", icc_profile=b"nonsense" * 40),
}


def png_16_bit_rgb(image):
    """A 16-bit RGB PNG, which Pillow reads but does not write."""
    values = np.asarray(image).astype(">u2") * 257
    rows = b"".join(b"\x00" + row.tobytes() for row in values)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", image.width, image.height, 16, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


@pytest.mark.parametrize("kind", FILES)
def test_every_kind_of_file_gives_the_same_upright_picture(kind, tmp_path):
    path = tmp_path / "room.picture"
    path.write_bytes(FILES[kind]())
    picture = load_picture(path)
    assert (picture.width, picture.height) == (160, 100)
    assert_is_halves(picture, tolerance=30 if "cmyk" in kind or "palette" in kind else 12)
    kept = opened(picture.data)
    assert kept.mode == "RGB" and kept.size == (160, 100) and not kept.getexif() and "icc_profile" not in kept.info
    assert picture.sha256 == hashlib.sha256(picture.data).hexdigest()
    assert load_picture(path) == picture


def test_transparent_parts_are_put_on_white_and_reported():
    image = with_alpha(halves())
    alpha = np.full((100, 160), 255, np.uint8)
    alpha[:, :40], alpha[:, 40:60] = 0, 128
    image.putalpha(Image.fromarray(alpha))
    picture = read_picture(encoded(image, "PNG"), "a.png")
    pixels = picture.pixels().astype(int)
    assert pixels[80, 10].tolist() == [255, 255, 255]
    assert np.abs(pixels[80, 50] - [(value + 255) // 2 for value in LEFT]).max() <= 2
    assert any("white" in note for note in picture.notes)


@pytest.mark.parametrize(
    "image",
    [
        Image.fromarray(np.linspace(0, 65535, 160 * 100).reshape(100, 160).astype(np.uint16)),
        Image.fromarray(np.linspace(0, 65535, 160 * 100).reshape(100, 160).astype(np.int32)),
        Image.fromarray(np.linspace(0, 1, 160 * 100).reshape(100, 160).astype(np.float32)),
        Image.fromarray(np.linspace(0, 4000, 160 * 100).reshape(100, 160).astype(np.float32)),
        Image.fromarray(np.linspace(0, 255, 160 * 100).reshape(100, 160).astype(np.uint8)),
    ],
    ids=["16 bit", "32 bit", "float", "float over 255", "8 bit grey"],
)
def test_grey_pictures_of_any_depth_keep_their_range(image):
    picture = read_picture(encoded(image, "TIFF"), "grey.tif")
    pixels = picture.pixels()[:, :, 0].astype(int)
    assert pixels[0, 0] <= 1 and pixels[-1, -1] >= 254
    assert abs(pixels[50, 0] - 127) <= 3


def test_numbers_that_are_none_become_black():
    values = np.ones((100, 160), np.float32)
    values[0, 0], values[1, 1] = np.nan, np.inf
    pixels = read_picture(encoded(Image.fromarray(values), "TIFF"), "x").pixels()
    assert pixels[0, 0, 0] == 0 and pixels[50, 50, 0] == 255


def test_bilevel_pictures_are_read():
    pixels = read_picture(
        encoded(halves().convert("L").point(lambda v: 255 * (v > 200)).convert("1"), "PNG"), "x"
    ).pixels()
    assert pixels[5, 5].tolist() == [255, 255, 255] and pixels[80, 80].tolist() == [0, 0, 0]


def test_a_colour_profile_that_does_not_fit_is_left_out_and_reported():
    srgb = ImageCms.ImageCmsProfile(SRGB).tobytes()
    assert_is_halves(read_picture(encoded(halves(), "PNG", icc_profile=srgb), "x"), 3)
    lab = ImageCms.ImageCmsProfile(LAB).tobytes()
    picture = read_picture(encoded(halves(), "PNG", icc_profile=lab), "x")
    assert_is_halves(picture, 3)
    assert any("profile" in note for note in picture.notes)


def test_a_wide_gamut_profile_is_brought_to_srgb():
    profile = exchanged_profile()
    picture = read_picture(encoded(halves(), "PNG", icc_profile=profile), "x")
    red, green, blue = picture.pixels()[75, 40].tolist()
    assert blue > 150 and red < 80, "the profile exchanges red and blue"


def exchanged_profile():
    """The sRGB profile with its red and blue primaries exchanged: whether it was applied is plain to see."""
    profile = bytearray(ImageCms.ImageCmsProfile(SRGB).tobytes())
    count = struct.unpack(">I", profile[128:132])[0]
    for index in range(count):
        place = 132 + 12 * index
        name = bytes(profile[place : place + 4])
        if name in (b"rXYZ", b"bXYZ"):
            profile[place : place + 4] = b"bXYZ" if name == b"rXYZ" else b"rXYZ"
    return bytes(profile)


def test_a_thirty_megapixel_picture_is_scaled_to_what_is_kept_and_sent():
    data = encoded(halves(6400, 4700), "JPEG", quality=60)
    picture = read_picture(data, "large.jpg")
    assert (picture.width, picture.height) == (KEEP_LONG_SIDE, 3008)
    assert any("6400 x 4700" in note for note in picture.notes)
    assert_is_halves(picture)
    sent = opened(picture.for_model())
    assert max(sent.size) == 1568 and abs(sent.width / sent.height - 6400 / 4700) < 0.01
    assert opened(picture.for_model(200)).size == (200, 147)


def test_nothing_is_ever_enlarged():
    picture = read_picture(encoded(halves(), "PNG"), "x")
    assert opened(picture.for_model()).size == (160, 100)


def test_a_photograph_is_sent_small():
    noise = np.random.default_rng(1).integers(0, 255, (1000, 1500, 3), dtype=np.uint8)
    picture = read_picture(encoded(Image.fromarray(noise), "PNG"), "noise.png")
    assert picture.data.startswith(b"\x89PNG") and np.array_equal(picture.pixels(), noise)
    assert picture.for_model().startswith(b"\xff\xd8") and len(picture.for_model()) < len(picture.data)


# What cannot be used ---------------------------------------------------------------------------------------------


def bomb(width, height):
    """A PNG that claims a size its data does not have."""
    good = bytearray(encoded(halves(), "PNG"))
    good[16:24] = struct.pack(">II", width, height)
    good[29:33] = struct.pack(">I", zlib.crc32(bytes(good[12:29])))
    return bytes(good)


UNUSABLE = {
    "one pixel": lambda: encoded(Image.new("RGB", (1, 1)), "PNG"),
    "too small": lambda: encoded(halves(63, 200), "PNG"),
    "a thread": lambda: encoded(Image.new("RGB", (20_000, 70)), "PNG"),
    "empty": lambda: b"",
    "text": lambda: b"this is not a picture",
    "truncated png": lambda: encoded(halves(), "PNG")[:-60],
    "truncated jpeg": lambda: encoded(halves(), "JPEG")[:400],
    "damaged png": lambda: encoded(halves(), "PNG").replace(b"IDAT", b"IDXT"),
    "bomb": lambda: bomb(60_000, 60_000),
    "over the limit": lambda: bomb(13_000, 10_000),
    "claims more than it has": lambda: bomb(9_000, 9_000),
    "text bomb": lambda: text_bomb(),
    "pdf": lambda: b"%PDF-1.7\n...",
    "svg": lambda: b"<?xml version='1.0'?><svg xmlns='http://www.w3.org/2000/svg'/>",
    "heic": lambda: b"\x00\x00\x00\x18ftypheic" + b"\x00" * 100,
    "postscript": lambda: b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 100 100\n",
}


def text_bomb():
    good = encoded(halves(), "PNG")
    data = b"key\x00\x00" + zlib.compress(b"\x00" * 80_000_000, 9)
    chunk = struct.pack(">I", len(data)) + b"zTXt" + data + struct.pack(">I", zlib.crc32(b"zTXt" + data))
    return good[:33] + chunk + good[33:]


@pytest.mark.parametrize("kind", UNUSABLE)
def test_what_is_no_usable_picture_is_told_in_one_plain_sentence(kind):
    with pytest.raises(PictureError) as caught:
        read_picture(UNUSABLE[kind](), "room.png")
    assert "'room.png'" in caught.value.message and caught.value.fix
    for word in {"pdf": "PDF", "svg": "SVG", "heic": "HEIC", "one pixel": "1 x 1"}.get(kind, "").split():
        assert word in caught.value.message


def test_missing_files_folders_and_odd_paths_are_told(tmp_path):
    os.mkfifo(tmp_path / "pipe") if hasattr(os, "mkfifo") else (tmp_path / "pipe").mkdir()
    for path in (
        tmp_path / "no.png",
        tmp_path,
        tmp_path / "pipe",
        tmp_path / "no" / "no.png",
        "",
        "a\x00b",
        "x" * 5000,
    ):
        with pytest.raises(PictureError):
            load_picture(path)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="permissions do not bind this user")
def test_an_unreadable_file_is_told(tmp_path):
    path = tmp_path / "room.png"
    path.write_bytes(FILES["png"]())
    path.chmod(0)
    with pytest.raises(PictureError, match="cannot be read"):
        load_picture(path)


@given(st.sampled_from(["png", "jpeg", "webp", "gif", "tiff", "bmp", "turned 90"]), st.data())
@settings(max_examples=150, deadline=None)
def test_damaged_files_give_a_picture_or_a_picture_error(kind, data):
    raw = bytearray(FILES[kind]())
    for _ in range(data.draw(st.integers(1, 5))):
        raw[data.draw(st.integers(0, min(len(raw) - 1, 300)))] = data.draw(st.integers(0, 255))
    raw = raw[: data.draw(st.integers(len(raw) // 2, len(raw)))]
    try:
        picture = read_picture(bytes(raw), "x")
    except PictureError:
        return
    assert picture.pixels().shape == (picture.height, picture.width, 3)
