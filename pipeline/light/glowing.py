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

SHADE, BULB = 0.8, 3.0
"""Strength of a shade and of a bare bulb that are on, at exposure 0."""
_LEAST, _MOST = 0.05, 40.0
_BULB = "bulb"


def switched(text: str, layout: Layout, lamps: Sequence[ProxyLine], shapes: Mapping[str, Sequence[Shape]]) -> str:
    """The room text with lamps whose shades glow or not, as their lights shine or not.

    A shade whose strength is written out stays as it is. A text that this would spoil stays.

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
    """The look, or the name of one like it that glows as it should; others than shades stay."""
    written = looks.looks.get(look, look)
    strength = _strength(bulb, lit, exposure)
    if strength == SHADE or not _may_change(written):
        return look
    inside = written.removeprefix("shade(").removesuffix(")").strip().rstrip(",")
    expression = f"shade({inside}{', ' if inside else ''}strength={strength:g})"
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


def _may_change(expression: str) -> bool:
    """Whether this is a shade that says nothing of its strength."""
    try:
        call = ast.parse(expression, mode="eval").body
    except SyntaxError:
        return False
    named = isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "shade"
    if not named or not isinstance(call, ast.Call) or not expression.startswith("shade("):
        return False
    return len(call.args) < 2 and all(k.arg in ("color", "warm") for k in call.keywords)


def _strength(bulb: bool, lit: bool, exposure: float) -> float:
    if not lit:
        return 0.0
    return float(f"{min(_MOST, max(_LEAST, (BULB if bulb else SHADE) * 2.0**-exposure)):.2g}")


def _drop_unworn(changed: finishes.Materials, before: finishes.Materials) -> None:
    """Take away the looks that only these lamps wore."""
    worn = {word for finish in changed.finishes.values() for look in finish.values() for word in _words(look)}
    worn |= {word for expression in changed.looks.values() for word in _words(expression)}
    once = {word for finish in before.finishes.values() for look in finish.values() for word in _words(look)}
    for name in [n for n in changed.looks if n in once and n not in worn]:
        del changed.looks[name]


def _words(expression: str) -> list[str]:
    return re.findall(r"[A-Za-z_]\w*", expression)
