# SPDX-License-Identifier: GPL-3.0-or-later
"""Light, sky, exposure, ceiling and section in Blender; what the artist changes of them stays."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from code_as_room.pipeline.program.assemble import assemble
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import parse_layout, print_layout
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.realise import realise_record
from code_as_room.pipeline.scene.shoot import CUT, cut_for, set_stage, shoot, strike_stage
from code_as_room.pipeline.scene.studio import visible_objects
from code_as_room.pipeline.scene.tags import find_room_collection
from PIL import Image

ROOM = """
room(size=(4, 3, 2.5), floor=[(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)])
wall("wall_s", (-2, -1.5), (2, -1.5), height=2.5)
wall("wall_e", (2, -1.5), (2, 1.5), height=2.5)
wall("wall_n", (2, 1.5), (-2, 1.5), height=2.5)
wall("wall_w", (-2, 1.5), (-2, -1.5), height=2.5)
window("window_1", wall="wall_s", start=(-1, -1.5), end=(1, -1.5), sill=0.9, height=1.3)
proxy("lamp_1", "floor lamp", centre=(1.5, 1, 0.8), size=(0.4, 0.4, 1.6))
proxy("art_1", "picture", centre=(0, -1.47, 1.2), size=(0.5, 0.03, 0.4), placement="wall", parent="wall_s")
light("window_1_light", "area", at=(0, -1.45, 1.5), energy=40, size=1.8, size_y=1.2, target=(0, 0, 1.5), kelvin=7000, parent="window_1")
light("lamp_1_light", "point", at=(1.5, 1, 1.3), energy=8, size=0.05, kelvin=3000, parent="lamp_1")
world("sky", strength=0.5, kelvin=7000, background=(0.8, 0.9, 1))
view("view", exposure=0.75, transform="AgX", look="AgX - Medium High Contrast", ceiling=2.5, cut=2)
camera("reference", "perspective", matrix=(1, 0, 0, 0, 0, 0.5, -0.866025404, -6, 0, 0.866025404, 0.5, 5, 0, 0, 0, 1), fov_y=0.6,
    image_size=(320, 240))
camera("top", "orthographic", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5.5, 0, 0, 0, 1), ortho_height=3.5, image_size=(320, 240), near=3.5)
build()
"""


@pytest.fixture
def built() -> Any:
    """The room, built."""
    backend = BlenderScene(bpy.context.scene)
    backend.build(ROOM)
    return backend


def obj(name: str) -> Any:
    return bpy.data.objects[name]


def test_lights_shine_as_their_lines_say_and_are_not_seen(built: Any) -> None:
    window, lamp = obj("window_1_light"), obj("lamp_1_light")
    assert (window.data.shape, round(window.data.size, 4), round(window.data.size_y, 4)) == ("RECTANGLE", 1.8, 1.2)
    assert np.allclose(-np.array(window.matrix_world)[:3, 2], (0, 1, 0), atol=1e-6)
    assert window.data.color[2] > window.data.color[0] and lamp.data.color[0] > 1.5 * lamp.data.color[2]
    assert not window.visible_camera and not lamp.visible_camera
    assert window.parent == obj("window_1") and lamp.parent == obj("lamp_1")


@pytest.mark.parametrize(("transform", "seen"), [("AgX", False), ("Khronos PBR Neutral", True)])
def test_a_bright_ceiling_is_seen_in_gloss_where_gloss_is_taken_away_again(transform: str, seen: bool) -> None:
    """Through AgX dark leather under it would be grey."""
    panel = 'light("ceiling_light", "area", at=(0, 0, 2.4), energy=40, size=3, size_y=2)\nbuild()'
    text = ROOM.replace("build()", panel).replace('"AgX", look="AgX - Medium High Contrast"', f'"{transform}"')
    backend = BlenderScene(bpy.context.scene)
    for before in (text.replace(transform, "Standard"), text):
        backend.build(before)
    assert obj("ceiling_light").visible_glossy == seen
    assert not obj("window_1_light").visible_glossy and obj("lamp_1_light").visible_glossy
    assert backend.read_back() == []


def test_sky_and_exposure_are_set_and_nothing_reads_as_edited(built: Any) -> None:
    scene = bpy.context.scene
    assert scene.view_settings.exposure == pytest.approx(0.75)
    assert scene.view_settings.view_transform == "AgX" and "Medium High" in scene.view_settings.look
    strengths = {
        n.label: n.inputs["Strength"].default_value for n in scene.world.node_tree.nodes if n.type == "BACKGROUND"
    }
    assert strengths["Light"] == pytest.approx(0.5)
    assert obj("top").data.clip_start == pytest.approx(3.5)
    assert built.read_back() == []


def test_what_the_artist_changed_of_sky_and_exposure_stays_until_the_line_changes(built: Any) -> None:
    scene = bpy.context.scene
    scene.view_settings.exposure = -1.0
    mine = bpy.data.worlds.new("Mine")
    scene.world = mine
    built.build(ROOM.replace("energy=8", "energy=9"))
    assert scene.view_settings.exposure == -1.0 and scene.world == mine
    built.build(ROOM.replace("exposure=0.75", "exposure=0.5"))
    assert scene.view_settings.exposure == pytest.approx(0.5) and scene.world == mine


def test_a_room_without_the_lines_gives_back_what_was_there() -> None:
    scene = bpy.context.scene
    scene.world = before = bpy.data.worlds.new("Before")
    scene.view_settings.view_transform, scene.view_settings.exposure = "Standard", 0.3
    backend = BlenderScene(scene)
    backend.build(ROOM)
    assert scene.world != before
    plain = "\n".join(row for row in ROOM.splitlines() if not row.startswith(("world", "view")))
    backend.build(plain)
    assert scene.world == before and scene.view_settings.view_transform == "Standard"
    assert scene.view_settings.exposure == pytest.approx(0.3)
    assert "ceiling" not in bpy.data.objects and not [w for w in bpy.data.worlds if w.name.startswith("Room World")]


def test_a_light_that_follows_its_lamp_is_no_edit_of_the_artists(built: Any) -> None:
    obj("lamp_1").location.x -= 0.5
    bpy.context.view_layer.update()
    edits = {edit.id: edit for edit in built.read_back()}
    assert edits["lamp_1"].origin == "artist"
    assert edits["lamp_1_light"].origin == "parent"
    assert "at=(1, 1, 1.3)" in str(edits["lamp_1_light"].line)


def test_a_light_that_the_artist_dimmed_stays_dimmed(built: Any) -> None:
    obj("lamp_1_light").data.energy = 3.0
    edits = built.read_back()
    assert [e.id for e in edits] == ["lamp_1_light"] and "energy=3" in str(edits[0].line)
    built.build(ROOM)
    assert obj("lamp_1_light").data.energy == 3.0


def test_the_ceiling_hides_nothing_of_the_editors_pictures(built: Any) -> None:
    room = find_room_collection(bpy.context.scene)
    ceiling = obj("ceiling")
    assert {"ceiling", "section"} & {o.name for o in visible_objects(room)} == set()
    assert ceiling.display_type == "WIRE" and ceiling.hide_select
    assert ceiling.data.polygons[0].normal.z == pytest.approx(-1)
    assert {round(v.co.z, 4) for v in obj("section").data.vertices} == {1.998}
    for v in obj("section").data.vertices:  # inside the walls, and not where the window is
        assert 1.5 < abs(v.co.y) < 1.62 or 2.0 < abs(v.co.x) < 2.12


def test_room_py_makes_the_same_light(built: Any, tmp_path: Path) -> None:
    scene = bpy.context.scene

    def said() -> Any:
        lights = {
            o.name: (o.data.energy, tuple(o.data.color), o.visible_camera)
            for o in bpy.data.objects
            if o.type == "LIGHT"
        }
        nodes = sorted(n.bl_idname for n in scene.world.node_tree.nodes)
        return (
            lights,
            nodes,
            scene.view_settings.exposure,
            scene.view_settings.look,
            sorted(o.name for o in bpy.data.objects),
        )

    first = said()
    text = assemble(built.program_text())
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    path = tmp_path / "room.py"
    path.write_text(text, encoding="utf-8")
    runpy.run_path(str(path))
    assert said() == first


def test_light_moves_no_object_and_no_vertex() -> None:
    plain = "\n".join(row for row in ROOM.splitlines() if not row.startswith(("world", "view", "light")))

    def stands() -> dict[str, Any]:
        return {
            o.name: (np.array(o.matrix_world).tolist(), [tuple(v.co) for v in o.data.vertices])
            for o in bpy.data.objects
            if o.type == "MESH" and o.name not in ("ceiling", "section", "skirting")
        }

    realise_record(evaluate(plain))
    before = stands()
    realise_record(evaluate(ROOM))
    assert stands() == before


def test_a_render_leaves_the_scene_as_it_was_and_sees_into_the_room(built: Any, tmp_path: Path) -> None:
    scene = bpy.context.scene
    before = (len(bpy.data.scenes), len(bpy.data.objects), scene.render.resolution_x, scene.camera.name)
    stage = set_stage(scene, "reference", 96, "CYCLES")
    hidden = {o.name.split(".")[0] for o in stage.objects if not o.visible_camera and o.type == "MESH"}
    assert hidden == {"wall_s", "window_1", "art_1"}  # the wall before the camera, with what it carries
    strike_stage(stage)
    shoot(scene, "reference", tmp_path / "view.png", 64)
    image = Image.open(tmp_path / "view.png").convert("L")
    assert image.size == (64, 48)
    middle = np.asarray(image)[18:34, 20:44]
    assert 30 < middle.mean() < 235 and middle.std() > 1  # the floor is lit, and neither black nor burnt out
    after = (len(bpy.data.scenes), len(bpy.data.objects), scene.render.resolution_x, scene.camera.name)
    assert after == before and all(o.visible_camera for o in bpy.data.objects if o.type == "MESH")


def test_a_chosen_view_cuts_the_walls_before_it_and_gives_them_back(built: Any) -> None:
    scene = bpy.context.scene
    cut_for(scene, obj("reference"))
    assert not obj("wall_s").visible_camera and CUT in obj("wall_s")
    cut_for(scene, obj("top"))
    assert obj("wall_s").visible_camera and CUT not in obj("wall_s")


def test_lines_of_light_survive_a_round_through_text() -> None:
    layout = parse_layout(ROOM)
    assert parse_layout(print_layout(layout)) == layout


def test_a_view_is_rendered_brighter_by_its_own_stops() -> None:
    text = ROOM.replace("image_size=(320, 240), near=3.5)", "image_size=(320, 240), near=3.5, stops=0.6)")
    BlenderScene(bpy.context.scene).build(text)
    scene = bpy.context.scene
    for name, exposure in (("reference", 0.75), ("top", 1.35)):
        stage = set_stage(scene, name, 64, "CYCLES")
        assert stage.view_settings.exposure == pytest.approx(exposure)
        strike_stage(stage)
    assert scene.view_settings.exposure == pytest.approx(0.75)
    assert parse_layout(print_layout(parse_layout(text))).cameras[1].stops == 0.6
