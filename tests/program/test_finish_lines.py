# SPDX-License-Identifier: GPL-3.0-or-later
"""`finish` statements: checked, carried through edits, read and written."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.artifacts.layout import LayoutEdit
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.objects.text import relaid
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.finishes import Materials, read_materials, with_materials
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.program.patch import patch_text

HEAD = """room(size=(4, 4, 2.6), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])
wall("wall_s", (-2, -2), (2, -2), height=2.6)
door("door_1", wall="wall_s", start=(0, -2), end=(0.9, -2))
proxy("bed_1", "bed", centre=(0, 0, 0.25), size=(1.6, 2, 0.5))
proxy("rug_1", "rug", centre=(0, 0, 0.01), size=(2, 2, 0.02))

"""
DEFS = """def bed_1(size):
    return [part("frame", box(size), material="wood #6A4A32"), part("pillow", sphere(0.1), material="linen")]


furnish("bed_1", bed_1)
"""
LOOKS = """oak = wood("#6A4A32", along="x")
finish("bed_1", {"frame": oak, "": linen("#EFEAE0")})  # as on the left
finish("door_1", oak)
finish("floor", planks("#A9794F"))

build()
"""
TEXT = HEAD + DEFS + LOOKS


def test_a_finish_is_recorded_with_its_looks() -> None:
    record = evaluate(TEXT)
    assert {name: sorted(looks) for name, looks in record.finishes.items()} == {
        "bed_1": ["", "frame"],
        "door_1": [""],
        "floor": [""],
    }
    assert record.finishes["bed_1"]["frame"] == record.finishes["door_1"][""]


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ('finish("bed_9", oak)', "finish names 'bed_9', which is nothing in this room; surfaces are floor, walls"),
        ('finish("floor", oak)', "'floor' is finished twice"),
        ('finish("walls", "white")', "looks must be a dict"),
        ('finish("walls", {"": "white"})', "must be given a look"),
        ("finish(oak, oak)", "the id must be text"),
    ],
)
def test_what_a_finish_cannot_be_is_refused(statement: str, words: str) -> None:
    with pytest.raises(ProgramError, match=words):
        evaluate(TEXT.replace("build()", f"{statement}\nbuild()"))


def test_a_finish_follows_a_rename_and_goes_with_what_it_is_for() -> None:
    edits = [LayoutEdit(op="rename", id="bed_1", new_id="bed_left"), LayoutEdit(op="remove", id="door_1")]
    text, _ = patch_text(TEXT, edits)
    assert 'finish("bed_left", {"frame": oak, "": linen("#EFEAE0")})  # as on the left' in text
    assert set(evaluate(text).finishes) == {"bed_left", "floor"}


def test_another_layout_keeps_the_finishes_of_what_is_still_there() -> None:
    layout = parse_layout(TEXT)
    without = layout.model_copy(update={"proxies": [p for p in layout.proxies if p.id != "bed_1"]})
    record = evaluate(relaid(TEXT, without))
    assert set(record.finishes) == {"door_1", "floor"}
    unfurnished = evaluate(relaid(HEAD + LOOKS, layout))
    assert set(unfurnished.finishes) == {"bed_1", "door_1", "floor"}


def test_materials_are_read_and_written_without_touching_the_rest() -> None:
    found = read_materials(TEXT)
    assert found.looks == {"oak": 'wood("#6A4A32", along="x")'}
    assert found.finishes["bed_1"] == {"frame": "oak", "": 'linen("#EFEAE0")'} and found.finishes["door_1"] == {
        "": "oak"
    }
    new = Materials({"ash": 'wood("#C8A06E")'}, {"walls": {"": 'plaster("#F1EEE8")'}, "bed_1": {"frame": "ash"}})
    text = with_materials(TEXT, new)
    assert read_materials(text) == new and with_materials(text, new) == text
    assert text.startswith(HEAD + DEFS) and text.endswith("\n\nbuild()\n")
    assert with_materials(text, Materials()).split() == (HEAD + DEFS + "build()").split()
    assert set(evaluate(text).finishes) == {"walls", "bed_1"}
