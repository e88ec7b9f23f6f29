# SPDX-License-Identifier: GPL-3.0-or-later
"""The stage "Draft": a whole room in one answer, which grows while it is written; the stages after it refine it.

What of it cannot be used is asked again alone, once; what stays unusable has the library's piece instead.
"""

from __future__ import annotations

from ..artifacts.draft import DraftProgram
from ..artifacts.replies import PlainReply
from ..draft.artifact import draft_program
from ..draft.growing import DraftGrowth
from ..draft.prompt import again_values, pictures, values
from ..draft.reading import Draft
from ..draft.readings import Reading, taken_over
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
    reading = read_usable(written)
    draft = reading.draft
    refused = draft.refused_programs()[:MOST_AGAIN]
    at_first = sum(s.is_lost for s in draft.statements)
    amended: list[str] = []
    if refused:
        requests = tuple(_again(view, written, draft, *one) for one in refused)
        answers = yield Ask(requests, optional=True)
        amended = [a.text for a in answers if a is not None]
    reading.amend(amended)
    yield Tell("Building the room", 3, 3)
    with reading.lock:  # its growing room may still look at it
        made = draft_program(text, written, draft, amended, at_first, (view.reference.width, view.reference.height))
    yield Build(made.room_text)
    return [made]


def read_usable(written: Split) -> Reading:
    """The draft of an answer, as far as it was read while it grew, and the rest of it.

    Raises:
        ReplyError: there is nothing in it of which a room could be made.
    """
    reading = taken_over(written.statements)
    reading.go_on(written.statements)
    if reading.draft.room is None and not reading.draft.things:
        raise ReplyError(
            "The answer holds no room program.",
            "Try again, or go on stage by stage.",
            ("There was neither a room line nor a proxy line in the answer.",),
        )
    return reading


def _request(view: View) -> Request:
    picture = view.reference
    return Request(
        key="draft",
        prompt="draft",
        reply=PlainReply,
        values=values(picture, view.settings, view.number("known_width_m")),
        images=tuple(Picture(name, file) for name, file in pictures(picture)),
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
