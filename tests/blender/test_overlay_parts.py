# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn over the picture, what lies under the pointer there, and what the verbs of calibration do."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import fitted_view, view_state
from code_as_room.operators.overlay import adding, composing, dragging, hits, length_field, selection, shown
from code_as_room.operators.overlay.composing import Frame, Hot, Wanted, compose, labels
from code_as_room.operators.overlay.draft import Draft
from code_as_room.pipeline.artifacts.analysis import Calibration
from code_as_room.pipeline.artifacts.common import ImageBox, ImagePoint
from code_as_room.pipeline.artifacts.corrections import Corrections, KnownLength, ObjectCorrection
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.geometry.handles import WHOLE, Grip
from code_as_room.pipeline.geometry.measuring import floor_distance
from code_as_room.pipeline.run_corrections import corrections_of
from PIL import Image, ImageDraw

FRAME = Frame(100.0, 700.0, 0.8, -0.6)
"""A picture of 800 x 600 pixels whose upper left corner is at (100, 700) of the region."""


def measure(text: str) -> float:
    return 6.0 * len(text)


def wanted(**options: Any) -> Wanted:
    boxes = (
        shown.ShownBox("bed_1", "double_bed", (100, 100, 500, 600), "placed"),
        shown.ShownBox("lamp_1", "floor_lamp", (700, 100, 760, 160)),
        shown.ShownBox("rug_1", "rug", (90, 500, 800, 900), "left out"),
    )
    corners = ((50.0, 50.0), (950.0, 50.0), (950.0, 950.0), (50.0, 950.0))
    return Wanted(shown.Shown(corners, boxes), FRAME, **options)


def test_the_frame_maps_there_and_back() -> None:
    assert FRAME.point((0, 0)) == (100, 700) and FRAME.point((1000, 1000)) == pytest.approx((900, 100))
    assert FRAME.back(FRAME.point((123.0, 456.0))) == pytest.approx((123, 456))
    assert FRAME.rectangle((100, 100, 500, 600)) == pytest.approx((180, 340, 500, 640))


def test_a_corner_is_grabbed_before_a_box_and_only_where_corners_are_shown() -> None:
    at = FRAME.point((52, 51))
    assert hits.hit_at(wanted(), at, measure=measure) == Hot(corner=0)
    assert hits.hit_at(wanted(corners=False), at, measure=measure) is None


def test_the_edge_of_the_floor_offers_a_new_corner() -> None:
    found = hits.hit_at(wanted(boxes=False), FRAME.point((500, 948)), True, measure)
    assert found is not None and found.edge is not None and found.edge.edge == 2
    assert found.edge.point == pytest.approx(FRAME.point((500, 950)))
    assert hits.hit_at(wanted(boxes=False), FRAME.point((500, 948)), False, measure) is None


def test_the_upper_edge_of_a_box_is_its_upper_edge_in_the_picture() -> None:
    found = hits.hit_at(wanted(active="bed_1", corners=False), FRAME.point((400, 101)), measure=measure)
    assert found == Hot(box="bed_1", grip=Grip(top=True))
    found = hits.hit_at(wanted(active="bed_1", corners=False), FRAME.point((499, 599)), measure=measure)
    assert found == Hot(box="bed_1", grip=Grip(right=True, bottom=True))


def test_the_active_box_comes_first_where_boxes_cross() -> None:
    crossing = FRAME.point((500, 500))  # the bed's right edge on the rug's upper edge
    for name in ("bed_1", "rug_1"):
        found = hits.hit_at(wanted(active=name, corners=False), crossing, measure=measure)
        assert found is not None and found.box == name


def test_a_label_is_clicked_to_hold_the_whole_box_and_labels_do_not_cover_each_other() -> None:
    places = labels(wanted(), measure)
    assert set(places) == {"bed_1", "lamp_1", "rug_1"}
    x_min, y_min, x_max, y_max = places["lamp_1"]
    found = hits.hit_at(wanted(corners=False), ((x_min + x_max) / 2, (y_min + y_max) / 2), measure=measure)
    assert found == Hot(box="lamp_1", grip=WHOLE)


def test_the_middle_of_a_box_is_left_to_blender() -> None:
    assert hits.hit_at(wanted(active="bed_1"), FRAME.point((300, 400)), True, measure) is None


def test_what_is_off_is_not_drawn() -> None:
    nothing = compose(wanted(corners=False, boxes=False), measure)
    assert not nothing.lines and not nothing.triangles and not nothing.texts
    assert {t.text for t in compose(wanted(corners=False), measure).texts} == {"double bed", "floor lamp", "rug"}


def test_the_active_box_is_thicker_and_states_have_colours_of_their_own() -> None:
    made = compose(wanted(active="lamp_1", corners=False), measure)
    thick = made.lines[composing.THICK]
    assert {s.start for s in thick} == set(composing.corners_of(FRAME.rectangle((700, 100, 760, 160))))
    colours = {s.colour for s in made.lines[composing.THIN]}
    assert colours == {composing.STATES["placed"], composing.STATES["left out"]}
    assert len(set(composing.STATES.values())) == len(composing.STATES)


def test_while_a_box_is_dragged_it_is_drawn_where_it_would_be() -> None:
    draft = Draft(1, box=(200, 200, 300, 300), box_id="lamp_1")
    made = compose(wanted(active="lamp_1", corners=False, draft=draft), measure)
    assert made.lines[composing.THICK][0].start == pytest.approx(FRAME.point((200, 300)))


def test_an_outline_no_floor_can_have_is_drawn_as_a_fault() -> None:
    outline = ((50.0, 50.0), (950.0, 950.0), (950.0, 50.0), (50.0, 950.0))
    made = compose(wanted(boxes=False, draft=Draft(1, outline=outline, faulty=True)), measure)
    assert {s.colour for s in made.lines[2.0]} == {composing.FAULT}


def test_without_handles_nothing_looks_as_if_it_could_be_grabbed() -> None:
    assert not compose(wanted(boxes=False, handles=False), measure).triangles


def test_a_box_that_was_drawn_in_is_corrected_where_it_is_kept() -> None:
    box = ImageBox(x_min=1, y_min=2, x_max=30, y_max=40)
    old = ImageBox(x_min=0, y_min=0, x_max=9, y_max=9)
    corrections = adding.with_added(Corrections(), adding.AddedObject(id="lamp_9", category="lamp", box=old))
    assert dragging.with_box(corrections, "lamp_9", box).added[0].box == box
    assert not dragging.with_box(corrections, "lamp_9", box).objects
    noted = Corrections(objects=[ObjectCorrection(id="bed_1", note="wide")])
    both = dragging.with_box(noted, "bed_1", box).of("bed_1")
    assert both.box == box and both.note == "wide"
    assert adding.without_object(corrections, "lamp_9") == Corrections()


@pytest.mark.parametrize(
    ("typed", "category", "identifier"),
    [
        ("  Floor  Lamp ", "floor_lamp", "floor_lamp_2"),
        ("Stehlampe!", "stehlampe", "stehlampe_1"),
        ("椅子", "椅子", "object_1"),
        ("...", "", "object_1"),
    ],
)
def test_what_an_artist_types_becomes_a_category_and_a_free_id(typed: str, category: str, identifier: str) -> None:
    assert adding.clean_category(typed) == category
    assert adding.added_id(category, {"floor_lamp_1"}) == identifier


@pytest.fixture
def room(tmp_path: Path) -> Iterator[Any]:
    """A scene whose picture was analysed; the built-in analysis sees a bed and a wardrobe."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    image = Image.new("RGB", (480, 400), "white")
    pen = ImageDraw.Draw(image)
    pen.rectangle((30, 30, 450, 370), fill=(120, 120, 125))
    pen.rectangle((45, 45, 435, 355), fill=(205, 170, 130))
    pen.rectangle((170, 50, 310, 220), fill=(90, 120, 180))
    pen.rectangle((370, 120, 430, 280), fill=(235, 235, 230))
    image.save(tmp_path / "flat.png")
    bpy.ops.code_as_room.load_picture(filepath=str(tmp_path / "flat.png"))
    bpy.ops.code_as_room.run_stage(stage="s01_analysis")
    yield bpy.context.scene
    if hasattr(bpy.types.Scene, "code_as_room"):
        code_as_room.unregister()


def kept(scene: Any) -> Corrections:
    from code_as_room.operators import room_memory

    return corrections_of(room_memory.memory_of(scene))


def calibration(scene: Any) -> Calibration:
    from code_as_room.operators import room_memory

    found = room_memory.memory_of(scene).latest(Calibration)
    assert found is not None
    return found


def correct(scene: Any, **changes: Any) -> None:
    from code_as_room.operators.overlay.tools import correct as apply

    apply(scene, lambda c: c.model_copy(update=changes), "Test")


def test_right_after_the_analysis_corners_and_boxes_are_shown(room: Any) -> None:
    seen = shown.refresh(room)
    assert len(seen.corners) == 4 and seen.camera is not None and not seen.moved
    assert seen.boxes and {b.state for b in seen.boxes} == {"detected"}


def test_a_corrected_box_is_shown_and_used(room: Any) -> None:
    box = shown.refresh(room).boxes[0]
    new = ImageBox(x_min=box.box[0] - 20, y_min=box.box[1], x_max=box.box[2], y_max=box.box[3])
    correct(room, objects=[ObjectCorrection(id=box.id, box=new)])
    found = shown.refresh(room).box_of(box.id)
    assert found is not None and found.image_box == new
    assert view_state.peek(room).stages[0].status == "done", "nothing has to be asked again"


def test_what_was_left_out_is_still_shown_so_that_it_can_come_back(room: Any) -> None:
    box = shown.refresh(room).boxes[0]
    correct(room, objects=[ObjectCorrection(id=box.id, include=False)])
    found = shown.refresh(room).box_of(box.id)
    assert found is not None and found.state == "left out" and found.box == box.box


def test_an_object_is_added_becomes_active_and_is_deleted_again(room: Any) -> None:
    before = {b.id for b in shown.refresh(room).boxes}
    bpy.ops.code_as_room.add_object(category="Floor Lamp", box=(700.0, 700.0, 760.0, 780.0))
    (added,) = [b for b in shown.refresh(room).boxes if b.id not in before]
    assert added.category == "floor_lamp" and added.added
    assert added.box == pytest.approx((700, 700, 760, 780))
    assert selection.active_id(room) == added.id
    bpy.ops.code_as_room.delete_added()
    assert {b.id for b in shown.refresh(room).boxes} == before and kept(room) == Corrections()


def test_a_detected_object_cannot_be_deleted(room: Any) -> None:
    selection.activate(room, shown.refresh(room).boxes[0].id)
    with pytest.raises(RuntimeError, match="Only an object that you drew in"):
        bpy.ops.code_as_room.delete_added()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"category": " ", "box": (1.0, 1.0, 90.0, 90.0)}, "no name"),
        ({"category": "lamp", "box": (5.0, 5.0, 6.0, 90.0)}, "too small"),
    ],
)
def test_a_drawing_that_says_too_little_is_refused_and_adds_nothing(
    room: Any, options: dict[str, Any], said: str
) -> None:
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.code_as_room.add_object(**options)
    assert kept(room) == Corrections()


def test_a_known_length_scales_the_room_and_can_be_changed_and_removed(room: Any) -> None:
    start, end = (300.0, 400.0), (700.0, 650.0)
    points = {"start": ImagePoint(x=start[0], y=start[1]), "end": ImagePoint(x=end[0], y=end[1])}
    size = view_state.peek(room).room_size
    correct(room, known_length=KnownLength(**points, metres=2.0))
    assert floor_distance(calibration(room).camera, start, end) == pytest.approx(2.0)
    setattr(bpy.context.window_manager, length_field.NAME, 3.0)
    assert getattr(bpy.context.window_manager, length_field.NAME) == pytest.approx(3.0)
    assert floor_distance(calibration(room).camera, start, end) == pytest.approx(3.0)
    bpy.ops.code_as_room.set_known_length(metres=4.0)
    assert floor_distance(calibration(room).camera, start, end) == pytest.approx(4.0)
    bpy.ops.code_as_room.remove_known_length()
    assert view_state.peek(room).room_size == pytest.approx(size)
    with pytest.raises(RuntimeError, match="no known length"):
        bpy.ops.code_as_room.remove_known_length()


def test_corners_that_were_moved_can_be_put_back(room: Any) -> None:
    found = list(shown.refresh(room).corners)
    moved = [ImagePoint(x=x + (15 if i == 0 else 0), y=y) for i, (x, y) in enumerate(found)]
    with pytest.raises(RuntimeError, match="where the analysis found them"):
        bpy.ops.code_as_room.reset_corners()
    correct(room, floor_polygon=moved)
    assert shown.refresh(room).moved and "pixels" in dragging.fit_sentence(room)
    bpy.ops.code_as_room.reset_corners()
    assert list(shown.refresh(room).corners) == found and not shown.peek(room).moved


def test_corners_that_no_room_has_are_refused_and_nothing_changes(room: Any) -> None:
    point = ImagePoint(x=500.0, y=500.0)
    before = calibration(room)
    with pytest.raises(RoomError):
        correct(room, floor_polygon=[point] * 4)
    assert calibration(room) == before and kept(room) == Corrections()


def test_tools_of_the_pointer_say_why_they_cannot_be_used(room: Any) -> None:
    for name in ("known_length", "add_missing", "drag_handle"):
        with pytest.raises(RuntimeError, match="used in a 3D view"):
            getattr(bpy.ops.code_as_room, name)()
    bpy.ops.code_as_room.new_room()
    with pytest.raises(RuntimeError, match="Run the scene analysis first"):
        bpy.ops.code_as_room.known_length()


def test_the_fits_number_is_explained_for_this_picture(room: Any) -> None:
    from code_as_room.operators.overlay.corner_ops import explanation

    assert "1.9 px is good" in " ".join(explanation(room)), "0.4 percent of 480 pixels"


def test_everything_says_what_it_does(room: Any) -> None:
    from code_as_room.operators import overlay

    for cls in overlay.CLASSES:
        if issubclass(cls, bpy.types.Operator):
            kind = getattr(bpy.ops.code_as_room, cls.bl_idname.split(".")[1]).get_rna_type()
            assert kind.description.strip() and not kind.description.rstrip().endswith(".")
            assert all(p.description for p in kind.properties if p.identifier != "rna_type"), kind.name


def test_nothing_is_left_after_disabling(room: Any) -> None:
    assert not fitted_view.is_looking_through(bpy.context)
    code_as_room.unregister()
    assert not hasattr(bpy.types.WindowManager, length_field.NAME)
    assert not [n for n in dir(bpy.types) if n.startswith(("CODE_AS_ROOM_GT", "CODE_AS_ROOM_GGT"))]
    assert not bpy.app.timers.is_registered(shown._look)
    assert not bpy.app.timers.is_registered(length_field._take_over)
