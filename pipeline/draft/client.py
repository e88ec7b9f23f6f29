# SPDX-License-Identifier: GPL-3.0-or-later
"""The client that answers the questions of stages 1 to 10 from a draft, so that the ordinary stages run on it.

Nothing is sent for that. The draft itself, and the second look for what it missed, go to the real client.
"""

from __future__ import annotations

import hashlib
import json
import re
import threading
from collections.abc import Callable

from pydantic import BaseModel

from ..artifacts.draft import DraftProgram
from ..errors import Cancelled, NotRecordedError, ReplyError
from ..memory import Memory
from ..models.base import ModelClient, Prompt, Reply, name_of
from ..models.builtin.client import BuiltinClient
from ..models.builtin.empty import empty_value
from .artifact import read_again
from .derive import analysis_reply, auxiliary_reply, object_reply
from .derive_looks import descriptions_reply, light_reply, materials_reply, programs_reply
from .kept import DRAFT_STAGE, PREFIX
from .reading import Draft

_REAL = ("01_second_look", "01_again", "draft")
"""Questions that only eyes can answer, by the beginning of their keys."""
_LISTED = re.compile(r"^\d+, ([\w-]+), ", re.MULTILINE)
"""The ids in a question's list of objects."""


class DraftedClient:
    """Answers from the latest draft of a memory; see `ModelClient`.

    Args:
        inner: who is asked for the draft, and for what was missed in it.
    """

    def __init__(self, inner: ModelClient, memory: Memory) -> None:
        self.inner, self._memory = inner, memory
        self._builtin = BuiltinClient()
        self._lock = threading.Lock()
        self.name = f"{PREFIX}{name_of(inner, DRAFT_STAGE)}"
        self.describes = f"{inner.describes.rstrip('.')}; the stages read its draft"

    def name_for(self, stage: str) -> str:
        """The name under which answers to a stage are kept; another draft's answers are others."""
        real = name_of(self.inner, DRAFT_STAGE)
        if stage == DRAFT_STAGE:
            return real
        program = self._program()
        mark = hashlib.sha256("\x00".join([program.text, *program.amended]).encode()).hexdigest()[:6] if program else ""
        return f"{PREFIX}{real}/{mark}" if mark else f"{PREFIX}{real}"

    def _program(self) -> DraftProgram | None:
        return self._memory.latest(DraftProgram)

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Answer one prompt; see `ModelClient.answer`."""
        if cancel.is_set():
            raise Cancelled
        program = self._program()
        if prompt.stage == DRAFT_STAGE or program is None:
            return self.inner.answer(prompt, cancel, progress)
        if prompt.key.startswith(_REAL):
            return self._real(prompt, cancel, progress)
        with self._lock:
            draft, style = read_again(program)
        reply = derived(prompt, draft, style or program.style)
        model = self._model()
        if reply is not None:
            return Reply(reply.model_dump_json(), model)
        if prompt.key == "01_analysis":
            found = self._builtin.answer(prompt, cancel, progress)
            text = _with_things(found.text, draft)
            notes = (*found.notes, "The draft does not say where the floor is in the picture; it was looked for.")
            return Reply(text, model, notes=notes)
        return Reply(json.dumps(empty_value(prompt.schema)), model)

    def _real(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None) -> Reply:
        """What eyes have to answer; where nothing usable comes of a second look, the room stays as it was drafted."""
        try:
            return self.inner.answer(prompt, cancel, progress)
        except (ReplyError, NotRecordedError) as error:
            if prompt.key.startswith("01_again") or (isinstance(error, ReplyError) and not prompt.repair):
                raise
            note = f"Nothing was found out by a second look: {error.message}"
            return Reply(json.dumps(empty_value(prompt.schema)), self._model(), notes=(note,))

    def _model(self) -> str:
        entry = self._memory.latest_entry(DraftProgram.__name__)
        return entry.meta.model or self.name if entry is not None else self.name


def derived(prompt: Prompt, draft: Draft, style: str) -> BaseModel | None:
    """What a draft answers to a question, None where it says nothing on it."""
    key, ids = prompt.key, frozenset(_LISTED.findall(prompt.text))
    if key == "01_analysis":
        return analysis_reply(draft)
    if key == "04_auxiliary":
        return auxiliary_reply(draft, ids)
    if key.startswith("05_descriptions"):
        return descriptions_reply(draft, ids, style)
    if key.startswith("06_programs"):
        return programs_reply(draft, ids)
    if key.startswith("08_materials"):
        return materials_reply(draft, ids)
    return light_reply(draft) if key == "10_light" else None


def _with_things(text: str, draft: Draft) -> str:
    """The built-in analysis' room with the draft's things."""
    found = json.loads(text)
    things = [object_reply(t).model_dump(mode="json") for t in draft.things.values()]
    if things:
        found["objects"] = things
        found["architecture"] = found["architecture"] if not draft.fixed else []
    return json.dumps(found)
