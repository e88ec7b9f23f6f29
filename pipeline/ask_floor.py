# SPDX-License-Identifier: GPL-3.0-or-later
"""A floor of quality under a weak model: where its answers stay unusable, the built-in analysis answers instead.

With it every stage ends, whatever the model writes. It is for models that are known to be weak: with a strong one an error
that names the problem serves the artist better than a room that the model did not see.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace

from .analysis.calibrate import calibrate
from .analysis.clean import clean_analysis
from .artifacts import light, materials, objects, replies
from .artifacts.replies import AnalysisReply
from .errors import ReplyError, RoomError
from .models.base import ModelClient, Prompt, name_of
from .models.base import Reply as Said
from .models.builtin.client import BuiltinClient
from .models.validate import validate_reply
from .picture import read_picture

_HOMES = (replies, objects, materials, light)


class FloorClient:
    """A client that never falls below the built-in analysis; see `ModelClient`.

    A first answer that cannot be used is passed on, so that the model is told what is wrong with it. Only where the second
    try fails too does the built-in analysis answer; the reply's `model` and a note say so. A service that fails or refuses
    stays an error: that is no matter of quality.
    """

    def __init__(self, client: ModelClient) -> None:
        self._client, self._floor = client, BuiltinClient()
        self._first: dict[tuple[str, str], str] = {}
        self.name, self.describes = client.name, client.describes

    def name_for(self, stage: str) -> str:
        """As the client below is called for a stage."""
        return name_of(self._client, stage)

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Said:
        """Answer one prompt; see `ModelClient.answer`."""
        place = (prompt.stage, prompt.key)
        try:
            said = self._client.answer(prompt, cancel, progress)
            _check_room(said.text, prompt)
        except ReplyError as error:
            if not prompt.repair:
                raise
            return self._fallen(prompt, error, cancel, progress)
        if not prompt.repair:
            self._first[place] = said.text
            return said
        try:
            _check(said.text, prompt)
        except ReplyError as error:
            return self._fallen(prompt, error, cancel, progress)
        return said

    def _fallen(
        self, prompt: Prompt, error: ReplyError, cancel: threading.Event, progress: Callable[[str], None] | None
    ) -> Said:
        """What the built-in analysis says; the error where the first answer is good for something, or it has nothing."""
        try:
            _check(self._first.pop((prompt.stage, prompt.key), ""), prompt)
        except ReplyError:
            pass
        else:
            raise error
        try:
            said = self._floor.answer(prompt, cancel, progress)
            _check(said.text, prompt)
        except ReplyError:
            raise error from None
        note = f"The built-in analysis answered, since the model's answers could not be used: {error.message}"
        return replace(said, notes=(note, *said.notes))


def _check(text: str, prompt: Prompt) -> None:
    """Raises ReplyError where nothing can be made of an answer."""
    kind = next((getattr(home, prompt.schema_name) for home in _HOMES if hasattr(home, prompt.schema_name)), None)
    if kind is not None:
        validate_reply(text, kind, salvage=True)
    _check_room(text, prompt)


def _check_room(text: str, prompt: Prompt) -> None:
    """Raises ReplyError where a description of the picture is one, and yet no room comes of it."""
    if prompt.schema_name != AnalysisReply.__name__ or not prompt.images:
        return
    try:
        reply, _ = validate_reply(text, AnalysisReply, salvage=True)
    except ReplyError:
        # Told by whoever reads the answer, with the answer itself.
        return
    try:
        picture = read_picture(prompt.images[0], "picture")
        calibrate(clean_analysis(reply, (picture.width, picture.height)))
    except RoomError as error:
        said = f"No room comes of the floor's corners and its size: {error.message}"
        raise ReplyError(said, error.fix, (said,)) from None
