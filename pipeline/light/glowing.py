# SPDX-License-Identifier: GPL-3.0-or-later
"""Shades of lamps glow while the lamp is on, as brightly as the exposure makes them look right, and not while it is off."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence

from ..artifacts.layout import Layout, ProxyLine
from ..errors import ProgramError
from ..program import finishes
from ..program.prelude.palette import ROLE_COLOURS, split_role
from ..program.prelude.shape import Shape

BULB = 3.0
"""Strength of a bulb in its shade that is on, at exposure 0."""
_USUAL = {"shade": 0.8, "glow": 6.0}  # of looks that say nothing of it, as in the language
_LEAST, _MOST = 0.05, 40.0
_BULB = "bulb"


def switched(text: str, layout: Layout, lamps: Sequence[ProxyLine], shapes: Mapping[str, Sequence[Shape]]) -> str:
    """The room text with lamps whose shades and bulbs glow or not, as their lights shine or not.

    A strength that is written out counts at exposure 0. A text that this would spoil stays.

    Args:
        layout: its lights say which lamps are on, its view how it is exposed. shapes: the parts of each object, by id.
    """
    exposure = layout.views[0].exposure if layout.views else 0.0
    lit = {light.parent for light in layout.lights if light.energy > 0}
    try:
        found = finishes.read_materials(text)
        changed = finishes.Materials(dict(found.looks), dict(found.finishes))
        taken = set(re.findall(r"[A-Za-z_]\w*", text))
        for lamp in lamps:
            finish = found.finishes.get(lamp.id, {})
            bare = {} if finish else _unfinished(shapes.get(lamp.id, ()))
            made = {
                key: _glowing(changed, look, key == _BULB, lamp.id in lit, exposure, taken)
                for key, look in (finish or bare).items()
            }
            if made != finish:
                changed.finishes[lamp.id] = made
        if changed.finishes == found.finishes:
            return text
        _drop_unworn(changed, found)
        return finishes.with_materials(text, changed)
    except ProgramError:
        return text


def _unfinished(shapes: Sequence[Shape]) -> dict[str, str]:
    """Looks that a lamp's shades have by themselves, where no finish says anything of the lamp."""
    found: dict[str, str] = {}
    for shape in shapes:
        role, code = split_role(shape.material)
        if role == "shade":
            found[_BULB if shape.part == _BULB else shape.material] = f'shade("#{code or ROLE_COLOURS["shade"][0]}")'
    return found


def _glowing(looks: finishes.Materials, look: str, bulb: bool, lit: bool, exposure: float, taken: set[str]) -> str:
    """The look, or the name of one like it that glows as it should; what does not shine by itself stays."""
    written = looks.looks.get(look, look)
    expression = _at_strength(written, bulb, lit, exposure)
    if expression in (None, written):
        return look
    assert expression is not None
    if look not in looks.looks:
        return expression
    known = next((name for name, other in looks.looks.items() if other == expression), None)
    if known is not None:
        return known
    base = f"{look}_{'off' if not lit else 'bulb' if bulb else 'lit'}"
    name, number = base, 1
    while name in taken:
        number += 1
        name = f"{base}_{number}"
    taken.add(name)
    looks.looks[name] = expression
    return name


def _at_strength(written: str, bulb: bool, lit: bool, exposure: float) -> str | None:
    """The expression of a shade or a glow with the strength that it should have, None for all others."""
    try:
        call = ast.parse(written, mode="eval").body
    except SyntaxError:
        return None
    if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name) or call.func.id not in _USUAL:
        return None
    given = [*call.args[1:2], *(k.value for k in call.keywords if k.arg == "strength")]
    value: object = BULB if bulb and call.func.id == "shade" else _USUAL[call.func.id]
    if given:
        # What was off and is on now shines as usual.
        value = (given[0].value or value) if isinstance(given[0], ast.Constant) else None
    if not isinstance(value, int | float):
        return None
    strength = _rounded(value * 2.0**-exposure) if lit else 0.0
    if not given and strength == _USUAL[call.func.id]:
        return written
    if len(call.args) > 2:
        return None  # more than the color and the strength by their places
    inside = [_source(written, argument) for argument in call.args[:1]]
    inside += [f"{k.arg}={_source(written, k.value)}" for k in call.keywords if k.arg != "strength"]
    return f"{call.func.id}({', '.join([*inside, f'strength={strength:g}'])})"


def _source(written: str, node: ast.expr) -> str:
    return ast.get_source_segment(written, node) or ast.unparse(node)


def _rounded(strength: float) -> float:
    return float(f"{min(_MOST, max(_LEAST, strength)):.2g}")


def _drop_unworn(changed: finishes.Materials, before: finishes.Materials) -> None:
    """Take away the looks that only these lamps wore."""
    worn = {word for finish in changed.finishes.values() for look in finish.values() for word in _words(look)}
    worn |= {word for expression in changed.looks.values() for word in _words(expression)}
    once = {word for finish in before.finishes.values() for look in finish.values() for word in _words(look)}
    for name in [n for n in changed.looks if n in once and n not in worn]:
        del changed.looks[name]


def _words(expression: str) -> list[str]:
    return re.findall(r"[A-Za-z_]\w*", expression)
