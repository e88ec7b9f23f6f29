# SPDX-License-Identifier: GPL-3.0-or-later
"""The client with which a draft's programs are looked at: what is written comes from the draft, what mends it from the model.

Whoever writes a whole room at once sees none of it. Here each object is rendered beside its part of the picture, and the model
that wrote it says what is wrong, as it would of programs of its own (stage 6, second round).
"""

from __future__ import annotations

import threading
from collections.abc import Callable

from ..models.base import ModelClient, Prompt, Reply, name_of
from .kept import LOOK_PREFIX

WRITTEN = "06_programs"
"""How the keys of questions begin that the draft has answered."""


class LookingClient:
    """Answers the first round of programs from a draft, and everything else by asking; see `ModelClient`.

    Args:
        drafted: answers from the draft. real: who is asked.
    """

    def __init__(self, drafted: ModelClient, real: ModelClient) -> None:
        self._drafted, self._real = drafted, real
        self.name = f"{LOOK_PREFIX}{real.name}"
        self.describes = real.describes

    def name_for(self, stage: str) -> str:
        """The name under which answers to a stage are kept."""
        return f"{LOOK_PREFIX}{name_of(self._real, stage)}"

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Answer one prompt; see `ModelClient.answer`."""
        client = self._drafted if prompt.key.startswith(WRITTEN) else self._real
        return client.answer(prompt, cancel, progress)
