# SPDX-License-Identifier: GPL-3.0-or-later
"""The journal: every answer of a model, on disk the moment it arrives, whatever becomes of Blender, its file and undo.

One file a picture, one JSON record a line, only ever appended to. A record is written with a line break before and
after it in one write and then synced, so that a record which a crash tore is skipped and harms no other, and two
Blenders may append to the same file. There is no picture, prompt, key or path in it.

What is kept is the text as it came over the wire, before anything judged it. A run that begins again is answered from
here first, so it goes through the same steps as before, up to the first question that was never answered.
"""

from __future__ import annotations

import contextlib
import json
import logging
import math
import os
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Protocol

from .memory import content_hash, now
from .models.base import ModelClient, Prompt, Reply, name_of

log = logging.getLogger(__name__)
SUFFIX = ".jsonl"
MOST_BYTES = 200_000_000
MOST_DAYS = 90.0
_IN_USE = 3600.0
"""A journal that was touched within so many seconds may be another Blender's, and is never pruned."""


@dataclass(frozen=True)
class KeptAnswer:
    """An answer as it arrived.

    Attributes:
        stage, key, repair: of the prompt; prompt_hash: its hash.
        client: name of the client that was asked; model: what answered.
        cost: US dollars, None when unknown. time: UTC, ISO 8601.
        inputs: hashes of what the stage was made from (`Run.inputs`).
    """

    stage: str
    key: str
    client: str
    prompt_hash: str
    text: str
    model: str = ""
    prompt_tokens: int = 0
    completion_tokens: int = 0
    cost: float | None = None
    seconds: float = 0.0
    time: str = ""
    notes: tuple[str, ...] = ()
    inputs: Mapping[str, str] = field(default_factory=dict)
    repair: bool = False


@dataclass(frozen=True)
class KeptReply(Reply):
    """A reply that was paid for earlier: nothing was sent for it now."""


class AnswerJournal(Protocol):
    """What a run needs of a journal. Any thread; nothing here raises because of the disk."""

    def keep(self, answer: KeptAnswer) -> None:
        """Keep an answer; when this returns it survives a crash."""
        ...

    def answer(self, prompt_hash: str, client: str) -> KeptAnswer | None:
        """This client's latest answer to the prompt with this hash, unless it turned out to be unusable."""
        ...

    def answers(self) -> Sequence[KeptAnswer]:
        """All of them, oldest first, one a prompt and client."""
        ...

    def refuse(self, stage: str, key: str, client: str, inputs: Mapping[str, str]) -> None:
        """The answers to this request, made from these inputs, stayed unusable: it is to be asked again."""
        ...

    def finish(self, stage: str, client: str, inputs: Mapping[str, str]) -> None:
        """All questions of this stage, made from these inputs, are answered."""
        ...

    def has_finished(self, stage: str, client: str, inputs: Mapping[str, str]) -> bool:
        """Whether that is so; a client of "" stands for any."""
        ...


class JournalledClient:
    """A client whose answers go to a journal as they arrive, and which is not asked again what the journal holds.

    Args:
        inputs: what the stage is made from, kept with each answer.
        fresh: ask even where the journal holds an answer (the artist's "redo").
    """

    def __init__(
        self, client: ModelClient, journal: AnswerJournal, inputs: Mapping[str, str], fresh: bool = False
    ) -> None:
        self._client, self._journal, self._inputs, self._fresh = client, journal, inputs, fresh
        self.name, self.describes = client.name, client.describes

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """As `ModelClient.answer`; a `KeptReply` when nothing was asked."""
        name = name_of(self._client, prompt.stage)
        kept = None if self._fresh else self._journal.answer(prompt.hash, name)
        if kept is not None:
            return KeptReply(
                text=kept.text,
                model=kept.model,
                prompt_tokens=kept.prompt_tokens,
                completion_tokens=kept.completion_tokens,
                cost=kept.cost,
                seconds=kept.seconds,
                notes=kept.notes,
            )
        reply = self._client.answer(prompt, cancel, progress)
        self._journal.keep(
            KeptAnswer(
                stage=prompt.stage,
                key=prompt.key,
                client=name,
                prompt_hash=prompt.hash,
                text=reply.text,
                model=reply.model,
                prompt_tokens=reply.prompt_tokens,
                completion_tokens=reply.completion_tokens,
                cost=reply.cost,
                seconds=round(reply.seconds, 3),
                time=now(),
                notes=reply.notes,
                inputs=self._inputs,
                repair=prompt.repair,
            )
        )
        return reply


class Journal:
    """An `AnswerJournal` in one file.

    A full or read-only disk never stops a run: what cannot be written is kept for as long as this object lives, tried
    again with the next answer, and `problem` says so.

    Args:
        path: the file; it need not exist.
        version: of this program. Answers of the built-in analysis, which are free, hold for this version only.

    Attributes:
        problem: why the last answer could not be written, in a few words, else "".
    """

    def __init__(self, path: Path, version: str = "") -> None:
        self.path, self.problem = path, ""
        self._version = version
        self._lock = threading.RLock()
        self._unwritten: list[dict[str, Any]] = []
        self._clear()

    def keep(self, answer: KeptAnswer) -> None:
        """As `AnswerJournal.keep`."""
        self._append({"is": "answer", "version": self._version, **asdict(answer)})

    def answer(self, prompt_hash: str, client: str) -> KeptAnswer | None:
        """As `AnswerJournal.answer`."""
        with self._lock:
            self._catch_up()
            return self._answers.get((prompt_hash, client))

    def answers(self) -> Sequence[KeptAnswer]:
        """As `AnswerJournal.answers`."""
        with self._lock:
            self._catch_up()
            return list(self._answers.values())

    def refuse(self, stage: str, key: str, client: str, inputs: Mapping[str, str]) -> None:
        """As `AnswerJournal.refuse`."""
        mark = {"stage": stage, "key": key, "client": client, "inputs": content_hash(inputs)}
        self._append({"is": "unusable", **mark})

    def finish(self, stage: str, client: str, inputs: Mapping[str, str]) -> None:
        """As `AnswerJournal.finish`."""
        if not self.has_finished(stage, client, inputs):
            mark = {"stage": stage, "client": client, "inputs": content_hash(inputs)}
            self._append({"is": "finished", "version": self._version, **mark})

    def has_finished(self, stage: str, client: str, inputs: Mapping[str, str]) -> bool:
        """As `AnswerJournal.has_finished`."""
        with self._lock:
            self._catch_up()
            clients = self._finished.get((stage, content_hash(inputs)), set())
            return bool(clients) if not client else client in clients

    def forget(self) -> None:
        """Delete the file and all that was read of it.

        Raises:
            OSError: it cannot be deleted.
        """
        with self._lock:
            self._unwritten.clear()
            self.path.unlink(missing_ok=True)
            self._clear()

    def _clear(self) -> None:
        self._offset, self._file = 0, (0, 0)
        self._answers: dict[tuple[str, str], KeptAnswer] = {}
        self._finished: dict[tuple[str, str], set[str]] = {}

    def _append(self, record: dict[str, Any]) -> None:
        """Write a record, and before it those that could not be written earlier."""
        with self._lock:
            self._unwritten.append(record)
            self._apply(record)
            try:
                while self._unwritten:
                    _write(self.path, self._unwritten[0])
                    self._unwritten.pop(0)
                self.problem = ""
            except OSError as error:
                self.problem = error.strerror or type(error).__name__
                log.warning("An answer could not be written to the journal: %s", self.problem)

    def _catch_up(self) -> None:
        """Read what this or another Blender has appended since."""
        try:
            with self.path.open("rb") as file:
                status = os.fstat(file.fileno())
                if (status.st_dev, status.st_ino) != self._file or status.st_size < self._offset:
                    self._begin_anew((status.st_dev, status.st_ino))
                if status.st_size == self._offset:
                    return
                file.seek(self._offset)
                data = file.read()
        except FileNotFoundError:
            if self._file != (0, 0):
                self._begin_anew((0, 0))
            return
        except OSError as error:
            self.problem = error.strerror or type(error).__name__
            return
        whole = data.rfind(b"\n") + 1
        self._offset += whole
        for line in data[:whole].splitlines():
            if line.strip():
                self._apply(_read(line))

    def _begin_anew(self, file: tuple[int, int]) -> None:
        """The file was deleted or replaced meanwhile; what could not be written is still known."""
        self._clear()
        self._file = file
        for record in self._unwritten:
            self._apply(record)

    def _apply(self, record: Mapping[str, Any]) -> None:
        """Take one record in. What is damaged or of a newer version is skipped."""
        kind = record.get("is")
        client = record.get("client")
        if client == "builtin" and record.get("version", self._version) != self._version:
            return
        with contextlib.suppress(KeyError, TypeError, ValueError, AttributeError):
            if kind == "answer":
                answer = _answer(record)
                name = (answer.prompt_hash, answer.client)
                self._answers.pop(name, None)
                self._answers[name] = answer
            elif kind == "unusable":
                asked = (record["stage"], record["key"], client, record["inputs"])
                for name, a in list(self._answers.items()):
                    if (a.stage, a.key, a.client, content_hash(a.inputs)) == asked:
                        del self._answers[name]
            elif kind == "finished":
                self._finished.setdefault((str(record["stage"]), str(record["inputs"])), set()).add(str(client))


def prune(folder: Path, keep: Path | None = None) -> list[Path]:
    """Delete journals that were not used for long, then the oldest until the rest is small enough.

    Args:
        keep: never delete this one.

    Returns:
        What was deleted. Nothing is raised: what cannot be deleted stays.
    """
    found: list[tuple[float, int, Path]] = []
    with contextlib.suppress(OSError):
        for path in folder.glob(f"*{SUFFIX}"):
            status = path.stat()
            found.append((status.st_mtime, status.st_size, path))
    present, total = time.time(), sum(size for _, size, _ in found)
    deleted = []
    for used, size, path in sorted(found):
        is_old = present - used > MOST_DAYS * 86_400
        if path == keep or present - used < _IN_USE or not (is_old or total > MOST_BYTES):
            continue
        with contextlib.suppress(OSError):
            path.unlink()
            total -= size
            deleted.append(path)
    return deleted


def _write(path: Path, record: Mapping[str, Any]) -> None:
    """Append one record in one write, and wait until it is on the disk.

    Raises:
        OSError: it was not written, or not whole.
    """
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    data = b"\n" + json.dumps(record, separators=(",", ":")).encode() + b"\n"
    handle = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o600)
    try:
        if os.write(handle, data) != len(data):
            raise OSError(28, "the disk is full")
        os.fsync(handle)
    finally:
        os.close(handle)


def _read(line: bytes) -> Mapping[str, Any]:
    try:
        record = json.loads(line)
    except (ValueError, RecursionError):
        return {}
    return record if isinstance(record, dict) else {}


def _answer(record: Mapping[str, Any]) -> KeptAnswer:
    """An answer from its record; raises KeyError, TypeError, ValueError or AttributeError when it is none."""
    cost = record.get("cost")
    names = ("stage", "key", "client", "prompt_hash", "text")
    if not all(isinstance(record[name], str) for name in names):
        raise TypeError
    return KeptAnswer(
        **{name: record[name] for name in names},
        model=str(record.get("model", "")),
        prompt_tokens=int(record.get("prompt_tokens", 0)),
        completion_tokens=int(record.get("completion_tokens", 0)),
        cost=None if cost is None else _number(cost),
        seconds=_number(record.get("seconds", 0.0)),
        time=str(record.get("time", "")),
        notes=tuple(str(note) for note in record.get("notes", ())),
        inputs={str(k): str(v) for k, v in record.get("inputs", {}).items()},
        repair=bool(record.get("repair", False)),
    )


def _number(value: Any) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise ValueError
    return number
