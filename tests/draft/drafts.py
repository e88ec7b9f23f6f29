# SPDX-License-Identifier: GPL-3.0-or-later
"""Drafts to read, and a model that answers with them."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable

from code_as_room.pipeline.draft.prompt import EXAMPLE
from code_as_room.pipeline.draft.reading import Draft, read
from code_as_room.pipeline.draft.statements import split
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.builtin.empty import empty_value

ROOM = (
    "room(size=(4, 3, 2.5), floor=[(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)],\n"
    "    seen=[(150, 850), (850, 850), (850, 150), (150, 150)], view='orthographic', kind='bedroom')\n"
)
TABLE = (
    "proxy('table_1', 'table', at=(0, 0, 0), size=(1.2, 0.8, 0.7), seen=(395, 407, 605, 593))\n"
    "def table_1(size):\n"
    "    w, d, h = size\n"
    "    legs = [box((0.05, 0.05, h - 0.03), at=(s * (w / 2 - 0.03), t * (d / 2 - 0.03), (h - 0.03) / 2)) "
    "for s in (-1, 1) for t in (-1, 1)]\n"
    "    return [part('top', box((w, d, 0.03), at=(0, 0, h - 0.015)), material='wood #A87C52'), "
    "part('leg', legs, material='wood #A87C52')]\n"
)


def read_text(text: str) -> Draft:
    """A whole answer as a draft."""
    return read(split(text).statements)


class Scripted:
    """A model that writes this draft, and finds nothing else to say.

    Attributes:
        asked: keys of what it was asked, in their order.
    """

    name = "scripted:strong"
    describes = "A scripted model"

    def __init__(self, draft: str = EXAMPLE, again: str = "") -> None:
        self.draft, self.again = draft, again
        self.asked: list[str] = []

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """See `ModelClient.answer`."""
        self.asked.append(prompt.key)
        if prompt.key == "draft":
            return Reply(self.draft, self.name)
        if prompt.plain:
            return Reply(self.again or "I cannot.", self.name)
        return Reply(json.dumps(empty_value(prompt.schema)), self.name)
