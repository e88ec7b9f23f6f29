# SPDX-License-Identifier: GPL-3.0-or-later
"""The journals of answers in the extension's own user folder: one a picture, shared by all scenes and files.

Where the add-on is not installed as an extension (the bpy package, the command) there is no such folder and no journal.
"""

from __future__ import annotations

import contextlib
import os
import tomllib
from pathlib import Path
from typing import Any

import bpy

from .. import __package__ as base_package
from ..pipeline.journal import SUFFIX, Journal, prune
from . import reference

_journals: dict[str, Journal] = {}


def folder() -> Path | None:
    """The folder of the journals, made when it is not there; None where there is none. Main thread only."""
    try:
        path = Path(bpy.utils.extension_path_user(base_package or "", path="journal", create=True))
        path.chmod(0o700)  # answers describe the artist's picture
    except (ValueError, OSError):
        return None
    return path


def journal_of(picture_hash: str) -> Journal | None:
    """The journal of a picture; the same object for as long as Blender runs. Main thread only."""
    found = _journals.get(picture_hash)
    if found is not None:
        return found
    place = folder()
    if place is None or not picture_hash:
        return None
    path = place / f"{picture_hash}{SUFFIX}"
    with contextlib.suppress(OSError):  # there is none yet
        os.utime(path)  # it is in use, so it is not pruned
    prune(place, keep=path)
    found = _journals[picture_hash] = Journal(path, _version())
    return found


def problem_of(scene: Any) -> str:
    """A sentence when answers cannot be kept outside the .blend, else ""; cheap."""
    journal = _journals.get(reference.picture_mark(scene))
    if journal is None or not journal.problem:
        return ""
    return f"Answers cannot be kept on this computer ({journal.problem}). Save the file to keep them."


def forget_all() -> None:
    """Forget what was read; the files stay."""
    _journals.clear()


def _version() -> str:
    """The add-on's version."""
    try:
        manifest = tomllib.loads((Path(__file__).parents[1] / "blender_manifest.toml").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    return str(manifest.get("version", ""))
