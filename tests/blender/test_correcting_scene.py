# SPDX-License-Identifier: GPL-3.0-or-later
"""Corrections in a scene: the built room, its memory and the panel follow at once, and nothing happens half-way."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import clients, correcting, driver, view_state
from code_as_room.operators.scene_backend import ResolvedScene
from code_as_room.pipeline.artifacts.common import ImagePoint
from code_as_room.pipeline.artifacts.corrections import Corrections, KnownLength, ObjectCorrection
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.memory import load_memory
from code_as_room.pipeline.models.recorded import RecordedClient
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run_corrections import corrections_of
from code_as_room.pipeline.scene.tags import ID, find_room_collection
from code_as_room.pipeline.stages import all_stages

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "bedroom"
LENGTH = KnownLength(start=ImagePoint(x=300, y=300), end=ImagePoint(x=700, y=300), metres=3.5)


@pytest.fixture(scope="module")
def furnished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file with the sample's room in it, all stages done."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(clients, "room_client", lambda *a, **k: RecordedClient(SAMPLE / "replies"))
        patch.setattr(clients, "current_client", lambda *a, **k: RecordedClient(SAMPLE / "replies"))
        bpy.ops.code_as_room.load_picture(filepath=str(SAMPLE / "picture.png"))
        bpy.ops.code_as_room.run_all()
    path = tmp_path_factory.mktemp("room") / "room.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    code_as_room.unregister()
    return path


@pytest.fixture
def scene(furnished: Path) -> Iterator[Any]:
    """The sample's room, opened anew; nobody can be asked."""
    code_as_room.register()
    bpy.ops.wm.open_mainfile(filepath=str(furnished))
    yield bpy.context.scene
    code_as_room.unregister()


def memory(scene: Any) -> Any:
    return load_memory(ResolvedScene(scene).load_memory())


def standing(scene: Any) -> dict[str, tuple[Any, ...]]:
    """World matrices and vertex coordinates of everything that was built, as plain numbers."""
    bpy.context.view_layer.update()
    result = {}
    for obj in find_room_collection(scene).all_objects:
        if ID in obj and obj.type in ("MESH", "EMPTY"):
            points = tuple(tuple(v.co) for v in obj.data.vertices) if obj.type == "MESH" else ()
            result[obj[ID]] = (tuple(tuple(row) for row in obj.matrix_world), points)
    return result


def extent(scene: Any, identifier: str) -> list[float]:
    """Width, depth and height of what stands for an object, in the world."""
    matrix, points = standing(scene)[identifier]
    world = [[sum(r[i] * p[i] for i in range(3)) + r[3] for r in matrix[:3]] for p in points]
    return [max(v) - min(v) for v in zip(*world, strict=True)]


def statuses(scene: Any) -> list[str]:
    return [row.status for row in view_state.refresh(scene).stages]


def test_a_known_length_scales_what_stands_and_all_stages_stay_done(scene: Any) -> None:
    proxies = parse_layout(ResolvedScene(scene).program_text()).proxies
    before, boxes = {p.id: extent(scene, p.id) for p in proxies}, {p.id: p.size for p in proxies}
    width = view_state.refresh(scene).room_size[0]
    correcting.apply(scene, lambda c: c.model_copy(update={"known_length": LENGTH}))
    factor = view_state.peek(scene).room_size[0] / width  # type: ignore[union-attr]
    assert statuses(scene) == ["done"] * len(all_stages()) and abs(factor - 1.0) > 0.05
    assert corrections_of(memory(scene)).known_length == LENGTH
    lying = set(re.findall(r'furnish\("(\w+)", \w+, lying=True\)', ResolvedScene(scene).program_text()))
    for name, size in before.items():
        # Seams and roundings of furniture have thicknesses of their own, so a turned thing's outline follows nearly. How
        # far the ends of a cloth fall depends on what they fall onto.
        axes = slice(2 if name in lying else 3)
        wanted = [v * factor for v in size]
        assert extent(scene, name)[axes] == pytest.approx(wanted[axes], rel=5e-2, abs=1e-3), name
    sizes = {p.id: p.size for p in parse_layout(ResolvedScene(scene).program_text()).proxies}
    for name, size in boxes.items():
        assert sizes[name] == pytest.approx([v * factor for v in size], rel=2e-3, abs=1e-3), name
    assert not ResolvedScene(scene).read_back(), "the new sizes are no edits by hand"
    correcting.apply(scene, lambda c: Corrections())
    for name, size in before.items():
        assert extent(scene, name) == pytest.approx(size, abs=1e-5), name


def test_what_was_moved_by_hand_is_taken_over_before_the_room_is_scaled(scene: Any) -> None:
    chair = next(o for o in find_room_collection(scene).all_objects if o.type == "MESH" and "bench" in o.get(ID, ""))
    name = chair[ID]
    chair.location.x += 0.5
    bpy.context.view_layer.update()
    x = chair.matrix_world.translation.x
    width = view_state.refresh(scene).room_size[0]
    scene.code_as_room.known_width = width * 2
    scene.code_as_room.use_known_width = True
    assert view_state.peek(scene).room_size[0] == pytest.approx(width * 2, rel=1e-5)  # type: ignore[union-attr]
    chair = next(o for o in find_room_collection(scene).all_objects if o.get(ID) == name)
    assert chair.matrix_world.translation.x == pytest.approx(2 * x, abs=1e-3)
    assert len([e for e in memory(scene).entries if e.type == "HandEdits"]) == 1
    assert statuses(scene) == ["done"] * len(all_stages())


def test_what_the_artist_put_into_the_room_is_scaled_with_it_and_back(scene: Any) -> None:
    mesh = bpy.data.meshes.new("Crate")
    corners = [(x, y, z) for x in (0.0, 0.4) for y in (0.0, 0.3) for z in (0.0, 0.5)]
    mesh.from_pydata(corners, [], [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)])
    crate = bpy.data.objects.new("Crate", mesh)
    crate.location = (0.3, -0.5, 0.0)
    find_room_collection(scene).objects.link(crate)
    width = view_state.refresh(scene).room_size[0]
    scene.code_as_room.known_width = width * 2
    scene.code_as_room.use_known_width = True
    name = crate[ID]
    assert extent(scene, name) == pytest.approx([0.8, 0.6, 1.0], abs=1e-3)
    assert tuple(crate.matrix_world.translation) == pytest.approx((0.6, -1.0, 0.0), abs=1e-3)
    assert not ResolvedScene(scene).read_back()
    scene.code_as_room.use_known_width = False
    assert extent(scene, name) == pytest.approx([0.4, 0.3, 0.5], abs=1e-4)
    assert len(mesh.vertices) == 8 and statuses(scene) == ["done"] * len(all_stages())


def test_ticking_a_known_size_alone_changes_nothing(scene: Any) -> None:
    before, size = standing(scene), view_state.refresh(scene).room_size
    high = extent(scene, "wall_n")[2]
    scene.code_as_room.use_known_width = True
    scene.code_as_room.use_wall_height = True
    assert scene.code_as_room.known_width == pytest.approx(size[0])
    assert scene.code_as_room.wall_height == pytest.approx(size[2])
    assert standing(scene) == before and statuses(scene) == ["done"] * len(all_stages())
    scene.code_as_room.wall_height = size[2] + 0.4
    assert extent(scene, "wall_n")[2] == pytest.approx(high + 0.4, abs=1e-4)
    unmoved = parse_layout(ResolvedScene(scene).program_text()).proxies
    assert all(standing(scene)[p.id] == before[p.id] for p in unmoved if p.placement != "ceiling")
    assert statuses(scene) == ["done"] * len(all_stages())


def test_a_locked_object_keeps_its_very_numbers_when_the_layout_is_done_again(
    scene: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = "bed_1" if "bed_1" in standing(scene) else next(i for i in standing(scene) if "bed" in i)
    before = standing(scene)[name]
    correcting.apply(scene, lambda c: c.having(ObjectCorrection(id=name, locked=True)))
    for patched in ("room_client", "current_client"):
        monkeypatch.setattr(clients, patched, lambda *a, **k: RecordedClient(SAMPLE / "replies"))
    bpy.ops.code_as_room.run_stage(stage="s03_layout")
    bpy.ops.code_as_room.run_stage(stage="s04_auxiliary")
    assert standing(scene)[name][0] == before[0]
    bpy.ops.code_as_room.run_all()
    assert standing(scene)[name] == before


def test_nothing_is_corrected_while_a_run_goes_on_or_in_edit_mode(scene: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    text, stood = ResolvedScene(scene).load_memory(), standing(scene)
    with monkeypatch.context() as patch:
        patch.setattr(driver, "is_running", lambda: True)
        with pytest.raises(RoomError, match="going on"):
            correcting.apply(scene, lambda c: c.model_copy(update={"known_length": LENGTH}))
    mesh = next(o for o in find_room_collection(scene).all_objects if o.type == "MESH" and not o.hide_get())
    bpy.context.view_layer.objects.active = mesh
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RoomError, match="Edit mode"):
        correcting.apply(scene, lambda c: c.model_copy(update={"known_length": LENGTH}))
    bpy.ops.object.mode_set(mode="OBJECT")
    with pytest.raises(RoomError):
        correcting.apply(scene, lambda c: c.model_copy(update={"floor_polygon": []}))
    assert ResolvedScene(scene).load_memory() == text and standing(scene) == stood


def test_without_a_picture_there_is_nothing_to_correct() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    try:
        with pytest.raises(RoomError, match="picture"):
            correcting.apply(bpy.context.scene, lambda c: Corrections())
    finally:
        code_as_room.unregister()
