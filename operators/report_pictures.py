# SPDX-License-Identifier: GPL-3.0-or-later
"""What the report shows beside the pictures that are drawn for it: renders of the room's views, and its textures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from datetime import datetime
from pathlib import Path

from ..pipeline.artifacts.textures import Textures
from ..pipeline.backend import ImageKeeper
from ..pipeline.memory import Memory
from ..pipeline.report import RENDER
from ..pipeline.report_finish import TEXTURE
from ..pipeline.run import Run


def further_pictures(run: Run, renders: Mapping[str, Path]) -> dict[str, bytes]:
    """The report's pictures by name, see `make_report`. What cannot be read is left out.

    Args:
        renders: files by the camera's id.
    """
    textures = run.memory.latest(Textures)
    names = [texture.name for texture in textures.images] if textures is not None else []
    kept = run.backend.kept_images(names) if names and isinstance(run.backend, ImageKeeper) else {}
    found = {TEXTURE + name: data for name, data in kept.items()}
    for camera, path in renders.items():
        try:
            found[RENDER + camera] = path.read_bytes()
        except OSError:
            continue
    return found


def fresh_renders(folder: Path | None, cameras: Iterable[str], memory: Memory) -> dict[str, Path]:
    """Renders in a folder, CAMERA.png each, that were made after the room as it is now was worked out."""
    entry = memory.latest_entry("LayoutProgram")
    if folder is None or entry is None:
        return {}
    found = {}
    for camera in cameras:
        path = folder / f"{camera}.png"
        try:
            if path.stat().st_mtime >= datetime.fromisoformat(entry.meta.time).timestamp():
                found[camera] = path
        except (OSError, ValueError):
            continue
    return found
