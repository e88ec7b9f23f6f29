# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks as values of the language: one key for one look, refusals in plain words, the mean colour."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.program.evaluate import call_function, evaluate
from code_as_room.pipeline.program.prelude import registry
from code_as_room.pipeline.program.prelude.dressing import usual_look
from code_as_room.pipeline.program.prelude.looks import Look
from code_as_room.pipeline.program.prelude.palette import ROLE_COLOURS
from hypothesis import given
from hypothesis import strategies as st

MAPS = ("noise_map", "wave_map", "voronoi_map", "brick_map", "picture", "ramp", "mix", "bump")
FAMILIES = [name for name in registry.LOOKS if name not in MAPS]

colours = st.integers(0, 0xFFFFFF).map(lambda value: f"#{value:06X}")
shares = st.floats(0, 1, width=16).map(lambda value: round(value, 3))
patterns = st.one_of(
    st.builds(lambda s, d: f"noise_map({s}, detail={d})", st.sampled_from([0.01, 0.2, 3]), st.integers(0, 6)),
    st.builds(lambda s, a: f"wave_map({s}, {a!r}, distortion=2.5)", st.sampled_from([0.02, 1]), st.sampled_from("xyz")),
    st.builds(lambda s, o: f"voronoi_map({s}, {o!r})", st.sampled_from([0.02, 1]), st.sampled_from(["tone", "edge"])),
    st.builds(
        lambda w, o: f"brick_map(({w}, 0.1), output={o!r}, turned=True)", st.just(0.4), st.sampled_from(["gap", "tone"])
    ),
    st.just('picture("floor", size=(2.4, 1))'),
)
maps = st.recursive(
    patterns,
    lambda inner: st.one_of(
        st.builds(lambda m, a, b: f"ramp({m}, [(0, {a!r}), (0.4, {b!r}), (1, {a!r})])", inner, colours, colours),
        st.builds(lambda a, m, s: f'mix({a!r}, {m}, {s}, mode="multiply")', colours, inner, shares),
    ),
    max_leaves=4,
)
programs = st.builds(
    lambda base, rough, height, depth: f"principled(base={base}, roughness={rough}, bump=bump({height}, {depth}))",
    maps,
    shares,
    patterns,
    st.sampled_from([0.001, -0.004]),
)


def look(expression: str) -> Look:
    """What the language makes of an expression."""
    found = call_function(f"def made():\n    return {expression}\n", "made")
    assert isinstance(found, Look)
    return found


@given(programs)
def test_a_key_is_written_so_that_it_means_the_same_look(expression: str) -> None:
    made = look(expression)
    again = look(made.key)
    assert again.key == made.key and again.inputs == made.inputs and again.colour == made.colour


@given(st.sampled_from(FAMILIES), colours)
def test_the_key_of_a_family_means_it_and_colours_differ_only_in_their_letters(name: str, colour: str) -> None:
    made = look(f'{name}("{colour}")' if name != "principled" else f'principled("{colour}")')
    assert look(made.key).inputs == made.inputs and made.colour == colour
    assert look(made.key.replace(colour, colour.lower())) == made


def test_defaults_and_other_ways_of_writing_do_not_make_another_look() -> None:
    assert look('wood("#6a4a32", along="length", figure=0.50)') == look('wood(color="#6A4A32")')
    assert look('wood("#6A4A32", along="x")') != look('wood("#6A4A32")')


@pytest.mark.parametrize(
    ("expression", "words"),
    [
        ('wood("brown")', "wood: the colour must be a colour such as"),
        ('wood("#6A4A32", along="up")', "along must be one of length, x, y, z"),
        ('tile("#FFFFFF", size=0.3)', "tile: size must be 2 numbers"),
        ("principled(base=3)", "base must be a colour"),
        ("principled(roughness=2)", "roughness must be between 0 and 1"),
        ("principled(bump=noise_map(0.1))", "bump must be what bump"),
        ("principled(base=bump(noise_map(0.1)))", "belongs to principled"),
        ('ramp("#FFFFFF", [(0, 1), (1, 0)])', "must be a map"),
        ('principled(base=ramp(noise_map(0.1), [(0, "#FFFFFF"), (1, 0.5)]))', "all be colours or all be numbers"),
        ("noise_map(float('inf'))", "size must be a finite number|not"),
        ("picture('', (1, 1))", "the name must not be empty"),
    ],
)
def test_what_cannot_be_is_refused_in_plain_words(expression: str, words: str) -> None:
    with pytest.raises(ProgramError, match=words):
        call_function(f"def made():\n    return {expression}\n", "made")


def test_a_look_that_would_fill_the_memory_is_refused() -> None:
    text = "def made():\n    m = noise_map(0.1)\n    for i in range(40):\n        m = mix(m, m)\n    return principled(base=m)\n"
    with pytest.raises(ProgramError, match="at most 48 maps"):
        call_function(text, "made")


def test_every_role_of_the_palette_has_a_look_of_its_own_colour() -> None:
    flat = {"floor", "section", "marker"}
    for role, (code, _) in ROLE_COLOURS.items():
        made = usual_look(role, "table")
        assert (made is None) == (role in flat), role
        if made is not None:
            assert made.colour == f"#{code}"
            tinted = usual_look(f"{role} #123456", "table")
            assert tinted is not None and tinted.colour == "#123456" and tinted.name == made.name


def test_an_object_of_one_colour_is_made_of_what_its_family_is() -> None:
    kinds = {family: usual_look("#8A5A3C", family) for family in ("seating", "storage", "rug", "wet")}
    assert [made and made.name for made in kinds.values()] == ["fabric", "painted_wood", "carpet", "ceramic"]
    assert usual_look("", "bed") is None  # a box that stands in for a bed keeps its flat colour


def test_the_viewport_gets_about_the_mean_of_a_program() -> None:
    assert look('principled(base=ramp(noise_map(0.1), [(0, "#000000"), (1, "#FFFFFF")]))').colour == "#BCBCBC"
    assert look('principled(base=mix("#FF0000", "#0000FF", 0))').colour == "#FF0000"
    assert look('principled(base=picture("x"))').colour == "#A9A39B"


def test_names_of_looks_are_free_inside_functions_and_guarded_outside() -> None:
    room = 'room(size=(2, 2, 2), floor=[(0, 0), (2, 0), (2, 2), (0, 2)])\nproxy("a", "box", centre=(1, 1, 0.5), size=(1, 1, 1))\n'
    made = (
        "def a(size):\n    wood, glass = 0.5, 'metal'\n    return part('x', box((wood, wood, wood)), material=glass)\n"
    )
    record = evaluate(room + made + 'furnish("a", a)\nfinish("a", wood("#6A4A32"))\nbuild()\n')
    assert record.finishes["a"][""].name == "wood" and record.furnished["a"][0].material == "metal"
    with pytest.raises(ProgramError, match="wood belongs to the room language"):
        evaluate(room + "wood = 3\nbuild()\n")
