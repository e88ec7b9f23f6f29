# SPDX-License-Identifier: GPL-3.0-or-later
"""What is marked as an asset in a .blend file, with its tags, description and size, read without Blender.

Blender lists names only, and gives an asset's tags only once the asset with all its meshes is loaded, on the main
thread. A .blend file describes its own structures, so what an asset browser shows can be read off it in any thread:
blocks that are not about assets are passed over. Nothing in the file is ever run.
"""

from __future__ import annotations

import struct
import uuid
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from .blend_stream import DATA, BlendError, BlendStream, Block

Kind = Literal["object", "collection"]
_KINDS: dict[bytes, Kind] = {b"OB\0\0": "object", b"GR\0\0": "collection"}
_MOST_BYTES = 1 << 18
"""A block that is larger is none of an asset's words."""
_MOST_BLOCKS = 4000
_MOST_TAGS = 64
_ARRAY, _FLOAT, _DOUBLE = 5, 2, 8
__all__ = ["BlendError", "FoundAsset", "Kind", "read_assets"]


@dataclass(frozen=True)
class FoundAsset:
    """One marked datablock.

    Attributes:
        catalog: id of its catalogue, "" for none.
        size: width, depth, height in metres as Blender noted them when the file was saved; None where it did not.
    """

    kind: Kind
    name: str
    tags: tuple[str, ...] = ()
    description: str = ""
    catalog: str = ""
    author: str = ""
    licence: str = ""
    size: tuple[float, float, float] | None = None


def read_assets(path: Path, newest: tuple[int, int]) -> list[FoundAsset]:
    """The objects and collections of a file that are marked as assets; any thread.

    Args:
        newest: the Blender version (major, minor) that is running; files of newer ones are refused.

    Raises:
        BlendError: the file is none, is cut off, or is of a newer or too old Blender; its text is one plain sentence.
    """
    try:
        with BlendStream(path, newest) as stream:
            layout = stream.structures()
        with BlendStream(path, newest) as stream:
            return _Reader(stream, layout).read()
    except BlendError:
        raise
    except OSError as error:
        raise BlendError(f"it cannot be opened ({error.strerror or 'no access'})") from error
    except Exception as error:  # whatever nonsense the bytes are
        raise BlendError("it is damaged") from error


class _Reader:
    """Goes through a file's blocks once."""

    def __init__(self, stream: BlendStream, layout: Any) -> None:
        self.stream, self.layout = stream, layout
        self.name_at, self.name_length = layout.field("ID", "name")
        self.data_at, _ = layout.field("ID", "asset_data")

    def read(self) -> list[FoundAsset]:
        found: list[FoundAsset] = []
        block = self.stream.next_block()
        while block is not None:
            kind = _KINDS.get(block.code)
            if kind is None:
                block = self.stream.next_block()
                continue
            head = self.stream.read(min(block.length, self.layout.size("ID")))
            pointer = struct.unpack_from("<Q", head, self.data_at)[0]
            name = _text(head[self.name_at : self.name_at + self.name_length])[
                2:
            ]  # without the two letters of its type
            if not pointer:
                block = self.stream.next_block()
                continue
            own, block = self._own_blocks()
            found.append(self._asset(kind, name, own, pointer))
        return found

    def _own_blocks(self) -> tuple[dict[int, tuple[Block, bytes]], Block | None]:
        """The data blocks that follow a datablock belong to it; and the block after them."""
        own: dict[int, tuple[Block, bytes]] = {}
        block = self.stream.next_block()
        while block is not None and block.code == DATA:
            if block.length <= _MOST_BYTES and len(own) < _MOST_BLOCKS:
                own[block.pointer] = (block, self.stream.read(block.length))
            block = self.stream.next_block()
        return own, block

    def _asset(self, kind: Kind, name: str, own: dict[int, tuple[Block, bytes]], pointer: int) -> FoundAsset:
        if pointer not in own:
            return FoundAsset(kind, name)
        meta = own[pointer][1]
        return FoundAsset(
            kind,
            name,
            self._tags(meta, own),
            self._string(meta, "description", own),
            self._catalog(meta),
            self._string(meta, "author", own),
            self._string(meta, "license", own),
            self._size(meta, own),
        )

    def _pointer(self, data: bytes, owner: str, name: str, extra: int = 0) -> int:
        at = self.layout.field(owner, name)[0] + extra
        return int(struct.unpack_from("<Q", data, at)[0])

    def _string(self, meta: bytes, name: str, own: dict[int, tuple[Block, bytes]]) -> str:
        if not self.layout.has("AssetMetaData", name):
            return ""
        found = own.get(self._pointer(meta, "AssetMetaData", name))
        return _text(found[1]) if found is not None else ""

    def _catalog(self, meta: bytes) -> str:
        at, length = self.layout.field("AssetMetaData", "catalog_id")
        low, mid, high, a, b, *node = struct.unpack_from("<IHHBB6B", meta, at)
        value = uuid.UUID(fields=(low, mid, high, a, b, int.from_bytes(bytes(node), "big")))
        return str(value) if value.int and length else ""

    def _tags(self, meta: bytes, own: dict[int, tuple[Block, bytes]]) -> tuple[str, ...]:
        tags: list[str] = []
        at, length = self.layout.field("AssetTag", "name")
        pointer = self._pointer(meta, "AssetMetaData", "tags")
        while pointer in own and len(tags) < _MOST_TAGS:
            data = own[pointer][1]
            tags.append(_text(data[at : at + length]))
            pointer = self._pointer(data, "AssetTag", "next")
        return tuple(tag for tag in tags if tag)

    def _size(self, meta: bytes, own: dict[int, tuple[Block, bytes]]) -> tuple[float, float, float] | None:
        """Blender writes an object's dimensions among the asset's custom properties whenever the file is saved."""
        group = own.get(self._pointer(meta, "AssetMetaData", "properties"))
        if group is None:
            return None
        inner = self.layout.field("IDPropertyData", "group")[0]
        pointer = self._pointer(group[1], "IDProperty", "data", inner)
        name_at, name_length = self.layout.field("IDProperty", "name")
        for _ in range(_MOST_TAGS):
            if pointer not in own:
                return None
            data = own[pointer][1]
            if _text(data[name_at : name_at + name_length]) == "dimensions":
                return self._numbers(data, own)
            pointer = self._pointer(data, "IDProperty", "next")
        return None

    def _numbers(self, data: bytes, own: dict[int, tuple[Block, bytes]]) -> tuple[float, float, float] | None:
        kind, inner = (data[self.layout.field("IDProperty", name)[0]] for name in ("type", "subtype"))
        values = own.get(self._pointer(data, "IDProperty", "data"))
        form = {_FLOAT: "<3f", _DOUBLE: "<3d"}.get(inner)
        if kind != _ARRAY or form is None or values is None or len(values[1]) < struct.calcsize(form):
            return None
        x, y, z = struct.unpack_from(form, values[1])
        size = (float(x), float(y), float(z))
        return size if all(0 <= v < 1e7 for v in size) and max(size) > 0 else None


def _text(data: bytes) -> str:
    return " ".join(data.split(b"\0", 1)[0].decode("utf-8", "replace").split())
