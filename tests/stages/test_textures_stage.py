# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 9 by itself: sources in the artist's order, images beside the memory, reasons in words."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.analysis import Calibration
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import Layout, LayoutProgram, ProxyLine, RoomLine, Score
from code_as_room.pipeline.artifacts.textures import Texture, TextureChoice, TextureChoices, Textures
from code_as_room.pipeline.picture import load_picture
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.finishes import read_materials
from code_as_room.pipeline.program.lines import print_layout
from code_as_room.pipeline.stages import s09_textures
from code_as_room.pipeline.stages.base import View
from code_as_room.pipeline.stages.texture_wishes import KeepImages, Paint, Painting
from code_as_room.pipeline.textures.looks import finished_text, picture_text
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
SCORE = Score(total=1, measured=1, coverage=1, overlap=1, bounds=1, relations=1, boxes=1)
Painter = Callable[[Paint], list[Painting] | None]


@cache
def room(folder: str) -> tuple[View, Layout]:
    path = ROOT / folder
    truth = json.loads((path / "truth.json").read_text(encoding="utf-8"))
    fields = ("id", "category", "centre", "size", "yaw", "placement", "parent")
    proxies = [ProxyLine.model_validate({name: thing[name] for name in fields}) for thing in truth["objects"]]
    layout = Layout(room=RoomLine(size=truth["room"]["size"], floor=truth["room"]["floor"]), proxies=proxies)
    lens = CameraModel.model_validate(truth["camera"])
    calibration = Calibration(camera=lens, floor=truth["room"]["floor"], height=2.6, error_px=0, scale_source="truth")
    program = LayoutProgram(text=print_layout(layout), stage="s07_surfaces", score=SCORE)
    return View(load_picture(path / "picture.png"), {Calibration: calibration, LayoutProgram: program}), layout


def run(
    folder: str, choices: TextureChoices, painter: Painter = lambda wish: None, built: list[str] | None = None
) -> tuple[Textures, dict[str, bytes]]:
    view, _ = room(folder)
    stage = s09_textures.run(View(view.reference, view.artifacts, recalled={TextureChoices: choices}))
    kept: dict[str, bytes] = {}
    built = [] if built is None else built
    answer: object = None
    try:
        while True:
            wish = stage.send(answer)
            answer = None
            if isinstance(wish, Paint):
                answer = painter(wish)
            elif isinstance(wish, KeepImages):
                kept.update(wish.images)
    except StopIteration as stop:
        program, found = stop.value
        built.append(program.text)
        assert isinstance(found, Textures)
        return found, kept


def only(*surfaces: str, source: str) -> TextureChoices:
    """Everything made, but for these surfaces."""
    chosen = [TextureChoice.model_validate({"surface": s, "source": source}) for s in surfaces]
    return TextureChoices(first=["procedural"], surfaces=chosen)


def painted(size: tuple[int, int] = (512, 512)) -> bytes:
    noise = np.random.default_rng(1).integers(90, 170, (size[1] // 4, size[0] // 4, 3), dtype=np.uint8)
    buffer = io.BytesIO()
    Image.fromarray(noise).resize(size).save(buffer, "JPEG")
    return buffer.getvalue()


def test_the_samples_floor_and_rug_are_taken_from_its_picture() -> None:
    asked: list[Paint] = []
    choices = only("floor", "rug", "mirror", source="picture")
    found, kept = run("samples/bedroom", choices, lambda wish: asked.append(wish))
    assert not asked
    floor, rug = found.of("floor"), found.of("rug")
    assert floor is not None and rug is not None
    assert (floor.source, floor.tiles, rug.source, rug.tiles) == ("picture", True, "picture", False)
    assert set(kept) == {floor.name, rug.name} and found.of("mirror") is None
    for entry in (floor, rug):
        data = kept[entry.name]
        assert data.startswith(b"\x89PNG") and hashlib.sha256(data).hexdigest() == entry.sha256
        assert Image.open(io.BytesIO(data)).size == entry.pixels
    # Memory holds no image.
    assert len(found.model_dump_json()) < 6000
    assert all(t.source == "procedural" and not t.name for t in found.surfaces if t.name not in kept)


def test_lines_of_the_room_language() -> None:
    built: list[str] = []
    found, _ = run("samples/bedroom", only("floor", "rug", source="picture"), built=built)
    finishes = evaluate(built[-1]).finishes
    assert set(finishes) == {"floor", "rug"}
    floor = found.of("floor")
    assert floor is not None and f"size=({floor.size[0]:g}, {floor.size[1]:g})" in picture_text(floor)
    # The colour stands where the image is missing, and is what exports without nodes show.
    assert finishes["floor"][""].colour == f"#{floor.colour}"


def test_an_image_takes_one_part_and_leaves_the_rest_of_what_was_said() -> None:
    text = """\
room(size=(4, 3, 2.5), floor=[(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)])
proxy("rug_1", "rug", centre=(0, 0, 0.01), size=(2, 1, 0.02))


def rug_1(size):
    width, depth, height = size
    pile = box((width, depth, height), at=(0, 0, height / 2))
    fringe = box((0.02, depth, height), at=(width / 2 - 0.01, 0, height / 2))
    return [part("pile", pile, material="fabric"), part("fringe", fringe, material="linen")]


furnish("rug_1", rug_1)
oak_1 = wood("#6A4A32", gloss=0.3)
wool_1 = carpet("#804020")
finish("floor", {"": oak_1})
finish("rug_1", {"pile": wool_1, "fringe": linen("#EEEEEE")})
build()
"""
    image = {"source": "picture", "name": "rug_1", "sha256": "0", "colour": "804020"}
    rug = Texture.model_validate({"surface": "rug_1", "kind": "rug", **image})
    floor = Texture.model_validate({"surface": "floor", "kind": "floor", "source": "procedural"})
    textured = finished_text(text, Textures(surfaces=[floor, rug]), evaluate(text))
    found = read_materials(textured)
    assert found.finishes["floor"] == {"": "oak_1"} and found.finishes["rug_1"]["fringe"] == 'linen("#EEEEEE")'
    assert 'base=picture("rug_1"' in found.finishes["rug_1"]["pile"] and set(found.looks) == {"oak_1"}
    # Without an image the part looks as it usually does.
    bare = Texture.model_validate({"surface": "rug_1", "kind": "rug", "source": "procedural"})
    again = read_materials(finished_text(textured, Textures(surfaces=[bare]), evaluate(textured)))
    assert again.finishes["rug_1"] == {"fringe": 'linen("#EEEEEE")'}


def test_a_rugs_faint_streaks_show_the_image_and_its_dark_band_stays() -> None:
    text = (
        "room(size=(4, 4, 2.5), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])\n"
        'proxy("rug_1", "rug", centre=(0, 0, 0.01), size=(2, 1, 0.02))\n'
        "def rug_1(size):\n    return [\n"
        "        part('pile', box((1.2, 1, 0.02), at=(-0.4, 0, 0.01)), material='fabric #B1ACA1'),\n"
        "        part('streak', box((0.4, 1, 0.02), at=(0.4, 0, 0.01)), material='fabric #C4C0B6'),\n"
        "        part('band', box((0.4, 1, 0.02), at=(0.8, 0, 0.01)), material='fabric #364961'),\n    ]\n"
        'furnish("rug_1", rug_1)\nbuild()\n'
    )
    fields = {
        "surface": "rug_1",
        "kind": "rug",
        "source": "picture",
        "name": "rug_1_ab",
        "sha256": "ab",
        "size": (2, 1),
    }
    made = finished_text(text, Textures(surfaces=[Texture.model_validate(fields)]), evaluate(text))
    finish = read_materials(made).finishes["rug_1"]
    assert finish["pile"] == finish["streak"] and 'picture("rug_1_ab"' in finish["pile"] and "band" not in finish


def test_nothing_is_taken_from_a_plan_and_it_says_so() -> None:
    found, kept = run("benchmark/pictures/flat_plan", TextureChoices(first=["picture", "procedural"]))
    assert not kept and found.surfaces
    assert all(t.source == "procedural" and "drawing" in t.note for t in found.surfaces)


def test_an_image_model_goes_first_where_the_artist_wants_it() -> None:
    wishes: list[Paint] = []

    def painter(wish: Paint) -> list[Painting]:
        wishes.append(wish)
        return [Painting(painted(), "painter-x") for _ in wish.requests]

    found, kept = run("samples/bedroom", only("floor", "rug", source="model"), painter)
    (wish,) = wishes
    assert {r.key.rpartition("/")[2] for r in wish.requests} == {"floor", "rug"}
    floor, rug = found.of("floor"), found.of("rug")
    assert floor is not None and rug is not None
    assert floor.source == rug.source == "model" and floor.model == "painter-x" and set(kept) == {floor.name, rug.name}
    ratio = rug.pixels[0] / rug.pixels[1]
    assert ratio == pytest.approx(2.06 / 2.46, rel=0.03)


def test_what_the_model_does_not_paint_comes_from_the_picture() -> None:
    choices = TextureChoices(first=["procedural"], surfaces=[TextureChoice(surface="floor", source=None)])
    choices = choices.model_copy(update={"first": ["model", "picture", "procedural"]})
    found, kept = run(
        "samples/bedroom", choices, lambda wish: [Painting(problem="The account has no credit.") for _ in wish.requests]
    )
    floor = found.of("floor")
    assert floor is not None and floor.source == "picture" and "no credit" in floor.note and floor.name in kept
    assert [f.message for f in found.findings] == ["The account has no credit."]


@pytest.mark.parametrize("data", (painted((64, 64)), b""))
def test_a_painting_that_cannot_be_used_is_not(data: bytes) -> None:
    found, kept = run("benchmark/pictures/flat_plan", only("floor", source="model"), lambda wish: [Painting(data, "x")])
    floor = found.of("floor")
    assert floor is not None and floor.source == "procedural" and not kept


def test_the_same_room_gives_the_same_bytes() -> None:
    choices = only("rug", source="picture")
    assert run("samples/bedroom", choices)[1] == run("samples/bedroom", choices)[1]


def test_the_order_of_sources() -> None:
    choices = TextureChoices(first=["picture", "model"], surfaces=[TextureChoice(surface="rug", source="model")])
    assert choices.order("floor") == ("picture", "model", "procedural")
    assert choices.order("rug") == ("model", "procedural")
    assert TextureChoices().order("floor") == ("model", "picture", "procedural")
