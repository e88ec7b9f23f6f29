# SPDX-License-Identifier: GPL-3.0-or-later
"""What a surface's image is called: by the surface and by its own bytes.

So an image never changes under its name. A stage that is stopped half-way, an undo, and two rooms in one file each find
the image that their program speaks of.
"""

from __future__ import annotations

import re

_DIGITS = 8
_LONGEST = 48


def image_name(surface: str, sha256: str) -> str:
    """The name of a surface's image in the program, in the .blend and (with ".png") beside `room.py`."""
    return f"{surface[:_LONGEST]}_{sha256[:_DIGITS]}"


def shows_image_of(surface: str, look: str) -> bool:
    """Whether the text of a look shows an image that was made for this surface."""
    name = re.escape(surface[:_LONGEST])
    return re.search(rf"""picture\(\s*["']{name}(_[0-9a-f]{{{_DIGITS}}})?["']""", look) is not None
