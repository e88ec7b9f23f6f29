# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps a model's answers in a folder and plays them back.

The folder holds `replies.json`: one entry a stage and request key, sorted, with the answer as JSON (so that it can be
read and edited), the hashes of the prompt that it answered, a small mark of each picture, the model and the time.
A prompt that has changed since is still answered, and the drift is reported in the reply's notes. An answer that is a plain
text is played in pieces, as a model would write it, where its entry says how fast (`characters_a_second`).
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import tempfile
import threading
import time
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from PIL import Image

from ..errors import Cancelled, ModelError, NotRecordedError, OutputError, ReplyError
from .base import ModelClient, Prompt, Reply, name_of
from .hearing import PAUSE, Hearing
from .readable_json import readable_json
from .tolerant import read_json

FILE_NAME = "replies.json"
FORMAT = "code-as-room/replies/1"
DRAFT = "s00_draft/"
_MARK_SIDE = 8
_MARK_MEAN, _MARK_MOST = 3.0, 20
"""How far two picture marks may differ, in grey levels, and still be the same picture encoded or rendered elsewhere."""


class RecordedClient:
    """Answers from a folder that `Recorder` wrote. Needs no network and no model.

    Raises:
        ModelError: the folder holds no readable recordings.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self._replies = load_replies(self.folder)
        models = sorted({str(entry.get("model", "")) for entry in self._replies.values()} - {""})
        # Memory recalls answers by this name, and another folder's answers are others.
        digest = hashlib.sha256(json.dumps(self._replies, sort_keys=True).encode()).hexdigest()
        self.name = f"recorded:{digest[:8]}"
        self.describes = f"Recorded answers from {self.folder.name!r} (made by {', '.join(models) or 'unknown'})"

    @property
    def has_draft(self) -> bool:
        """Whether a room written in one answer is among the answers."""
        return any(key.startswith(DRAFT) for key in self._replies)

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Play back the answer kept under the prompt's stage and key.

        Raises:
            ModelError: nothing is recorded for it.
            ReplyError: it is asked for a second time because the recorded answer does not fit any more.
            Cancelled: `cancel` was set.
        """
        if cancel.is_set():
            raise Cancelled
        key = reply_key(prompt)
        entry = self._replies.get(key)
        if entry is None:
            raise NotRecordedError(
                f"No answer is recorded for {key!r} in {self.folder.name!r}.",
                "Record it with a model, or choose the built-in analysis.",
            )
        if prompt.repair:
            raise ReplyError(
                f"The recorded answer for {key!r} does not fit what is asked now.", "Record it again with a model."
            )
        text = _text(entry)
        _play(text, entry, prompt, cancel)
        return Reply(
            text=text,
            model=str(entry.get("model", "recorded")),
            prompt_tokens=_count(entry.get("prompt_tokens")),
            completion_tokens=_count(entry.get("completion_tokens")),
            notes=_drift(key, entry, prompt),
        )


class Recorder:
    """Wraps a client and keeps each of its answers in a folder.

    A later answer to the same key replaces the earlier one, so a repair round's answer is the one that stays; an
    answer without readable JSON never replaces one that has it. Safe to call from several threads.
    """

    def __init__(self, client: ModelClient, folder: str | Path) -> None:
        self.inner = client
        self.folder = Path(folder)
        self.name = client.name
        self.describes = f"{client.describes}, recorded into {self.folder.name!r}"
        self._lock = threading.Lock()

    def name_for(self, stage: str) -> str:
        """The name of who answers a stage."""
        return name_of(self.inner, stage)

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Answer with the wrapped client and keep what it said.

        Raises:
            OutputError: the recording cannot be written. Otherwise as the wrapped client.
        """
        reply = self.inner.answer(prompt, cancel, progress)
        entry = _entry(prompt, reply)
        with self._lock:
            replies = load_replies(self.folder) if (self.folder / FILE_NAME).exists() else {}
            earlier = replies.get(reply_key(prompt))
            if earlier is not None and "text" in entry and "reply" in earlier:
                return reply
            if earlier is not None and prompt.repair:
                # A repair prompt quotes the first answer; drift is measured against the prompt as first asked.
                for name in ("prompt_hash", "text_hash", "pictures"):
                    entry[name] = earlier.get(name, entry[name])
            replies[reply_key(prompt)] = entry
            save_replies(self.folder, replies)
        return reply


def reply_key(prompt: Prompt) -> str:
    """What a prompt's answer is kept under: stage and request key."""
    return f"{prompt.stage}/{prompt.key}"


def load_replies(folder: Path) -> dict[str, dict[str, Any]]:
    """The recordings of a folder by key.

    Raises:
        ModelError: there are none, or the file is not what this version can read.
    """
    path = folder / FILE_NAME
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError:
        raise ModelError(f"There are no recorded answers in {folder.name!r}.", "Choose another folder.") from None
    except (ValueError, RecursionError):
        raise ModelError(f"The recorded answers in {folder.name!r} are not readable JSON.", "Record again.") from None
    replies = data.get("replies") if isinstance(data, dict) and data.get("format") == FORMAT else None
    if not isinstance(replies, dict) or not all(isinstance(entry, dict) for entry in replies.values()):
        raise ModelError(f"The recorded answers in {folder.name!r} are of another format.", "Record again.")
    return replies


def save_replies(folder: Path, replies: Mapping[str, Mapping[str, Any]]) -> None:
    """Write all recordings of a folder in one step, sorted by key.

    Raises:
        OutputError: the folder cannot be written.
    """
    text = readable_json({"format": FORMAT, "replies": {key: replies[key] for key in sorted(replies)}}) + "\n"
    temporary = ""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=folder, prefix=".replies-", suffix=".tmp")
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
        # mkstemp makes private files; a recording is an ordinary one.
        os.chmod(temporary, 0o644)
        os.replace(temporary, folder / FILE_NAME)
    except OSError as error:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        reason = error.strerror or "unknown reason"
        raise OutputError(
            f"The answers cannot be recorded in {folder.name!r}: {reason}.", "Choose another folder."
        ) from None


def _entry(prompt: Prompt, reply: Reply) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "made": datetime.now(UTC).replace(microsecond=0).isoformat(),
        "model": reply.model,
        "prompt_hash": prompt.hash,
        "text_hash": _text_hash(prompt),
        "pictures": [_mark(image) for image in prompt.images],
        "prompt_tokens": reply.prompt_tokens,
        "completion_tokens": reply.completion_tokens,
    }
    try:
        entry["text" if prompt.plain else "reply"] = reply.text if prompt.plain else read_json(reply.text)
    except ReplyError:
        entry["text"] = reply.text
    return entry


def _play(text: str, entry: Mapping[str, Any], prompt: Prompt, cancel: threading.Event) -> None:
    """Let the answer be heard, in pieces where the recording says so. Raises Cancelled."""
    hearing, pace = Hearing(prompt), entry.get("characters_a_second")
    if prompt.hear is not None and isinstance(pace, (int, float)) and pace > 0:
        began = time.monotonic()
        while (end := int(pace * (time.monotonic() - began))) < len(text):
            if cancel.wait(PAUSE / 2):
                raise Cancelled
            hearing.so_far(lambda end=end: text[:end])  # type: ignore[misc]
    hearing.whole(text)


def _text(entry: Mapping[str, Any]) -> str:
    if "reply" in entry:
        return json.dumps(entry["reply"], ensure_ascii=False)
    return str(entry.get("text", ""))


def _count(value: Any) -> int:
    return value if isinstance(value, int) and value >= 0 else 0


def _text_hash(prompt: Prompt) -> str:
    return hashlib.sha256(f"{prompt.schema_name}\n{prompt.text}".encode()).hexdigest()


def _drift(key: str, entry: Mapping[str, Any], prompt: Prompt) -> tuple[str, ...]:
    """Sentences on how the prompt differs from the one that was answered."""
    if entry.get("prompt_hash") == prompt.hash:
        return ()
    made = str(entry.get("made", ""))[:10] or "an unknown day"
    notes = []
    if entry.get("text_hash") != _text_hash(prompt):
        notes.append(f"The words of the prompt {key!r} have changed since it was answered on {made}.")
    marks = entry.get("pictures")
    kept = marks if isinstance(marks, list) else []
    now = [_mark(image) for image in prompt.images]
    differing = [i + 1 for i, mark in enumerate(now) if i >= len(kept) or not _same_mark(str(kept[i]), mark)]
    if differing or len(kept) != len(now):
        which = ", ".join(map(str, differing)) or "number"
        notes.append(f"The pictures of the prompt {key!r} ({which}) have changed since it was answered on {made}.")
    return tuple(notes)


def _mark(image: bytes) -> str:
    """64 grey levels of the picture in hexadecimal: enough to tell another picture from another encoding."""
    try:
        with Image.open(io.BytesIO(image)) as opened:
            small = opened.convert("L").resize((_MARK_SIDE, _MARK_SIDE), Image.Resampling.BOX)
    except (OSError, ValueError, SyntaxError):
        return hashlib.sha256(image).hexdigest()
    return small.tobytes().hex()


def _same_mark(one: str, other: str) -> bool:
    if one == other:
        return True
    try:
        first, second = bytes.fromhex(one), bytes.fromhex(other)
    except ValueError:
        return False
    if len(first) != len(second) or len(first) != _MARK_SIDE**2:
        return False
    differences = [abs(a - b) for a, b in zip(first, second, strict=True)]
    return sum(differences) / len(differences) <= _MARK_MEAN and max(differences) <= _MARK_MOST
