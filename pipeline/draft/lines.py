# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines of a draft: what each says goes into `Said`, and what is refused is told."""

from __future__ import annotations

import ast
import re
from dataclasses import replace

from ..analysis.clean import SIDE_NAMES
from ..errors import ProgramError
from ..program.prelude.recorder import SURFACES
from .calls import Call, Ref, calls_of
from .making import model
from .programs import piece_program
from .said import Said
from .statements import Statement
from .things import SMALL_ON_FLOOR, Arguments, Fixed, RoomSaid, Thing, read_fixed, read_light, read_room, read_thing

MOST_THINGS = 300
_FLAT = 0.05
"""Metres that a rug is high at most."""
_ORDERS = {
    "room": ("size", "floor", "seen", "top"),
    "wall": ("id", "start", "end", "height", "thickness"),
    "door": ("id", "wall", "start", "end", "height"),
    "window": ("id", "wall", "start", "end", "sill", "height"),
    "opening": ("id", "wall", "start", "end", "sill", "height"),
    "proxy": ("id", "category", "at", "size", "yaw"),
    "lighting": ("style", "sun_from"),
}
_WORKED_OUT = frozenset({"light", "world", "view", "camera"})
"""Lines that the picture decides later."""


def take_lines(draft: Said, node: ast.stmt, statement: Statement) -> bool:
    """Take over all lines that a statement makes; whether the room has changed by them."""
    preamble = draft.palette.numbers
    known = draft.defs.defs.keys() | {t.id for t in draft.things.values()}
    found = calls_of(node, preamble, known, draft.palette.named)
    changed = False
    for call in found:
        try:
            notes = _line(draft, call)
            name = str(call.args[0] if call.args else call.keywords.get("id", ""))[:60]
            verdict = "mended" if notes or not call.plain else "ok"
            sentence = " ".join(notes) or (
                "" if call.plain else "Its values were worked out; lines take plain literals."
            )
            draft.note(statement, call.name, "" if call.name == "room" else name, verdict, sentence)
            changed = True
        except ProgramError as error:
            name = str(call.args[0])[:60] if call.args else ""
            draft.note(statement, call.name, name, "refused", f"{error.message} {error.fix}".strip())
    return changed


def _line(draft: Said, call: Call) -> list[str]:
    """Take one line over; sentences on what was forgiven."""
    if call.name == "build":
        draft.ended = True
        return []
    if call.name in _WORKED_OUT:
        parent = call.keywords.get("parent")
        if call.name == "light" and isinstance(parent, str):
            draft.lamps.append(parent)
        return [] if call.name == "light" else ["It is worked out from the picture."]
    if call.name == "furnish":
        return _furnish(draft, call)
    if call.name == "finish":
        return _finish(draft, call)
    given = Arguments(call.name, call.args, call.keywords, _ORDERS[call.name])
    if call.name == "room":
        if draft.room is not None:
            raise ProgramError("There is a room line already.")
        draft.room = read_room(given)
    elif call.name == "lighting":
        draft.lighting = read_light(given)
    elif call.name == "proxy":
        _thing(draft, read_thing(given), given.notes)
    else:
        _fixed(draft, read_fixed(call.name, given), given.notes)
    return given.notes


def _fixed(draft: Said, found: Fixed, notes: list[str]) -> None:
    if found.kind == "partition" and (found.partition is False or _is_outer(found, draft.room) or draft.room is None):
        if draft.room is not None and _is_outer(found, draft.room):
            return
        draft.outer.append(found)
        return
    if found.id in draft.ids and found.id in draft.fixed and draft.fixed[found.id].kind == found.kind:
        raise ProgramError(f"There is a {found.kind} {found.id} already.")
    name = draft.new_id(found.id, found.kind)
    if name != found.id:
        notes.append(f"It is called {name}.")
    draft.fixed[name] = replace(found, id=name)


def _thing(draft: Said, found: Thing, notes: list[str]) -> None:
    if len(draft.things) >= MOST_THINGS:
        raise ProgramError(f"A room has at most {MOST_THINGS} things.")
    before = draft.things.get(draft.ids.get(found.id, ""))
    if before is not None and _same_place(before, found):
        raise ProgramError(f"{found.id} stands there already.")
    name = draft.new_id(found.id, "object")
    if name != found.id:
        notes.append(f"It is called {name}.")
    thing = _off_rug(draft, replace(found, id=name, parent=_parent(draft, found.parent)))
    draft.things[name] = thing
    model(draft, thing)


def _off_rug(draft: Said, thing: Thing) -> Thing:
    """What stands on a rug stands on the floor: with the rug as its carrier it would count for a small thing on a table."""
    rug = draft.things.get(thing.parent or "")
    if rug is None or thing.placement != "surface" or rug.placement != "floor" or rug.size[2] > _FLAT:
        return thing
    small = max(thing.size[:2]) < SMALL_ON_FLOOR
    at = (*thing.at[:2], 0.0 if thing.at[2] <= 2 * _FLAT else thing.at[2])
    return replace(thing, placement="floor", parent=None, at=at, salience="minor" if small else "major")


def _parent(draft: Said, written: str | None) -> str | None:
    return None if written is None else draft.ids.get(written, written)


def _furnish(draft: Said, call: Call) -> list[str]:
    given = Arguments("furnish", call.args, call.keywords, ("id", "shapes", "lying"))
    identifier, shapes = given.word("id"), given.take("shapes")
    given.take("lying")
    name = draft.ids.get(identifier, identifier)
    thing = draft.things.get(name)
    if thing is None:
        raise ProgramError(f"There is no proxy line of {identifier or 'it'} above.")
    if not isinstance(shapes, (Ref, str)):
        raise ProgramError("furnish needs the name of a def.")
    text = shapes if isinstance(shapes, str) else shapes.text
    if text.startswith("lambda"):
        made = f"{name}_made"
        tree = ast.parse(text, mode="eval").body
        assert isinstance(tree, ast.Lambda)
        draft.defs.defs[made] = f"def {made}({ast.unparse(tree.args) or 'size'}):\n    return {ast.unparse(tree.body)}"
        word = made
    else:
        word = re.sub(r"\W.*", "", text, flags=re.DOTALL)
    if word not in draft.defs.defs:
        piece = replace(thing, piece=word)
        if not piece_program(piece, "made"):
            raise ProgramError(f"There is no def {word} above.")
        thing = piece
        draft.things[name] = piece
    elif draft.def_of(thing) == word and name in draft.made:
        return []
    else:
        draft.furnished[name] = word
    draft.made.pop(name, None)
    model(draft, thing)
    return []


def _finish(draft: Said, call: Call) -> list[str]:
    given = Arguments("finish", call.args, call.keywords, ("id", "looks"))
    written, looks = given.word("id"), given.take("looks")
    pairs = {"": looks} if isinstance(looks, Ref) else looks
    if not isinstance(pairs, dict) or not pairs:
        raise ProgramError('finish needs a look, or looks by part: finish("bed_1", {"frame": oak}).')
    found, notes = {}, []
    for key, value in pairs.items():
        try:
            if not isinstance(value, Ref):
                raise ProgramError("it is no look")
            draft.palette.look(value.text)
            found[str(key)[:60]] = draft.palette.named.get(value.text, value.text)
        except ProgramError as error:
            notes.append(f"{key or written}: {error.message}.")
    if not found:
        raise ProgramError(" ".join(notes))
    name = draft.ids.get(written, written)
    known = {*draft.things, *draft.fixed, *SURFACES, *SIDE_NAMES}
    if name not in known and not name.startswith(("wall_", "partition")):
        raise ProgramError(f"There is no {written or 'such thing'} in the room.")
    draft.finishes[name] = {**draft.finishes.get(name, {}), **found}
    return notes


def _same_place(a: Thing, b: Thing) -> bool:
    return a.category == b.category and max(abs(p - q) for p, q in zip(a.at[:2], b.at[:2], strict=True)) < 0.05


def _is_outer(wall: Fixed, room: RoomSaid | None) -> bool:
    """Whether a wall's line runs along one of the floor's edges."""
    if room is None:
        return False
    for a, b in zip(room.floor, [*room.floor[1:], room.floor[0]], strict=True):
        length = max(1e-6, ((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2) ** 0.5)
        ux, uy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
        if all(abs((p[0] - a[0]) * uy - (p[1] - a[1]) * ux) < 0.2 and -0.3 < (p[0] - a[0]) * ux + (p[1] - a[1]) * uy < length + 0.3
               for p in (wall.start, wall.end)):  # fmt: skip
            return True
    return False
