# SPDX-License-Identifier: GPL-3.0-or-later
"""What stage 6 asks the model: which library pieces, or programs of its own, which it then sees rendered and mends once."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import Any

from ..artifacts.analysis import Calibration, SceneAnalysis
from ..artifacts.layout import ProxyLine
from ..artifacts.objects import PiecesReply, ProgramsReply
from ..draft.kept import DRAFTED, LOOKED
from ..library import catalogue
from ..objects.asking import apart_from, batches, crop_of, facing_words, object_line, picture_box
from ..objects.choose import candidates
from ..objects.cloths import is_lying_cloth
from ..objects.crops import TILE, sheet, side_by_side
from ..objects.detailing import Detailing
from ..objects.examples import nearest_programs
from ..objects.eyes import eyes_on
from ..objects.rows import another, rows
from ..objects.written import FAR, STRETCH
from ..program.prelude.palette import category_family
from ..program.reference import reference
from .base import View
from .s06_written import OnItsWay
from .wishes import Ask, Picture, Portrait, Request, Tell, Wish

BATCH = 5
MOST_PROGRAMS = 25
"""Objects that get programs of their own; the smallest of more have library pieces."""
_CANDIDATES = 3
Asking = Generator[Wish, Any, None]


def choose_pieces(view: View, detailing: Detailing) -> Asking:
    """One request for the whole room: which library piece for each object, with which parameters."""
    analysis, calibration = view.need(SceneAnalysis), view.need(Calibration)
    things = detailing.todo
    boxes = [(str(n), box) for n, p in enumerate(things, 1) if (box := picture_box(p, calibration.camera, analysis))]
    near = {c.piece.name: c.piece for p in things for c in candidates(p, "", category_family(p.category))[:_CANDIDATES]}
    pieces = "\n".join(_piece_lines(piece) for piece in near.values())
    others = ", ".join(name for name in catalogue.pieces() if name not in near)
    lines = [_line(view, detailing, n, p) for n, p in enumerate(things, 1)]
    request = Request(
        key="06_pieces",
        prompt="06_pieces",
        reply=PiecesReply,
        values={
            "objects": "\n".join(lines) + view.noted(p.id for p in things),
            "pieces": pieces,
            "others": others,
            "style": detailing.style.style or "not known",
        },
        images=(Picture("room", view.reference.with_boxes_drawn(boxes, long_side=1280)),),
    )
    [reply] = yield Ask((request,), optional=True)
    if reply is None:
        detailing.notes |= {p.id: "The model chose no piece; this one was chosen by name and size." for p in things[:1]}
        return
    detailing.take_pieces(reply.objects)


def _piece_lines(piece: catalogue.Piece) -> str:
    lines = [f"{piece.name}: {piece.title}"]
    lines += [f"  {name}={default}: {meaning}" for name, (default, meaning) in piece.parameters.items()]
    return "\n".join(lines)


def _line(view: View, detailing: Detailing, number: int, proxy: ProxyLine) -> str:
    """One object of a list: its place and colours, how it looks, which way it is turned, what is not part of it."""
    described = detailing.described(proxy.id)
    parent = detailing.layout.proxy(proxy.parent) if proxy.parent else None
    known = object_line(number, proxy, described, parent)
    return "; ".join(part for part in (known, *_facts(view, detailing, proxy)) if part)


def _facts(view: View, detailing: Detailing, proxy: ProxyLine) -> tuple[str, ...]:
    analysis, calibration = view.need(SceneAnalysis), view.need(Calibration)
    gone = {i for i, name in view.names(analysis).items() if name is None}
    on_it = ", ".join(f"{i} ({c})" for i, c in apart_from(proxy, detailing.layout, analysis, gone))
    return (
        detailing.described(proxy.id).words,
        f"a cloth, laid onto {proxy.parent} afterwards" if is_lying_cloth(proxy) else "",
        facing_words(proxy, calibration.camera),
        f"separate, not part of it: {on_it}" if on_it else "",
    )


def write_programs(view: View, detailing: Detailing) -> Asking:
    """Programs for the larger objects in two rounds: written from the crops, then mended once after a look at renders."""
    drafted, looked = (view.settings.get("objects") == word for word in (DRAFTED, LOOKED))
    followers = _followers(view, detailing)
    todo = [p for p in detailing.todo if p.id not in followers]
    chosen = sorted(todo, key=lambda p: -_weight(p))[: None if drafted else MOST_PROGRAMS]
    chosen.sort(key=lambda p: (category_family(p.category), p.category, p.id))
    groups = batches(chosen, BATCH)
    requests = tuple(_first_request(view, detailing, n, batch) for n, batch in enumerate(groups, 1))
    answers = yield Ask(requests, optional=True)
    replies = {o.id: o for reply in answers if reply is not None for o in reply.objects}
    if not any(reply.program.strip() for reply in replies.values()):
        if any(answer is not None for answer in answers) or not answers:
            return
        detailing.notes |= {
            p.id: "No program was written for it; the library's piece stands for it." for p in chosen[:1]
        }
        return
    drafts = {p.id: OnItsWay(p, replies.get(p.id)) for p in chosen}
    for draft in drafts.values():
        draft.take(detailing, FAR if drafted or looked else STRETCH)
    if drafted:
        # Nobody looks at them now; that is what refining does.
        for draft in drafts.values():
            if draft.written_by_model:
                draft.keep_drafted(detailing)
        return
    yield Tell("Looking at the objects", 2, 3)
    for draft in drafts.values():
        if draft.made is not None:
            shapes, family = draft.made.shapes, category_family(draft.proxy.category)
            cameras = eyes_on(shapes, draft.proxy, view.need(Calibration).camera, TILE)
            draft.render = yield Portrait(shapes, family, cameras)
    asked = [[drafts[p.id] for p in batch if drafts[p.id].written_by_model] for batch in groups]
    asked = [batch for batch in asked if batch]
    corrections = yield Ask(
        tuple(_second_request(view, detailing, n, b) for n, b in enumerate(asked, 1)), optional=True
    )
    better = {o.id: o for reply in corrections if reply is not None for o in reply.objects}
    for draft in drafts.values():
        draft.mend(detailing, better.get(draft.proxy.id))
        if not looked:
            draft.keep(detailing)
        elif draft.made is not None or not detailing.leave(draft.proxy.id):
            draft.keep_drafted(detailing)
    _make_rows(detailing, followers)


def _followers(view: View, detailing: Detailing) -> dict[str, str]:
    """Rows that another row's program makes, and that one; a draft has its own program for each."""
    return {} if view.settings.get("objects") in (DRAFTED, LOOKED) else rows(detailing.todo)


def _make_rows(detailing: Detailing, followers: Mapping[str, str]) -> None:
    """Rows of books and of clothes that one program makes: each gets it with a seed of its own."""
    for seed, (identifier, first) in enumerate(followers.items(), 2):
        proxy, written = detailing.layout.proxy(identifier), detailing.written.get(first)
        made = another(written, proxy, detailing.names[identifier], seed) if proxy and written else None
        if made is not None and made.checked.penalty < 1.0:
            detailing.written[identifier] = made


def _weight(proxy: ProxyLine) -> float:
    """How much an object counts in a picture of the room: large furniture first."""
    w, d, h = proxy.size
    return (w * d + w * h + d * h) * (2.0 if proxy.salience == "major" else 1.0)


def _first_request(view: View, detailing: Detailing, number: int, batch: Sequence[ProxyLine]) -> Request:
    analysis, calibration = view.need(SceneAnalysis), view.need(Calibration)
    boxes = {p.id: picture_box(p, calibration.camera, analysis) for p in batch}
    shown = [(p, box) for p in batch if (box := boxes[p.id]) is not None]
    numbers = {p.id: n for n, p in enumerate(batch, 1)}
    whole = view.reference.with_boxes_drawn([(str(numbers[p.id]), box) for p, box in shown], long_side=900)
    lines = [f"{_line(view, detailing, numbers[p.id], p)}; {_def_words(view, detailing, p)}" for p in batch]
    return Request(
        key=f"06_programs/{number}",
        prompt="06_programs",
        reply=ProgramsReply,
        values={
            "reference": reference(),
            "style": detailing.style.style or "not known",
            "objects": "\n".join(lines) + view.noted(p.id for p in batch),
            "crops": ", ".join(str(numbers[p.id]) for p, _ in shown) or "none",
            "examples": nearest_programs(batch),
        },
        images=(Picture("room", whole), *(Picture(p.id, crop_of(view.reference, box)) for p, box in shown)),
    )


def _def_words(view: View, detailing: Detailing, proxy: ProxyLine) -> str:
    """What an object's def is to be called, and that it makes several rows."""
    name, more = detailing.names[proxy.id], list(_followers(view, detailing).values()).count(proxy.id)
    if not more:
        return f"name the def {name}"
    return f"it makes {more + 1} such rows, so def {name}(size, seed=1), and all that varies by rand((seed, ...))"


def _second_request(view: View, detailing: Detailing, number: int, batch: Sequence[OnItsWay]) -> Request:
    sheets = [(draft, _sheet(view, draft)) for draft in batch]
    shown = [Picture(draft.proxy.id, data) for draft, data in sheets if data]
    order = [picture.name for picture in shown]
    return Request(
        key=f"06_correct/{number}",
        prompt="06_correct",
        reply=ProgramsReply,
        values={
            "reference": reference(example=False),
            "pictures": "; ".join(f"{n} {what}" for n, what in enumerate(order, 1)) or "none",
            "style": detailing.style.style or "not known",
            "objects": "\n\n".join(draft.told(_what(view, detailing, draft.proxy)) for draft in batch),
        },
        images=tuple(shown),
    )


def _what(view: View, detailing: Detailing, proxy: ProxyLine) -> list[str]:
    """What an object is and looks like, in the words of the first request."""
    parent = detailing.layout.proxy(proxy.parent) if proxy.parent else None
    line = object_line(0, proxy, detailing.described(proxy.id), parent).split("; ")
    kind = proxy.category.replace("_", " ")
    named = f"{kind} ({proxy.label})" if proxy.label and proxy.label.lower() != kind.lower() else kind
    many = _def_words(view, detailing, proxy) if proxy.id in _followers(view, detailing).values() else ""
    return [part for part in (named, *line[1:], *_facts(view, detailing, proxy), many) if part]


def _sheet(view: View, draft: OnItsWay) -> bytes:
    """An object in the picture, and as its program makes it; without what there is no picture of."""
    analysis, calibration = view.need(SceneAnalysis), view.need(Calibration)
    box = picture_box(draft.proxy, calibration.camera, analysis)
    tiles = [] if box is None else [("in the picture", crop_of(view.reference, box))]
    if draft.render:
        titles = ("yours, seen from the same place", "yours, from its front")
        tiles += zip(titles, side_by_side(draft.render, len(titles)), strict=True)
    return sheet([(f"{draft.proxy.id} {title}", data) for title, data in tiles]) if tiles else b""
