# SPDX-License-Identifier: GPL-3.0-or-later
"""A stand-in for a weaker model: it answers every request of stages 1 to 4 from a strong model's recording, with errors.

The first answer is the recorded one with noise (`benchmark/noise.py`). Later answers compare what they are shown with what
the strong model saw (`benchmark/seen.py`), find some of the differences, and err again in what they say of them. So what
was overlooked can be found, what was misjudged can be mended, and what was right can be spoilt, with the chances of the
strength. Ground truth is never looked at.

At strength "none" a request that was recorded is answered as it was recorded; one that never was (a further round of the
critique, a critique of another layout) is answered from what the strong model saw, without error. Such answers are
listed in `simulated`. They are better than a real model's: a stand-in without errors sees every outline that is off.
"""

from __future__ import annotations

import hashlib
import re
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import Layout
from code_as_room.pipeline.artifacts.replies import (
    AuxiliaryPlacementReply,
    AuxiliaryReply,
    GraphReply,
)
from code_as_room.pipeline.errors import Cancelled, ModelError
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.recorded import RecordedClient, load_replies, reply_key
from pydantic import BaseModel

from .known import Known
from .noisy_critic import critique
from .noisy_look import second_look
from .seen import GRAPH, Seen, recorded_reply
from .strengths import NONE, Strength

Shows = Callable[[], tuple[Layout, CameraModel] | None]


class NoisyClient:
    """A `ModelClient` that answers as a weaker model would have.

    Args:
        recordings: folder of `replies.json`; seen: what its model saw.
        shows: the layout and camera of the picture that a critique is about; None when there is none.
    """

    def __init__(self, recordings: Path, seen: Seen, strength: Strength, seed: int, shows: Shows) -> None:
        self._recorded, self._entries = RecordedClient(recordings), load_replies(recordings)
        self._known, self._shows = Known(seen, strength, seed), shows
        self._lock = threading.Lock()
        self.simulated: list[str] = []
        self.name = f"{self._recorded.name}:{strength.name}:{seed}"
        self.describes = f"{self._recorded.describes}, with {strength.name} noise"

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Answer one request.

        Raises:
            ModelError: a request that neither was recorded nor can be answered from what was seen.
            Cancelled: `cancel` was set.
        """
        if cancel.is_set():
            raise Cancelled
        if self._known.strength == NONE and self._plays(prompt):
            return self._recorded.answer(prompt, cancel, progress)
        with self._lock:
            self.simulated.append(prompt.key)
            reply = self._simulate(prompt)
        return Reply(text=reply.model_dump_json(), model=self.name)

    def _plays(self, prompt: Prompt) -> bool:
        """Whether the recorded answer is one to this request. A critique of another layout is another question."""
        entry = self._entries.get(reply_key(prompt))
        if entry is None:
            return False
        return prompt.schema_name != "CritiqueReply" or entry.get("text_hash") == _text_hash(prompt)

    def _simulate(self, prompt: Prompt) -> BaseModel:
        known = self._known
        if prompt.schema_name == "AnalysisReply":
            return known.first.reply
        if prompt.schema_name == "SecondLookReply":
            return second_look(known, prompt.text)
        if prompt.schema_name == "GraphReply":
            return _graph(known, self._entries)
        if prompt.schema_name == "CritiqueReply":
            shown = self._shows()
            if shown is None:
                raise ModelError("A critique was asked for before anything was shown.", "Render the layout first.")
            return critique(known, prompt, *shown)
        if prompt.schema_name == "AuxiliaryReply":
            return _auxiliary(known, prompt.text)
        raise ModelError(
            f"The noise model has no answer to {reply_key(prompt)!r}.", "Teach it in benchmark/noisy_client.py."
        )


def _text_hash(prompt: Prompt) -> str:
    return hashlib.sha256(f"{prompt.schema_name}\n{prompt.text}".encode()).hexdigest()


def _graph(known: Known, entries: Mapping[str, Mapping[str, Any]]) -> GraphReply:
    """The recorded facts and relations under the stand-in's names; some are not said, few are the wrong way round."""
    if GRAPH not in entries:
        return GraphReply()
    recorded: GraphReply = recorded_reply(entries, GRAPH, GraphReply)
    strength, draws = known.strength, known.draws
    walls = {r.target for r in recorded.relations} - set(known.seen.objects)
    attributes = [
        a.model_copy(update={"id": known.names[a.id]})
        for a in recorded.attributes
        if a.id in known.names and draws.share("facts", a.id) >= strength.orphan / 2
    ]
    relations = []
    for n, said in enumerate(recorded.relations):
        ends = [known.names.get(i, i if i in walls else "") for i in (said.source, said.target)]
        if not all(ends) or draws.share("relation", n) < strength.orphan:
            continue
        if draws.share("reversed", n) < strength.harm and ends[1] not in walls:
            ends.reverse()
        relations.append(said.model_copy(update={"source": ends[0], "target": ends[1]}))
    return GraphReply(attributes=attributes, relations=relations)


def _auxiliary(known: Known, text: str) -> AuxiliaryReply:
    """Where the things asked about belong, as far as it is noticed."""
    strength, draws = known.strength, known.draws
    asked = set(re.findall(r"[a-z0-9_]+", text))
    placements = []
    for name, item in known.seen.objects.items():
        given = known.names[name]
        if given not in asked or draws.share("belongs", name) >= max(strength.mend, strength.found):
            continue
        placements.append(
            AuxiliaryPlacementReply(
                id=given,
                placement=item.placement,
                parent=known.parent(item),
                base_m=max(0.0, item.base_m + strength.base * draws.normal("belongs", name)),
                height_m=item.size_m.height,
            )
        )
    return AuxiliaryReply(placements=placements)
