# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers that are a plain text, such as a program."""

from __future__ import annotations

from .artifacts.replies import PlainReply
from .errors import ReplyError

_OPEN, _CLOSE = "<think>", "</think>"


def plain_reply(text: str) -> PlainReply:
    """A model's answer as it is.

    Raises:
        ReplyError: it is empty.
    """
    text = without_thoughts(text)
    if not text.strip():
        raise ReplyError("The model's answer is empty.", "Try again.", ("The answer was empty.",))
    return PlainReply(text=text)


def without_thoughts(text: str) -> str:
    """A text without a reasoning model's thoughts, which some services leave before it, ended or not yet."""
    return text.partition(_CLOSE)[2] if text.lstrip().startswith(_OPEN) else text
