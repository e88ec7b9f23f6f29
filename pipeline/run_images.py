# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of a room: kept in its scene, looked for when a stage's state is told, and paid for once."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from .artifacts.textures import Textures
from .backend import ImageKeeper, SceneBackend
from .memory import EntryMeta, Memory, now
from .program.prelude.image_files import IMAGE_FOLDER, image_file
from .stages.base import Stage
from .stages.texture_wishes import FindImages, KeepImages, Painting, PaintRequest

if TYPE_CHECKING:
    from .run import Run

log = logging.getLogger(__name__)


def keep_images(run: Run, wish: KeepImages) -> None:
    """Perform a `KeepImages`. Main thread only; a scene that keeps none shows plain colours."""
    if isinstance(run.backend, ImageKeeper):
        run.backend.keep_images(wish.images)


def find_images(run: Run, wish: FindImages) -> frozenset[str] | None:
    """Perform a `FindImages`. Main thread only."""
    backend = run.backend
    if not isinstance(backend, ImageKeeper):
        return None
    return frozenset(name for name in wish.names if backend.has_images([name]))


def lacks_images(run: Run, stage: Stage) -> bool:
    """Whether a stage that is done wrote images that the scene has lost since. Main thread only."""
    if Textures not in stage.writes or not isinstance(run.backend, ImageKeeper):
        return False
    found = run.memory.latest(Textures, (stage.id,))
    return found is not None and not run.backend.has_images([t.name for t in found.images])


def note_painting(
    run: Run, stage: str, request: PaintRequest, painting: Painting, round_number: int, inputs: Mapping[str, str]
) -> None:
    """What an image cost goes to memory as an answer; the image itself does not."""
    meta = EntryMeta(
        time=now(),
        client=run.painter.name if run.painter is not None else "",
        model=painting.model,
        cost=painting.cost,
        seconds=round(painting.seconds, 3),
        prompt_hash=painting.asked,
        tries=painting.tries,
        round=round_number,
        inputs=dict(inputs),
    )
    digest = hashlib.sha256(painting.data).hexdigest()
    run.memory.keep_answer(stage, request.key, f"An image of {len(painting.data)} bytes, sha256 {digest}", meta)


def bring_images(memory: Memory, backend: SceneBackend, folder: Path) -> int:
    """Take the images that an earlier run wrote beside its `room.py` into a scene that has none. Main thread only.

    Files that are not what memory speaks of are left out; their stage then counts as out of date.

    Returns:
        How many there are now.
    """
    textures = memory.latest(Textures)
    if textures is None or not isinstance(backend, ImageKeeper):
        return 0
    found: dict[str, bytes] = {}
    for texture in textures.images:
        try:
            data = (folder / IMAGE_FOLDER / image_file(texture.name)).read_bytes()
        except OSError as error:
            log.info("%s is not there: %s", texture.name, error.strerror)
            continue
        if hashlib.sha256(data).hexdigest() == texture.sha256:
            found[texture.name] = data
    if found:
        backend.keep_images(found)
    return len(found)
