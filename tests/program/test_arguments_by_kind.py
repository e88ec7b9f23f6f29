# SPDX-License-Identifier: GPL-3.0-or-later
"""Arguments out of their order mean what they can only mean, in the add-on and in room.py alike."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.program.assemble import assemble_file
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.program.prelude import registry
from code_as_room.pipeline.program.prelude.shape import Shape, flat_shapes
from hypothesis import given
from hypothesis import strategies as st

P = "(1, 2, 3)"
TRIANGLE = "[(0, 0), (1, 0), (0, 1)]"
HOLE = "[[(0.1, 0.1), (0.3, 0.1), (0.1, 0.3)]]"
MEANT = {
    f"cylinder(0.1, 0.4, 0.005, at={P})": f"cylinder(0.1, 0.4, at={P}, edge=0.005)",
    f"cylinder(0.1, 0.4, 0.005, {P})": f"cylinder(0.1, 0.4, at={P}, edge=0.005)",
    f"cylinder(0.1, 0.4, {P}, 0.005)": f"cylinder(0.1, 0.4, at={P}, edge=0.005)",
    "cylinder(0.1, 0.4, 0.005)": "cylinder(0.1, 0.4, edge=0.005)",
    "cylinder(0.1, 0.4, 'x')": "cylinder(0.1, 0.4, axis='x')",
    "cylinder(0.1, 0.4, 16)": "cylinder(0.1, 0.4, segments=16)",
    f"cylinder(0.1, 0.4, {P}, 16, 'y', 0.01)": f"cylinder(0.1, 0.4, at={P}, segments=16, axis='y', edge=0.01)",
    f"cone(0.2, 0.4, 0.1, 0.005, at={P})": f"cone(0.2, 0.4, 0.1, at={P}, edge=0.005)",
    f"cone(0.2, 0.4, {P})": f"cone(0.2, 0.4, at={P})",
    f"prism(6, 0.2, 0.4, 0.005, at={P})": f"prism(6, 0.2, 0.4, at={P}, edge=0.005)",
    f"torus(0.2, 0.05, 180, at={P})": f"torus(0.2, 0.05, at={P}, angle=180)",
    f"torus(0.2, 0.05, 180, {P}, axis='x')": f"torus(0.2, 0.05, at={P}, axis='x', angle=180)",
    f"sphere(0.2, 16, 8, at={P})": f"sphere(0.2, at={P}, segments=16, rings=8)",
    f"capsule(0.1, 0.5, 'x', at={P})": f"capsule(0.1, 0.5, axis='x', at={P})",
    f"rounded_box((1, 2, 3), {P})": f"rounded_box((1, 2, 3), at={P})",
    f"rounded_box((1, 2, 3), {P}, 0.1)": f"rounded_box((1, 2, 3), 0.1, at={P})",
    f"wedge((1, 2, 3), {P})": f"wedge((1, 2, 3), at={P})",
    f"extrude({TRIANGLE}, 0.2, 0.01, {HOLE}, at={P})": f"extrude({TRIANGLE}, 0.2, at={P}, edge=0.01, holes={HOLE})",
    f"extrude({TRIANGLE}, 0.2, {HOLE})": f"extrude({TRIANGLE}, 0.2, holes={HOLE})",
    f"extrude({TRIANGLE}, 0.2, 'y', 0.01)": f"extrude({TRIANGLE}, 0.2, axis='y', edge=0.01)",
    f"extrude(0.2, {TRIANGLE}, edge=0.01)": f"extrude({TRIANGLE}, 0.2, edge=0.01)",
    f"lathe([(0.1, 0), (0.1, 1)], {P})": f"lathe([(0.1, 0), (0.1, 1)], at={P})",
    f"tube([(0, 0, 0), (0, 0, 1), (1, 0, 1)], 0.1, True, at={P})": "tube([(0, 0, 0), (0, 0, 1), (1, 0, 1)], 0.1, "
    f"closed=True, at={P})",
    f"loft([{TRIANGLE}, {TRIANGLE}], [0, 1], False)": f"loft([{TRIANGLE}, {TRIANGLE}], [0, 1], smooth=False)",
    f"cushion((1, 1, 0.2), {P})": f"cushion((1, 1, 0.2), at={P})",
    f"cushion((1, 1, 0.2), 0.3, False, at={P})": f"cushion((1, 1, 0.2), 0.3, seam=False, at={P})",
    f"pillow((0.6, 0.4, 0.15), {P}, 0.8)": f"pillow((0.6, 0.4, 0.15), 0.8, at={P})",
    f"drape((1, 2), (0.2, 0.2, 0.1, 0), {P})": f"drape((1, 2), hang=(0.2, 0.2, 0.1, 0), at={P})",
    f"curtain((1, 0.1, 2), {P})": f"curtain((1, 0.1, 2), at={P})",
    "curtain((1, 0.1, 2), 'pinch')": "curtain((1, 0.1, 2), heading='pinch')",
    "rug((2, 1, 0.02), 0.05)": "rug((2, 1, 0.02), fringe=0.05)",
    f"panelled((1, 0.03, 2), 2, 3, 'raised', at={P})": f"panelled((1, 0.03, 2), 2, 3, style='raised', at={P})",
    "array(box((1, 1, 1)), (2, 0, 0), 3)": "array(box((1, 1, 1)), 3, (2, 0, 0))",
    "extrude(rectangle(1, 2, (1, 1)), 1)": "extrude(rectangle(1, 2, at=(1, 1)), 1)",
    "extrude(ellipse(1, 2, (1, 1)), 1)": "extrude(ellipse(1, 2, at=(1, 1)), 1)",
}
"""What a call is to mean, by how it may be written."""


def made(expression: str) -> list[Shape]:
    return evaluate_object(f"def thing():\n    return {expression}\n", "thing")


def same(a: list[Shape], b: list[Shape]) -> None:
    assert len(a) == len(b)
    for one, other in zip(a, b, strict=True):
        np.testing.assert_array_equal(one.vertices, other.vertices)
        assert one.faces == other.faces


@pytest.mark.parametrize("call", MEANT)
def test_a_call_means_what_it_can_only_mean(call: str) -> None:
    same(made(call), made(MEANT[call]))


@pytest.mark.parametrize("call", MEANT)
def test_python_itself_reads_it_alike(call: str) -> None:
    """The same functions are in room.py, where plain Python calls them."""
    names: dict[str, Any] = dict(registry.CONSTRUCTORS)
    same(flat_shapes("test", eval(call, names)), made(MEANT[call]))  # noqa: S307  (a text of our own)


def test_the_file_on_disk_reads_it_alike(tmp_path: Path) -> None:
    """Its prelude is cut down to what a room needs; the text of the room itself stays as it was written."""
    call = f"cylinder(0.1, 0.4, 0.005, at={P})"
    room = f'def stool(size):\n    return part("seat", {call}, material="wood")\n'
    whole = assemble_file(f"{room}\n\nSTOOL = stool((1, 1, 1))\n")
    assert call in whole
    (tmp_path / "room.py").write_text(whole, encoding="utf-8")
    names = runpy.run_path(str(tmp_path / "room.py"))
    same(names["STOOL"] if isinstance(names["STOOL"], list) else [names["STOOL"]], made(call))


@pytest.mark.parametrize(
    "call",
    [
        "cylinder(0.1, 0.4, (0, 0, 1), (0, 0, 2))",
        "cylinder(0.1, 0.4, 'q')",
        "cylinder(0.1, -0.4, 0.005, at=(0, 0, 1))",
        "rounded_box((1, 1, 1), (0, 0, 1), at=(0, 0, 2))",
        "cylinder(0.1, 0.4, None)",
        "box((1, 1, 1), 2)",
        "extrude(0.1, 0.2)",
    ],
)
def test_what_could_mean_anything_is_still_refused(call: str) -> None:
    with pytest.raises(ProgramError):
        made(call)


@given(
    st.sampled_from(["cylinder", "prism", "capsule", "sphere", "rounded_box"]),
    st.permutations(["at", "axis", "segments"]),
    st.integers(1, 3),
)
def test_any_order_of_what_differs_in_kind_is_the_same(name: str, order: list[str], count: int) -> None:
    required = {"cylinder": (0.2, 1.0), "prism": (6, 0.2, 1.0), "capsule": (0.2, 1.0), "sphere": (0.2,),
                "rounded_box": ((1.0, 1.0, 1.0), 0.1)}  # fmt: skip
    values = {"at": (1, 2, 3), "axis": "y", "segments": 9}
    make = registry.CONSTRUCTORS[name]
    code = make.__wrapped__.__code__  # type: ignore[attr-defined]
    chosen = [n for n in order[:count] if n in code.co_varnames[: code.co_argcount]]
    same(
        [make(*required[name], *(values[n] for n in chosen))], [make(*required[name], **{n: values[n] for n in chosen})]
    )
