# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's memory and reference image, parsed once for as long as they do not change.

Parsing a memory takes tens of milliseconds, and the panel, the handlers and every correction need it. The text is the
key: whoever changed it (a stage, an undo, a load, the artist) is noticed, and an undo that is redone finds its memory
again. What is kept here is shared, so it is never changed: `run_of` works on a copy.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import replace
from typing import Any

from ..pipeline.memory import Memory, dump_memory, load_memory
from ..pipeline.picture import ReferencePicture
from ..pipeline.run import Run
from ..pipeline.scene.ownership import check_own
from ..pipeline.scene.tags import find_room_collection
from ..pipeline.scene.texts import MEMORY, read_text
from . import asset_shelf, clients, journals, properties, reference
from .scene_backend import ResolvedScene

_MOST = 6
"""Texts that are remembered: those of a few scenes, and of a few steps of undo."""

_parsed: OrderedDict[str, Memory] = OrderedDict()
_pictures: OrderedDict[tuple[str, str], ReferencePicture] = OrderedDict()


def memory_text(scene: Any) -> str:
    """The memory's text as it stands in the file, "" when there is none. Main thread only."""
    return read_text(find_room_collection(scene), MEMORY)


def memory_of(scene: Any) -> Memory:
    """The scene's memory. It is shared: read it, never change it (`run_of` gives one that may be changed).

    Its settings are those that were in force when it was written last; `run_of` has those of the panel.

    Raises:
        RoomError: the text cannot be read; it stays as it is.
    """
    text = memory_text(scene)
    found = _parsed.get(text)
    if found is None:
        found = load_memory(text)
        remember(text, found)
    else:
        _parsed.move_to_end(text)
    return found


def remember(text: str, memory: Memory) -> None:
    """This text is known to be this memory, so that it need not be parsed. The memory must not be changed afterwards."""
    _parsed[text] = memory
    while len(_parsed) > _MOST:
        _parsed.popitem(last=False)


def picture_of(scene: Any) -> ReferencePicture | None:
    """As `reference.kept_picture`, without hashing and decoding an image again that did not change."""
    image = scene.code_as_room.picture
    if image is None:
        return None
    key = (reference.picture_mark(scene), scene.code_as_room.picture_name)
    known = _pictures.get(key)
    packed = image.packed_file
    if known is not None and packed is not None and packed.size == len(known.data) and packed.data == known.data:
        return known
    found = reference.kept_picture(scene)
    if found is not None:
        _pictures[key] = found
        while len(_pictures) > _MOST:
            _pictures.popitem(last=False)
    return found


def copy_of(memory: Memory) -> Memory:
    """A memory of its own that may be appended to; entries are never changed, so they are shared."""
    return replace(memory, settings=dict(memory.settings), entries=list(memory.entries))


def run_of(scene: Any) -> Run:
    """A run for reading and correcting: the scene's picture, memory and settings, and nobody to ask. Main thread only.

    Its memory is a copy: what is appended reaches the scene only through `keep(run)`.

    Raises:
        RoomError: there is no picture, or memory cannot be read.
    """
    picture = picture_of(scene)
    if picture is None:
        raise reference.missing(scene)
    check_own(scene)
    memory = copy_of(memory_of(scene))
    memory.settings = properties.memory_settings(scene.code_as_room, memory.settings)
    journal = journals.journal_of(picture.sha256)
    return Run(picture, memory, clients.NOBODY, ResolvedScene(scene), journal=journal, shelf=asset_shelf.shelf())


def keep(run: Run) -> None:
    """Write the memory of a run that `run_of` gave into its scene. Main thread only.

    Raises:
        RoomError: the scene is gone.
    """
    backend = run.backend
    backend.save_memory(dump_memory(run.memory))
    if isinstance(backend, ResolvedScene):
        backend.flush()


def forget_all() -> None:
    """Drop everything that is remembered, as when another file is opened."""
    _parsed.clear()
    _pictures.clear()
