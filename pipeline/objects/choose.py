# SPDX-License-Identifier: GPL-3.0-or-later
"""Which library piece comes nearest to an object, and with which parameters: by words and size, without a model."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..artifacts.layout import ProxyLine
from ..library import catalogue
from ..library.catalogue import Piece

LEAST = 0.3
"""A piece that fits the words less than this is not used."""
_SIZE_WEIGHT = 0.6
_KIND = 0.8
"""The words' score of a piece that is a kind of what is wanted: a single bed where a bed is."""
_QUOTED = re.compile(r'"([^"]+)"')
_ROUND = ("round", "oval", "circular")

_SYNONYMS: dict[str, str] = {
    "blanket": "throw blanket",
    "bedside lamp": "table lamp",
    "closet": "wardrobe",
    "framed photo": "picture",
    "framed picture": "picture",
    "bin": "waste bin",
    "trash can": "waste bin",
    "tv": "television",
    "cushion": "cushion",
    "bedside": "nightstand",
}
_FAMILIES: dict[str, str] = {
    "seating": "chair",
    "table": "table",
    "storage": "cabinet",
    "bed": "bed",
    "rug": "rug",
    "lamp": "lamp",
    "plant": "plant",
}
"""What stands for a category of a family that no piece is called by."""


_OWN_THINGS: tuple[tuple[str, Any, tuple[str, ...]], ...] = (
    ("pillows", 0, ("pillow", "cushion")),
    ("cushions", 0, ("pillow", "cushion")),
    ("throw", False, ("throw", "blanket", "duvet")),
    ("bedding", False, ("duvet", "comforter", "bedspread", "bedding", "quilt")),
    ("filled", False, ("book", "vase", "decor")),
)
"""Parameters that put things on a piece, their value for nothing, and what makes that necessary."""


_ALSO: dict[str, tuple[str, ...]] = {
    "barrel": ("tub", "rounded"),
    "round": ("circular", "oval", "rolled"),
    "upholstered": ("padded",),
    "slats": ("slatted",),
    "tripod": ("three legged",),
    "terracotta": ("clay",),
    "metal": ("steel", "iron"),
    "mirror": ("mirrored",),
}
"""What else the options of the library's parameters are called."""
_NUMBERS = {"one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8}


_COMMON = frozenset(
    {"small", "large", "table", "floor", "wooden", "house", "style", "storage", "hanging", "single", "double"}
)


_PILLOW, _LEAN = "pillow", 66
"""The word of pieces that lean, and by how many degrees."""


@dataclass(frozen=True)
class Choice:
    """A library piece with its parameters.

    Attributes:
        score: how well words and size fit, 0 to 1. parameters: name -> value, only those that differ from the default.
        leaning: made lying and turned up, as a cushion that is higher than deep leans: drawn out it would be an egg.
    """

    piece: Piece
    score: float
    parameters: Mapping[str, Any] = field(default_factory=dict)
    leaning: bool = False

    def call(self, size: str = "size") -> str:
        """The call of the piece in the room language."""
        made = f"({size}[0], {size}[2], 0.6 * {size}[1])" if self.leaning else size
        call = f"{self.piece.name}({', '.join([made, *(f'{k}={literal(v)}' for k, v in self.parameters.items())])})"
        return f'fill(turn({call}, {_LEAN}, "x"), {size})' if self.leaning else call


def candidates(proxy: ProxyLine, words: str = "", family: str = "", carried: Sequence[str] = ()) -> list[Choice]:
    """Pieces for an object, best first; none when nothing fits its words.

    Args:
        words: what else is known of it, such as its description. family: of its category (`palette.category_family`).
        carried: categories of what stands or lies on it as an object of its own.
    """
    category = proxy.category.replace("_", " ").strip()
    label = f"{proxy.label} {words}".strip()
    if proxy.shape == "l_shape":
        category = f"l-shaped {category}"
    found = catalogue.find(_SYNONYMS.get(category.lower(), category), label, proxy.placement)
    if not found or found[0][0] < LEAST:
        found = [*found, *catalogue.find(proxy.label or category, category, proxy.placement)]
    if not found or max(score for score, _ in found) < LEAST:
        stand_in = _FAMILIES.get(family, "")
        found = (
            [(score * 0.6, piece) for score, piece in catalogue.find(stand_in, label, proxy.placement)]
            if stand_in
            else []
        )
    best: dict[str, Choice] = {}
    for score, piece in found:
        said = _bonus(piece, label)
        kinds = [word.split()[-1] for word in piece.words[:3]]
        if " " not in category and category.lower() in kinds:
            score = max(score, _KIND)
        total = score + said - _SIZE_WEIGHT * misfit(proxy.size, piece.typical)
        if score >= LEAST * 0.6 and (piece.name not in best or best[piece.name].score < total):
            leaning = _PILLOW in piece.words and proxy.size[2] > proxy.size[1]
            best[piece.name] = Choice(piece, total, parameters_for(piece, proxy, label, carried), leaning)
    return sorted(best.values(), key=lambda c: (-c.score, c.piece.name))


def _bonus(piece: Piece, label: str) -> float:
    """What an object's label says for a piece: "three-seater corner sofa" is rather a corner sofa than a sofa."""
    text = f" {_plain(label)} "
    own = {w for word in piece.words[:1] for w in _plain(word).split()}
    parts = {w for word in piece.words for w in _plain(word).split() if len(w) > 4} - own - _COMMON
    named = 0.06 * min(2, sum(f" {w} " in text for w in parts))
    return named + max(
        (0.12 + 0.06 * len(w.split()) for w in map(_plain, piece.words) if len(w.split()) > 1 and f" {w} " in text),
        default=0.0,
    )


def misfit(size: Sequence[float], typical: Sequence[float]) -> float:
    """How far a size is from a usual one, 0 for the same; the largest of the three counts most. A turned one is one."""
    ways = [[abs(math.log(max(a, 1e-3) / b)) for a, b in zip(size, typical, strict=True)]]
    far = min(0.75 * max(way) + 0.25 * sum(way) / 3 for way in ways)
    return max(0.0, far - 0.12)


def parameters_for(piece: Piece, proxy: ProxyLine, label: str, carried: Sequence[str] = ()) -> dict[str, Any]:
    """Parameters that the words or the shape of an object ask for; the others stay at their defaults."""
    found: dict[str, Any] = {}
    text = f" {_plain(label)} {_plain(proxy.category)} "
    for name, (default, meaning) in piece.parameters.items():
        options = _QUOTED.findall(meaning)
        said = [o for o in options if any(f" {_plain(word)} " in text for word in (o, *_ALSO.get(o, ())))]
        shaped = (
            [o for o in options if o in _ROUND] if proxy.shape == "round" and name in ("shape", "form", "style") else []
        )
        chosen: Any = (said or shaped or [_counted(name, default, text)])[0]
        if chosen is not None and literal(chosen) != literal(ast.literal_eval(default)):
            found[name] = chosen
    # What lies on it was detected by itself.
    for name, nothing, words in _OWN_THINGS:
        if name in piece.parameters and any(word in category for category in carried for word in words):
            found[name] = nothing
    return found


def _counted(name: str, default: str, text: str) -> int | None:
    """A number that the words give for a parameter: "three-door wardrobe" has three doors."""
    value = ast.literal_eval(default)
    if isinstance(value, bool) or not isinstance(value, int):
        return None
    thing = name.removesuffix("s")
    match = re.search(rf" ({'|'.join(_NUMBERS)}|\d) (?:\w+ )?{re.escape(thing)}(?:s|er)? ", text)
    return None if match is None else _NUMBERS.get(match[1]) or int(match[1])


def parameter_value(piece: Piece, name: str, text: str) -> Any:
    """The value of a parameter that a model wrote as text, of the default's type; None when it cannot be."""
    if name not in piece.parameters:
        return None
    default_text, meaning = piece.parameters[name]
    default = ast.literal_eval(default_text)
    word = text.strip().strip("\"'")
    if isinstance(default, bool):
        return {"true": True, "yes": True, "false": False, "no": False}.get(word.lower())
    if isinstance(default, int | float):
        try:
            value = float(word)
        except ValueError:
            return None
        if not math.isfinite(value) or abs(value) > 1000:
            return None
        return int(value) if isinstance(default, int) and value == int(value) else value
    options = _QUOTED.findall(meaning)
    return next((o for o in options if o.lower() == word.lower()), None)


def literal(value: Any) -> str:
    """A parameter's value in the room language."""
    return f'"{value}"' if isinstance(value, str) else repr(value)


def _plain(text: str) -> str:
    return " ".join(re.findall(r"[a-z0-9]+", text.lower()))
