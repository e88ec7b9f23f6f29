# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of layouts, kept as they are rendered in the loop, and as icons for the panel.

They are files under the extension's own user folder, named by the program that they show, and made anew when they are
missing; so they are in no .blend. Where there is no such folder (the bpy package) they last as long as the session.
Everything here runs on Blender's main thread; icons are made in `prepare`, never while drawing.
"""

from __future__ import annotations

import contextlib
import io
import logging
from collections import OrderedDict
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from PIL import Image

from .. import __package__ as base_package
from ..pipeline.artifacts.camera import CameraModel
from ..pipeline.scene.backend import BlenderScene
from .view_state import RoomState

log = logging.getLogger(__name__)
LONG_SIDE = 1024
ICON_SIDE = 192
MOST_FILES, MOST_KEPT = 240, 12
_bytes: OrderedDict[str, bytes] = OrderedDict()
_absent: set[str] = set()
_icons: Any = None


def _path(key: str) -> Path | None:
    """Where the picture of this key is kept; None where there is no folder for it."""
    try:
        folder = Path(bpy.utils.extension_path_user(base_package or "", path="rounds", create=True))
    except (ValueError, OSError):
        return None
    return folder / f"{key}.png"


def keep(key: str, png: bytes) -> None:
    """Keep the picture of the program with this key (see `report_rounds.text_key`)."""
    _bytes[key] = png
    _absent.discard(key)
    if _icons is not None and key in _icons:
        del _icons[key]
    while len(_bytes) > MOST_KEPT:
        _bytes.popitem(last=False)
    path = _path(key)
    if path is None:
        return
    try:
        part = path.with_suffix(".part")
        part.write_bytes(png)
        part.replace(path)
        _prune(path.parent)
    except OSError as error:  # a full disk costs a thumbnail, not the run
        log.warning("The picture of a round could not be kept: %s", error.strerror or error)


def find(key: str) -> bytes | None:
    """The picture of the program with this key; None when there is none."""
    if key in _bytes:
        return _bytes[key]
    path = _path(key)
    try:
        return path.read_bytes() if path is not None else None
    except OSError:
        return None


def alias(old: str, new: str) -> None:
    """The program with the key `new` looks like the one with the key `old`, as far as its picture goes."""
    png = find(old)
    if png is not None and find(new) is None:
        keep(new, png)


def _prune(folder: Path) -> None:
    """Remove the pictures that were written longest ago."""
    files = sorted(folder.glob("*.png"), key=lambda path: path.stat().st_mtime)
    for path in files[:-MOST_FILES]:
        with contextlib.suppress(OSError):
            path.unlink()


def icon(key: str) -> int:
    """The picture as an icon, 0 when it was not prepared; a look into a dictionary, for `draw`."""
    preview = _icons.get(key) if _icons is not None else None
    return int(preview.icon_id) if preview is not None else 0


def prepare(scene: Any, state: RoomState) -> None:
    """Have the icons of this room's rounds ready; called after every refresh of the state."""
    global _icons
    ready = _absent.union(_icons.keys() if _icons is not None else ())
    missing = {row.picture for row in state.rounds} - ready
    if not missing:
        return
    if _icons is None:
        import bpy.utils.previews

        _icons = bpy.utils.previews.new()
    for key in missing:
        png = find(key)
        if png is None or not _load(key, png):
            _absent.add(key)


def _load(key: str, png: bytes) -> bool:
    """Make an icon of a picture; False when the file is broken."""
    try:
        with Image.open(io.BytesIO(png)) as opened:
            image = opened.convert("RGBA")
    except (OSError, ValueError):
        return False
    image.thumbnail((ICON_SIDE, ICON_SIDE))
    # Blender's icons are square: a picture that is not would be stretched.
    square = Image.new("RGBA", (max(image.size), max(image.size)))
    square.paste(image, ((square.width - image.width) // 2, (square.height - image.height) // 2))
    preview = _icons.new(key)
    preview.image_size = square.size
    preview.image_pixels_float.foreach_set((np.asarray(square)[::-1].astype(np.float32) / 255.0).ravel())
    return True


def render(text: str, camera: CameraModel) -> bytes:
    """Build a program in a scene of its own, picture it, and remove everything again.

    Raises:
        RoomError: it cannot be built or drawn.
    """
    before = {kind: set(_ids(kind)) for kind in _KINDS}
    scene = bpy.data.scenes.new("Code-as-Room Round")
    try:
        room = BlenderScene(scene)
        room.build(text)
        return room.render(camera, LONG_SIDE, labels=True)
    finally:
        bpy.data.scenes.remove(scene)
        for kind in _KINDS:
            data = getattr(bpy.data, kind)
            for item in [item for item in data if item.session_uid not in before[kind]]:
                data.remove(item)


_KINDS = ("collections", "objects", "meshes", "curves", "materials", "cameras", "lights", "texts", "worlds", "images")


def _ids(kind: str) -> list[int]:
    return [item.session_uid for item in getattr(bpy.data, kind)]


def forget_all() -> None:
    """Free the icons and what is kept in this session; files stay."""
    global _icons
    if _icons is not None:
        import bpy.utils.previews

        bpy.utils.previews.remove(_icons)
        _icons = None
    _bytes.clear()
    _absent.clear()
