# SPDX-License-Identifier: GPL-3.0-or-later
"""The second look of a stand-in for a weaker model: what it finds of the missing, what it mends, what it spoils."""

from __future__ import annotations

import re

from code_as_room.pipeline.artifacts.replies import CorrectionReply, MissedReply, ObjectReply, SecondLookReply

from .known import Known, visibly_off
from .noise import facing_of, noised_box, noised_centre, noised_object, noised_size

LOOK = "second"
ASKED = 1.4
"""A thing that is asked about by name is looked at more closely: the chance to mend it goes up by this factor."""


def second_look(known: Known, text: str) -> SecondLookReply:
    """Answer to the second look.

    Args:
        text: the request; it states the room's metres, and may ask about things by name.
    """
    return SecondLookReply(missed=_missed(known, text), corrections=_corrections(known, text))


def asked_about(text: str, name: str) -> list[str]:
    """The request's lines that ask something about a thing: they begin with its name and a colon."""
    begins = re.compile(rf"[\W\d]*{re.escape(name)}\s*:")
    return [line for line in text.splitlines() if begins.match(line)]


def in_metres_of(known: Known, item: ObjectReply, text: str) -> ObjectReply:
    """A thing in the metres of the room that a request states."""
    x, y = known.metres_of(text)
    both = (x * y) ** 0.5
    centre, size = item.centre_m, item.size_m
    return item.model_copy(
        update={
            "centre_m": centre.model_copy(update={"x_m": centre.x_m * x, "y_m": centre.y_m * y}),
            "size_m": size.model_copy(update={"width": size.width * both, "depth": size.depth * both}),
        }
    )


def _missed(known: Known, text: str) -> list[MissedReply]:
    """What the first answer lacks and this one finds. Boxes are given in the whole picture, with the crops' precision."""
    strength, draws = known.strength, known.draws
    listed = set(known.first.ids)
    found = []
    for name, item in known.seen.objects.items():
        if name in listed or draws.share("found", name) >= strength.found:
            continue
        again = in_metres_of(known, noised_object(item, strength, draws, known.errors, LOOK, strength.zoom), text)
        again = again.model_copy(update={"id": known.names[name], "parent": known.parent(again)})
        found.append(MissedReply.model_validate({**again.model_dump(), "picture": 1}))
    return found


def _corrections(known: Known, text: str) -> list[CorrectionReply]:
    strength, draws = known.strength, known.draws
    listed = {o.id: o for o in known.first.reply.objects}
    fixes = []
    for name, given in known.first.ids.items():
        if name not in known.seen.objects:
            # The strong model took it back itself.
            if draws.share("mend", "gone", name) < strength.mend:
                fixes.append(CorrectionReply(id=given, remove=True, wrong="not there"))
            continue
        fix = _correction(known, name, listed[given], text)
        if len(fix) > 2:
            fixes.append(CorrectionReply.model_validate(fix))
    for name, double in known.doubles.items():
        if draws.share("mend", "double", name) < strength.mend:
            fixes.append(CorrectionReply(id=double, remove=True, wrong="listed twice"))
    return fixes


def _correction(known: Known, name: str, said: ObjectReply, text: str) -> dict[str, object]:
    """What this look says of one listed thing; only id and reason when it has nothing to say."""
    strength, draws, errors = known.strength, known.draws, known.errors
    item = known.seen.objects[name]
    questions = asked_about(text, said.id)
    chance = min(1.0, strength.mend * (ASKED if questions else 1.0))

    def notices(what: str) -> bool:
        return draws.share("mend", what, name) < chance

    fix: dict[str, object] = {"id": said.id, "wrong": "off"}
    if (questions or visibly_off(said.box, item.box)) and notices("box"):
        fix["box"] = noised_box(item.box, name, strength, draws, errors, LOOK, strength.zoom)
    elif draws.share("harm", "box", name) < strength.harm:
        fix["box"] = noised_box(item.box, name, strength, draws, errors, "harm", 1.5)
    if said.category != item.category and notices("category"):
        fix["category"] = item.category
    if abs((said.yaw_deg - item.yaw_deg + 180) % 360 - 180) > 40 and item.facing != "none" and notices("facing"):
        fix["facing"] = facing_of(item.yaw_deg)
    if said.parent is None and item.parent is not None and notices("parent") and known.parent(item):
        fix["parent"] = known.parent(item)
    if questions and notices("metres"):
        fix |= _metres(known, name, text)
    return fix


def _metres(known: Known, name: str, text: str) -> dict[str, object]:
    """A second estimate in metres, where a question asks for one and the answer has a place for it."""
    strength, draws, errors, item = known.strength, known.draws, known.errors, known.seen.objects[name]
    again = in_metres_of(
        known,
        item.model_copy(
            update={
                "centre_m": noised_centre(item.centre_m, name, strength, draws, errors, LOOK),
                "size_m": noised_size(item.size_m, name, strength, draws, errors, LOOK),
            }
        ),
        text,
    )
    fields = CorrectionReply.model_fields
    return {field: getattr(again, field) for field in ("centre_m", "size_m") if field in fields}
