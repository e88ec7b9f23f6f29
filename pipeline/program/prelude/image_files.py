# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the images of a room lie beside its `room.py`."""

from __future__ import annotations

IMAGE_FOLDER = "textures"


def image_file(name: str) -> str:
    """The file of an image in that folder; whatever the name is, it stays inside."""
    safe = "".join(c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in name)
    return f"{safe[:100] or 'image'}.png"
