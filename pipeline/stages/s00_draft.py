# SPDX-License-Identifier: GPL-3.0-or-later
"""The stage "Draft": a whole room in one answer, which grows while it is written; the stages after it refine it.

What of it cannot be used is asked again alone, once; what stays unusable has the library's piece instead.
"""

from __future__ import annotations

from ..artifacts.draft import DraftProgram
from ..artifacts.replies import PlainReply
from ..draft.artifact import draft_program
from ..draft.growing import DraftGrowth
from ..draft.prompt import again_values, values
from ..draft.reading import Draft
from ..draft.statements import Split, split
from ..errors import ReplyError
from .base import Growth, Stage, View
from .wishes import Ask, Build, Picture, Request, StageRun, Tell

ID = "s00_draft"
MOST_AGAIN = 8
"""Programs that are asked again."""


def run(view: View) -> StageRun:
    """Write `DraftProgram`; one request, and a second round for what of its answer cannot be used."""
    yield Tell("Asking for the whole room", 1, 3)
    [reply] = yield Ask((_request(view),))
    text = reply.text
    yield Tell("Reading the draft", 2, 3)
    written = split(text)
    draft = read_usable(written)
    refused = draft.refused_programs()[:MOST_AGAIN]
    at_first = sum(s.is_lost for s in draft.statements)
    amended: list[str] = []
    if refused:
        requests = tuple(_again(view, written, draft, *one) for one in refused)
        answers = yield Ask(requests, optional=True)
        amended = [a.text for a in answers if a is not None]
    for again in amended:
        draft.amend(split(again).statements)
    yield Tell("Building the room", 3, 3)
    made = draft_program(text, written, draft, amended, at_first, (view.reference.width, view.reference.height))
    yield Build(made.room_text)
    return [made]


def read_usable(written: Split) -> Draft:
    """The draft of an answer.

    Raises:
        ReplyError: there is nothing in it of which a room could be made.
    """
    draft = Draft()
    for statement in written.statements:
        draft.take(statement)
    if draft.room is None and not draft.things:
        raise ReplyError(
            "The answer holds no room program.",
            "Try again, or go on stage by stage.",
            ("There was neither a room line nor a proxy line in the answer.",),
        )
    return draft


def _request(view: View) -> Request:
    picture = view.reference
    return Request(
        key="draft",
        prompt="draft",
        reply=PlainReply,
        values=values(picture, view.settings, view.number("known_width_m")),
        images=(Picture("reference", picture.for_model()), Picture("grid", picture.with_grid())),
    )


def _again(view: View, written: Split, draft: Draft, name: str, program: str, problem: str) -> Request:
    return Request(
        key=f"draft_again/{name}",
        prompt="draft_again",
        reply=PlainReply,
        values=again_values(draft, written.style, name, program, problem),
        images=(Picture("reference", view.reference.for_model()),),
    )


def growth(view: View) -> Growth:
    """What builds while the draft is written."""
    return DraftGrowth((view.reference.width, view.reference.height))


STAGE = Stage(
    id=ID,
    title="Draft",
    reads=(),
    writes=(DraftProgram,),
    run=run,
    settings=("notes",),
    growth=growth,
)
