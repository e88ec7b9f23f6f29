# SPDX-License-Identifier: GPL-3.0-or-later
"""From a stage's request to the prompt that a client is handed: template, values, schema, hash."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.resources import files

from .artifacts.replies import PlainReply
from .errors import RoomError
from .models.base import Prompt
from .models.schema import strict_schema
from .stages.wishes import Request

PROMPT_LIMIT = 40_000
"""Most bytes of prompt text a call; longer prompts are sent, and reported."""
_PLACE = re.compile(r"\{\{\s*([A-Za-z_][A-Za-z0-9_]*)\s*\}\}")
_LEADING_COMMENT = re.compile(r"\A\s*<!--.*?-->\s*", re.DOTALL)


def load_template(name: str) -> str:
    """The text of `prompts/NAME.md`, without a leading comment. Works wherever the package is installed.

    Raises:
        RoomError: there is no such template.
    """
    root = (__package__ or "").rpartition(".")[0]
    if not re.fullmatch(r"[A-Za-z0-9_]+", name):
        raise RoomError(f"{name!r} is not a prompt's name.", "Install the add-on again.")
    try:
        text = files(f"{root}.prompts").joinpath(f"{name}.md").read_text(encoding="utf-8")
    except (OSError, ModuleNotFoundError):
        raise RoomError(f"The prompt {name!r} is missing from the add-on.", "Install the add-on again.") from None
    return _LEADING_COMMENT.sub("", text)


def fill_template(template: str, values: Mapping[str, str]) -> str:
    """Put values into the `{{name}}` places; what stands in a value is never filled again.

    Raises:
        RoomError: a place without a value, or a value without a place.
    """
    wanted = set(_PLACE.findall(template))
    missing, unused = sorted(wanted - set(values)), sorted(set(values) - wanted)
    if missing:
        raise RoomError(f"The prompt has no value for {', '.join(missing)}.", "Install the add-on again.")
    if unused:
        raise RoomError(f"The prompt has no place for {', '.join(unused)}.", "Install the add-on again.")
    return _PLACE.sub(lambda match: values[match.group(1)], template)


def prompt_hash(text: str, images: Sequence[bytes], schema_name: str) -> str:
    """sha256, hexadecimal, over a prompt's text, its pictures and the name of its answer's schema."""
    digest = hashlib.sha256()
    for part in (text.encode(), schema_name.encode(), *images):
        digest.update(len(part).to_bytes(8, "big"))
        digest.update(part)
    return digest.hexdigest()


def make_prompt(request: Request, stage: str) -> Prompt:
    """The prompt for a request.

    Raises:
        RoomError: the template is missing or does not fit the values.
    """
    text = fill_template(load_template(request.prompt), request.values)
    images = tuple(picture.data for picture in request.images)
    name, plain = request.reply.__name__, issubclass(request.reply, PlainReply)
    return Prompt(
        stage=stage,
        key=request.key,
        text=text,
        images=images,
        schema_name=name,
        schema={} if plain else strict_schema(request.reply),
        hash=prompt_hash(text, images, name),
        facts=request.facts,
        plain=plain,
    )


def repair_prompt(prompt: Prompt, problems: Sequence[str], answer: str) -> Prompt:
    """The second try: the same prompt with the earlier answer (as much as fits) and what is wrong with it."""
    lines = "\n".join(f"- {problem}" for problem in problems)
    head = f"{prompt.text}\n\n---\nYour earlier answer to this could not be used:\n{lines}\n"
    shape = "" if prompt.plain else " as one JSON object,"
    tail = f"\nAnswer again in full,{shape} with these points mended and everything else kept."
    room = max(4_000, PROMPT_LIMIT - len(head.encode()) - len(tail.encode()) - 100)
    kept = answer.encode()[:room].decode("utf-8", "ignore")
    quoted = ""
    if kept.strip():
        shortened = " (its beginning)" if len(kept) < len(answer) else ""
        quoted = f"\nThe earlier answer{shortened}:\n{kept}\n"
    text = head + quoted + tail
    return replace(prompt, text=text, hash=prompt_hash(text, prompt.images, prompt.schema_name), repair=True)
