# SPDX-License-Identifier: GPL-3.0-or-later
"""Performs stage 9's wish for painted images: templates, threads, simpler words after a refusal, nothing paid for twice."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor

from .ask import AskEvent
from .errors import Cancelled, ModelError
from .models.faults import ServiceError
from .models.image_base import FINAL_KINDS, SIDE_BY_SIDE, ImageClient, ImageRequest
from .prompting import fill_template, load_template
from .stages.texture_wishes import Paint, Painting, PaintRequest
from .textures.kept import KeptImages, request_hash


def paint(
    wish: Paint,
    client: ImageClient | None,
    kept: KeptImages | None,
    cancel: threading.Event,
    on_event: Callable[[AskEvent], None] | None = None,
    fresh: bool = False,
) -> list[Painting] | None:
    """Answer a `Paint`; None where there is no image model. Safe to call from a worker thread.

    Args:
        kept: where images are kept the moment they arrive, and looked for first.
        on_event: is told what happens to each request; called from several threads.
        fresh: paint anew what is kept.

    Raises:
        Cancelled: `cancel` was set; what had arrived by then is kept.
    """
    if client is None:
        return None
    run = _Run(client, kept, cancel, on_event or (lambda event: None), fresh)
    with ThreadPoolExecutor(max_workers=SIDE_BY_SIDE, thread_name_prefix="code-as-room-paint") as pool:
        waiting = [pool.submit(run.one, request) for request in wish.requests]
        found = [future.result() for future in waiting]
    if cancel.is_set():
        raise Cancelled
    return found


class _Run:
    """The requests of one wish; after a failure that all would meet, the rest is not sent."""

    def __init__(
        self,
        client: ImageClient,
        kept: KeptImages | None,
        cancel: threading.Event,
        tell: Callable[[AskEvent], None],
        fresh: bool,
    ) -> None:
        self._client, self._kept, self._cancel, self._tell, self._fresh = client, kept, cancel, tell, fresh
        self._failed = ""

    def one(self, request: PaintRequest) -> Painting:
        """One image: with all words, then with simple ones."""
        problem, tries = "", 0
        for template in (request.prompt, request.simple):
            asked = ImageRequest(filled(template, request.values), request.proportions)
            known = request_hash(self._client.name, asked.text, asked.proportions)
            before = self._kept.find(known) if self._kept and not self._fresh else None
            if before is not None:
                self._tell(AskEvent(request.key, "recalled", "the image that was painted before is used again"))
                return Painting(before, self._client.name, asked=known)
            if self._failed or self._cancel.is_set():
                return Painting(problem=self._failed)
            tries += 1
            self._tell(AskEvent(request.key, "asked", "an image is being painted"))
            try:
                made = self._client.paint(
                    asked, self._cancel, lambda text: self._tell(AskEvent(request.key, "progress", text))
                )
            except Cancelled:
                return Painting()
            except ServiceError as error:
                problem = error.message
                self._tell(AskEvent(request.key, "failed", problem))
                if error.kind in FINAL_KINDS:
                    self._failed = problem
                    break
                continue
            except ModelError as error:
                # Such as the spending cap: nothing was sent, and nothing will be.
                self._failed = problem = error.message
                self._tell(AskEvent(request.key, "failed", problem))
                break
            if self._kept:
                self._kept.keep(known, made.data)
            self._tell(AskEvent(request.key, "answered", "an image was painted"))
            model = made.model or self._client.name
            return Painting(made.data, model, "", made.cost, made.seconds, tries, known)
        return Painting(problem=problem)


def filled(template: str, values: Mapping[str, str]) -> str:
    """A template with those of the values that it has places for."""
    text = load_template(template)
    return fill_template(text, {name: value for name, value in values.items() if f"{{{{{name}}}}}" in text}).strip()
