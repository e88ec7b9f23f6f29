# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks of a .blend file, plain or compressed, and its own description of its structures."""

from __future__ import annotations

import gzip
import importlib
import re
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

DATA = b"DATA"
_ZSTD, _GZIP = b"\x28\xb5\x2f\xfd", b"\x1f\x8b"
_STEP = 1 << 20
_LARGEST = 1 << 40
_HEADER = re.compile(rb"BLENDER(?:([-_])([vV])(\d{3})|17-(\d\d)v(\d{4}))")


class BlendError(Exception):
    """A .blend file cannot be read; its text goes on from "It is left out, since"."""


@dataclass(frozen=True)
class Block:
    """One block: its code, length in bytes, address when it was saved, and number of its structure."""

    code: bytes
    length: int
    pointer: int
    structure: int


class Structures:
    """Where the fields of a file's structures are."""

    def __init__(self, data: bytes) -> None:
        at = _expect(data, 0, b"SDNA")
        at = _expect(data, at, b"NAME")
        names, at = _strings(data, at)
        at = _expect(data, _aligned(at), b"TYPE")
        types, at = _strings(data, at)
        at = _expect(data, _aligned(at), b"TLEN")
        lengths = struct.unpack_from(f"<{len(types)}H", data, at)
        at = _expect(data, _aligned(at + 2 * len(types)), b"STRC")
        (count,) = struct.unpack_from("<I", data, at)
        at += 4
        self._sizes = dict(zip(types, lengths, strict=True))
        self._fields: dict[str, dict[str, tuple[int, int]]] = {}
        for _ in range(count):
            kind, number = struct.unpack_from("<HH", data, at)
            pairs = struct.unpack_from(f"<{2 * number}H", data, at + 4)
            at += 4 + 4 * number
            offset, fields = 0, {}
            for type_index, name_index in zip(pairs[::2], pairs[1::2], strict=True):
                name = names[name_index]
                size = 8 if name[0] in "*(" else lengths[type_index]
                for repeat in re.findall(r"\[(\d+)\]", name):
                    size *= int(repeat)
                fields[re.sub(r"\[.*|[*()]", "", name)] = (offset, size)
                offset += size
            self._fields[types[kind]] = fields

    def field(self, owner: str, name: str) -> tuple[int, int]:
        """Offset and length in bytes of a structure's field; KeyError when there is none."""
        return self._fields[owner][name]

    def has(self, owner: str, name: str) -> bool:
        """Whether a structure has a field."""
        return name in self._fields.get(owner, {})

    def size(self, owner: str) -> int:
        """Bytes of a structure."""
        return int(self._sizes[owner])


class BlendStream:
    """Reads a .blend file block by block; a context manager.

    Raises:
        BlendError: when opened or read, see there.
        OSError: the file cannot be opened.
    """

    def __init__(self, path: Path, newest: tuple[int, int]) -> None:
        self._raw: Any = path.open("rb")
        try:
            self._file = self._opened()
            self._rest = 0
            self._is_large = self._begin(newest)
        except BaseException:
            self._raw.close()
            raise

    def __enter__(self) -> BlendStream:
        return self

    def __exit__(self, *_: Any) -> None:
        self._raw.close()

    def next_block(self) -> Block | None:
        """The next block, None behind the last. What was not read of the one before is passed over."""
        self._skip(self._rest)
        head = self._exactly(32 if self._is_large else 24)
        if self._is_large:
            code, structure, pointer, length, _ = struct.unpack("<4siQqq", head)
        else:
            code, length, pointer, structure, _ = struct.unpack("<4siQii", head)
        if code == b"ENDB":
            return None
        if not 0 <= length < _LARGEST:
            raise BlendError("it is damaged")
        self._rest = length
        return Block(code, length, pointer, structure)

    def read(self, count: int) -> bytes:
        """So many bytes of the present block."""
        data = self._exactly(min(count, self._rest))
        self._rest -= len(data)
        return data

    def structures(self) -> Structures:
        """The file's description of its structures."""
        block = self.next_block()
        while block is not None:
            if block.code == b"DNA1":
                return Structures(self.read(block.length))
            block = self.next_block()
        raise BlendError("it is damaged")

    def _opened(self) -> Any:
        start = self._raw.read(4)
        self._raw.seek(0)
        if start == _ZSTD:
            return _unpacker()(self._raw)
        return gzip.GzipFile(fileobj=self._raw) if start[:2] == _GZIP else self._raw

    def _begin(self, newest: tuple[int, int]) -> bool:
        """Read the header; whether the blocks' heads are those of Blender 5."""
        head = self._file.read(12)
        if head[:7] != b"BLENDER":
            raise BlendError("it is no .blend file" if head else "it is empty")
        if head[7:9] == b"17":
            head += self._exactly(5)
        match = _HEADER.match(head)
        if match is None:
            raise BlendError("it is of a newer Blender, or damaged")
        pointers, order, old, form, new = match.groups()
        if old is not None and (pointers == b"_" or order == b"V"):
            raise BlendError("it is of a Blender that is too old; save it again with a present one")
        digits = int(old or new)
        version = (digits // 100, digits % 100)
        if version > newest or (form is not None and form != b"01"):
            raise BlendError(f"it was saved with Blender {version[0]}.{version[1]}, which is newer than this one")
        return new is not None

    def _exactly(self, count: int) -> bytes:
        parts: list[bytes] = []
        while count > 0:
            part = self._file.read(min(count, _STEP))
            if not part:
                raise BlendError("it is cut off")
            parts.append(part)
            count -= len(part)
        return b"".join(parts)

    def _skip(self, count: int) -> None:
        if self._file is self._raw:
            self._raw.seek(count, 1)
            return
        while count > 0:
            part = self._file.read(min(count, _STEP))
            if not part:
                raise BlendError("it is cut off")
            count -= len(part)


def _unpacker() -> Callable[[Any], Any]:
    """What unpacks Zstandard: Blender's own copy of that package, or Python's from 3.14.

    Both are optional and neither is a dependency of ours, so they are looked for by name.
    """
    try:
        package: Any = importlib.import_module("zstandard")
        return lambda raw: package.ZstdDecompressor().stream_reader(raw, read_across_frames=True, closefd=False)
    except ImportError:
        pass
    try:
        standard: Any = importlib.import_module("compression.zstd")
        return lambda raw: standard.ZstdFile(raw)
    except ImportError as error:
        raise BlendError("it is compressed and nothing here unpacks it; save it without Compress") from error


def _expect(data: bytes, at: int, word: bytes) -> int:
    if data[at : at + 4] != word:
        raise BlendError("it is damaged")
    return at + 4


def _strings(data: bytes, at: int) -> tuple[list[str], int]:
    (count,) = struct.unpack_from("<I", data, at)
    at += 4
    found = []
    for _ in range(count):
        end = data.index(b"\0", at)
        found.append(data[at:end].decode("ascii"))
        at = end + 1
    return found, at


def _aligned(at: int) -> int:
    return (at + 3) & ~3
