# SPDX-License-Identifier: GPL-3.0-or-later
"""All that a recording's model saw of a picture: its first answer with what its second look added and corrected.

This is what a stand-in for a weaker model may know. Ground truth is not part of it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from code_as_room.pipeline.analysis.clean import FACING_YAW, clean_id
from code_as_room.pipeline.artifacts.analysis import SceneAnalysis
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.artifacts.replies import (
    AnalysisReply,
    BoxReply,
    CorrectionReply,
    MissedReply,
    ObjectReply,
    SecondLookReply,
)
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.memory import Memory
from code_as_room.pipeline.models.recorded import RecordedClient, load_replies
from code_as_room.pipeline.models.validate import validate_reply
from code_as_room.pipeline.picture import ReferencePicture
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages

from .plain_backend import PlainBackend

FIRST, SECOND, GRAPH = "s01_analysis/01_analysis", "s01_analysis/01_second_look", "s02_graph/02_graph"


@dataclass(frozen=True)
class Seen:
    """What the recorded model saw.

    Attributes:
        first: its first answer, ids as the pipeline calls them.
        objects: all things by id, as it knew them in the end: boxes in 0-1000 of the whole picture, metres its own.
    """

    first: AnalysisReply
    objects: Mapping[str, ObjectReply]


def seen_in(recordings: Path, picture: ReferencePicture) -> Seen:
    """Everything that the recording in this folder tells of the picture.

    Where enlarged parts lie is known to stage 1 alone, so it runs once over the recording to place what was missed.

    Raises:
        ModelError: there is no readable recording of stage 1.
        ReplyError: the recorded answer does not fit any more.
    """
    replies = load_replies(recordings)
    first, renamed = _own_ids(recorded_reply(replies, FIRST, AnalysisReply))
    objects = {o.id: o for o in first.objects}
    if SECOND not in replies:
        return Seen(first, objects)
    second = recorded_reply(replies, SECOND, SecondLookReply)
    for fix in second.corrections:
        name = renamed.get(fix.id, fix.id)
        if fix.remove:
            objects.pop(name, None)
        elif name in objects:
            objects[name] = _corrected(objects[name], fix)
    if second.missed:
        found = _analysis_of(recordings, picture)
        boxes = {o.id: o.box for o in found.objects if o.id not in renamed.values() and o.box is not None}
        for missed in second.missed:
            name = _name_in(missed, boxes)
            if name is not None:
                plain = missed.model_dump(exclude={"picture"})
                plain |= {"id": name, "box": _reply_box(boxes.pop(name))}
                objects[name] = ObjectReply.model_validate(plain)
    return Seen(first, objects)


def recorded_reply(replies: Mapping[str, Any], key: str, kind: Any) -> Any:
    entry = replies.get(key)
    if entry is None:
        raise RoomError(f"The recording has no answer to {key}.", "Record the picture again.")
    text = json.dumps(entry["reply"]) if "reply" in entry else str(entry.get("text", ""))
    return validate_reply(text, kind, salvage=True)[0]


def _own_ids(reply: AnalysisReply) -> tuple[AnalysisReply, dict[str, str]]:
    """The answer with the unique ids that the pipeline gives its things, and by what id they went before."""
    taken: set[str] = set()
    architecture = [a.model_copy(update={"id": clean_id(a.id or a.kind, taken, a.kind)}) for a in reply.architecture]
    renamed: dict[str, str] = {}
    objects = []
    for item in reply.objects:
        name = clean_id(item.id or item.category, taken, "object")
        renamed.setdefault(item.id, name)
        objects.append(item.model_copy(update={"id": name}))
    objects = [o.model_copy(update={"parent": renamed.get(o.parent or "", o.parent)}) for o in objects]
    return reply.model_copy(update={"architecture": architecture, "objects": objects}), renamed


def _corrected(item: ObjectReply, fix: CorrectionReply) -> ObjectReply:
    """Every field that a correction shares with the thing and does not leave open."""
    given = {k: v for k, v in dict(fix).items() if v is not None and k not in ("id", "wrong", "remove")}
    known = {k: v for k, v in given.items() if k in type(item).model_fields}
    if "facing" in known and "yaw_deg" not in known:
        known["yaw_deg"] = FACING_YAW.get(str(known["facing"]), item.yaw_deg)
    return item.model_copy(update=known)


def _analysis_of(recordings: Path, picture: ReferencePicture) -> SceneAnalysis:
    run = Run(picture, Memory(), RecordedClient(recordings), PlainBackend())
    run.run_stage(all_stages()[0])
    found = run.memory.latest(SceneAnalysis)
    assert found is not None
    return found


def _name_in(missed: MissedReply, boxes: Mapping[str, ImageBox]) -> str | None:
    """What stage 1 called a thing that was missed; None when it made nothing of it."""
    name = clean_id(missed.id or missed.category, set(), "object")
    same = [i for i in boxes if i == name or i.startswith(name + "_")]
    return min(same, key=len) if same else None


def _reply_box(box: ImageBox) -> BoxReply:
    return BoxReply.model_validate(box.model_dump())
