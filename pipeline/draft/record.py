# SPDX-License-Identifier: GPL-3.0-or-later
"""What the text of a room in parts means, without evaluating it: the parts' shapes were made when their defs were read.

So a room that grows is neither parsed nor evaluated anew for each new thing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..errors import ProgramError
from ..library import catalogue
from ..objects.text import library_names
from ..program.evaluate import evaluate_object
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import name_of, rounded_line
from ..program.prelude.budget import spend_vertices, vertex_budget
from ..program.prelude.covers import NEAR, ancestors, lay_covers
from ..program.prelude.record import Record
from ..program.prelude.recorder import Recorder
from ..program.prelude.shape import Shape
from ..program.reuse import remember
from .parts import Composed, Part


def record_of(composed: Composed, cloths: Cloths | None = None) -> Record:
    """What the composed text means, without evaluating it.

    Args:
        cloths: those that were laid for the room before this one.

    Raises:
        ProgramError, ValueError: the room cannot be so.
    """
    recorder = Recorder()
    layout = composed.layout
    proxies = sorted(layout.proxies, key=lambda proxy: proxy.salience != "major")
    groups = (layout.walls, layout.doors, layout.windows, layout.openings, proxies, layout.cameras)
    for line in [layout.room, *(line for group in groups for line in group)]:
        rounded = rounded_line(line)
        getattr(recorder, name_of(line))(**{name: getattr(rounded, name) for name in type(line).model_fields})
    lying: list[str] = []
    with vertex_budget(FINISHED_ROOM_LIMITS.vertices):
        for identifier, part in composed.parts.items():
            if part.function:
                shapes = _shapes_of(part)
                spend_vertices(sum(shape.vertex_count for shape in shapes))
                recorder.furnish(identifier, shapes)
                lying += [identifier] if part.lying else []
        for identifier, names in composed.materials.finishes.items():
            recorder.finish(identifier, {key: composed.looks[name] for key, name in names.items()})
        recorder.build()
        (cloths or Cloths()).lay(recorder.record, lying, composed.parts)
    return recorder.record


class Cloths:
    """The cloths of a room, laid onto what carries them; again only where something near them is another."""

    def __init__(self) -> None:
        self._near: list[Part] = []
        self._laid: dict[str, tuple[list[Shape], list[Shape]]] = {}

    def lay(self, record: Record, names: Sequence[str], parts: Mapping[str, Part]) -> None:
        """Lay these."""
        near = _near(record, names, parts)
        same = len(near) == len(self._near) and all(a is b for a, b in zip(near, self._near, strict=True))
        if not same or self._laid.keys() != set(names):
            lay_covers(record, names)
            self._near, self._laid = near, {name: (record.plain[name], record.furnished[name]) for name in names}
        for name in self._laid:
            record.plain[name], record.furnished[name] = self._laid[name]


def _near(record: Record, names: Sequence[str], parts: Mapping[str, Part]) -> list[Part]:
    """All that cloths could lie on or hang against, and themselves."""
    lines = {line["id"]: line for line in record.proxies}
    found: dict[str, Part] = {}
    for name in names:
        line = lines[name]
        points = np.concatenate([shape.vertices for shape in record.furnished[name]])
        low, high = points.min(axis=0)[:2], points.max(axis=0)[:2]
        reach = math.hypot(*(high - low)) / 2 + math.hypot(*((high + low) / 2)) + 2 * NEAR
        around = [
            other["id"]
            for other in record.proxies
            if math.dist(other["centre"][:2], line["centre"][:2]) <= reach + math.hypot(*other["size"][:2]) / 2
        ]
        found.update({i: parts[i] for i in [name, *ancestors(line, lines), *around]})
    return list(found.values())


def _shapes_of(part: Part) -> list[Shape]:
    """What a part's def makes of its size."""
    if part.shapes is None:
        code = "\n\n\n".join(part.defs.values())
        size = part.line.size
        text = f"{catalogue.source(sorted(library_names(code) - part.defs.keys()))}\n\n{code}"
        part.shapes = evaluate_object(text, part.function, FINISHED_ROOM_LIMITS, (size,))
        if not part.shapes:
            raise ProgramError(f"there are no shapes for {part.line.id}")
        remember(text, part.function, size, part.shapes)
    return part.shapes
