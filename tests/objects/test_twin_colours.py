# SPDX-License-Identifier: GPL-3.0-or-later
"""Twins share their geometry, not their colours; and what lies on a thing says nothing of the thing's own colours."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine, RoomLine
from code_as_room.pipeline.artifacts.objects import (
    Descriptions,
    Geometry,
    MeasuredColour,
    ObjectDescription,
    OwnModelling,
    RoomStyle,
)
from code_as_room.pipeline.materials.colours import part_colours, uncovered
from code_as_room.pipeline.materials.difference import difference
from code_as_room.pipeline.materials.parts import cells_of
from code_as_room.pipeline.objects.detailing import Detailing
from code_as_room.pipeline.objects.lying_on import covers_of
from code_as_room.pipeline.objects.twins import codes_of, other_colours, twin_tints
from code_as_room.pipeline.objects.written import take_program
from code_as_room.pipeline.program.evaluate import evaluate, evaluate_object
from code_as_room.pipeline.program.prelude.palette import split_role

ROOM = RoomLine(size=(4, 4, 2.5), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])
CODES = {"ball_orange": "E9AD77", "ball_green": "A8C092", "ball_blue": "84A6CB", "ball_other": "E8AE79",
         "ball_red": "DC7164"}  # fmt: skip
BALL = """def ball_orange(size):
    w, d, h = size
    ball = part("ball", sphere((w / 2, d / 2, h / 2), at=(0, 0, h / 2)), material="rubber #EAA263")
    return [ball, part("valve", cylinder(0.01, 0.004, at=(0, 0, h - 0.002)), material="rubber #CF8746")]
"""


def described(name: str, code: str, share: float = 0.95) -> ObjectDescription:
    return ObjectDescription(id=name, measured=[MeasuredColour(code=code, share=share)], seen=0.6)


def balls(by_model: bool) -> Detailing:
    lines = [
        ProxyLine(id=name, category="ball", centre=(0.4 * n, 0, 0.1), size=(0.2, 0.2, 0.2), shape="round")
        for n, name in enumerate(CODES)
    ]
    known = Descriptions(objects=[described(name, code) for name, code in CODES.items()])
    detailing = Detailing.begin(
        Layout(room=ROOM, proxies=lines), known, RoomStyle(), "", Geometry(), OwnModelling(), frozenset()
    )
    detailing.from_library()
    if by_model:
        detailing.written["ball_orange"] = take_program(BALL, lines[0], "ball_orange")
    return detailing


@pytest.mark.parametrize("by_model", [True, False], ids=["program", "library"])
def test_one_geometry_and_each_its_own_colour(by_model: bool) -> None:
    detailing = balls(by_model)
    assert [p.id for p in detailing.todo] == ["ball_orange"]
    text = detailing.sound_text()
    made = evaluate(text).furnished
    for name, code in CODES.items():
        colours = [c for s in made[name] if (c := split_role(s.material)[1])]
        assert colours and min(difference(c, code) for c in colours) < 12, name
        assert [len(s.vertices) for s in made[name]] == [len(s.vertices) for s in made["ball_orange"]]
    assert text.count("sphere(") <= 1 or not by_model
    functions = {o.id: o.function for o in detailing.geometry().objects}
    assert functions["ball_other"] == functions["ball_orange"] != functions["ball_green"]
    assert {o.like for o in detailing.geometry().objects} == {"", "ball_orange"}
    for name, function in functions.items():
        assert f'furnish("{name}", {function})' in text


@pytest.mark.parametrize("material", ["painted", "rubber #D2691E", "wood"])
def test_a_program_in_other_colours_than_measured_makes_no_twins_of_its_own_colour(material: str) -> None:
    detailing = balls(True)
    program = BALL.replace("rubber #EAA263", material).replace("rubber #CF8746", "metal")
    detailing.written["ball_orange"] = take_program(program, detailing.todo[0], "ball_orange")
    made = evaluate(detailing.sound_text()).furnished
    for name in ("ball_green", "ball_blue", "ball_red"):
        colours = [split_role(s.material)[1] for s in made[name] if s.part == "ball"]
        assert all(c and difference(c, CODES[name]) < 12 for c in colours), (name, colours)


def test_only_what_differs_gets_another_colour() -> None:
    white, red, blue = (MeasuredColour(code=c, share=0.45) for c in ("F0F0F0", "C02020", "2040C0"))
    first = ObjectDescription(id="a", seen=1.0, measured=[red, white])
    own = ObjectDescription(id="b", seen=1.0, measured=[blue, white])
    shapes = evaluate_object(
        "def f():\n    return [part('seat', box((1, 1, 1)), material='fabric #B82424'), "
        "part('leg', box((1, 1, 1)), material='painted #F4F4F2'), part('x', box((1, 1, 1)), material='wood #8A5A3C')]",
        "f",
    )
    tints = twin_tints(codes_of(shapes), first, own)
    assert set(tints) == {"fabric"} and difference(tints["fabric"][1:], "2040C0") < 12
    assert other_colours(first, own) and not other_colours(first, first)
    assert not other_colours(first, own.model_copy(update={"seen": 0.05}))


def test_a_covered_mattress_does_not_take_the_colour_of_its_frame() -> None:
    bed = ProxyLine(id="bed", category="bed", centre=(0.5, 0.2, 0.3), size=(1.6, 2.0, 0.6), yaw=90)
    duvet = ProxyLine(
        id="duvet",
        category="duvet",
        centre=(0.5, 0.2, 0.6),
        size=(1.4, 1.85, 0.1),
        yaw=90,
        parent="bed",
        placement="surface",
    )
    shapes = evaluate_object(
        "def f():\n    rails = [box((0.1, 2, 0.4), at=(s * 0.75, 0, 0.2)) for s in (-1, 1)]\n"
        "    return [part('mattress', box((1.4, 1.9, 0.5), at=(0, 0, 0.3)), material='linen'), "
        "part('frame', rails, material='wood')]",
        "f",
    )
    cells = cells_of(shapes)
    known = described("bed", "B07840")
    covers = covers_of(bed, Layout(room=ROOM, proxies=[bed, duvet]))
    assert "linen" in part_colours(cells, known)
    assert part_colours(uncovered(cells, shapes, covers), known) == {"wood": "B07840"}
    assert uncovered(cells, shapes, []) == cells
