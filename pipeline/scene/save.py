# SPDX-License-Identifier: GPL-3.0-or-later
"""Saves a copy of the .blend without changing which file the artist works in."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import bpy

from ..errors import OutputError
from .compat import quiet


def save_copy(path: Path) -> None:
    """Write the whole file to `path`, compressed, beside its place first, so that no half-written file is left.

    Images of the room are packed; paths of the artist's other files are made to fit the new place.

    Raises:
        OutputError: the file cannot be written.
    """
    for image in bpy.data.images:
        if _is_ours(image) and image.packed_file is None and image.has_data:
            image.pack()
    part = path.with_name(f".{path.stem}.part.blend")
    try:
        with quiet():
            bpy.ops.wm.save_as_mainfile(filepath=str(part), copy=True, compress=True, relative_remap=True)
        os.replace(part, path)
    except (RuntimeError, OSError) as problem:
        part.unlink(missing_ok=True)
        raise OutputError(
            f"{path.name} cannot be saved: {str(problem).strip()}.", "Choose another folder, or make room."
        ) from problem


def _is_ours(image: Any) -> bool:
    return any(key.startswith("code_as_room") for key in image.keys())  # noqa: SIM118 (an ID is not a dict)
