# SPDX-License-Identifier: GPL-3.0-or-later
"""Library pieces for objects: which one, with which parameters, in which text."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine, RoomLine
from code_as_room.pipeline.artifacts.objects import (
    Descriptions,
    MeasuredColour,
    ObjectDescription,
    ParameterReply,
    PieceReply,
)
from code_as_room.pipeline.objects.alike import alike
from code_as_room.pipeline.objects.choose import candidates
from code_as_room.pipeline.objects.library import asked_piece, best_piece, shapes_of
from code_as_room.pipeline.objects.text import (
    compose,
    function_name,
    read_modelling,
    relaid,
    with_statements,
    without_statements,
)
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.prelude.palette import category_family

ROOM = RoomLine(size=(4, 4, 2.5), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])


def proxy(category: str, size: tuple[float, float, float], label: str = "", **more: Any) -> ProxyLine:
    values = {
        "id": "thing_1",
        "category": category,
        "label": label,
        "size": size,
        "centre": (0, 0, size[2] / 2),
        **more,
    }
    return ProxyLine.model_validate(values)


def first(item: ProxyLine) -> Any:
    return candidates(item, "", category_family(item.category))[0]


@pytest.mark.parametrize(
    ("item", "piece"),
    [
        (proxy("bed", (1.8, 2.1, 1.0)), "double_bed"),
        (proxy("bed", (0.95, 2.0, 0.9)), "single_bed"),
        (proxy("potted_plant", (0.6, 0.6, 1.1)), "potted_plant"),
        (proxy("rug", (2, 1.4, 0.01)), "floor_rug"),
        (proxy("throw blanket", (1.8, 0.6, 0.3)), "throw_blanket"),
        (proxy("pillow", (0.7, 0.5, 0.2)), "bed_pillow"),
        (proxy("curtain", (0.55, 0.12, 2.4), placement="wall"), "curtain_panel"),
        (proxy("curtains", (2.3, 0.15, 2.4), placement="wall"), "curtain_pair"),
        (proxy("sofa", (2.8, 1.8, 0.8), shape="l_shape"), "corner_sofa"),
        (proxy("trash bin", (0.3, 0.3, 0.35)), "waste_bin"),
        (proxy("books", (0.25, 0.2, 0.15), placement="surface"), "book_stack"),
    ],
    ids=lambda value: value if isinstance(value, str) else value.category,
)
def test_words_and_size_choose_the_piece(item: ProxyLine, piece: str) -> None:
    assert first(item).piece.name == piece


def test_the_label_sets_parameters() -> None:
    wardrobe = first(proxy("wardrobe", (1.7, 0.6, 2.2), "three-door mirrored wardrobe"))
    assert wardrobe.parameters == {"doors": 3, "style": "mirror"}
    assert first(proxy("armchair", (0.8, 0.8, 0.8), "green tub armchair")).parameters["style"] == "barrel"
    assert first(proxy("coffee table", (0.8, 0.8, 0.4), shape="round")).parameters["shape"] == "round"


def test_pillows_that_were_detected_are_not_on_the_bed_twice() -> None:
    bed = proxy("double bed", (1.8, 2.1, 1.0))
    plain = candidates(bed, "", "bed")[0]
    with_pillows = candidates(bed, "", "bed", ("pillow", "throw blanket"))[0]
    assert "pillows" not in plain.parameters
    assert with_pillows.parameters == {"pillows": 0, "throw": False}


def test_what_the_library_does_not_have_is_a_block_with_a_note() -> None:
    made = best_piece(proxy("zeppelin", (1, 1, 1)), ObjectDescription(id="thing_1"))
    assert made.choice.piece.name == "plain_block" and "no such thing" in made.note


def test_a_models_choice_is_taken_as_far_as_it_can_be() -> None:
    chair = proxy("chair", (0.5, 0.5, 0.9))
    reply = PieceReply(
        id="thing_1",
        piece="chair",
        parameters=[
            ParameterReply(name="style", value='"Spindle"'),
            ParameterReply(name="arms", value="true"),
            ParameterReply(name="wings", value="2"),
            ParameterReply(name="seat", value="lava"),
        ],
    )
    made = asked_piece(chair, ObjectDescription(id="thing_1"), reply)
    assert made is not None and dict(made.choice.parameters) == {"style": "spindle", "arms": True}
    assert "seat, wings" in made.note
    assert (
        asked_piece(chair, ObjectDescription(id="thing_1"), PieceReply(id="thing_1", piece="__import__('os')")) is None
    )


def test_alike_chairs_are_one_and_a_patterned_one_is_another() -> None:
    def chair(name: str, width: float) -> ProxyLine:
        return proxy("dining chair", (width, 0.5, 0.9)).model_copy(update={"id": name})

    def colour(name: str, code: str) -> ObjectDescription:
        return ObjectDescription(id=name, measured=[MeasuredColour(code=code, share=1.0)], seen=1.0)

    chairs = [chair("a", 0.45), chair("b", 0.47), chair("c", 0.46), chair("d", 0.7), chair("e", 0.46)]
    known = Descriptions(objects=[colour("a", "8A6A4A"), colour("b", "8C6C4C"), colour("c", "C02020")])
    halves = [MeasuredColour(code=code, share=0.5) for code in ("C02020", "F0F0F0")]
    known.objects.append(ObjectDescription(id="e", measured=halves, seen=1.0))
    assert alike(chairs, known) == {"a": "a", "b": "a", "c": "a", "d": "d", "e": "e"}


def test_two_rows_of_books_or_clothes_are_never_copies() -> None:
    rows = [
        proxy(kind, (0.6, 0.25, 0.3)).model_copy(update={"id": f"{kind}_{n}"})
        for kind in ("row of books", "clothes")
        for n in (1, 2)
    ]
    assert all(name == first for name, first in alike(rows, Descriptions()).items())


def room_text(size: tuple[float, float, float] = (0.5, 0.5, 0.9)) -> tuple[Layout, str]:
    chair = proxy("chair", size)
    layout = Layout(room=ROOM, proxies=[chair])
    code = best_piece(chair, ObjectDescription(id="thing_1")).text("thing_1", 'a "chair"')
    return layout, compose(layout, {"thing_1": code}, {"thing_1": 'furnish("thing_1", thing_1)'})


def test_a_composed_room_evaluates_and_follows_its_proxys_size() -> None:
    _, text = room_text()
    wide = text.replace("size=(0.5, 0.5, 0.9)", "size=(0.8, 0.5, 0.9)")
    for program, width in ((text, 0.5), (wide, 0.8), (text, 0.5)):
        points = np.concatenate([s.vertices for s in evaluate(program).furnished["thing_1"]])
        assert abs(np.ptp(points[:, 0]) - width) < 0.003


def test_a_function_that_was_edited_is_made_anew() -> None:
    _, text = room_text()
    before = evaluate(text).furnished["thing_1"]
    assert evaluate(text).furnished["thing_1"][0] is before[0], "the same text is not made twice"
    edited = text.replace("return chair(size", 'return tint(chair(size), {"wood": "#102030"}) if size else chair(size')
    assert "wood #102030" in {s.material for s in evaluate(edited).furnished["thing_1"]}


def test_a_function_that_uses_numbers_of_the_module_is_never_taken_from_before() -> None:
    _, text = room_text()
    own = 'tall = {}\n\n\ndef thing_1(size):\n    return box((size[0], size[1], tall))\n\n\nfurnish("thing_1", thing_1)\n\nbuild()\n'
    layout_part = text.split("\n\n\n# Furniture")[0]
    for tall in (0.4, 0.8):
        shapes = evaluate(f"{layout_part}\n\n\n{own.format(tall)}").furnished["thing_1"]
        assert abs(np.ptp(shapes[0].vertices[:, 2]) - tall) < 1e-9


def test_boxes_and_back_leave_the_function_where_it_is() -> None:
    _, text = room_text()
    boxes = without_statements(text, {"thing_1"})
    assert "furnish(" not in boxes and "def thing_1(size):" in boxes
    assert not evaluate(boxes).furnished
    assert set(evaluate(with_statements(boxes, ['furnish("thing_1", thing_1)'])).furnished) == {"thing_1"}


def test_a_new_layout_keeps_the_functions() -> None:
    layout, text = room_text()
    moved = layout.proxies[0].model_copy(update={"centre": (1.0, 0.5, 0.45)})
    again = relaid(text, layout.model_copy(update={"proxies": [moved]}))
    assert set(evaluate(again).furnished) == {"thing_1"}
    assert (
        "furnish" not in relaid(text, layout.model_copy(update={"proxies": []})).split("build()")[0].split("def ")[-1]
    )


def test_names_of_functions_are_names_and_nobody_elses() -> None:
    assert function_name("sofa", ()) == "sofa_made"
    assert function_name("bed_1", {"bed_1"}) == "bed_1_made"
    assert function_name("3 légs", ()) == "thing_3_lgs"
    assert function_name("for", ()) == "for_made"
    assert function_name("日本", ()) == "thing"


def test_own_code_is_read_with_its_helpers_and_without_the_library() -> None:
    _, text = room_text()
    own = text.replace("def thing_1(size):", "def rung(size):\n    return chair(size)\n\n\ndef thing_1(size):").replace(
        "return chair(size", "return rung(size", 2
    )
    code = read_modelling(own).code_of("thing_1")
    assert code.startswith("def ") and "def chair(" not in code


def test_a_cushion_that_is_higher_than_deep_leans_and_is_no_egg() -> None:
    def cushion(size: tuple[float, float, float]) -> np.ndarray:
        proxy = ProxyLine(id="cushion_1", category="cushion", centre=(0, 0, size[2] / 2), size=size)
        made = shapes_of(candidates(proxy)[0], size)
        points = np.concatenate([s.vertices for s in made])
        assert np.allclose(np.ptp(points, axis=0), size, atol=2e-3)
        return points

    leaning = cushion((0.58, 0.2, 0.36))
    middle = leaning[np.abs(leaning[:, 2] - 0.18) < 0.03]
    assert np.ptp(middle[:, 1]) < 0.16, "at half its height it is as thick as a cushion, not as deep as its box"
    low, high = leaning[leaning[:, 2] < 0.08], leaning[leaning[:, 2] > 0.28]
    assert high[:, 1].mean() > low[:, 1].mean() + 0.04, "it leans back"
    lying = cushion((0.58, 0.4, 0.16))
    assert abs(lying[lying[:, 2] > 0.1][:, 1].mean()) < 0.02
