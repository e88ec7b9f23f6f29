# SPDX-License-Identifier: GPL-3.0-or-later
"""What the sidebar says before, during and after a run, drawn into a layout that checks what it is given."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import driver, view_state
from code_as_room.operators.job import Progress
from code_as_room.pipeline.errors import ModelError
from code_as_room.pipeline.stages import all_stages
from PIL import Image, ImageDraw

ICONS = {item.identifier for item in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items}


def options_of(function: str) -> set[str]:
    """The arguments that a function of Blender's layouts takes."""
    return set(bpy.types.UILayout.bl_rna.functions[function].parameters.keys())


class Drawn:
    """A layout that records, and refuses what Blender would refuse: unknown icons, properties and operators."""

    def __init__(self, said: list[str], off: list[str], menus: list[str], disabled: bool = False) -> None:
        self.said, self.off, self.menus, self._disabled = said, off, menus, disabled
        self.enabled = self.active = True

    def _child(self, *_: Any, **__: Any) -> Drawn:
        return Drawn(self.said, self.off, self.menus, self._disabled or not self.enabled)

    row = column = box = grid_flow = split = _child

    def _say(self, text: str, icon: str = "NONE") -> None:
        assert icon in ICONS, icon
        assert isinstance(text, str)
        self.said.append(text)
        if self._disabled or not self.enabled:
            self.off.append(text)

    def label(self, text: str = "", icon: str = "NONE") -> None:
        self._say(text, icon)

    def separator(self, **options: Any) -> None:
        assert set(options) <= options_of("separator")

    def prop(self, data: Any, name: str, text: str | None = None, icon: str = "NONE", **options: Any) -> None:
        assert set(options) <= options_of("prop")
        self._say(data.bl_rna.properties[name].name if text is None else text, icon)

    def operator(self, name: str, text: str | None = None, icon: str = "NONE", **options: Any) -> Any:
        assert set(options) <= options_of("operator")
        group, verb = name.split(".")
        kind = getattr(getattr(bpy.ops, group), verb).get_rna_type()
        self._say(kind.name if text is None else text, icon)
        return SimpleNamespace(**{prop.identifier: None for prop in kind.properties})

    def operator_menu_enum(self, name: str, property: str, text: str = "", icon: str = "NONE") -> Any:
        group, verb = name.split(".")
        kind = getattr(getattr(bpy.ops, group), verb).get_rna_type()
        assert property in kind.properties
        self._say(text, icon)
        return SimpleNamespace(**{prop.identifier: None for prop in kind.properties})

    def menu(self, name: str, text: str = "", icon: str = "NONE") -> None:
        assert hasattr(bpy.types, name)
        self.menus.append(name)

    def template_list(
        self, kind: str, name: str, data: Any, items: str, active: Any, index: str, **options: Any
    ) -> None:
        assert set(options) <= options_of("template_list")
        assert isinstance(getattr(active, index), int)
        for place, item in enumerate(getattr(data, items)):
            getattr(bpy.types, kind).draw_item(None, bpy.context, self._child(), data, item, 0, active, index, place)

    def progress(self, factor: float, text: str, type: str) -> None:
        assert 0.0 <= factor <= 1.0
        self._say(text)

    def template_icon(self, icon_value: int, scale: float) -> None:
        assert isinstance(icon_value, int)

    def icon(self, data: Any) -> int:
        return 1


def draw(title: str = "") -> Drawn:
    """Draw one panel, or all that would be shown."""
    from code_as_room import panels

    drawn = Drawn([], [], [])
    for cls in panels.panel_classes():
        parent = getattr(cls, "bl_parent_id", "")
        if title and cls.bl_label != title and getattr(getattr(bpy.types, parent, None), "bl_label", "") != title:
            continue
        if not hasattr(cls, "poll") or cls.poll(bpy.context):
            panel = SimpleNamespace(layout=drawn)
            panel.draw_state = partial(cls.draw_state, panel)
            if hasattr(cls, "draw_header_preset"):
                cls.draw_header_preset(panel, bpy.context)
            cls.draw(panel, bpy.context)
    return drawn


def opened(menu: str) -> Drawn:
    """What a menu offers now."""
    drawn, cls = Drawn([], [], []), getattr(bpy.types, menu)
    cls.draw(SimpleNamespace(layout=drawn, stage=getattr(cls, "stage", "")), bpy.context)
    return drawn


def text_of(drawn: Drawn) -> str:
    return " ".join(drawn.said)


@pytest.fixture(autouse=True)
def enabled() -> Iterator[None]:
    """The add-on enabled in an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    yield
    code_as_room.unregister()


@pytest.fixture
def picture(tmp_path: Path) -> str:
    """A drawing of a room with a bed and a wardrobe."""
    image = Image.new("RGB", (480, 400), "white")
    pen = ImageDraw.Draw(image)
    pen.rectangle((30, 30, 450, 370), fill=(120, 120, 125))
    pen.rectangle((45, 45, 435, 355), fill=(205, 170, 130))
    pen.rectangle((170, 50, 310, 220), fill=(90, 120, 180))
    pen.rectangle((180, 55, 300, 90), fill=(240, 240, 240))
    pen.rectangle((370, 120, 430, 280), fill=(235, 235, 230))
    path = tmp_path / "flat.png"
    image.save(path)
    return str(path)


def load(path: str) -> None:
    bpy.ops.code_as_room.load_picture(filepath=path)


def test_a_scene_that_was_not_looked_at_yet_draws_too() -> None:
    view_state.forget_all()
    assert "Reading the room" in draw("Stages").said


def test_without_a_picture_it_asks_for_one_and_nothing_can_run() -> None:
    view_state.refresh(bpy.context.scene)
    assert "Load a picture of a room" in text_of(draw())
    assert not bpy.ops.code_as_room.run_all.poll()
    with pytest.raises(RuntimeError, match="Load a picture of a room first"):
        bpy.ops.code_as_room.run_all()


def test_with_a_picture_it_shows_name_and_size_and_says_that_no_model_is_used(picture: str) -> None:
    load(picture)
    said = text_of(draw())
    assert "flat.png" in said and "480 x 400 pixels" in said
    assert "No model" in said
    assert bpy.ops.code_as_room.run_all.poll()


def test_a_picture_that_is_none_is_refused_in_a_sentence_and_the_earlier_one_stays(
    picture: str, tmp_path: Path
) -> None:
    load(picture)
    wrong = tmp_path / "notes.png"
    wrong.write_text("not a picture")
    with pytest.raises(RuntimeError, match=r"notes\.png") as caught:
        load(str(wrong))
    assert "Traceback" not in str(caught.value)
    assert bpy.context.scene.code_as_room.picture_name == "flat.png"
    assert "notes.png" in text_of(draw("Stages"))


def test_an_image_that_is_open_in_blender_can_be_used() -> None:
    image = bpy.data.images.new("painted", 200, 160)
    image.pixels.foreach_set([0.5, 0.25, 0.75, 1.0] * (200 * 160))
    bpy.ops.code_as_room.use_image(image="painted")
    assert "200 x 160 pixels" in text_of(draw("Reference"))
    from code_as_room.operators.reference import kept_picture

    kept = kept_picture(bpy.context.scene)
    assert kept is not None
    with Image.open(io.BytesIO(kept.data)) as pixels:
        assert pixels.convert("RGB").getpixel((5, 5)) == pytest.approx((128, 64, 191), abs=1)


def test_after_a_run_it_shows_the_room_and_what_became_of_the_objects(picture: str, tmp_path: Path) -> None:
    load(picture)
    scene = bpy.context.scene
    scene.code_as_room.use_known_width, scene.code_as_room.known_width = True, 4.0
    scene.code_as_room.iterations = 1
    bpy.ops.code_as_room.run_all()
    said = text_of(draw())
    assert "4.00 x" in said
    stages = len(all_stages())
    assert "detailed" in said and "Round 1, score" in said and f"Done: {stages} stages" in said
    assert draw("Stages").said.count("done") == stages
    assert not bpy.ops.code_as_room.run_all.poll(), "there is nothing left to run"

    scene.code_as_room.known_width = 5.0
    assert "5.00 x" in text_of(draw("Calibration")), "what is known takes effect at once"
    assert draw("Stages").said.count("done") == stages, "and nothing has to be asked again"
    scene.code_as_room.known_width = 4.0
    assert "4.00 x" in text_of(draw("Calibration"))

    bpy.ops.code_as_room.write_outputs(directory=str(tmp_path / "new" / "folder"))
    assert (tmp_path / "new" / "folder" / "report.html").is_file()
    assert {"Report", "Folder"} <= set(draw("Output").said)

    saved = str(tmp_path / "room.blend")
    bpy.ops.wm.save_as_mainfile(filepath=saved)
    bpy.ops.wm.open_mainfile(filepath=saved)
    assert draw("Stages").said.count("done") == stages, "the room is resumed from the file alone"

    objects = len(bpy.context.scene.objects)
    assert objects > 4
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.code_as_room.new_room()
    assert [o.name for o in bpy.context.scene.objects if o.type == "MESH"] == ["Cube"], "only what we made is removed"
    assert any(text.name.startswith("Memory of flat.png") for text in bpy.data.texts)
    assert "done" not in draw("Stages").said


def test_another_picture_does_not_overwrite_a_room(picture: str, tmp_path: Path) -> None:
    load(picture)
    from code_as_room.operators.scene_backend import ResolvedScene
    from code_as_room.pipeline.memory import EntryMeta, Memory, dump_memory

    memory = Memory("flat.png", bpy.context.scene.code_as_room.picture["code_as_room_reference"])
    memory.keep_answer("s01_analysis", "01_analysis", "{}", EntryMeta(time="2026-01-01T00:00:00+00:00"))
    backend = ResolvedScene(bpy.context.scene)
    backend.save_memory(dump_memory(memory))
    backend.flush()
    other = str(tmp_path / "other.png")
    Image.new("RGB", (300, 200), "green").save(other)
    with pytest.raises(RuntimeError, match="begun with another picture"):
        load(other)
    assert bpy.context.scene.code_as_room.picture_name == "flat.png"
    bpy.ops.code_as_room.load_picture(filepath=other, anew=True)
    assert bpy.context.scene.code_as_room.picture_name == "other.png"


def test_a_failed_stage_says_why_in_the_panel(picture: str) -> None:
    load(picture)
    scene = bpy.context.scene
    view_state.note_failure(scene.session_uid, "s01_analysis", ModelError("The service is full.", "Try again later."))
    view_state.refresh(scene)
    drawn = draw("Stages")
    assert "failed" in drawn.said
    assert "Scene analysis: The service is full. Try again later." in text_of(drawn)


def test_a_fault_of_ours_is_told_without_its_innards() -> None:
    problem = view_state.Problem.of(KeyError("secret innards"))
    assert "secret" not in problem.message + problem.fix
    assert problem.fix


def test_a_memory_that_the_artist_broke_is_told_with_its_line_and_blocks_running(picture: str) -> None:
    load(picture)
    from code_as_room.operators.scene_backend import ResolvedScene

    backend = ResolvedScene(bpy.context.scene)
    backend.save_memory('{\n "format": oops\n}\n')
    backend.flush()
    view_state.refresh(bpy.context.scene)
    assert "line 2" in text_of(draw("Reference"))
    assert not bpy.ops.code_as_room.run_all.poll()
    with pytest.raises(RuntimeError, match="line 2"):
        bpy.ops.code_as_room.run_all()


def test_while_a_run_is_going_on_it_shows_progress_and_stop(picture: str, monkeypatch: pytest.MonkeyPatch) -> None:
    load(picture)
    progress = Progress("s03_layout", "Major layout", "Layout, round 2", 2, 6, "answered", 0.0, 3, 4)
    monkeypatch.setattr(driver, "progress_of", lambda scene: progress)
    monkeypatch.setattr(driver, "is_running", lambda: True)
    drawn = draw()
    assert "running" in drawn.said and "Stop (Esc)" in drawn.said
    assert "Layout, round 2: answered" in text_of(drawn)
    assert "Run to the End" not in drawn.said
    assert "Change" not in draw("Reference").said or not bpy.ops.code_as_room.load_picture.poll()


def test_stages_wait_for_the_stage_before_them(picture: str) -> None:
    load(picture)
    state = view_state.peek(bpy.context.scene)
    assert state is not None
    assert [bool(row.blocked) for row in state.stages] == [False] + [True] * (len(all_stages()) - 1)
    assert "Scene analysis" in state.stages[1].blocked


def test_the_menu_of_a_stage_offers_what_can_be_done_now(picture: str) -> None:
    load(picture)
    first, second = opened("CODE_AS_ROOM_MT_s01_analysis"), opened("CODE_AS_ROOM_MT_s02_graph")
    assert {"Redo", "Redo from Here", "Redo Selected Objects Only"} <= set(first.off), "it has not run yet"
    assert "Run" not in first.off and "Run to Here" not in first.off
    assert "Run" in second.off, "it waits for the first"
    assert "Run to Here" not in second.off
    bpy.ops.code_as_room.run_to(stage="s02_graph")
    first = opened("CODE_AS_ROOM_MT_s01_analysis")
    assert {"Redo", "Redo from Here"}.isdisjoint(first.off) and "Run to Here" in first.off
    state = view_state.peek(bpy.context.scene)
    assert state is not None and [row.status for row in state.stages][:4] == ["done", "done", "not run", "not run"]


def test_every_panel_says_what_to_do_next_while_it_is_empty(picture: str) -> None:
    load(picture)
    assert "after the scene analysis" in text_of(draw("Detected Objects"))
    assert "once it has run" in text_of(draw("Layout Loop"))


def test_an_answer_that_waits_is_told(picture: str) -> None:
    load(picture)
    scene = bpy.context.scene
    state = view_state.peek(scene)
    assert state is not None
    waiting = replace(state.stages[0], status="answered")
    view_state._states[scene.session_uid] = replace(state, stages=(waiting, *state.stages[1:]))
    assert "answered, not applied" in text_of(draw("Stages"))
