# SPDX-License-Identifier: GPL-3.0-or-later
"""room.py: the prelude as text, the marker, and the room. Joined here, and taken apart again."""

from __future__ import annotations

import functools
from pathlib import Path

from ..errors import ProgramError
from .joiner import join_modules
from .prelude import registry

MARKER = "# ==== room ===="
"""The line between the prelude and the room."""

_HERE = Path(__file__).resolve().parent
_MADE = {**registry.CONSTRUCTORS, **registry.LOOKS}
_REALISE = _HERE.parent / "scene" / "realise.py"

_HEADER = '''# SPDX-License-Identifier: GPL-3.0-or-later
"""A room as a program, made with Code-as-Room for Blender.

Run it in Blender 4.5 or later, with no add-on: `blender --background --python room.py`, or open it in the Text Editor
and press Run Script. It makes the room in a collection of its own and touches nothing else.

Below the line with "room" between equals signs is the room itself, and that is the part to edit: one line for each
wall, opening, object, light and camera (metres, Z up, yaw in degrees, 0 faces -Y), then functions that model objects.
Above it is the prelude, which is the same in every room: the functions that a room is written with.

Licence: the prelude is part of Code-as-Room, GPL-3.0-or-later. The room is the work of the artist who made it.
"""

from __future__ import annotations

'''

_BUILD = '''def build() -> None:
    """Check the room and make it in Blender. The last statement of a room."""
    _recorder.build()
    for _note in {realise}(_recorder.record) or ():
        print(_note)
'''


@functools.lru_cache(maxsize=1)
def prelude_text() -> str:
    """The prelude as the text of one module: header, constructors, the room's shell, and the making of Blender data."""
    roots = [_HERE / "prelude" / "recorder.py"]
    roots += [_HERE / "prelude" / f"{_module(name)}.py" for name in _MADE]
    public = {(_module(name), name) for name in _MADE}
    body, names = join_modules([*dict.fromkeys(roots), _REALISE], public)
    title = "# ---- what a room is written with "
    lines = [
        title + "-" * (100 - len(title)),
        "",
        "from math import (",
        *(f"    {name}," for name in registry.MATH),
        ")",
    ]
    lines += ["", *(f"{name} = {value!r}" for name, value in registry.CONSTANTS.items())]
    lines += [f"_recorder = {names['recorder', 'Recorder']}()"]
    lines += [f"{name} = _recorder.{name}" for name in registry.LINE_NAMES if name != "build"]
    build = _BUILD.format(realise=names["realise", "realise_record"])
    return "\n".join([_HEADER + body, "", *lines, "", "", build])


def _module(name: str) -> str:
    """The prelude module that a constructor is defined in."""
    return _MADE[name].__module__.rpartition(".")[2]


def assemble(room_text: str) -> str:
    """The whole room.py: prelude, marker, room. Plain Python with bpy runs it."""
    return f"{prelude_text()}\n\n{MARKER}\n{room_text}"


def room_part(full_text: str) -> str:
    """The room of a whole room.py, exactly as it was given to `assemble`. Raises ProgramError without the marker."""
    return split_room(full_text)[1]


def split_room(full_text: str) -> tuple[int, str]:
    """How many lines stand before the room, and the room. Raises ProgramError when the marker is missing."""
    at = 0
    for number, line in enumerate(full_text.split("\n"), start=1):
        at += len(line) + 1
        if line.rstrip() == MARKER:
            return number, full_text[at:]
    raise ProgramError(
        f'the line "{MARKER}" is missing', 0, "Put it back where the prelude ends and the room begins, or undo."
    )
