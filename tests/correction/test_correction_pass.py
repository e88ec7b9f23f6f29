"""The correction pass on rooms of boxes: what is wrong is found and mended by the least move, and nothing else changes."""

from __future__ import annotations

import math

import pytest
from code_as_room.pipeline.artifacts.correction import FAULT_KINDS
from code_as_room.pipeline.correction.correct import Corrected, Options, correct, find_faults
from code_as_room.pipeline.geometry.camera import camera_looking_at
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.program.patch import patch_text

SHELL = """# A room of 5 x 4 metres
room(size=(5, 4, 2.6), floor=[(-2.5, -2), (2.5, -2), (2.5, 2), (-2.5, 2)])
wall("south", (-2.5, -2), (2.5, -2), height=2.6, thickness=0.12)
wall("east", (2.5, -2), (2.5, 2), height=2.6, thickness=0.12)
wall("north", (2.5, 2), (-2.5, 2), height=2.6, thickness=0.12)
wall("west", (-2.5, 2), (-2.5, -2), height=2.6, thickness=0.12)
door("door", wall="south", start=(-2.2, -2), end=(-1.3, -2), height=2.05, open=70)
"""
TABLE = 'proxy("table", "table", centre=(1.2, 0, 0.35), size=(1.2, 0.8, 0.7), yaw=0)\n'
VASE = 'proxy("vase", "vase", centre=({x}, 0, {z}), size=(0.2, 0.2, 0.3), yaw=0, placement="surface", parent="table")\n'


def room(*lines: str, end: str = "") -> str:
    return SHELL + "".join(lines) + end + "build()\n"


def stool(x: float, y: float, z: float = 0.225, name: str = "stool") -> str:
    return f'proxy("{name}", "stool", centre=({x}, {y}, {z}), size=(0.4, 0.4, 0.45), yaw=0)\n'


def centre(text: str, name: str) -> tuple[float, float, float]:
    found = parse_layout(text).proxy(name)
    assert found is not None
    return found.centre


def mended(text: str, kind: str, options: Options | None = None) -> Corrected:
    """Corrected, with exactly one kind of fault before and none after; a second pass changes nothing."""
    options = options or Options()
    assert {f.kind for f in find_faults(text, options)} == {kind}
    result = correct(text, options)
    assert not find_faults(result.text, options)
    assert correct(result.text, options).text == result.text
    assert {fix.kind for fix in result.report.fixes} == {kind}
    return result


def test_a_sound_room_stays_byte_for_byte() -> None:
    text = room(TABLE, VASE.format(x=1.2, z=0.85), stool(-1, 1))
    result = correct(text)
    assert (result.text, result.edits, result.report.fixes, result.report.left) == (text, [], [], [])


@pytest.mark.parametrize("z", [0.325, 0.125])
def test_what_floats_over_the_floor_or_is_sunken_into_it_is_put_onto_it(z: float) -> None:
    result = mended(room(stool(0, 0, z)), "support")
    assert centre(result.text, "stool") == pytest.approx((0, 0, 0.225))
    [fix] = result.report.fixes
    assert fix.amount == pytest.approx(0.1) and str(z) in fix.before and "0.225" in fix.after


@pytest.mark.parametrize("z", [1.0, 0.8])
def test_a_vase_over_or_in_a_table_ends_on_its_top(z: float) -> None:
    result = mended(room(TABLE, VASE.format(x=1.2, z=z)), "support")
    assert centre(result.text, "vase") == pytest.approx((1.2, 0, 0.85), abs=1e-4)


def test_a_vase_beside_its_table_finds_a_seat_on_it_near_by() -> None:
    result = mended(room(TABLE, VASE.format(x=0.3, z=0.85)), "support")
    x, y, z = centre(result.text, "vase")
    assert 0.6 <= x <= 0.75 and abs(y) < 0.03 and z == pytest.approx(0.85, abs=1e-3)


def test_heights_are_those_of_the_meshes_not_of_the_boxes() -> None:
    low = 'def made(size):\n    return [part("top", box((1.2, 0.8, 0.04), at=(0, 0, 0.48)), material="wood"), ' \
          'part("leg", box((0.1, 0.1, 0.46), at=(0, 0, 0.23)), material="wood")]\n'  # fmt: skip
    text = low + room(TABLE, VASE.format(x=1.2, z=0.85), end='furnish("table", made)\n')
    result = mended(text, "support")
    assert centre(result.text, "vase")[2] == pytest.approx(0.5 + 0.15, abs=1e-4)


def test_what_is_outside_comes_back_by_the_shortest_way_with_what_it_carries() -> None:
    text = room(TABLE.replace("(1.2, 0,", "(2.3, 0.4,"), VASE.format(x=2.3, z=0.85).replace(", 0, 0.85", ", 0.4, 0.85"))
    # The light of a lamp that stands on it goes along.
    text = text.replace(
        "build", 'light("lamp", "point", at=(2.3, 0.4, 1.2), energy=40, size=0.1, parent="vase")\nbuild'
    )
    result = mended(text, "outside")
    assert centre(result.text, "table") == pytest.approx((1.9, 0.4, 0.35), abs=2e-3)
    assert centre(result.text, "vase") == pytest.approx((1.9, 0.4, 0.85), abs=2e-3)
    assert parse_layout(result.text).lights[0].at == pytest.approx((1.9, 0.4, 1.2), abs=2e-3)


def test_the_smaller_of_two_that_run_through_each_other_moves_just_off_the_larger() -> None:
    result = mended(room(TABLE, stool(1.7, 0.1)), "overlap")
    assert centre(result.text, "table") == (1.2, 0, 0.35)
    assert centre(result.text, "stool") == pytest.approx((2.001, 0.1, 0.225), abs=2e-3)


def test_cushions_pressed_together_stay_as_they_were_laid_and_one_within_another_does_not() -> None:
    def cushions(apart: float) -> str:
        line = 'proxy("{0}", "cushion", centre=({1}, 0, {4}), size=(0.4, 0.3, {5}), yaw={2}, {3})\n'
        on = 'placement="surface", parent="table"'
        return room(TABLE, line.format("a", 1.0, 0, on, 0.78, 0.16), line.format("b", 1.0 + apart, 8, on, 0.77, 0.14))

    assert not find_faults(cushions(0.3), Options())
    assert [fault.kind for fault in find_faults(cushions(0.02), Options())] == ["overlap"]


def test_a_chair_under_a_table_does_not_run_through_it_though_their_boxes_do() -> None:
    table = 'def made(size):\n    w, d, h = size\n    return [part("top", box((w, d, 0.04), at=(0, 0, h - 0.02)), ' \
            'material="wood"), part("leg", box((0.06, 0.06, h - 0.04), at=(0.5, 0, (h - 0.04) / 2)), material="wood")]\n'  # fmt: skip
    text = table + room(TABLE, stool(1.0, 0.1), end='furnish("table", made)\n')
    assert not find_faults(text)


def test_what_blocks_a_door_makes_way() -> None:
    result = mended(room(stool(-1.7, -1.5)), "blocked")
    x, y, _ = centre(result.text, "stool")
    assert y - 0.2 >= -1.1 - 0.06 or abs(x + 1.75) >= 0.45 + 0.2 - 0.06
    assert math.dist((x, y), (-1.7, -1.5)) < 0.7


@pytest.mark.parametrize("x", [0.5, 2.1])
def test_a_picture_off_its_wall_is_hung_flush_also_where_its_side_touches_another(x: float) -> None:
    art = f'proxy("art", "painting", centre=({x}, 1.9, 1.5), size=(0.8, 0.04, 0.6), yaw=0, placement="wall")\n'
    assert centre(mended(room(art), "support").text, "art") == pytest.approx((x, 1.98, 1.5))


def test_a_picture_with_its_face_in_the_walls_plane_comes_out_of_it() -> None:
    sheet = 'def made(size):\n    return [part("sheet", box((0.8, 0.04, 0.6), at=(0, 0.02, 0.3)), material="paper")]\n'
    art = 'proxy("art", "painting", centre=(0.5, 2, 1.5), size=(0.8, 0.04, 0.6), yaw=0, placement="wall")\n'
    result = correct(sheet + room(art, end='furnish("art", made)\n'))
    assert not find_faults(result.text)
    assert centre(result.text, "art")[1] < 1.97


def test_of_two_rugs_in_one_plane_one_is_lifted_by_a_hair() -> None:
    rugs = "".join(
        f'proxy("rug_{n}", "rug", centre=({x}, 0.5, 0.005), size=({w}, 1, 0.01), yaw=0)\n'
        for n, x, w in ((1, 0, 2), (2, 0.7, 1.2))
    )
    result = mended(room(rugs), "coincident")
    assert centre(result.text, "rug_1") == (0, 0.5, 0.005)
    assert centre(result.text, "rug_2") == pytest.approx((0.7, 0.5, 0.007), abs=2.1e-3)


def test_absurd_light_is_brought_back_and_usual_light_is_not() -> None:
    lights = 'light("a", "point", at=(0, 0, 2), energy=90000, size=0.1)\nlight("b", "area", at=(0, 0, 2.5), energy=300, size=1)\n'
    result = mended(room(end=lights), "light")
    a, b = parse_layout(result.text).lights
    assert a.energy <= 200 and b.energy == 300


@pytest.mark.parametrize("eye", [(-3.5, 0.0, 1.5), (1.2, 0.1, 0.5)])
def test_a_camera_outside_or_in_a_table_is_put_where_it_sees_the_room(eye: tuple[float, float, float]) -> None:
    model = camera_looking_at("perspective", eye, (eye[0] - 1, eye[1], eye[2]), 60, (600, 400))
    matrix = ", ".join(f"{v:.9f}" for v in model.matrix)
    line = f'camera("eye", "perspective", matrix=({matrix}), fov_y=1.0)\n'
    result = mended(room(TABLE, end=line), "camera")
    m = parse_layout(result.text).cameras[0].matrix
    at, look = (m[3], m[7], m[11]), (-m[2], -m[6], -m[10])
    assert abs(at[0]) < 2.5 and abs(at[1]) < 2
    assert look[0] * -at[0] + look[1] * -at[1] > 0
    # The picture's own view, and one that cuts what is before it, stand outside on purpose.
    assert not find_faults(room(end=line.replace('"eye"', '"reference"')))
    assert not find_faults(room(end=line.replace("fov_y=1.0", "fov_y=1.0, near=2.0")))


def test_parts_without_a_material_get_one_and_the_rest_of_the_text_stays() -> None:
    made = 'def made(size):\n    return [part("top", box((1.2, 0.8, 0.1), at=(0, 0, 0.65))), ' \
           'part("leg", box((0.1, 0.1, 0.6), at=(0, 0, 0.3)), material="wood")]\n'  # fmt: skip
    text = made + room(TABLE, end='furnish("table", made)\n')
    result = mended(text, "material")
    assert [line for line in result.text.splitlines() if not line.startswith("finish")] == text.splitlines()
    looked = text.replace("build()", 'finish("table", {"leg": wood("#6A4A32")})\nbuild()')
    result = mended(looked, "material")
    assert '{"leg": wood("#6A4A32"), "top": wood("#6A4A32")}' in result.text


def test_a_missing_image_gives_way_to_a_colour_and_unknown_names_are_left_alone() -> None:
    finish = 'finish("table", {"": principled(picture("gone"), roughness=0.3)})\n'
    text = room(TABLE, end=finish)
    result = mended(text, "picture", Options(pictures=frozenset({"there"})))
    assert "gone" not in result.text and "roughness=0.3" in result.text
    assert not find_faults(text) and not find_faults(text, Options(pictures=frozenset({"gone"})))


def test_what_is_locked_or_switched_off_is_reported_and_not_touched() -> None:
    text = room(stool(0, 0, 0.325))
    for options, word in (
        (Options(locked=frozenset({"stool"})), "locked"),
        (Options(off=frozenset({"support"})), "off"),
    ):
        result = correct(text, options)
        assert result.text == text and not result.report.fixes
        [left] = result.report.left
        assert left.about == "stool" and word in left.message


def test_a_carrier_stays_where_what_it_carries_is_locked() -> None:
    text = room(TABLE.replace("0.35)", "0.55)"), VASE.format(x=1.2, z=1.05))
    assert centre(correct(text, Options(locked=frozenset({"vase"}))).text, "table")[2] == 0.55


def test_a_mend_that_would_bring_another_fault_is_not_done() -> None:
    walls = "".join(
        f'proxy("{n}", "wardrobe", centre=({x}, {y}, 1), size=({w}, {d}, 2), yaw=0)\n'
        for n, x, y, w, d in (("a", -1.2, 0.5, 2.4, 2.9), ("b", 1.25, 0, 2.4, 3.9))
    )
    text = room(walls, stool(1.0, 0.2))
    before = {f.key for f in find_faults(text)}
    result = correct(text, Options(locked=frozenset({"a", "b"})))
    assert {f.key for f in find_faults(result.text)} <= before


def test_the_edits_lead_to_the_same_text() -> None:
    text = room(TABLE, stool(1.7, 0.1, 0.4), VASE.format(x=1.2, z=1.1))
    result = correct(text)
    assert patch_text(text, result.edits)[0] == result.text
    assert {e.id for e in result.edits} == {"stool", "vase"}


def test_every_kind_is_listed_once() -> None:
    assert len(set(FAULT_KINDS)) == len(FAULT_KINDS)
