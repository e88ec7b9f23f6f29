# SPDX-License-Identifier: GPL-3.0-or-later
"""What a surface looks like: an immutable value of the language, a Principled shader with numbers, colours and maps.

Equal looks have equal keys, and share one material in Blender.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .checks import fail, number
from .maps import MOST_NODES, Map, call_text, colour_code, colour_of, linear, value_of

UNKNOWN = "#A9A39B"
"""The colour in the viewport of a look whose colour is not known, as that of a picture."""


@dataclass(frozen=True)
class Look:
    """One look.

    Attributes:
        key: how it is written in the language, in one way only: equal looks have equal keys.
        name: its family ("wood"), or "principled".
        colour: its mean colour, "#RRGGBB" (sRGB), which the viewport shows and exports without nodes get.
        inputs: what goes into the shader by name: numbers, linear colours, maps. Those at their default are left out.
    """

    key: str
    name: str = field(compare=False)
    colour: str = field(compare=False)
    inputs: tuple[tuple[str, Any], ...] = field(compare=False)


RANGES: dict[str, tuple[float, float, float]] = {
    "roughness": (0.5, 0, 1), "metallic": (0, 0, 1), "specular": (0.5, 0, 1), "transmission": (0, 0, 1), "ior": (1.45, 1, 3),
    "coat": (0, 0, 1), "sheen": (0, 0, 1), "strength": (0, 0, 1000), "alpha": (1, 0, 1),
}  # fmt: skip
"""Default, least and most of the shader's numbers."""


def principled(
    base: Any = "#A9A39B", roughness: Any = 0.5, metallic: Any = 0, specular: Any = 0.5, transmission: Any = 0, ior: Any = 1.45,
    coat: Any = 0, sheen: Any = 0, emission: Any = None, strength: Any = 0, alpha: Any = 1, bump: Any = None,
) -> Look:  # fmt: skip
    """A look of its own: numbers, colours "#RRGGBB" or maps.

    Args: `emission` the colour of its own light and `strength` how much; `bump` what bump(...) gives.
    """
    where = "principled"
    given = {"roughness": roughness, "metallic": metallic, "specular": specular, "transmission": transmission, "ior": ior,
             "coat": coat, "sheen": sheen, "strength": strength, "alpha": alpha}  # fmt: skip
    inputs: dict[str, Any] = {}
    keys: dict[str, str] = {}
    inputs["base"], keys["base"] = colour_of(where, "base", base)
    for name, value in given.items():
        default, low, high = RANGES[name]
        found, key = value_of(where, name, value, low, high)
        if found != default:
            inputs[name], keys[name] = found, key
    if emission is not None:
        inputs["emission"], keys["emission"] = colour_of(where, "emission", emission)
    if bump is not None:
        if not isinstance(bump, Map) or bump.kind != "bump":
            raise fail(where, "bump must be what bump(...) gives, such as bump(noise_map(0.01), 0.001)")
        inputs["bump"], keys["bump"] = bump, bump.key
    if sum(v.weight for v in inputs.values() if isinstance(v, Map)) > MOST_NODES:
        raise fail(where, f"a look may be made of at most {MOST_NODES} maps")
    written = f"principled({', '.join(f'{name}={key}' for name, key in keys.items())})"
    return Look(written, "principled", mean_colour(inputs["base"]), tuple(inputs.items()))


def family(name: str, colour: str, options: dict[str, tuple[Any, Any]], **inputs: Any) -> Look:
    """A look of a family: its colour, then the options that are not the default, then what goes into the shader."""
    first = (colour,) if colour else ()
    return Look(call_text(name, first, **options), name, colour or UNKNOWN, tuple(inputs.items()))


def own_colour(where: str, value: Any) -> tuple[str, tuple[float, float, float]]:
    """A family's colour as it is written, and as linear values."""
    code = colour_code(where, "the colour", value)
    return code, linear(code)


def share(where: str, name: str, value: Any, most: float = 1.0) -> float:
    """A number from 0 to `most`."""
    return number(where, name, value, 0, most)


def length(where: str, name: str, value: Any) -> float:
    """A length of a pattern in metres."""
    return number(where, name, value, 0.0005, 10)


BRIGHTEST = 0.92
"""Linear; what the whitest paint gives back."""


def toned(colour: tuple[float, float, float], factor: float, towards: float = 0.0) -> tuple[float, float, float]:
    """A linear colour made brighter or darker, and `towards` grey; no surface gives back more light than it gets."""
    grey = 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2]
    factor = min(factor, BRIGHTEST / max(*colour, 1e-6))  # all of it, since one alone would change the hue
    red, green, blue = ((c + (grey - c) * towards) * factor for c in colour)
    return red, green, blue


def mean_colour(base: Any) -> str:
    """The colour of a look in the viewport, from a linear colour or a map; `UNKNOWN` where a picture decides."""
    found = mean_of(base)
    if found is None:
        return UNKNOWN
    codes = (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055 for v in found)
    return "#" + "".join(f"{round(255 * min(max(code, 0.0), 1.0)):02X}" for code in codes)


def mean_of(value: Any) -> tuple[float, float, float] | None:
    """About the mean of a colour, number or map, linear; None where a picture of unknown colour decides."""
    if isinstance(value, tuple):
        return value[0], value[1], value[2]
    if not isinstance(value, Map):
        return float(value), float(value), float(value)
    if value.kind == "ramp":
        stops = value["stops"]
        low = max((s for s in stops if s[0] <= 0.5), default=stops[0], key=lambda s: s[0])
        high = min((s for s in stops if s[0] > 0.5), default=low, key=lambda s: s[0])
        a, b = mean_of(low[1]), mean_of(high[1])
        return a and b and blended(a, b, (0.5 - low[0]) / (high[0] - low[0]) if high[0] > low[0] else 0.0)
    if value.kind == "mix":
        a, b, by = mean_of(value["a"]), mean_of(value["b"]), mean_of(value["by"])
        return blended(a, b, by[0] if by else 0.5) if a and b and value["mode"] == "mix" else a
    if value.kind == "picture":
        return linear(value["color"]) if value["color"] else None
    return (0.03, 0.03, 0.03) if value.kind == "brick" and value["output"] == "gap" else (0.5, 0.5, 0.5)


def blended(a: tuple[float, float, float], b: tuple[float, float, float], t: float) -> tuple[float, float, float]:
    """From a to b."""
    return a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t
