# SPDX-License-Identifier: GPL-3.0-or-later
"""The protocol that every model client follows: a prepared prompt in, a text out. No pydantic, no bpy, thread-safe."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol


@dataclass(frozen=True)
class Prompt:
    """A request as a client sees it.

    Attributes:
        stage: id of the stage, such as "s01_analysis"; key: the request's key (see `stages.wishes.Request`).
        text: the whole prompt text; images: encoded pictures (PNG or JPEG) in order.
        schema_name, schema: JSON schema of the answer, as `models.schema.strict_schema` makes it.
        hash: sha256 of text and pictures, hexadecimal; recordings keep it to notice drift.
        facts: typed data for the built-in client only.
        repair: True for the second try that quotes validation errors back.
        plain: the answer is a text as it is: no schema is sent or described.
        hear: called in the worker thread with all of the answer that has arrived so far, at most every tenth of a second
            and once with the whole; after another try it may begin again with less. It must not raise.
        shared: how many characters at the beginning of `text` other prompts that are asked with it begin with too, 0
            when that is too little to matter; services keep such beginnings, so that they cost less.
    """

    stage: str
    key: str
    text: str
    images: tuple[bytes, ...]
    schema_name: str
    schema: Mapping[str, Any]
    hash: str
    facts: Mapping[str, Any] = field(default_factory=dict)
    repair: bool = False
    shared: int = 0
    plain: bool = False
    hear: Callable[[str], None] | None = field(default=None, compare=False, repr=False)

    def halves(self) -> tuple[str, str]:
        """The text's shared beginning, "" when there is none, and the rest; together they are the text."""
        return self.text[: self.shared], self.text[self.shared :]


@dataclass(frozen=True)
class Reply:
    """A client's answer: the text as the model wrote it, and what it took.

    `cost` is in US dollars, None when unknown. `notes` are sentences for the report, such as a recording's drift. Of
    `prompt_tokens`, `cached_tokens` were kept by the service from earlier prompts, and `written_tokens` are kept for later ones.
    """

    text: str
    model: str
    prompt_tokens: int = 0
    completion_tokens: int = 0
    cost: float | None = None
    seconds: float = 0.0
    notes: tuple[str, ...] = ()
    cached_tokens: int = 0
    written_tokens: int = 0

    def __post_init__(self) -> None:
        # Half of a surrogate pair is no character: neither a file nor Blender can hold it.
        object.__setattr__(self, "text", self.text.encode("utf-8", "replace").decode("utf-8"))


class ModelClient(Protocol):
    """Something that answers prompts. `answer` is called from worker threads, several at once.

    Attributes:
        name: short name for memory and report, such as "builtin" or "openai:gpt-x".
        describes: one sentence for the artist on what answers, such as "No model: the built-in picture analysis".
    """

    name: str
    describes: str

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Answer one prompt.

        Args:
            cancel: set when the artist stops the run; the client then raises `Cancelled` within a second.
            progress: called with short texts such as "received 12 kB".

        Raises:
            ModelError: the service failed or refused, in the service's own words where it gave any.
            ReplyError: the answer was cut or empty.
            Cancelled: `cancel` was set.
        """
        ...


def name_of(client: ModelClient, stage: str) -> str:
    """The name under which memory keeps this client's answers to a stage; clients may use a model of its own for each."""
    name_for = getattr(client, "name_for", None)
    return str(name_for(stage)) if name_for is not None else client.name
