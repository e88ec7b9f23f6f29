# SPDX-License-Identifier: GPL-3.0-or-later
"""The artist's own finishes in a room text: what a stage says of the same thing gives way."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from ..artifacts.layout import LayoutEdit
from ..artifacts.materials import OwnFinishes
from ..errors import ProgramError
from ..layout.hand import name_now
from ..program import finishes
from ..program.lines import parse_layout

_WORD = re.compile(r"[A-Za-z_]\w*")


def with_own(text: str, own: OwnFinishes, edits: Sequence[LayoutEdit] = ()) -> str:
    """A room text that a stage made, with what the artist wrote of materials in the place of what the stage says.

    Things that the room has not are passed over, and so are looks that nothing wears. A text that this would spoil stays.

    Args:
        edits: all edits by hand, which may have renamed things since.
    """
    if not own.looks and not own.finishes:
        return text
    try:
        found, present = finishes.read_materials(text), finishes.present_names(parse_layout(text))
        mine = {name_now(edits, name) or name: finish for name, finish in own.finishes.items()}
        merged = finishes.Materials(dict(found.looks), found.finishes | {n: f for n, f in mine.items() if n in present})
        worn = words_of(merged.finishes.values())
        merged.looks |= {name: look for name, look in own.looks.items() if name in worn}
        return text if merged == found else finishes.with_materials(text, merged)
    except ProgramError:
        return text


def own_among(text: str, made: Sequence[str], before: OwnFinishes) -> OwnFinishes:
    """The finishes and looks of a text that are not what stages made.

    Args:
        made: the texts that stages wrote. before: what was the artist's before, which stays the artist's while it stands.

    Raises:
        ProgramError: a text cannot be parsed.
    """
    typed, stages = finishes.read_materials(text), [finishes.read_materials(program) for program in made]
    # What was renamed in the text goes by another name there.
    gone = [finish for m in stages for name, finish in m.finishes.items() if name not in typed.finishes]
    finished = {
        name: finish
        for name, finish in typed.finishes.items()
        if before.finishes.get(name) == finish
        or (finish not in gone and all(m.finishes.get(name) != finish for m in stages))
    }
    # A look that stages know by another meaning was changed; one that they do not know counts where it is worn.
    changed = {
        name
        for name, look in typed.looks.items()
        if any(name in m.looks for m in stages) and all(m.looks.get(name) != look for m in stages)
    }
    worn = words_of(finished.values())
    looks = {name: look for name, look in typed.looks.items() if name in changed or name in worn}
    return OwnFinishes(looks=looks, finishes=finished)


def words_of(finished: Iterable[Mapping[str, str]]) -> set[str]:
    """All names in the expressions of finishes."""
    return {word for finish in finished for look in finish.values() for word in _WORD.findall(look)}
