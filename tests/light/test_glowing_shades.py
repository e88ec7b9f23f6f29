# SPDX-License-Identifier: GPL-3.0-or-later
"""Shades glow while their lamp is on and not while it is off, whoever said what they are made of."""

from __future__ import annotations

from code_as_room.pipeline.artifacts.layout import Layout, LightLine, ViewLine
from code_as_room.pipeline.light.glowing import switched
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.finishes import read_materials
from code_as_room.pipeline.program.lines import print_layout

from .rooms_to_light import rectangle, thing

DEFS = """
def lamp(size):
    return [part("shade", cylinder(0.2, 0.2, at=(0, 0, 1.3)), material="shade #CCBBAA"),
            part("bulb", sphere(0.03, at=(0, 0, 1.3)), material="shade"), part("pole", cylinder(0.02, 1.2), material="steel")]


"""
LAMPS = [thing(name, "floor lamp", (x, 0.0), (0.4, 0.4, 1.4)) for name, x in (("on", -1.0), ("off", 1.0))]


def room(exposure: float = 0.0) -> Layout:
    layout = rectangle(4.0, 4.0).model_copy(update={"proxies": LAMPS})
    light = LightLine(id="on_light", kind="point", at=(-1.0, 0.0, 1.3), energy=10.0, parent="on")
    return layout.model_copy(update={"lights": [light], "views": [ViewLine(id="view", exposure=exposure)]})


def text(layout: Layout, materials: str = "") -> str:
    furnish = 'furnish("on", lamp)\nfurnish("off", lamp)\n'
    return print_layout(layout).replace("build()\n", f"{DEFS}{furnish}{materials}build()\n")


def strengths(program: str, layout: Layout) -> dict[str, dict[str, float]]:
    """What `switched` makes of a text: for each lamp the strength that its parts have."""
    shapes = evaluate(program).furnished
    made = evaluate(switched(program, layout, LAMPS, shapes)).finishes
    return {
        name: {key: dict(look.inputs).get("strength", 0.0) for key, look in finish.items() if look.name == "shade"}
        for name, finish in made.items()
    }


def test_one_look_that_both_wear_becomes_one_that_glows_and_one_that_does_not() -> None:
    layout = room()
    given = 'cloth_1 = shade("#CCBBAA", warm="#FFC080")\n' + "".join(
        f'finish("{name}", {{"shade": cloth_1, "bulb": cloth_1, "steel": metal("#888888")}})\n'
        for name in ("on", "off")
    )
    found = strengths(text(layout, given), layout)
    assert found["off"] == {"shade": 0.0, "bulb": 0.0}
    assert found["on"]["shade"] > 0.5 and found["on"]["bulb"] > 2 * found["on"]["shade"]
    after = switched(text(layout, given), layout, LAMPS, {})
    assert 'warm="#FFC080"' in read_materials(after).looks["cloth_1_off"]
    assert switched(after, layout, LAMPS, {}) == after  # at exposure 0 a second time changes nothing


def test_lamps_without_a_finish_are_switched_too_and_keep_their_colour() -> None:
    layout = room()
    program = text(layout)
    found = strengths(program, layout)
    assert set(found["off"].values()) == {0.0} and len(found["off"]) == 2
    looks = evaluate(switched(program, layout, LAMPS, evaluate(program).furnished)).finishes["off"]
    assert looks["shade #CCBBAA"].colour == "#CCBBAA"


def test_the_glow_follows_the_exposure_so_that_it_looks_the_same() -> None:
    given = 'finish("on", {"shade": shade("#CCBBAA")})\n'
    dark, bright = (strengths(text(room(ev), given), room(ev))["on"]["shade"] for ev in (2.0, -2.0))
    assert 15 < bright / dark < 17


def test_strengths_that_are_written_out_hold_for_what_is_on_and_other_looks_stay() -> None:
    layout = room(1.0)
    given = "".join(
        f'finish("{name}", {{"shade": shade("#CCBBAA", 2), "bulb": glow("#FFE3B8", strength=8), "": metal("#777777")}})\n'
        for name in ("on", "off")
    )
    program = text(layout, given)
    made = evaluate(switched(program, layout, LAMPS, evaluate(program).furnished)).finishes
    strength = {n: {key: dict(look.inputs).get("strength", 0.0) for key, look in f.items()} for n, f in made.items()}
    assert strength["on"] == {"shade": 1.0, "bulb": 4.0, "": 0.0}
    assert strength["off"] == {"shade": 0.0, "bulb": 0.0, "": 0.0}
    assert made["off"]["bulb"].colour == "#FFE3B8" and made["off"][""] == made["on"][""]


def test_a_text_without_glowing_lamps_stays_as_it_is() -> None:
    layout = room()
    program = text(layout, 'finish("on", metal("#777777"))\nfinish("off", metal("#777777"))\n')
    assert switched(program, layout, LAMPS, evaluate(program).furnished) == program
