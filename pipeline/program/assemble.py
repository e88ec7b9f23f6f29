# SPDX-License-Identifier: GPL-3.0-or-later
"""room.py: what of the prelude the room needs, the marker, and the room. Joined here, and taken apart again."""

from __future__ import annotations

import functools
import re
from collections.abc import Collection
from pathlib import Path

from ..errors import ProgramError
from .finished import finished
from .joiner import join_modules
from .parse_safe import uncollected
from .prelude import registry
from .selection import Piece, Pieces, global_names
from .trimming import trimmed, with_short_docs, without_remarks
from .unchecked import unchecked

MARKER = "# ==== room ===="
"""The line between the prelude and the room."""
MOST_BYTES = 300_000
"""A longer room.py does without the docstrings of the prelude's own functions, a file also without its checks."""

_PAIRED = re.compile(r", strict=(?:True|False)\)")
"""That lists are of one length was shown by the package's own tests; it would be said fifty times."""
_HERE = Path(__file__).resolve().parent
_MADE = {**registry.CONSTRUCTORS, **registry.LOOKS}
_FRESH = _HERE.parent / "scene" / "fresh.py"
_PUBLIC = frozenset({*registry.CONSTANTS, *registry.MATH, *_MADE, *registry.LINE_NAMES})

_HEADER = '''# SPDX-License-Identifier: GPL-3.0-or-later
# The objects' functions are as their authors wrote them; rules of style do not apply.
# ruff: noqa: B007, B023, B905, C416, E731, FURB136, PLR1716, RUF007, RUF046, RUF059, RUF100
"""A room as a program, made with Code-as-Room for Blender.

Run it in Blender 4.5 or later, with no add-on: `blender --background --python room.py`, or by Run Script in the Text
Editor. It makes the room in a collection of its own and touches nothing else; your changes stay.

Below the line "==== room ====" is the room itself, the part to edit: one line for each wall, opening, object, light
and camera (metres, Z up, yaw in degrees, 0 faces -Y), then functions that model objects. Above it is the prelude: the
functions that this room uses.

Licence: the prelude is part of Code-as-Room, GPL-3.0-or-later. The room is its artist's work.
"""

from __future__ import annotations

'''

_TRUSTING = """
The room is large, so its prelude does not check values again: they were checked when it was made.
"""

_BUILD = '''def build():
    """Check the room and make it in Blender. The last statement of a room."""
    _recorder.build()
    for _note in {make}(_recorder.record) or ():
        print(_note)
'''


def prelude_text(docs: bool = True) -> str:
    """The whole prelude as the text of one module: all that a room can be written with.

    Args:
        docs: with the docstrings of its own functions, which large rooms do without.
    """
    return _prelude(_PUBLIC, docs)


@functools.lru_cache(maxsize=3)
def _pieces(docs: bool, checks: bool) -> Pieces:
    """The whole prelude, taken apart. With `docs`, its own functions keep what their docstrings begin with."""
    with uncollected():
        text = with_short_docs(_joined(), {*_PUBLIC, "build"}, docs)
        return Pieces.of(text if checks else without_remarks(unchecked(text)), docs)


@functools.lru_cache(maxsize=1)
def _joined() -> str:
    roots = [_HERE / "prelude" / "recorder.py"]
    roots += [_HERE / "prelude" / f"{_module(name)}.py" for name in _MADE]
    body, names = join_modules([*dict.fromkeys(roots), _FRESH], {(_module(name), name) for name in _MADE})
    title = "# ---- what a room is written with "
    lines = [title + "-" * (72 - len(title)), ""]
    lines += [f"{name} = {value!r}" for name, value in registry.CONSTANTS.items()]
    lines += [f"_recorder = {names['recorder', 'Recorder']}()"]
    lines += [f"{name} = _recorder.{name}" for name in registry.LINE_NAMES if name != "build"]
    whole = "\n".join([body, "", *lines, "", "", _BUILD.format(make=names["fresh", "make_record"])])
    return trimmed(_PAIRED.sub(")", whole))


@functools.lru_cache(maxsize=8)
def _prelude(used: frozenset[str], docs: bool, checks: bool = True) -> str:
    """What rooms need that use these names."""
    pieces = _pieces(docs, checks)
    needed = pieces.needed([*used, "build"])
    imports = {at for at in needed if _is_import(pieces.items[at])}
    header = _HEADER if checks else _HEADER.replace("\nLicence:", f"{_TRUSTING}\nLicence:")
    return header + _imports(pieces.text(imports), used) + "\n\n" + pieces.text(needed - imports)


def _is_import(item: object) -> bool:
    return isinstance(item, Piece) and item.text.startswith(("import ", "from "))


def _imports(text: str, used: Collection[str]) -> str:
    """Import statements in order: Python's own, then numpy and Blender's; plain ones before those from a module."""
    statements = [line for line in text.split("\n") if line]
    functions = sorted(set(registry.MATH) & set(used))
    if functions:
        statements.append("\n".join(["from math import (", *(f"    {name}," for name in functions), ")"]))
    foreign = [s for s in statements if s.split()[1].partition(".")[0] in ("bpy", "numpy")]
    groups = ([s for s in statements if s not in foreign], foreign)
    return "\n\n".join("\n".join(sorted(g, key=lambda s: (s.startswith("from"), s.split()[1]))) for g in groups)


def _module(name: str) -> str:
    """The prelude module that a constructor is defined in."""
    return _MADE[name].__module__.rpartition(".")[2]


def assemble(room_text: str) -> str:
    """The whole room.py: prelude, marker, and the room as it is. Plain Python with bpy runs it.

    What a room needs is found in its text; one that is not Python gets the whole prelude.
    """
    return _first_short_enough(room_text, [(True, True), (False, True)])


def assemble_file(room_text: str) -> str:
    """The whole room.py as it is handed out: the same room in fewer words (see `finished`).

    It was checked when it was made, so the checks go too where they make it too long (see `unchecked`).
    """
    return _first_short_enough(finished(room_text), [(True, True), (False, True), (False, False)])


def _first_short_enough(room_text: str, ways: list[tuple[bool, bool]]) -> str:
    """The room below its prelude, with docstrings and checks or not: the first that is not too long, else the last."""
    try:
        used = frozenset(global_names(room_text) & _PUBLIC)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        used = _PUBLIC
    whole = ""
    for docs, checks in ways:
        whole = f"{_prelude(used, docs, checks)}\n\n{MARKER}\n{room_text}"
        if len(whole) <= MOST_BYTES and len(whole.encode("utf-8", "replace")) <= MOST_BYTES:
            break
    return whole


def is_assembled(full_text: str) -> bool:
    """Whether what stands above the room is a prelude of ours, of this room as it was or is, without a change."""
    above = full_text.partition(f"\n\n{MARKER}\n")[0]
    found = re.findall(r"^(?:def (\w+)\(|(\w+) = |    (\w+),$)", above, re.MULTILINE)
    used = frozenset(name for names in found for name in names) & _PUBLIC
    return above == _prelude(used, re.search(r'^def _.+:\n    """', above, re.MULTILINE) is not None)


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
