# SPDX-License-Identifier: GPL-3.0-or-later
"""What became of everything that was detected, and how far small things are from where the picture shows them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from code_as_room.pipeline.artifacts.analysis import Calibration, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import LayoutProgram, LedgerEntry
from code_as_room.pipeline.geometry.camera import project, to_plane
from code_as_room.pipeline.layout.hand import name_now
from code_as_room.pipeline.memory import Memory
from code_as_room.pipeline.run_corrections import edits_of

from ..metrics import compare, load_result, load_truth
from ..metrics.runs import shapes_of
from .bodies import Body, BuiltRoom, Floats
from .look import Look

DONE = ("detailed", "placed")
LEAST_SEEN = 0.02
"""Share of a thing's surface that the camera must see for the picture to show it; its sides and its underside are never seen."""


@dataclass(frozen=True)
class Ledger:
    """What became of the detected objects.

    Attributes:
        states: how many ended how. missing: done by the ledger, and not in the room. unaccounted: without an entry, still
            waiting, or dropped without a reason.
    """

    detected: int
    states: Mapping[str, int]
    missing: tuple[str, ...]
    unaccounted: tuple[str, ...]

    @property
    def share(self) -> float:
        """Share of what was detected that is detailed or placed, and is there."""
        done = sum(self.states.get(state, 0) for state in DONE) - len(self.missing)
        return done / self.detected if self.detected else 1.0

    @property
    def closes(self) -> bool:
        """Whether everything is accounted for."""
        return not self.missing and not self.unaccounted and sum(self.states.values()) == self.detected


def ledger_of(memory: Memory, room: BuiltRoom) -> Ledger | None:
    """The ledger of the last program held against the room; None before stage 4."""
    analysis, program = memory.latest(SceneAnalysis), memory.latest(LayoutProgram)
    if analysis is None or program is None or not program.ledger:
        return None
    edits = edits_of(memory)
    entries = {entry.id: entry for entry in program.ledger}
    detected = [o.id for o in analysis.objects]
    missing = [i for i in detected if i in entries and _is_lost(entries[i], name_now(edits, i), room)]
    silent = [i for i in detected if i not in entries or (entries[i].state == "dropped" and not entries[i].reason)]
    waiting = [i for i in detected if i in entries and entries[i].state == "deferred"]
    states = Counter(entries[i].state for i in detected if i in entries)
    return Ledger(len(detected), dict(states), tuple(missing), tuple(silent + waiting))


def _is_lost(entry: LedgerEntry, name: str | None, room: BuiltRoom) -> bool:
    return entry.state in DONE and name not in room.things


def shown_distances(memory: Memory, room: BuiltRoom) -> dict[str, float]:
    """Metres between where small things are seen and where their boxes in the picture are, at the height of their middles.

    Boxes in answers go round what is seen of a thing, or round where all of it must be: the nearer of the two counts. What
    other things hide from the camera is nowhere in the picture, and has no figure.
    """
    analysis, calibration = memory.latest(SceneAnalysis), memory.latest(Calibration)
    if analysis is None or calibration is None:
        return {}
    edits = edits_of(memory)
    look = Look.of(calibration.camera, room)
    found = {}
    for item in analysis.objects:
        body = room.things.get(name_now(edits, item.id) or "")
        if body is None or body.placement != "surface" or item.box is None:
            continue
        seen = look.seen_of(body)
        if len(seen) < LEAST_SEEN * len(body.skin):
            continue
        distances = [_apart(calibration.camera, body, points, item.box.centre) for points in (body.points, seen)]
        known = [distance for distance in distances if distance is not None]
        if known:
            found[body.id] = min(known)
    return found


def _apart(camera: CameraModel, body: Body, points: Floats, wanted: tuple[float, float]) -> float | None:
    """Metres on the level of a thing's middle between the middle of points' outline in the picture and a picture point."""
    seen = project(camera, points)
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    level = float((body.low[2] + body.high[2]) / 2)
    own, other = to_plane(camera, [middle, wanted], level)
    distance = float(np.linalg.norm(own - other))
    return None if math.isnan(distance) else distance


def true_distances(scene: Path, truth: Path, memory: Memory | None) -> tuple[dict[str, float], float]:
    """Metres between small things and their true places, by id, both rooms laid over one another; the room's diagonal."""
    comparison = compare(load_truth(truth), load_result(scene, shapes_of(memory)))
    pairs = [p for p in comparison.asked_pairs if p.true.placement == "surface"]
    return {p.own.id: math.dist(p.true.centre, p.found.centre) for p in pairs}, float(np.hypot(*comparison.truth.size))
