# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory: what stages wrote, in one JSON text that lives in the .blend.

Entries are only ever appended; the latest entry of a type is the current one. Every entry keeps the hashes of what it
was made from, so that an edit upstream marks what depends on it as stale. The text has short lines (Blender's text
datablocks are quadratic in line length), and holds no key and no absolute path. (Paper: layered memory.)
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from .artifacts.analysis import Calibration, SceneAnalysis
from .artifacts.assets import ChosenAssets
from .artifacts.common import Artifact
from .artifacts.correction import CorrectionReport
from .artifacts.corrections import Corrections, Found, Rescaled
from .artifacts.draft import DraftProgram
from .artifacts.graph import MinorObjects, SceneGraph
from .artifacts.hand import HandEdits
from .artifacts.layout import LayoutProgram
from .artifacts.light import LightPlan
from .artifacts.materials import Materials, OwnFinishes
from .artifacts.objects import Descriptions, Geometry, OwnModelling, RoomStyle
from .artifacts.textures import TextureChoices, Textures
from .errors import MemoryFormatError

FORMAT = "code-as-room/memory/1"
KINDS: dict[str, type[Artifact]] = {
    kind.__name__: kind
    for kind in (
        DraftProgram,
        SceneAnalysis,
        Calibration,
        SceneGraph,
        MinorObjects,
        LayoutProgram,
        HandEdits,
        Corrections,
        Found,
        Rescaled,
        Descriptions,
        RoomStyle,
        Geometry,
        OwnModelling,
        ChosenAssets,
        Materials,
        OwnFinishes,
        Textures,
        TextureChoices,
        LightPlan,
        CorrectionReport,
    )
}
_CHUNK = 160
_TEXT = "~text"
A = TypeVar("A", bound=BaseModel)


class EntryMeta(Artifact):
    """How an entry came about. `client` is what was asked, `model` what answered; `inputs` maps what was read to its
    hash; `cost` is in US dollars. Of an answer: bytes of prompt text and calls in all tries, and which of the stage's
    rounds it was asked in, from 1; what is asked side by side shares a round."""

    time: str
    client: str = ""
    model: str = ""
    prompt_tokens: int = 0
    completion_tokens: int = 0
    cost: float | None = None
    seconds: float = 0.0
    prompt_hash: str = ""
    prompt_bytes: int = 0
    tries: int = 1
    round: int = 0
    inputs: dict[str, str] = {}
    notes: list[str] = []


class Entry(Artifact):
    """One thing that was written to memory, never changed afterwards."""

    stage: str
    type: str
    output: dict[str, Any]
    meta: EntryMeta

    @cached_property
    def text(self) -> str:
        """The entry as it stands in the memory's text. Kept, since the whole text is written again with every answer."""
        return json.dumps(_fold(self.model_dump(mode="json")), indent=1, ensure_ascii=False, allow_nan=False)


@dataclass
class Memory:
    """All entries of one room, and the picture they are about.

    Attributes:
        picture_name, picture_hash: the reference image's file name (no folder) and the sha256 of its normalised bytes.
        settings: what the artist fixed ("known_width_m": "4.2", "wall_height_m": ...), part of every stage's inputs.
    """

    picture_name: str = ""
    picture_hash: str = ""
    settings: dict[str, str] = field(default_factory=dict)
    entries: list[Entry] = field(default_factory=list)

    def append(self, stage: str, artifact: BaseModel, meta: EntryMeta) -> None:
        """Write one artifact; the type's name is its key."""
        output = artifact.model_dump(mode="json")
        self.entries.append(Entry(stage=stage, type=type(artifact).__name__, output=output, meta=meta))

    def latest_entry(self, kind: str, stages: Iterable[str] | None = None) -> Entry | None:
        """The current entry of this type, optionally only among those that the given stages wrote."""
        wanted = None if stages is None else set(stages)
        for entry in reversed(self.entries):
            if entry.type == kind and (wanted is None or entry.stage in wanted):
                return entry
        return None

    def latest(self, kind: type[A], stages: Iterable[str] | None = None) -> A | None:
        """The current artifact of this type, or None."""
        entry = self.latest_entry(kind.__name__, stages)
        return None if entry is None else kind.model_validate(entry.output)

    def answer(self, prompt_hash: str, client: str) -> Entry | None:
        """This client's kept answer to a prompt with this hash, so that nothing is paid for twice."""
        for entry in reversed(self.entries):
            if entry.type == "Answer" and entry.meta.prompt_hash == prompt_hash and entry.meta.client == client:
                return entry
        return None

    def keep_answer(self, stage: str, key: str, text: str, meta: EntryMeta) -> None:
        """Keep a model's answer the moment it arrives."""
        self.entries.append(Entry(stage=stage, type="Answer", output={"key": key, "text": text}, meta=meta))

    def hash_of(self, kind: str, stages: Iterable[str] | None = None) -> str:
        """Hash of the current artifact of this type, "" when there is none."""
        entry = self.latest_entry(kind, stages)
        return "" if entry is None else content_hash(entry.output)

    def cost(self) -> tuple[int, int, float]:
        """Prompt tokens, completion tokens and known cost in US dollars over all answers."""
        metas = [entry.meta for entry in self.entries if entry.type == "Answer"]
        return (
            sum(m.prompt_tokens for m in metas),
            sum(m.completion_tokens for m in metas),
            sum(m.cost or 0.0 for m in metas),
        )


def content_hash(value: Any) -> str:
    """Short sha256 of JSON-like data, independent of the order of keys."""
    text = json.dumps(value, sort_keys=True, ensure_ascii=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:20]


def now() -> str:
    """The present time in UTC, ISO 8601, whole seconds."""
    return datetime.now(UTC).replace(microsecond=0).isoformat()


def dump_memory(memory: Memory) -> str:
    """The memory as JSON text with short lines; `load_memory` reads it back to an equal memory."""
    data = {
        "format": FORMAT,
        "picture": {"name": memory.picture_name, "hash": memory.picture_hash},
        "settings": memory.settings,
        "entries": [],
    }
    text = json.dumps(_fold(data), indent=1, ensure_ascii=False, allow_nan=False)
    if memory.entries:
        entries = ",\n".join(entry.text for entry in tuple(memory.entries)).replace("\n", "\n  ")
        text = text.removesuffix("[]\n}") + f"[\n  {entries}\n ]\n}}"
    return text + "\n"


def load_memory(text: str) -> Memory:
    """Read a memory text.

    Raises:
        MemoryFormatError: says at which line and column the JSON broke, or which entry does not fit. The caller keeps
            the text as it is.
    """
    if not text.strip():
        return Memory()
    try:
        data = json.loads(text, parse_constant=_refuse_constant)
    except json.JSONDecodeError as error:
        raise MemoryFormatError(
            f"The memory text is broken at line {error.lineno}, column {error.colno}: {error.msg}.",
            "Mend it there, or undo the edit; nothing was changed.",
        ) from error
    except (ValueError, RecursionError) as error:
        raise MemoryFormatError(f"The memory text cannot be read: {error}.", "Undo the edit.") from error
    return _memory_from(data)


def _memory_from(data: Any) -> Memory:
    if not isinstance(data, Mapping) or data.get("format") != FORMAT:
        found = data.get("format") if isinstance(data, Mapping) else None
        if _is_newer(found):
            raise MemoryFormatError(
                "This room was made with a newer version of Code-as-Room.",
                "Install that version to go on; nothing was changed.",
            )
        raise MemoryFormatError(
            f"The memory text has the format {found!r}; this version reads {FORMAT!r}.",
            "Open the file with the version of Code-as-Room that wrote it.",
        )
    try:
        data = _unfold(data)
        entries = [Entry.model_validate(item) for item in data.get("entries", [])]
        for entry in entries:
            if entry.type in KINDS:
                KINDS[entry.type].model_validate(entry.output)
        picture = data.get("picture", {})
        settings = {str(k): str(v) for k, v in data.get("settings", {}).items()}
        return Memory(str(picture.get("name", "")), str(picture.get("hash", "")), settings, entries)
    except (ValidationError, AttributeError, TypeError) as error:
        first = error.errors()[0] if isinstance(error, ValidationError) else {"loc": (), "msg": str(error)}
        place = ".".join(str(part) for part in first["loc"])
        raise MemoryFormatError(
            f"The memory text has an entry that does not fit: {place} {first['msg']}.", "Undo the edit."
        ) from error


def _is_newer(found: Any) -> bool:
    """Whether a memory's format is one that a later version writes."""
    family, _, number = FORMAT.rpartition("/")
    given, _, count = str(found).rpartition("/")
    return given == family and count.isascii() and count.isdigit() and int(count[:9]) > int(number)


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number that can be used")


def _fold(value: Any) -> Any:
    """Long or multi-line strings as a list of short pieces, so that no line of the text is long."""
    if isinstance(value, str) and (len(value) > _CHUNK or "\n" in value):
        pieces = [line[i : i + _CHUNK] for line in value.splitlines(keepends=True) for i in range(0, len(line), _CHUNK)]
        return {_TEXT: pieces}
    if isinstance(value, Mapping):
        return {key: _fold(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_fold(item) for item in value]
    return value


def _unfold(value: Any) -> Any:
    if isinstance(value, Mapping):
        if set(value) == {_TEXT}:
            return "".join(value[_TEXT])
        return {key: _unfold(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_unfold(item) for item in value]
    return value
