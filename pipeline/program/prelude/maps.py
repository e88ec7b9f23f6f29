# SPDX-License-Identifier: GPL-3.0-or-later
"""What a look's colour, roughness or bumps may follow over a surface: patterns in metres, and what is made of them.

Patterns lie on the surface's UVs, which are in metres with U along the grain ("uv"), or in the object's own space
("object"). They give 0..1, about 0.5 on average. Nothing here is worked out: a map is a description for Blender's nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from .checks import choice, fail, flag, number, text
from .palette import linear_colour, split_role

MOST_NODES = 48
"""Maps in one look, each counted as often as it is used."""
SPACES = ("uv", "object")
MODES = ("mix", "multiply", "lighten", "darken", "add")


@dataclass(frozen=True)
class Map:
    """A value or colour that changes over a surface.

    Attributes:
        kind: which of Blender's nodes makes it ("noise", "ramp", ...).
        values: its settings by name; numbers, texts, linear colours, and maps.
        key: how it is written in the room language.
        weight: how many maps it is made of.
    """

    kind: str
    values: tuple[tuple[str, Any], ...]
    key: str = field(default="", compare=False)
    weight: int = field(default=1, compare=False)

    def __getitem__(self, name: str) -> Any:
        return dict(self.values)[name]


def new_map(kind: str, key: str = "", **values: Any) -> Map:
    """A map of a kind."""
    inner = [v for v in values.values() if isinstance(v, Map)]
    inner += [v for _, v in values.get("stops", ()) if isinstance(v, Map)]
    return Map(kind, tuple(values.items()), key, 1 + sum(m.weight for m in inner))


def spelt(value: Any) -> str:
    """A value of the language as it is written there."""
    if isinstance(value, Map):
        return value.key
    if isinstance(value, (tuple, list)):
        inner = ", ".join(spelt(v) for v in value)
        return f"[{inner}]" if isinstance(value, list) else f"({inner})"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e9:
        return str(int(value))
    return (
        f'"{value}"' if isinstance(value, str) else repr(round(value, 6)) if isinstance(value, float) else repr(value)
    )


def call_text(name: str, first: tuple[Any, ...], **given: tuple[Any, Any]) -> str:
    """A call as it is written: positional values, then those (value, default) that are not the default."""
    parts = [spelt(value) for value in first]
    parts += [f"{key}={spelt(value)}" for key, (value, default) in given.items() if value != default]
    return f"{name}({', '.join(parts)})"


def colour_code(where: str, name: str, value: Any) -> str:
    """A colour "#RRGGBB" as it is written everywhere, in capitals."""
    role, code = split_role(value) if isinstance(value, str) else ("", "")
    if role or not code:
        raise fail(where, f'{name} must be a colour such as "#8A5A3C"')
    return f"#{code}"


def linear(code: str) -> tuple[float, float, float]:
    """A colour "#RRGGBB" as linear red, green and blue."""
    red, green, blue, _ = linear_colour(code[1:])
    return red, green, blue


def value_of(where: str, name: str, value: Any, low: float = 0.0, high: float = 1.0) -> tuple[Any, str]:
    """A number or map, and how it is written."""
    if isinstance(value, Map):
        return value, map_of(where, name, value).key
    found = number(where, name, value, low, high)
    return found, spelt(found)


def colour_of(where: str, name: str, value: Any) -> tuple[Any, str]:
    """A colour as linear values, or a map; and how it is written."""
    if isinstance(value, Map):
        return value, map_of(where, name, value).key
    code = colour_code(where, name, value)
    return linear(code), f'"{code}"'


def end_of(where: str, name: str, value: Any) -> tuple[Any, str]:
    """A colour, a number or a map, and how it is written."""
    return colour_of(where, name, value) if isinstance(value, str) else value_of(where, name, value)


def map_of(where: str, name: str, value: Any) -> Map:
    """A map that gives numbers or colours."""
    if not isinstance(value, Map):
        raise fail(where, f"{name} must be a map, such as noise_map(0.1)")
    if value.kind == "bump":
        raise fail(where, f"{name} cannot be what bump(...) gives, which belongs to principled(bump=...)")
    return value


# ---- patterns ----

_LIMITS: dict[str, tuple[float, float]] = {
    "size": (0.0002, 100), "detail": (0, 12), "distortion": (0, 50), "rough": (0, 1), "random": (0, 1), "gap": (0, 1),
    "offset": (0, 1), "soft": (0, 1), "depth": (-0.1, 0.1), "strength": (0, 1), "turned": (-360, 360),
}  # fmt: skip
_CHOICES: dict[str, tuple[str, ...]] = {
    "space": SPACES, "axis": ("x", "y", "z"), "style": ("bands", "rings"),
    "output": ("distance", "tone", "edge", "gap"), "mode": MODES,
}  # fmt: skip


def checked(where: str, name: str, value: Any) -> Any:
    """A setting of a map: one of its words, or a number within its limits."""
    if name in _CHOICES:
        return choice(where, name, value, _CHOICES[name])
    return number(where, name, value, _LIMITS[name][0], _LIMITS[name][1])


def lengths(
    where: str, name: str, value: Any, least: float, most: float, count: tuple[int, ...] = (2,)
) -> tuple[float, ...]:
    """Two or three numbers."""
    if not isinstance(value, (tuple, list)) or len(value) not in count:
        raise fail(where, f"{name} must be {' or '.join(map(str, count))} numbers")
    return tuple(number(where, name, v, least, most) for v in value)


def pattern(kind: str, stretch: Any, first: dict[str, Any], more: dict[str, tuple[Any, Any]]) -> Map:
    """A pattern from what is always written, and what is written where it is not the default: (value, default)."""
    where = f"{kind}_map"
    values = {name: checked(where, name, value) for name, value in first.items()}
    options = {name: (checked(where, name, value), usual) for name, (value, usual) in more.items()}
    wide = (*lengths(where, "stretch", stretch, 0.001, 1000, (2, 3)), 1.0)[:3]
    key = call_text(where, tuple(values.values()), stretch=(wide, (1, 1, 1)), **options)
    return new_map(kind, key, stretch=wide, **values, **{name: value for name, (value, _) in options.items()})


def noise_map(
    size: Any = 0.1,
    detail: Any = 3,
    stretch: Any = (1, 1, 1),
    space: Any = "object",
    distortion: Any = 0,
    rough: Any = 0.5,
) -> Map:
    """Smooth random clouds.

    Args: `size` of the largest in metres; `detail` octaves, `rough` their share; `stretch` along each axis.
    """
    more = {"detail": (detail, 3), "space": (space, "object"), "distortion": (distortion, 0), "rough": (rough, 0.5)}
    return pattern("noise", stretch, {"size": size}, more)


def wave_map(
    size: Any = 0.05, axis: Any = "y", distortion: Any = 0, detail: Any = 2, style: Any = "bands", stretch: Any = (1, 1, 1),
    space: Any = "uv",
) -> Map:  # fmt: skip
    """Bands across an axis ("x" is U and "y" V on UVs), or "rings" round it.

    Args: `size` of one band in metres; `distortion` of its line and the `detail` of that.
    """
    more = {"distortion": (distortion, 0), "detail": (detail, 2), "style": (style, "bands"), "space": (space, "uv")}
    return pattern("wave", stretch, {"size": size, "axis": axis}, more)


def voronoi_map(
    size: Any = 0.05, output: Any = "distance", random: Any = 1, stretch: Any = (1, 1, 1), space: Any = "object"
) -> Map:
    """Cells: the "distance" from their middles, a "tone" for each, or the "edge" between them (0 there).

    Args: `size` of a cell in metres; `random` 0 is a regular grid.
    """
    more = {"random": (random, 1), "space": (space, "object")}
    return pattern("voronoi", stretch, {"size": size, "output": output}, more)


def brick_map(
    size: Any = (0.3, 0.3), gap: Any = 0.003, output: Any = "gap", offset: Any = 0, soft: Any = 0, turned: Any = False
) -> Map:
    """Tiles, planks or bricks on UVs: the "gap" between them (1 there), or a "tone" for each.

    Args: `size` (along U, along V) and `gap` in metres; each row shifted by `offset` of a length; `soft` edges; `turned` along V.
    """
    where = "brick_map"
    sides = lengths(where, "size", size, 0.002, 100)
    options = {name: (checked(where, name, value), usual) for name, value, usual in (
        ("gap", gap, 0.003), ("output", output, "gap"), ("offset", offset, 0), ("soft", soft, 0))}  # fmt: skip
    options["turned"] = (flag(where, "turned", turned), False)
    key = call_text(where, (sides,), **options)
    return new_map("brick", key, size=sides, **{name: value for name, (value, _) in options.items()})


def picture(name: Any, size: Any = None, turned: Any = 0, space: Any = "uv", color: Any = "") -> Map:
    """The colours of an image of the file by its name, repeated every `size` (width, depth) metres.

    Args: without `size` it fills the part once, seen from the front or above; `turned` degrees counter-clockwise; `space`
    "object" lays it along the object's x and y, as on a floor; `color` its mean, which stands for a missing image.
    """
    where = "picture"
    title = text(where, "the name", name, 60, empty=False)
    sides = None if size is None else lengths(where, "size", size, 0.001, 1000)
    angle, lies = checked(where, "turned", turned), checked(where, "space", space)
    code = colour_code(where, "color", color) if color else ""
    key = call_text(where, (title,), size=(sides, None), turned=(angle, 0), space=(lies, "uv"), color=(code, ""))
    return new_map("picture", key, name=title, size=sides, turned=angle, space=lies, color=code)


def fills(value: Any) -> bool:
    """Whether a map has a picture in it that is to fill its part once."""
    if not isinstance(value, Map):
        return False
    once = value.kind == "picture" and value["size"] is None
    return once or any(fills(inner) for _, inner in value.values)


# ---- what is made of maps ----


def ramp(map: Any, stops: Any) -> Map:
    """The map's 0..1 as colours or other numbers: ramp(noise_map(0.1), [(0, "#5A3A22"), (1, "#8A5A3C")])."""
    where = "ramp"
    map_of(where, "the first argument", map)
    if not isinstance(stops, (tuple, list)) or not 2 <= len(stops) <= 8:
        raise fail(where, "stops must be 2 to 8 pairs (place, colour or number)")
    found, keys = [], []
    for stop in stops:
        if not isinstance(stop, (tuple, list)) or len(stop) != 2:
            raise fail(where, "each stop must be (place, colour or number)")
        place = number(where, "the place of a stop", stop[0], 0, 1)
        value, key = end_of(where, "the value of a stop", stop[1])
        if isinstance(value, Map):
            raise fail(where, "the value of a stop must be a colour or a number")
        found.append((place, value))
        keys.append(f"({spelt(place)}, {key})")
    if len({isinstance(value, tuple) for _, value in found}) > 1:
        raise fail(where, "the stops must all be colours or all be numbers")
    found.sort(key=lambda pair: pair[0])
    return sized(where, new_map("ramp", f"ramp({map.key}, [{', '.join(keys)}])", map=map, stops=tuple(found)))


def mix(a: Any, b: Any, by: Any = 0.5, mode: Any = "mix") -> Map:
    """From a to b (colours, numbers or maps) by a number or map 0..1.

    Args: `mode` "mix", "multiply", "lighten", "darken" or "add".
    """
    where = "mix"
    ends = [end_of(where, n, v) for n, v in (("a", a), ("b", b))]
    share, key = value_of(where, "by", by)
    how = checked(where, "mode", mode)
    written = f"mix({ends[0][1]}, {ends[1][1]}, {key}" + (f', mode="{how}")' if how != "mix" else ")")
    return sized(where, new_map("mix", written, a=ends[0][0], b=ends[1][0], by=share, mode=how))


def bump(map: Any, depth: Any = 0.001, strength: Any = 1) -> Map:
    """Light and shadow as if the surface rose by `depth` metres where the map is 1; for the bump= of principled."""
    where = "bump"
    map_of(where, "the first argument", map)
    deep, much = checked(where, "depth", depth), checked(where, "strength", strength)
    key = call_text(where, (map, deep), strength=(much, 1))
    return sized(where, new_map("bump", key, map=map, depth=deep, strength=much))


def sized(where: str, found: Map) -> Map:
    """The map, unless it is made of too many."""
    if found.weight > MOST_NODES:
        raise fail(where, f"a look may be made of at most {MOST_NODES} maps")
    return found


def varied(map: Map, amount: float) -> Map:
    """The map, a little higher or lower on each object (ours only: the language has no word for it)."""
    return new_map("vary", map=map, amount=amount)


def loose(map: Map) -> Map:
    """The pattern shifted by another distance on each object, so that no two boards are the same."""
    return replace(map, values=(*map.values, ("loose", True)))
