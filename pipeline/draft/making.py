# SPDX-License-Identifier: GPL-3.0-or-later
"""What a draft's things are made of: their own defs, the library's pieces that they name, or those that come nearest."""

from __future__ import annotations

from dataclasses import replace

from ..artifacts.layout import ProxyLine
from ..artifacts.objects import ObjectDescription
from ..errors import RoomError
from ..objects.library import Made as Piece
from ..objects.library import best_piece
from ..objects.text import function_name
from .layout import proxy_line
from .programs import make, piece_program, tinted
from .said import Said
from .things import Thing


def model(draft: Said, thing: Thing) -> None:
    """Work out what a thing is made of; the library's piece stands where that fails."""
    proxy, main = proxy_line(thing), function_name(thing.id, ())
    name = draft.def_of(thing)
    try:
        if name:
            call = tinted("MADE", thing.colours) if thing.colours else ""
            source, notes = draft.defs.program(name, main, call)
            made = make(source, proxy, notes)
            draft.made[thing.id] = made
            draft.problems.pop(thing.id, None)
            if made.mended or made.notes:
                draft.judge_def(name, "mended", "; ".join(made.notes) or "It was written in another way.")
        elif source := piece_program(_like(draft, thing), main):
            draft.made[thing.id] = make(source, proxy)
        elif thing.piece:
            draft.problems[thing.id] = f"The library has no {thing.piece}."
            draft.pieces[thing.id] = nearest_piece(proxy)
    except (
        RoomError,
        ValueError,
        TypeError,
        ArithmeticError,
        LookupError,
        RecursionError,
        AttributeError,
    ) as error:
        message = error.message if isinstance(error, RoomError) else f"It cannot be made ({type(error).__name__})."
        draft.made.pop(thing.id, None)
        draft.problems[thing.id] = message
        draft.pieces[thing.id] = nearest_piece(proxy)
        if name and draft.first_of(thing) == thing.id:
            draft.judge_def(name, "refused", message)


def _like(draft: Said, thing: Thing) -> Thing:
    """A twin of a thing with a library's piece has that piece."""
    at, seen = thing, {thing.id}
    while not at.piece and at.like:
        other = draft.things.get(draft.ids.get(at.like, at.like))
        if other is None or other.id in seen:
            break
        seen.add(other.id)
        at = other
    return replace(thing, piece=at.piece, options=thing.options or at.options, colours=thing.colours or at.colours)


def nearest_piece(proxy: ProxyLine) -> Piece:
    """The library's piece that comes nearest to a thing."""
    return best_piece(proxy, ObjectDescription(id=proxy.id))
