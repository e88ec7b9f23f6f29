# SPDX-License-Identifier: GPL-3.0-or-later
"""Clients of chats and of images that hold to Blender's online access, and one that answers nothing."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import bpy

from ..pipeline.errors import Cancelled, ModelError
from ..pipeline.models.base import ModelClient, Prompt, Reply, name_of

if TYPE_CHECKING:
    from ..pipeline.models.image_base import ImageClient, ImageRequest, PaintedImage

_TICK = 0.05
_Result = TypeVar("_Result")


class OfflineError(ModelError):
    """Blender's online access is off."""

    kind = "offline"


OFFLINE = OfflineError(
    "Blender's online access is off, so the model service cannot be asked.",
    "Allow it in Preferences, System, Network; or use the built-in analysis or a service on this computer.",
)


class _Guard:
    """Asks only while Blender's online access is on, and stops when it is switched off.

    Worker threads must not read `bpy.app`, so the main thread looks for them: `watch` is called on every tick.
    """

    refusal = OFFLINE

    def __init__(self, name: str, describes: str) -> None:
        self.name, self.describes = name, describes
        self.online = False

    def watch(self) -> None:
        """Look whether online access is on. Main thread only."""
        self.online = bool(bpy.app.online_access)

    def while_online(self, ask: Callable[[threading.Event], _Result], cancel: threading.Event) -> _Result:
        """What `ask` gives, which is handed an event that stops it.

        Raises:
            OfflineError: online access is off, or was switched off meanwhile.
        """
        refused = OfflineError(self.refusal.message, self.refusal.fix)
        if not self.online:
            raise refused
        try:
            return ask(_StopOffline(self, cancel))
        except Cancelled:
            if cancel.is_set():
                raise
            raise refused from None


class GuardedClient(_Guard):
    """A client on the network."""

    def __init__(self, inner: ModelClient) -> None:
        super().__init__(inner.name, inner.describes)
        self.inner = inner

    def name_for(self, stage: str) -> str:
        """The name of who answers a stage."""
        return name_of(self.inner, stage)

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """As `ModelClient.answer`; OfflineError when online access is off."""
        return self.while_online(lambda stop: self.inner.answer(prompt, stop, progress), cancel)


class GuardedPainter(_Guard):
    """An image client on the network."""

    refusal = OfflineError(
        "Blender's online access is off, so the image model cannot be asked.",
        "Allow it in Preferences, System, Network.",
    )

    def __init__(self, inner: ImageClient) -> None:
        super().__init__(inner.name, inner.describes)
        self.inner = inner

    def paint(
        self, request: ImageRequest, cancel: threading.Event, progress: Callable[[str], None] | None = None
    ) -> PaintedImage:
        """As `ImageClient.paint`; OfflineError when online access is off."""
        return self.while_online(lambda stop: self.inner.paint(request, stop, progress), cancel)


class _StopOffline(threading.Event):
    """A run's cancel event that also counts as set while online access is off."""

    def __init__(self, client: _Guard, cancel: threading.Event) -> None:
        super().__init__()
        self._client, self._cancel = client, cancel

    def is_set(self) -> bool:
        """Whether to stop."""
        return self._cancel.is_set() or not self._client.online

    def wait(self, timeout: float | None = None) -> bool:
        """As `Event.wait`."""
        end = None if timeout is None else time.monotonic() + timeout
        while not self.is_set():
            left = _TICK if end is None else min(_TICK, end - time.monotonic())
            if left <= 0:
                break
            self._cancel.wait(left)
        return self.is_set()


def watch_online_access(client: ModelClient | ImageClient | None) -> None:
    """Tell a client on the network whether online access is still on. Main thread only."""
    found: Any = client
    while found is not None:
        watch = getattr(found, "watch", None)
        if watch is not None:
            watch()
        found = getattr(found, "inner", None)


class _Nobody:
    """Answers nothing: for reading the state of a room, where no question is ever asked."""

    name = ""
    describes = ""

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Always ModelError."""
        raise ModelError("There is no model to ask.")


NOBODY: ModelClient = _Nobody()
