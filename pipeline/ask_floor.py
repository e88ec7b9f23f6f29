# SPDX-License-Identifier: GPL-3.0-or-later
"""A floor of quality under a weak model: where its answers stay unusable, the built-in analysis answers instead.

With it every stage ends, whatever the model writes. It is for models that are known to be weak: with a strong one an error
that names the problem serves the artist better than a room that the model did not see.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace

from pydantic import BaseModel

from .analysis.calibrate import calibrate
from .analysis.clean import clean_analysis
from .artifacts import light, materials, objects, replies
from .artifacts.replies import AnalysisReply
from .ask_replaced import NOTE
from .errors import ModelError, ReplyError, RoomError
from .models.base import ModelClient, Prompt, name_of
from .models.base import Reply as Said
from .models.builtin.client import BuiltinClient
from .models.coordinates import as_asked
from .models.registry import ClientSettings
from .models.routing import model_of
from .models.sight import sizes_seen
from .models.strength import is_weak
from .models.validate import validate_reply
from .picture import read_picture

_HOMES = (replies, objects, materials, light)


def with_floor(client: ModelClient, settings: ClientSettings) -> ModelClient:
    """The client, with the built-in analysis under those of its models that are known to be weak."""
    if not settings.is_service:
        return client

    def weak(stage: str, pictures: int) -> bool:
        return is_weak(f"{settings.kind}:{model_of(settings.models, settings.model, stage, pictures)}")

    names = [settings.model, *settings.models.values()]
    return FloorClient(client, weak) if any(is_weak(f"{settings.kind}:{name}") for name in names if name) else client


class FloorClient:
    """A client that never falls below the built-in analysis; see `ModelClient`.

    A first answer that cannot be used is passed on, so that the model is told what is wrong with it. Only where the second
    try fails too does the built-in analysis answer; the reply's `model` and a note say so. What the second try cost stays
    in the reply. A model that takes no pictures is not shown any more after it has said so: the built-in analysis looks at
    them. A service that fails or refuses otherwise stays an error: that is no matter of quality.

    Args:
        inner: who is asked; is_weak: whether a stage's question with so many pictures goes to a weak model.
    """

    def __init__(self, inner: ModelClient, is_weak: Callable[[str, int], bool] = lambda stage, pictures: True) -> None:
        self.inner, self._is_weak, self._floor = inner, is_weak, BuiltinClient()
        self._first: dict[tuple[str, str], Said] = {}
        self._blind: dict[str, ModelError] = {}
        self.name = inner.name
        self.describes = (
            f"{inner.describes.rstrip('.')}; the built-in analysis where a weak model's answers cannot be used"
        )

    def name_for(self, stage: str) -> str:
        """As the client below is called for a stage."""
        return name_of(self.inner, stage)

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Said:
        """Answer one prompt; see `ModelClient.answer`."""
        if prompt.plain or not self._is_weak(prompt.stage, len(prompt.images)):
            return self.inner.answer(prompt, cancel, progress)
        place, said = (prompt.stage, prompt.key), None
        blind = self._blind.get(self.name_for(prompt.stage)) if prompt.images else None
        if blind is not None:
            return self._instead(prompt, blind, None, cancel, progress)
        try:
            said = self.inner.answer(prompt, cancel, progress)
            (_check if prompt.repair else _check_room)(said, prompt)
        except ReplyError as error:
            if not prompt.repair:
                if said is not None:
                    self._first[place] = said
                raise
            return self._fallen(prompt, error, said, cancel, progress)
        except ModelError as error:
            if not (prompt.images and getattr(error, "kind", "") == "pictures"):
                raise
            self._blind[self.name_for(prompt.stage)] = error
            return self._instead(prompt, error, None, cancel, progress)
        if not prompt.repair:
            self._first[place] = said
        return said

    def _fallen(
        self,
        prompt: Prompt,
        error: ReplyError,
        second: Said | None,
        cancel: threading.Event,
        progress: Callable[[str], None] | None,
    ) -> Said:
        """What the built-in analysis says; the error where the first answer is good for something, or it has nothing."""
        first = self._first.pop((prompt.stage, prompt.key), None)
        if first is not None:
            try:
                _check(first, prompt)
            except ReplyError:
                pass
            else:
                raise error
        return self._instead(prompt, error, second, cancel, progress)

    def _instead(
        self,
        prompt: Prompt,
        error: ModelError,
        second: Said | None,
        cancel: threading.Event,
        progress: Callable[[str], None] | None,
    ) -> Said:
        """The built-in analysis' answer, with what the model's cost; the error where that is of no use either."""
        try:
            said = self._floor.answer(prompt, cancel, progress)
            _check(said, prompt)
        except ReplyError:
            raise error from None
        said = replace(said, notes=(f"{NOTE}: {error.message}", *said.notes))
        if second is None:
            return said
        return replace(
            said,
            prompt_tokens=second.prompt_tokens,
            completion_tokens=second.completion_tokens,
            cost=second.cost,
            seconds=said.seconds + second.seconds,
        )


def _read(said: Said, kind: type[BaseModel], prompt: Prompt) -> BaseModel:
    """An answer as it is read by whoever asked. Raises ReplyError."""
    reply, _ = validate_reply(
        said.text, kind, True, lambda data: as_asked(data, said.model, sizes_seen(prompt.images, said.model))
    )
    return reply


def _check(said: Said, prompt: Prompt) -> None:
    """Raises ReplyError where nothing can be made of an answer."""
    kind = next((getattr(home, prompt.schema_name) for home in _HOMES if hasattr(home, prompt.schema_name)), None)
    if kind is not None:
        _read(said, kind, prompt)
    _check_room(said, prompt)


def _check_room(said: Said, prompt: Prompt) -> None:
    """Raises ReplyError where a description of the picture is one, and yet no room comes of it."""
    if prompt.schema_name != AnalysisReply.__name__ or not prompt.images:
        return
    try:
        reply = _read(said, AnalysisReply, prompt)
    except ReplyError:
        # Told by whoever reads the answer, with the answer itself.
        return
    assert isinstance(reply, AnalysisReply)
    try:
        picture = read_picture(prompt.images[0], "picture")
        calibrate(clean_analysis(reply, (picture.width, picture.height)))
    except RoomError as error:
        problem = f"No room comes of the floor's corners and its size: {error.message}"
        raise ReplyError(problem, error.fix, (problem,)) from None
