# SPDX-License-Identifier: GPL-3.0-or-later
"""An object as a library piece in the picture's colours: the way without a model, and what every failure falls back to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from ..artifacts.layout import ProxyLine
from ..artifacts.objects import ObjectDescription, PieceReply
from ..errors import ProgramError
from ..library import catalogue
from ..program.evaluate import evaluate_object
from ..program.prelude.palette import category_family
from ..program.prelude.shape import Shape
from .choose import Choice, candidates, literal, parameter_value
from .colours import clean_code
from .tinting import seen_from_above, tints_for

PLAIN = "plain_block"


@dataclass(frozen=True)
class Made:
    """A library piece as an object's program.

    Attributes:
        body: what the object's def returns, an expression in the room language.
        tints: role -> "#RRGGBB". note: why it is not what was asked for, "" when it is.
    """

    choice: Choice
    tints: Mapping[str, str] = field(default_factory=dict)
    note: str = ""

    @property
    def body(self) -> str:
        """The call of the piece, tinted."""
        return tinted(self.choice.call(), self.tints)

    def text(self, name: str, title: str = "") -> str:
        """The def of an object."""
        return def_of(name, self.body, title)


def tinted(call: str, tints: Mapping[str, str]) -> str:
    """An expression that makes shapes, with colours for their roles."""
    if not tints:
        return call
    colours = ", ".join(f"{literal(role)}: {literal(colour)}" for role, colour in tints.items())
    return f"tint({call}, {{{colours}}})"


def def_of(name: str, body: str, title: str = "") -> str:
    """The def of an object that returns an expression; its title is the docstring."""
    words = title.replace("\\", " ").replace('"', "'").strip().rstrip(".")
    doc = f'    """{words[:90]}."""\n' if words else ""
    return f"def {name}(size):\n{doc}    return {body}"


def best_piece(
    proxy: ProxyLine, described: ObjectDescription, carried: Sequence[str] = (), covers: Sequence[Shape] = ()
) -> Made:
    """The library piece that comes nearest to an object, in its measured colours.

    A piece that cannot be made in this size gives way to the next; a plain block is what is left in the end.

    Args:
        carried: categories of what stands or lies on it as an object of its own. covers: that as boxes in its frame.
    """
    family = category_family(proxy.category)
    note = ""
    for choice in candidates(proxy, described.words, family, carried)[:3]:
        shapes = shapes_of(choice, proxy.size)
        if shapes:
            return Made(choice, tints_for(seen_from_above([*shapes, *covers]), described), note)
        note = f"The library's {choice.piece.name} cannot be made in this size."
    choice = Choice(catalogue.pieces()[PLAIN], 0.0, {"form": "round"} if proxy.shape == "round" else {})
    shapes = shapes_of(choice, proxy.size)
    return Made(
        choice, tints_for(seen_from_above([*shapes, *covers]), described), note or "The library has no such thing."
    )


def asked_piece(
    proxy: ProxyLine, described: ObjectDescription, reply: PieceReply, covers: Sequence[Shape] = ()
) -> Made | None:
    """What a model chose from the library; None when it is not there or cannot be made. Unusable parameters are left out."""
    piece = catalogue.pieces().get(reply.piece.strip())
    if piece is None:
        return None
    values = {p.name: parameter_value(piece, p.name, p.value) for p in reply.parameters}
    given = {name: value for name, value in values.items() if value is not None}
    lost = sorted(set(values) - set(given))
    for parameters in (given, {}):
        choice = Choice(piece, 1.0, parameters)
        shapes = shapes_of(choice, proxy.size)
        if shapes:
            seen = seen_from_above([*shapes, *covers])
            said = {c.role: f"#{code}" for c in reply.colours if (code := clean_code(c.colour)) and c.role in seen}
            tints = {**said, **tints_for(seen, described)}
            if parameters is not given:
                lost = sorted(values)
            return Made(choice, tints, f"Unusable parameters were left out: {', '.join(lost)}." if lost else "")
    return None


def shapes_of(choice: Choice, size: Sequence[float]) -> list[Shape]:
    """The shapes of a piece with its parameters in a size, [] when they cannot be made."""
    return list(_shapes(choice.call(repr(tuple(float(v) for v in size))), choice.piece.name))


@lru_cache(maxsize=128)
def _shapes(call: str, name: str) -> tuple[Shape, ...]:
    try:
        return tuple(
            evaluate_object(f"{catalogue.source([name])}\n\ndef made_thing():\n    return {call}\n", "made_thing")
        )
    except ProgramError:
        return ()
