# SPDX-License-Identifier: GPL-3.0-or-later
"""The critique of a stand-in for a weaker model: it compares the outlines that it is shown with what the strong model saw.

A real critic looks at three pictures; here the layout and the camera that those pictures were drawn from are handed over,
and what a look at them would tell is worked out: whose outline is off, what faces another way, what is missing.
"""

from __future__ import annotations

import re

from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine
from code_as_room.pipeline.artifacts.replies import BoxReply, CritiqueReply, EditReply, ObjectReply
from code_as_room.pipeline.geometry.camera import GeometryError
from code_as_room.pipeline.geometry.footprint import image_box_of
from code_as_room.pipeline.models.base import Prompt

from .known import Known, iou, visibly_off
from .noise import facing_of, noised_box, noised_object

TOLD = 1.3
"""What the request names as a measured problem is looked at more closely: the chance to notice it goes up by this factor."""
MOST = 12
_PROBLEMS = re.compile(r"problems:", re.IGNORECASE)
_REFUSED = re.compile(r"refused|frozen", re.IGNORECASE)


def critique(known: Known, prompt: Prompt, layout: Layout, camera: CameraModel) -> CritiqueReply:
    """Score and edits for a layout of the major objects.

    Args:
        layout, camera: what the request's pictures show.
    """
    edits: list[tuple[float, EditReply]] = []
    matches = []
    for proxy in layout.proxies:
        name = known.true.get(proxy.id)
        outline = _outline(proxy, camera)
        if outline is None:
            continue
        item = None if name is None else known.seen.objects.get(name)
        if name is None or item is None:
            edits += _surplus(known, prompt, proxy)
            continue
        matches.append(iou(outline, item.box))
        if not _refused(prompt.text, proxy.id):
            edits += _of_one(known, prompt, proxy, outline, name, item)
    missing = _missing(known, prompt, layout)
    kept = [edit for _, edit in sorted([*edits, *missing], key=lambda pair: -pair[0])][:MOST]
    return CritiqueReply(score=_score(known, prompt, matches, len(missing)), edits=kept)


def _outline(proxy: ProxyLine, camera: CameraModel) -> BoxReply | None:
    try:
        box = image_box_of(camera, proxy.centre, proxy.size, proxy.yaw, proxy.shape)
    except GeometryError:
        return None
    return BoxReply.model_validate(box.model_dump())


def _refused(text: str, identifier: str) -> bool:
    """Whether the request tells that an earlier edit of this thing was refused: it is not asked for again."""
    return _mentioned(text, identifier, _REFUSED)


def _mentioned(text: str, identifier: str, where: re.Pattern[str]) -> bool:
    return any(identifier in re.findall(r"\w+", line) for line in text.splitlines() if where.search(line))


def _chance(known: Known, prompt: Prompt, identifier: str) -> float:
    """How likely something wrong with this thing is noticed; likelier where it is told of as a measured problem."""
    told = _mentioned(prompt.text, identifier, _PROBLEMS)
    return min(1.0, known.strength.mend * (TOLD if told else 1.0))


def _of_one(
    known: Known, prompt: Prompt, proxy: ProxyLine, outline: BoxReply, name: str, item: ObjectReply
) -> list[tuple[float, EditReply]]:
    """Edits of one thing, each with how much is wrong, 0..1."""
    strength, draws, errors, key = known.strength, known.draws, known.errors, prompt.key
    chance = _chance(known, prompt, proxy.id)
    edits = []
    if visibly_off(outline, item.box) and draws.share(key, "move", name) < chance:
        box = noised_box(item.box, name, strength, draws, errors, key, strength.zoom)
        edit = EditReply(op="move", id=proxy.id, reason="The outline is off.", box=box)
        edits.append((1 - iou(outline, item.box), edit))
    elif draws.share(key, "harm", name) < strength.harm:
        box = noised_box(item.box, name, strength, draws, errors, key + "/harm", 2.0)
        edits.append((0.5, EditReply(op="move", id=proxy.id, reason="It looks off.", box=box)))
    apart = abs((proxy.yaw - item.yaw_deg + 180) % 360 - 180)
    if item.facing != "none" and apart > 40 and draws.share(key, "turn", name) < chance:
        edits.append((0.7, _turn(proxy.id, item.yaw_deg)))
    elif item.facing != "none" and draws.share(key, "harm turn", name) < strength.harm / 2:
        edits.append((0.4, _turn(proxy.id, (proxy.yaw + 90) % 360)))
    if proxy.category != item.category and draws.share(key, "category", name) < chance:
        edits.append((0.6, EditReply(op="recategorise", id=proxy.id, reason="It is that.", category=item.category)))
    return edits


def _turn(identifier: str, yaw: float) -> EditReply:
    return EditReply(op="turn", id=identifier, reason="It faces that way.", facing=facing_of(yaw), yaw_deg=yaw)


def _surplus(known: Known, prompt: Prompt, proxy: ProxyLine) -> list[tuple[float, EditReply]]:
    """A thing listed twice, or one that the strong model took back; what the critic itself added is left alone."""
    if proxy.id not in {*known.doubles.values(), *known.true}:
        return []
    if known.draws.share(prompt.key, "remove", proxy.id) >= _chance(known, prompt, proxy.id):
        return []
    return [(0.8, EditReply(op="remove", id=proxy.id, reason="It is there twice."))]


def _missing(known: Known, prompt: Prompt, layout: Layout) -> list[tuple[float, EditReply]]:
    """Majors that the strong model saw and the layout lacks."""
    strength, draws, errors, key = known.strength, known.draws, known.errors, prompt.key
    present = {p.id for p in layout.proxies}
    factors = layout.room.size[0] / max(0.1, known.first.reply.room_width_m)
    edits = []
    for name, item in known.seen.objects.items():
        if item.salience != "major" or item.placement != "floor" or known.names[name] in present:
            continue
        if draws.share(key, "missing", name) >= strength.found:
            continue
        again = noised_object(item, strength, draws, errors, key, strength.zoom)
        size = again.size_m.model_copy(
            update={"width": again.size_m.width * factors, "depth": again.size_m.depth * factors}
        )
        edit = EditReply(
            op="add",
            id=known.names[name],
            reason="It is missing.",
            category=again.category,
            box=again.box,
            size_m=size,
            base_m=again.base_m,
            facing=again.facing,
            yaw_deg=again.yaw_deg,
        )
        edits.append((0.9, edit))
    return edits


def _score(known: Known, prompt: Prompt, matches: list[float], missing: int) -> float:
    """How well outlines and picture agree, flattered and rounded as weaker models do."""
    if not matches:
        return 0.0
    strength = known.strength
    lacking = 1 - sum(matches) / (len(matches) + missing)
    score = 100 * (1 - lacking * (1 - strength.flatter)) + 10 * strength.flatter * known.draws.normal(
        prompt.key, "score"
    )
    return max(0.0, min(100.0, round(score)))
