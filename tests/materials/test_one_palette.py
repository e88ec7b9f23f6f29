# SPDX-License-Identifier: GPL-3.0-or-later
"""What is of one material of the palette has one colour: the one that the picture shows of it, also where it is hidden."""

from __future__ import annotations

from code_as_room.pipeline.artifacts.materials import (
    MaterialsReply,
    ObjectMaterialsReply,
    PaletteReply,
    PartMaterialReply,
)
from code_as_room.pipeline.materials.answered import Answered
from code_as_room.pipeline.materials.choice import Choice
from code_as_room.pipeline.materials.difference import difference
from code_as_room.pipeline.materials.parts import Cell
from code_as_room.pipeline.materials.sameness import Sight, seen_colour

BLUE, PALE, PALER = "1F5FA8", "6FA8D8", "7BB0DA"


def test_most_of_what_is_seen_decides() -> None:
    found = seen_colour(BLUE, [Sight(PALE, 1.6), Sight(PALER, 1.0), Sight("A06040", 0.2)])
    assert difference(found, PALE) < 4 and difference(found, BLUE) > 15


def test_where_the_picture_does_not_agree_with_itself_or_shows_nothing_the_word_stands() -> None:
    assert seen_colour(BLUE, []) == BLUE
    assert seen_colour(BLUE, [Sight("E0E0E0", 1.0), Sight("B08050", 1.0)]) == BLUE  # of something else
    assert seen_colour("808080", [Sight("606060", 1.0), Sight("909090", 1.0), Sight("B8B8B8", 1.0)]) == "808080"


def test_a_hidden_blanket_is_as_pale_as_the_one_that_is_seen_and_a_red_one_stays_red() -> None:
    entry = PaletteReply(name="blue linen", family="linen", color=f"#{BLUE}")
    said = [PartMaterialReply(part="body", material="blue linen")]
    names = ("duvet_1", "duvet_2", "throw_1")
    reply = MaterialsReply(palette=[entry], objects=[ObjectMaterialsReply(id=n, parts=list(said)) for n in names])
    answered = Answered.of([reply], names)
    cell = Cell("body", f"linen #{BLUE}", 0.9)
    answered.seen = {"blue linen": seen_colour(answered.entry_of("duvet_1", cell)[1], [Sight(PALE, 1.6)])}
    seen, hidden, other = (
        answered.choice(name, cell, "duvet", Choice("linen", code)).code
        for name, code in zip(names, (PALE, BLUE, "B04038"), strict=True)
    )
    assert seen == hidden and difference(hidden, PALE) < 2 and difference(other, "B04038") < 2
