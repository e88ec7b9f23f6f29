# SPDX-License-Identifier: GPL-3.0-or-later
"""Typed edits change what they name, and nothing else in the text."""

from __future__ import annotations

import difflib
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.layout import LayoutEdit
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.program.lines import parse_layout, print_layout
from code_as_room.pipeline.program.patch import apply_edits, patch_text

TEXT = """\
# my room, do not touch this comment
room(size=(4,4,2.5), floor=[(-2,-2),(2,-2),(2,2),(-2,2)])
wall( "wall_s", (-2,-2), (2,-2), height = 2.5 )

proxy("bed_1", "bed", centre=(0, 0, 0.25),
      size=(1, 2, 0.5))  # the big one, é ü
proxy("pillow_1", "pillow", (0, 0.5, 0.6), (0.5, 0.5, 0.2), parent="bed_1", placement="surface", salience="minor")
proxy("lamp_1", "lamp", (0, 0, 2.2), (0.4, 0.4, 0.6), placement="ceiling"); width = 3

light("sun", "sun", at=(0, 0, 5), energy=3)


def bed_1():
    # proxy("bed_1") is only a comment here
    return [box((1, 2, 0.5), at=(0, 0, 0.25))]


furnish("bed_1", bed_1())  # furnished
build()
"""


def edit(op: Any, identifier: str, **fields: Any) -> LayoutEdit:
    """A typed edit."""
    return LayoutEdit(op=op, id=identifier, **fields)


def changed_lines(before: str, after: str) -> tuple[list[str], list[str]]:
    """Lines that went and lines that came."""
    difference = list(difflib.ndiff(before.splitlines(), after.splitlines()))
    return [d[2:] for d in difference if d[0] == "-"], [d[2:] for d in difference if d[0] == "+"]


def test_a_move_changes_one_statement_and_keeps_its_comment() -> None:
    text, findings = patch_text(TEXT, [edit("move", "bed_1", centre=(1, 0.12345, 0.25))])
    went, came = changed_lines(TEXT, text)
    assert not findings and went[0].startswith('proxy("bed_1"') and len(went) == 2
    assert came == [
        'proxy("bed_1", "bed", centre=(1, 0.1235, 0.25), size=(1, 2, 0.5), yaw=0, placement="floor", '
        'salience="major")  # the big one, é ü'
    ] or came == [
        'proxy("bed_1", "bed", centre=(1, 0.1234, 0.25), size=(1, 2, 0.5), yaw=0, placement="floor", '
        'salience="major")  # the big one, é ü'
    ]


def test_no_edit_leaves_every_byte() -> None:
    for text in (TEXT, TEXT.replace("\n", "\r\n"), "\ufeff" + TEXT, TEXT.rstrip("\n")):
        assert patch_text(text, []) == (text, [])
        assert patch_text(text, [edit("move", "nobody", centre=(0, 0, 0))])[0] == text


def test_resize_keeps_what_an_object_stands_on_or_hangs_from() -> None:
    layout, findings = apply_edits(
        parse_layout(TEXT),
        [edit("resize", "bed_1", size=(1, 2, 1)), edit("resize", "lamp_1", size=(1, 1, 1)),
         edit("resize", "pillow_1", size=(1, 1, 1), centre=(0, 0, 9))],
    )  # fmt: skip
    assert not findings
    assert [p.centre[2] for p in layout.proxies] == [0.5, 9, 2.0]


def test_a_rename_follows_into_children_and_furnish() -> None:
    text, findings = patch_text(TEXT, [edit("rename", "bed_1", new_id='bed "A"')])
    assert not findings
    assert 'furnish("bed \\"A\\"", bed_1())  # furnished' in text
    assert parse_layout(text).proxies[1].parent == 'bed "A"'
    assert '# proxy("bed_1") is only a comment here' in text


def test_a_removed_object_takes_its_furnishing_and_leaves_its_children() -> None:
    text, findings = patch_text(TEXT, [edit("remove", "bed_1"), edit("remove", "lamp_1")])
    went, came = changed_lines(TEXT, text)
    assert [p.id for p in parse_layout(text).proxies] == ["pillow_1"]
    assert parse_layout(text).proxies[0].parent is None
    assert "furnish" not in text and "def bed_1():" in text and "pass; width = 3" in text
    assert {f.severity for f in findings} == {"note"} and any("pillow_1" in f.message for f in findings)


def test_an_added_object_comes_after_the_last_of_its_salience() -> None:
    new = edit("add", "rug_1", category="rug", centre=(0, 0, 0.01), size=(2, 2, 0.02), yaw=30)
    text, _ = patch_text(TEXT, [new, new.model_copy(update={"id": "cup_1", "salience": "minor", "parent": "bed_1"})])
    assert [p.id for p in parse_layout(text).proxies] == ["bed_1", "pillow_1", "cup_1", "lamp_1", "rug_1"]
    went, came = changed_lines(TEXT, text)
    assert not went and len(came) == 2
    empty = print_layout(parse_layout(TEXT).model_copy(update={"proxies": []}))
    text, _ = patch_text(empty, [new])
    assert changed_lines(empty, text)[0] == [] and parse_layout(text).proxies[0].id == "rug_1"


def test_an_addition_does_not_fall_into_a_statement_that_shares_the_line() -> None:
    text = TEXT.replace("; width = 3", "; width = [\n    3,\n]")
    patched, _ = patch_text(text, [edit("add", "rug_1", category="rug", centre=(0, 0, 0), size=(2, 2, 0.02))])
    assert '; width = [\n    3,\n]\nproxy("rug_1"' in patched


UNUSABLE: dict[str, LayoutEdit] = {
    "there is no object 'nobody'": edit("move", "nobody", centre=(0, 0, 0)),
    "it gives no centre": edit("move", "bed_1"),
    "it gives no size": edit("resize", "bed_1"),
    "three positive numbers": edit("resize", "bed_1", size=(1, 0, 1)),
    "within 10000 of the origin": edit("move", "bed_1", centre=(1e9, 0, 0)),
    "the id 'lamp_1' is taken": edit("rename", "bed_1", new_id="lamp_1"),
    "the id 'wall_s' is taken": edit("rename", "bed_1", new_id="wall_s"),
    "the id 'bed_1' is taken": edit("add", "bed_1", category="bed", centre=(0, 0, 0), size=(1, 1, 1)),
    "it gives no category": edit("add", "bed_2", centre=(0, 0, 0), size=(1, 1, 1)),
    "category must not be empty": edit("recategorise", "bed_1", category=""),
    "the parents would run in a circle": edit("reparent", "bed_1", parent="pillow_1"),
    "would run in a circle": edit("reparent", "bed_1", parent="bed_1"),
    "the parent 'nobody' does not exist": edit("reparent", "bed_1", parent="nobody"),
    "neither a placement nor a parent": edit("reparent", "bed_1"),
}


@pytest.mark.parametrize("sentence", UNUSABLE)
def test_unusable_edits_are_reported_and_change_nothing(sentence: str) -> None:
    before = parse_layout(TEXT)
    layout, findings = apply_edits(before, [UNUSABLE[sentence]])
    assert layout == before == parse_layout(TEXT)
    assert len(findings) == 1 and sentence in findings[0].message and findings[0].severity == "warning"
    assert patch_text(TEXT, [UNUSABLE[sentence]]) == (TEXT, findings)


def test_a_furnish_statement_without_a_literal_id_is_left_and_reported() -> None:
    text, findings = patch_text(TEXT.replace('furnish("bed_1"', "furnish(name"), [edit("remove", "bed_1")])
    assert "furnish(name" in text and any("does not name its object" in f.message for f in findings)


def test_a_text_that_cannot_be_parsed_is_refused() -> None:
    with pytest.raises(ProgramError):
        patch_text("room(", [])
