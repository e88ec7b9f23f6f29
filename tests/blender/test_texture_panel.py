# SPDX-License-Identifier: GPL-3.0-or-later
"""Images on surfaces in the window: shown with reasons, chosen by the artist, made anew, kept in the file."""

from __future__ import annotations

import io
import json
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import driver, outputs, painters, room_memory, view_state
from code_as_room.operators.scene_backend import ResolvedScene
from code_as_room.operators.texture_rows import SurfaceRow
from code_as_room.panels.textures import CODE_AS_ROOM_PT_texture_reasons as Reasons
from code_as_room.panels.textures import CODE_AS_ROOM_PT_textures as Panel
from code_as_room.pipeline.artifacts.analysis import Calibration
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import Layout, LayoutProgram, ProxyLine, RoomLine, Score
from code_as_room.pipeline.memory import EntryMeta, load_memory, now
from code_as_room.pipeline.models.image_base import ImageRequest, PaintedImage
from code_as_room.pipeline.program.lines import print_layout
from code_as_room.pipeline.scene.pictures import IMAGE, find_image
from code_as_room.pipeline.stages import s09_textures
from noted_lines import drawn
from PIL import Image

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "bedroom"
SCORE = Score(total=1, measured=1, coverage=1, overlap=1, bounds=1, relations=1, boxes=1)


class Painter:
    """An image model that paints everything in one colour, and says what it was asked."""

    name, describes = "test-images", "The image model of a test"

    def __init__(self) -> None:
        self.asked: list[str] = []

    def paint(
        self, request: ImageRequest, cancel: threading.Event, progress: Callable[[str], None] | None = None
    ) -> PaintedImage:
        assert threading.current_thread() is not threading.main_thread()
        self.asked.append(request.text)
        buffer = io.BytesIO()
        Image.effect_noise((256, 256), 40).convert("RGB").save(buffer, "PNG")
        return PaintedImage(buffer.getvalue(), "painter-1", cost=0.04, seconds=1.0)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The sample's room without its furniture, with its floor, its rug and its picture on the wall, textured."""
    path = tmp_path_factory.mktemp("textures") / "built.blend"
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    bpy.ops.code_as_room.load_picture(filepath=str(SAMPLE / "picture.png"))
    truth = json.loads((SAMPLE / "truth.json").read_text(encoding="utf-8"))
    fields = ("id", "category", "centre", "size", "yaw", "placement", "parent")
    proxies = [ProxyLine.model_validate({name: thing[name] for name in fields}) for thing in truth["objects"]]
    layout = Layout(room=RoomLine(size=truth["room"]["size"], floor=truth["room"]["floor"]), proxies=proxies)
    camera = CameraModel.model_validate(truth["camera"])
    run = room_memory.run_of(bpy.context.scene)
    meta = EntryMeta(time=now())
    floor = truth["room"]["floor"]
    calibration = Calibration(camera=camera, floor=floor, height=2.6, error_px=0, scale_source="truth")
    run.memory.append("s01_analysis", calibration, meta)
    program = LayoutProgram(text=print_layout(layout), stage="s08_materials", score=SCORE)
    run.memory.append("s08_materials", program, meta)
    room_memory.keep(run)
    view_state.refresh(bpy.context.scene)
    make()
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    code_as_room.unregister()
    return str(path)


@pytest.fixture(autouse=True)
def scene(made: str) -> Iterator[Any]:
    code_as_room.register()
    bpy.ops.wm.open_mainfile(filepath=made)
    view_state.refresh(bpy.context.scene)
    yield bpy.context.scene
    code_as_room.unregister()


def make() -> None:
    driver.start(bpy.context.scene, [s09_textures.STAGE], again=True)
    outcome = driver.run_blocking()
    assert outcome.problem is None, outcome.problem


def row(surface: str) -> SurfaceRow:
    state = view_state.refresh(bpy.context.scene)
    return next(row for row in state.textures.rows if row.surface == surface)


def program() -> str:
    return ResolvedScene(bpy.context.scene).program_text()


def ours() -> dict[str, Any]:
    images: Any = bpy.data.images
    return {str(image[IMAGE]): image for image in images if IMAGE in image}


def test_images_are_in_the_file_and_on_their_surfaces_after_it_was_saved_and_opened() -> None:
    assert row("floor").source == row("rug").source == "From the picture"
    images = ours()
    assert len(images) >= 2
    for name, image in images.items():
        assert f'picture("{name}"' in program() and image.packed_file is not None
        assert image.filepath == f"//textures/{name}.png"
    shown = {
        node.image.name
        for material in bpy.data.materials
        if material.node_tree is not None
        for node in material.node_tree.nodes
        if node.type == "TEX_IMAGE" and node.image is not None
    }
    # Boxes show no finish; the floor is built as itself.
    assert {image.name for name, image in images.items() if name.startswith("floor_")} <= shown


def test_the_panel_shows_each_surface_its_source_and_why() -> None:
    text = drawn(Panel)
    assert "Floor" in text and "From the picture" in text and "Image model, then picture" in text
    assert "No image model is chosen" in text.replace(" | ", " ")
    reasons = drawn(Reasons)
    noted = [r for r in view_state.refresh(bpy.context.scene).textures.rows if r.note]
    assert "pixels" in reasons and all(r.title in reasons for r in noted)


def test_the_artists_choice_waits_until_the_textures_are_made_anew_and_then_holds() -> None:
    floor = next(name for name in ours() if name.startswith("floor_"))
    bpy.ops.code_as_room.choose_texture_source(surface="floor", source="PROCEDURAL")
    assert row("floor").waits and not row("rug").waits and floor in program()
    assert "You have chosen other sources" in drawn(Panel).replace(" | ", " ")
    bpy.ops.code_as_room.make_textures()
    assert row("floor").source == "Made" and not row("floor").waits and floor not in program()
    assert row("rug").source == "From the picture"
    bpy.ops.code_as_room.choose_texture_source(surface="floor", source="BEST")
    bpy.ops.code_as_room.make_textures()
    assert row("floor").source == "From the picture" and floor in program() and find_image(floor) is not None


def test_an_order_for_all_leaves_what_was_chosen_for_one() -> None:
    bpy.ops.code_as_room.choose_texture_source(surface="rug", source="PICTURE")
    bpy.ops.code_as_room.prefer_textures(order="MADE")
    assert row("floor").waits and not row("rug").waits
    bpy.ops.code_as_room.make_textures()
    assert row("floor").source == "Made" and row("rug").source == "From the picture"
    assert view_state.refresh(bpy.context.scene).textures.order == "MADE"


def test_choosing_what_holds_already_changes_nothing() -> None:
    before = ResolvedScene(bpy.context.scene).load_memory()
    bpy.ops.code_as_room.choose_texture_source(surface="floor", source="BEST")
    bpy.ops.code_as_room.prefer_textures(order="MODEL_FIRST")
    assert ResolvedScene(bpy.context.scene).load_memory() == before


def test_an_image_model_paints_what_the_artist_wants_once_and_its_cost_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    painter, kept = Painter(), s09_kept(tmp_path)
    monkeypatch.setattr(painters, "room_painter", lambda picture, spent: painter)
    monkeypatch.setattr(painters, "painted_images", lambda: kept)
    bpy.ops.code_as_room.prefer_textures(order="PICTURE_ONLY")
    bpy.ops.code_as_room.choose_texture_source(surface="rug", source="MODEL")
    bpy.ops.code_as_room.make_textures()
    assert row("rug").source == "Painted" and "painter-1" in row("rug").detail and len(painter.asked) == 1
    memory = load_memory(ResolvedScene(bpy.context.scene).load_memory())
    assert memory.cost()[2] == pytest.approx(0.04)
    bpy.ops.code_as_room.make_textures()
    assert len(painter.asked) == 1, "what was painted is paid for once"


def s09_kept(folder: Path) -> Any:
    from code_as_room.pipeline.textures.kept import KeptImages

    return KeptImages(folder)


def test_a_lost_image_makes_its_stage_out_of_date_and_comes_back_with_it() -> None:
    name = next(name for name in ours() if name.startswith("rug_"))
    bpy.data.images.remove(ours()[name])
    state = view_state.refresh(bpy.context.scene)
    stage = state.stage(s09_textures.ID)
    assert stage is not None and stage.status == "stale"
    make()
    assert find_image(name) is not None
    stage = view_state.refresh(bpy.context.scene).stage(s09_textures.ID)
    assert stage is not None and stage.status == "done"


def test_results_have_the_images_beside_the_program(tmp_path: Path) -> None:
    run = room_memory.run_of(bpy.context.scene)
    files = outputs.image_files(run, program())
    assert set(files) == {f"textures/{name}.png" for name in ours()}
    written = outputs.write_together(tmp_path, {name: _writer(data) for name, data in files.items()})
    assert all(Image.open(path).size[0] > 8 for path in written)
    assert not [p for p in tmp_path.rglob("*") if ".part-" in p.name]


def _writer(data: bytes) -> Callable[[Path], Any]:
    return lambda path: path.write_bytes(data)
