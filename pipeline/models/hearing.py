# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets whoever asked hear an answer while it is being written."""

from __future__ import annotations

import time
from collections.abc import Callable

from .base import Prompt

PAUSE = 0.1
"""Seconds between two times at which the answer so far is told."""


class Hearing:
    """Tells a prompt's listener the answer so far: all of it each time, at most every tenth of a second, never the same twice.

    Nothing happens where the prompt has no listener. For one try of one prompt and one thread; a new try begins anew.
    """

    def __init__(self, prompt: Prompt, clock: Callable[[], float] = time.monotonic) -> None:
        self._hear, self._clock = prompt.hear, clock
        self._next, self._told = 0.0, ""

    def so_far(self, text: Callable[[], str]) -> None:
        """The answer has perhaps grown; `text` puts it together, and is only called when it is time."""
        if self._hear is None or self._clock() < self._next:
            return
        self._next = self._clock() + PAUSE
        self._tell(text())

    def whole(self, text: str) -> None:
        """The answer is complete."""
        self._tell(text)

    def _tell(self, text: str) -> None:
        if self._hear is not None and text and text != self._told:
            self._told = text
            self._hear(text)
