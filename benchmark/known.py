# SPDX-License-Identifier: GPL-3.0-or-later
"""What a stand-in for a weaker model knows of a picture, by what names, and in whose metres."""

from __future__ import annotations

import re

from code_as_room.pipeline.artifacts.replies import BoxReply, ObjectReply

from .draws import Draws, Errors
from .noise import new_id, noised_analysis
from .seen import Seen
from .strengths import NONE, Strength

_ROOM = re.compile(r"room\s+(\d+(?:\.\d+)?)\s*x\s*(\d+(?:\.\d+)?)\s*m\b")


class Known:
    """What one stand-in knows: what was seen, how it errs, and what it calls things.

    Attributes:
        first: its first answer; names: by true id, what a thing is called; true: the other way round.
    """

    def __init__(self, seen: Seen, strength: Strength, seed: int) -> None:
        self.seen, self.strength, self.draws = seen, strength, Draws(seed)
        self.errors = Errors.of(seen.first, strength, self.draws)
        # The first answer is made from the first answer: what the strong model mended later was wrong at first.
        self.first = noised_analysis(seen.first, strength, self.draws, self.errors)
        self.names = dict(self.first.ids)
        taken = {o.id for o in self.first.reply.objects} | {a.id for a in self.first.reply.architecture}
        for name, item in seen.objects.items():
            if name not in self.names:
                self.names[name] = name if strength == NONE else new_id(item.category, taken)
        self.true = {given: name for name, given in self.names.items()}
        self.doubles = dict(self.first.doubles)

    def parent(self, item: ObjectReply) -> str | None:
        """What the thing's parent is called, None when it is nothing that the stand-in knows."""
        walls = {a.id for a in self.first.reply.architecture} | {"left", "right", "top", "bottom"}
        name = self.names.get(item.parent or "", item.parent)
        return name if name in self.true or name in walls else None

    def metres_of(self, text: str) -> tuple[float, float]:
        """Factors from its own metres to those of a request that states the room's size."""
        match = _ROOM.search(text)
        own = self.first.reply.room_width_m, self.first.reply.room_depth_m
        if match is None or min(own) <= 0:
            return 1.0, 1.0
        return float(match.group(1)) / own[0], float(match.group(2)) / own[1]


def iou(a: BoxReply, b: BoxReply) -> float:
    """Intersection over union of two boxes of the picture."""
    width = min(a.x_max, b.x_max) - max(a.x_min, b.x_min)
    height = min(a.y_max, b.y_max) - max(a.y_min, b.y_min)
    if width <= 0 or height <= 0:
        return 0.0
    both = sum(abs((c.x_max - c.x_min) * (c.y_max - c.y_min)) for c in (a, b))
    return width * height / (both - width * height)


def visibly_off(drawn: BoxReply, seen: BoxReply) -> bool:
    """Whether a drawn box or outline is off by what an attentive eye notices: more than ten units, and not by a hair."""
    most = max(abs(getattr(drawn, edge) - getattr(seen, edge)) for edge in ("x_min", "y_min", "x_max", "y_max"))
    return most > 10 and iou(drawn, seen) < 0.85
