# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of a room inside a .blend: found by their mark, never in the way of the artist's, and in `room.py` from files."""

from __future__ import annotations

import hashlib
import io
import runpy
from pathlib import Path
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.artifacts.textures import Texture, Textures
from code_as_room.pipeline.memory import EntryMeta, Memory, now
from code_as_room.pipeline.program.assemble import assemble
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.pictures import picture_names
from code_as_room.pipeline.program.prelude.image_files import image_file
from code_as_room.pipeline.run_images import bring_images
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.pictures import IMAGE, STANDS_IN, find_image
from PIL import Image

NAME = "floor_0a1b2c3d"
ROOM = f"""\
room(size=(4, 3, 2.5), floor=[(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)])
finish("floor", {{"": principled(base=picture("{NAME}", size=(2, 2), space="object", color="#804020"), roughness=0.5)}})
build()
"""


def png(colour: str, size: int = 64, kind: str = "PNG") -> bytes:
    buffer = io.BytesIO()
    Image.new("RGB", (size, size), colour).save(buffer, kind)
    return buffer.getvalue()


def shown() -> list[Any]:
    """The images that materials show."""
    trees = [m.node_tree for m in bpy.data.materials if m.node_tree is not None]
    nodes: list[Any] = [node for tree in trees for node in tree.nodes]
    return [node.image for node in nodes if node.type == "TEX_IMAGE"]


def colour_of(image: Any) -> list[int]:
    return [round(255 * value) for value in image.pixels[:3]]


def test_the_artists_own_image_of_the_same_name_stays_as_it_is() -> None:
    own = bpy.data.images.new(NAME, 4, 4)
    scene = BlenderScene()
    scene.keep_images({NAME: png("#804020")})
    scene.build(ROOM)
    (image,) = shown()
    assert image != own and image[IMAGE] == NAME and colour_of(image) == [0x80, 0x40, 0x20]
    assert own.name == NAME and IMAGE not in own and tuple(own.size) == (4, 4)


def test_an_image_of_the_artists_can_be_shown_by_its_name_and_is_written_with_the_room(tmp_path: Path) -> None:
    (tmp_path / "tiles.jpg").write_bytes(png("#336699", kind="JPEG"))
    own = bpy.data.images.load(str(tmp_path / "tiles.jpg"))
    scene = BlenderScene()
    scene.build(ROOM.replace(NAME, "tiles.jpg"))
    assert shown() == [own] and IMAGE not in own
    data = scene.kept_images(["tiles.jpg", "not there"])
    assert list(data) == ["tiles.jpg"] and Image.open(io.BytesIO(data["tiles.jpg"])).format == "PNG"


def test_an_image_that_nothing_shows_yet_survives_save_and_load(tmp_path: Path) -> None:
    BlenderScene().keep_images({NAME: png("#804020")})
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    scene = BlenderScene()
    assert scene.has_images([NAME]) and scene.kept_images([NAME]) == {NAME: png("#804020")}
    # What the stage does not want any more goes with the next save, unless something shows it.
    scene.build(ROOM)
    scene.keep_images({"rug_99999999": png("#112233"), "old_00000000": png("#445566")})
    scene.keep_images({"rug_99999999": png("#112233")})
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    assert find_image(NAME) is not None and find_image("rug_99999999") is not None
    assert find_image("old_00000000") is None


def test_a_missing_image_is_a_plain_colour_until_it_comes() -> None:
    scene = BlenderScene()
    scene.build(ROOM)
    (stand_in,) = shown()
    assert STANDS_IN in stand_in and colour_of(stand_in) == pytest.approx([0x80, 0x40, 0x20], abs=1)
    assert not scene.has_images([NAME]) and scene.kept_images([NAME]) == {}
    scene.keep_images({NAME: png("#2266AA")})
    (image,) = shown()
    assert STANDS_IN not in image and colour_of(image) == [0x22, 0x66, 0xAA] and image.packed_file is not None
    assert len([i for i in bpy.data.images if i.get(IMAGE) == NAME]) == 1


def test_other_bytes_under_a_name_are_shown_where_the_former_ones_were() -> None:
    scene = BlenderScene()
    scene.keep_images({NAME: png("#804020")})
    scene.build(ROOM)
    scene.keep_images({NAME: png("#2266AA")})
    (image,) = shown()
    assert colour_of(image) == [0x22, 0x66, 0xAA] and image.name == NAME
    scene.keep_images({NAME: png("#2266AA")})
    assert shown() == [image], "the same bytes change nothing"


@pytest.mark.parametrize("has_file", (True, False))
def test_room_py_shows_the_image_beside_it_or_a_plain_colour(tmp_path: Path, has_file: bool) -> None:
    (tmp_path / "room.py").write_text(assemble(ROOM), encoding="utf-8")
    if has_file:
        (tmp_path / "textures").mkdir()
        (tmp_path / "textures" / image_file(NAME)).write_bytes(png("#2266AA"))
    runpy.run_path(str(tmp_path / "room.py"), run_name="__main__")
    (image,) = shown()
    assert (STANDS_IN in image) is not has_file
    assert colour_of(image) == pytest.approx([0x22, 0x66, 0xAA] if has_file else [0x80, 0x40, 0x20], abs=1)
    assert "floor" in bpy.data.objects and (image.packed_file is not None) is has_file


def test_a_file_that_is_no_image_is_a_plain_colour(tmp_path: Path) -> None:
    (tmp_path / "room.py").write_text(assemble(ROOM), encoding="utf-8")
    (tmp_path / "textures").mkdir()
    (tmp_path / "textures" / image_file(NAME)).write_bytes(b"no image")
    runpy.run_path(str(tmp_path / "room.py"), run_name="__main__")
    (image,) = shown()
    assert colour_of(image) == pytest.approx([0x80, 0x40, 0x20], abs=1)


@pytest.mark.parametrize("name", ("../../etc/passwd", "/etc/passwd", "..", "a/b", "C:\\x", "ö", ""))
def test_no_name_leads_out_of_the_folder(name: str) -> None:
    file = image_file(name)
    assert file.endswith(".png") and Path(file).name == file and not file.startswith(".")


def test_which_images_a_program_shows_wherever_they_are_written() -> None:
    look = 'principled(base=mix(picture("a"), ramp(picture("b"), [(0, "#000000"), (1, "#FFFFFF")]), 0.5), alpha=picture("c"))'
    text = ROOM.replace("build()", f'finish("walls", {{"": {look}}})\nbuild()')
    assert picture_names(evaluate(text)) == [NAME, "a", "b", "c"]


def test_a_run_that_is_resumed_takes_its_images_from_the_folder(tmp_path: Path) -> None:
    good, wrong = png("#2266AA"), png("#112233")
    textures = [
        Texture(surface="floor", kind="floor", source="picture", name=NAME, sha256=hashlib.sha256(good).hexdigest()),
        Texture(surface="rug", kind="rug", source="picture", name="rug_11111111", sha256="0" * 64),
        Texture(surface="art", kind="picture", source="picture", name="art_22222222", sha256="1" * 64),
    ]
    memory = Memory()
    memory.append("s09_textures", Textures(surfaces=textures), EntryMeta(time=now()))
    (tmp_path / "textures").mkdir()
    (tmp_path / "textures" / f"{NAME}.png").write_bytes(good)
    (tmp_path / "textures" / "rug_11111111.png").write_bytes(wrong)
    scene = BlenderScene()
    assert bring_images(memory, scene, tmp_path) == 1
    assert scene.has_images([NAME]) and not scene.has_images(["rug_11111111"])
