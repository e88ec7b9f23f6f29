# SPDX-License-Identifier: GPL-3.0-or-later
"""Which look each part gets: by role, name, words, measured colours, and by what a model answers."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.artifacts.materials import MaterialsReply
from code_as_room.pipeline.artifacts.objects import MeasuredColour, ObjectDescription
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.materials.answered import Answered
from code_as_room.pipeline.materials.choice import Choice, look_of
from code_as_room.pipeline.materials.colours import part_colours
from code_as_room.pipeline.materials.difference import difference, lab_of
from code_as_room.pipeline.materials.parts import Cell, cells_of
from code_as_room.pipeline.materials.sharing import finish_of, merged, named
from code_as_room.pipeline.materials.shell import ShellColours, _walls
from code_as_room.pipeline.materials.usual import usual
from code_as_room.pipeline.program.evaluate import evaluate_object


def described(material: str = "", *colours: tuple[str, float], seen: float = 1.0) -> ObjectDescription:
    measured = [MeasuredColour(code=code, share=share) for code, share in colours]
    return ObjectDescription(id="x", material=material, measured=measured, seen=seen)


@pytest.mark.parametrize(
    ("part", "material", "category", "words", "family"),
    [
        ("seat", "fabric", "armchair", "green velvet, oak legs", "velvet"),
        ("leg", "wood", "armchair", "green velvet, oak legs", "wood"),
        ("side", "wood", "wardrobe", "painted wood doors, oak body", "wood"),
        ("door", "painted", "wardrobe", "oak body", "painted_wood"),
        ("blanket", "fabric", "throw", "chunky knit wool", "knit"),
        ("pile", "fabric", "rug", "woven wool", "carpet"),
        ("sun", "paper", "picture", "terracotta and clay shapes", "paper"),
        ("mirror glass", "paper", "wardrobe", "", "mirror_glass"),
        ("mirror frame", "wood", "mirror", "", "wood"),
        ("pane", "glass", "mirror", "", "mirror_glass"),
        ("pane", "glass", "cabinet", "velvet", "glass"),
    ],
)
def test_families_without_an_answer(part: str, material: str, category: str, words: str, family: str) -> None:
    object_family = "rug" if category == "rug" else "other"
    assert usual(Cell(part, material), described(words), category, object_family, "").family == family


@pytest.mark.parametrize(
    ("part", "material", "category", "words"),
    [
        ("voile", "shade #F4F1EA", "curtain", ""),
        ("panel", "linen #F4F1EA", "sheer_curtain", ""),
        ("cloth", "linen", "curtain", "white voile"),
    ],
)
def test_sheers_let_light_through_and_give_none(part: str, material: str, category: str, words: str) -> None:
    cell = Cell(part, material, 1.0)
    made = usual(cell, described(words), category, "textile", "F4F1EA")
    assert (made.family, dict(made.options).get("sheer")) == ("linen", "0.5")
    shining = MaterialsReply.model_validate({"objects": [{"id": "x", "parts": [{"part": "all", "material": "glow"}]}]})
    assert Answered.of([shining], ["x"]).choice("x", cell, category, made).family == "linen"


def test_a_lamps_shade_shines() -> None:
    assert usual(Cell("shade", "shade #F4F1EA"), described("linen shade"), "floor lamp", "lamp", "").family == "shade"


def test_a_border_counts_without_what_it_goes_round() -> None:
    """A rug's band is a ring: its middle is the field's."""
    made = evaluate_object(
        "def rug_1(size):\n    w, d, h = size\n"
        "    ring = extrude(rectangle(w, d), h, holes=(rectangle(w - 0.2, d - 0.2),))\n"
        "    field = box((w - 0.2, d - 0.2, h / 2), at=(0, 0, h / 4))\n"
        "    return [part('field', field, material='fabric'), part('band', ring, material='accent')]\n",
        "rug_1", args=((2.0, 1.0, 0.01),),
    )  # fmt: skip
    share = {cell.part: cell.share for cell in cells_of(made)}
    assert share["band"] == pytest.approx(0.28, abs=0.06) and share["field"] == pytest.approx(0.72, abs=0.06)


def test_a_mirror_never_gets_what_it_reflects() -> None:
    cell = Cell("plate", "mirror #804020", 0.9)
    made = usual(cell, described("", ("804020", 0.9)), "mirror", "wall", "804020")
    assert difference(made.code, "804020") > 30


def test_the_largest_colour_goes_to_the_largest_part() -> None:
    cells = [Cell("seat", "fabric", 0.7), Cell("leg", "wood", 0.3), Cell("glass", "glass", 0.2)]
    found = part_colours(cells, described("", ("3F6B52", 0.7), ("9A6A40", 0.3)))
    assert found == {"fabric": "3F6B52", "wood": "9A6A40"}


def test_a_programs_own_colour_stays_where_something_else_was_measured() -> None:
    cells = [Cell("door", "painted #F0F0EC", 0.5), Cell("top", "wood #C7AB8D", 0.5)]
    found = part_colours(cells, described("", ("C9AE90", 1.0)))
    assert found == {"wood #C7AB8D": "C9AE90"}


def test_what_is_white_stays_white_in_the_shade_and_what_is_grey_does_not_turn_white() -> None:
    duvet = [Cell("body", "linen #F3F1EC", 0.9), Cell("hem", "linen #EFECE6", 0.1)]
    found = lab_of(part_colours(duvet, described("", ("D4D6D3", 1.0)))["linen #F3F1EC"])
    own, measured = lab_of("F3F1EC"), lab_of("D4D6D3")
    assert measured[0] + 3 < found[0] < own[0] - 3 and abs(found[2] - own[2]) < 1  # darker, and as warm as it was
    assert part_colours(duvet, described("", ("CDB79E", 1.0))) == {"linen #F3F1EC": "CDB79E"}  # it is beige


def test_hardly_seen_things_and_brown_leaves_keep_their_colours() -> None:
    assert part_colours([Cell("a", "fabric", 1.0)], described("", ("3F6B52", 1.0), seen=0.1)) == {}
    assert part_colours([Cell("leaf", "foliage", 1.0)], described("", ("8A6A4A", 1.0))) == {}


def test_near_equal_looks_are_one_and_the_weightier_stays() -> None:
    a, b, c = Choice("wood", "C29E77"), Choice("wood", "C39F78"), Choice("painted_wood", "C29E77")
    found = merged([(a, 1.0), (b, 5.0), (c, 9.0)])
    assert found == {a: b, b: b, c: c}


def test_names_are_free_and_stay() -> None:
    oak = Choice("wood", "C29E77", word="oak")
    assert named([oak], {"oak_1"}, {}) == {oak.expression: "oak_2"}
    assert named([oak], set(), {"floor_1": oak.expression}) == {oak.expression: "floor_1"}
    assert list(named([Choice("wood", "112233", word="3 Öl / é")], set(), {}).values()) == ["look_3_l_1"]


def test_a_finish_gives_each_cell_its_look_and_says_little() -> None:
    cells = [Cell("top", "wood", 0.8), Cell("leg", "wood"), Cell("leg", "steel"), Cell("side", "wood #112233"),
             Cell("knob", "wood #445566"), Cell("knob", "brass")]  # fmt: skip
    looks = ["oak", "oak", "chrome", "ebony", "ebony", "gold"]
    found = finish_of(cells, looks)
    for cell, look in zip(cells, looks, strict=True):
        keys = (cell.part, cell.material, cell.role, "")
        assert next(found[k] for k in keys if k in found) == look
    assert finish_of(cells[:2], looks[:2]) == {"wood": "oak"}


def test_a_wall_of_another_paint_is_told_from_walls_in_the_shade() -> None:
    found = ShellColours()
    seen = {"s": ("DBDAD7", 18), "e": ("DBD9D6", 26), "n": ("CDC7BD", 26), "w": ("B0B19E", 20)}
    _walls(found, seen)
    assert found.walls in ("DBDAD7", "DBD9D6") and found.own == {"w": "B0B19E"}


@pytest.mark.parametrize("text", ["import os", "wood(", "box((1, 1, 1))", "7", "", "open('x')", "[wood()] * 9", "look = 3",
                                  "wood(color='red')", "f = lambda: f()\nf()"])  # fmt: skip
def test_what_is_no_look_is_refused(text: str) -> None:
    with pytest.raises(ProgramError):
        look_of(text)


@pytest.mark.parametrize("text", [
    'principled(base=mix("#CCC4B8", "#BFB7AA", noise_map(0.1)))',
    'm = noise_map(0.1)\nlook = principled(\n    base=mix("#CCC4B8", "#BFB7AA", m),\n)',
])  # fmt: skip
def test_material_programs_are_read(text: str) -> None:
    look = look_of(text)
    assert look_of(look.key).key == look.key and difference(look.colour[1:], "C6BEB1") < 3


def answered(part: dict[str, object], palette: list[dict[str, object]] | None = None) -> Answered:
    reply = {"palette": palette or [], "objects": [{"id": "x", "parts": [part]}]}
    return Answered.of([MaterialsReply.model_validate(reply)], ["x"])


MEASURED = Choice("fabric", "808890", why="", source="measured")
SEAT = Cell("seat", "fabric", 1.0)


def test_a_colour_stays_as_measured_unless_it_is_vetoed() -> None:
    said = {"part": "seat", "material": "velvet", "color": "#203040"}
    assert answered(said).choice("x", SEAT, "chair", MEASURED).expression == 'velvet("#808890")'
    made = answered({**said, "veto": "a shadow"}).choice("x", SEAT, "chair", MEASURED)
    assert (made.family, made.code, made.why) == ("velvet", "203040", "a shadow")


def test_the_palette_gives_family_parameters_and_a_near_colour() -> None:
    palette = [{"name": "Moss", "family": "velvet fabric", "color": "#828A90"}]
    made = answered({"part": "", "material": "moss"}, palette).choice("x", SEAT, "chair", MEASURED)
    assert (made.family, made.code, made.word) == ("fabric", "828A90", "moss")


@pytest.mark.parametrize(("part", "family"), [
    ({"part": "seat", "material": "unobtainium"}, "fabric"),
    ({"part": "seat", "material": "velvet", "color": "#12", "veto": "x"}, "velvet"),
    ({"part": "seat", "material": "velvet", "options": [{"name": "shine", "value": "9"}]}, "velvet"),
    ({"part": "seat", "material": "linen", "program": "import os"}, "linen"),
    ({"part": "seat", "material": "linen", "program": 'principled(base="#FF0000")'}, "linen"),
    ({"part": "seat", "material": "linen", "program": 'principled(base=picture("mine"))'}, "linen"),
])  # fmt: skip
def test_nonsense_falls_back_with_a_sentence(part: dict[str, object], family: str) -> None:
    found = answered(part)
    made = found.choice("x", SEAT, "chair", MEASURED)
    assert (made.family, made.code) == (family, "808890") and len(found.findings) == 1
    look_of(made.expression)


def test_what_the_room_has_not_is_told() -> None:
    reply = MaterialsReply.model_validate(
        {"objects": [{"id": "ghost", "parts": []}, {"id": "x", "parts": [{"part": "fin"}]}]}
    )
    found = Answered.of([reply, None], ["x"])
    found.check_parts("x", [SEAT])
    assert [f.about for f in found.findings] == ["materials", "x"]


def test_a_model_cannot_turn_a_mirror_into_something_else() -> None:
    mirror = Choice("mirror_glass", "E9EEEE", source="usual")
    found = answered({"part": "plate", "material": "paper", "program": 'principled(base="#808080")'})
    assert found.choice("x", Cell("plate", "mirror", 1.0), "mirror", mirror) == mirror
