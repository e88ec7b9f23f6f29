# SPDX-License-Identifier: GPL-3.0-or-later
"""Every difference between the supported versions of Blender (4.5, 5.0, 5.1, 5.2) has its one home here.

What a version has is asked for by feature, not by number, wherever a feature can be asked for. `ensure_node_tree` lives
in `nodes.py`, because `room.py` carries it along.
"""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from collections.abc import Iterator
from typing import Any

import bpy

from .nodes import ensure_node_tree

_HARMLESS = b"EGL Error (0x3009)"
"""Blender tries a window surface that a surfaceless driver does not have, then goes on without."""
__all__ = ["eevee_id", "ensure_gpu", "ensure_node_tree", "quiet", "set_png"]


def eevee_id(scene: Any) -> str:
    """EEVEE's engine id: "BLENDER_EEVEE_NEXT" in 4.5, "BLENDER_EEVEE" from 5.0. Remove when 4.5 is no longer supported."""
    known = scene.render.bl_rna.properties["engine"].enum_items.keys()
    if "BLENDER_EEVEE_NEXT" in known or bpy.app.version < (5, 0, 0):
        return "BLENDER_EEVEE_NEXT"
    return "BLENDER_EEVEE"


def set_png(settings: Any) -> None:
    """Make image settings write 8-bit PNG with alpha. From 5.0 the media type has to be set before the format."""
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format = "PNG"
    settings.color_mode = "RGBA"
    settings.color_depth = "8"
    settings.compression = 15


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Keep a background Blender from printing a line for each render, each file saved, and each harmless EGL complaint.

    All versions write these straight to the process's output, past Python, and 5.0 and 4.5 have different switches
    for some of them only. Other lines on standard error are passed on. In a window nothing is changed.
    """
    if not bpy.app.background:
        yield
        return
    sys.stdout.flush()
    sys.stderr.flush()
    with open(os.devnull, "wb") as nowhere, tempfile.TemporaryFile() as errors:
        kept = os.dup(1), os.dup(2)
        try:
            os.dup2(nowhere.fileno(), 1)
            os.dup2(errors.fileno(), 2)
            yield
        finally:
            for number, descriptor in enumerate(kept, 1):
                os.dup2(descriptor, number)
                os.close(descriptor)
            errors.seek(0)
            told = b"".join(line for line in errors if not line.startswith(_HARMLESS))
            if told:
                os.write(2, told)


def ensure_gpu() -> None:
    """Start the graphics context of a Blender without a window; needed from 5.2, absent before."""
    import gpu

    start = getattr(gpu, "init", None)
    if bpy.app.background and start is not None:
        start()
