# SPDX-License-Identifier: GPL-3.0-or-later
"""Which beginning the prompts of one wish share: a service that keeps beginnings is sent the language reference once."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace

from .models.base import Prompt

LEAST_BYTES = 3_600
"""Of a beginning that is worth keeping: services keep none of under 1024 tokens."""


def mark_shared(prompts: Sequence[Prompt]) -> list[Prompt]:
    """The same prompts, each with the length of the beginning that it shares with the others of its kind.

    Their text and hash stay as they are. A beginning ends between two paragraphs, and a prompt that stands alone has none.
    """
    together: dict[tuple[str, str], list[Prompt]] = {}
    for prompt in prompts:
        together.setdefault((prompt.stage, prompt.schema_name), []).append(prompt)
    lengths = {kind: _shared([prompt.text for prompt in alike]) for kind, alike in together.items()}
    return [replace(prompt, shared=lengths[prompt.stage, prompt.schema_name]) for prompt in prompts]


def _shared(texts: Sequence[str]) -> int:
    if len(texts) < 2:
        return 0
    common = os.path.commonprefix(list(texts))
    end = common.rfind("\n\n") + 2 if "\n\n" in common else common.rfind("\n") + 1
    return end if len(common[:end].encode()) >= LEAST_BYTES else 0
