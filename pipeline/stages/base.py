# SPDX-License-Identifier: GPL-3.0-or-later
"""What a stage is, and what it may see."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from pydantic import BaseModel

from ..artifacts.corrections import Corrections
from ..artifacts.layout import LayoutEdit
from ..errors import RoomError
from ..picture import ReferencePicture
from .wishes import StageRun

A = TypeVar("A", bound=BaseModel)


@dataclass(frozen=True)
class Reads:
    """One artifact type that a stage reads, from the latest entry that one of `stages` wrote (any stage when empty)."""

    kind: type[BaseModel]
    stages: tuple[str, ...] = ()


@dataclass(frozen=True)
class View:
    """The artifacts that a stage declared it reads, the picture, and what the artist fixed.

    Attributes:
        settings: the artist's numbers and wishes as text ("known_width_m", "wall_height_m", "iterations", "target").
        hand_edits: what the artist changed by hand so far; their objects are locked.
        corrections: what the artist corrected of the analysis.
        only: ids of the objects that are to be done anew, everything else is frozen; None for all.
    """

    reference: ReferencePicture
    artifacts: Mapping[type[BaseModel], BaseModel] = field(default_factory=dict)
    settings: Mapping[str, str] = field(default_factory=dict)
    hand_edits: tuple[LayoutEdit, ...] = ()
    corrections: Corrections = field(default_factory=Corrections)
    only: frozenset[str] | None = None

    def need(self, kind: type[A]) -> A:
        """The artifact of this type; RoomError names the missing step when an earlier stage has not run."""
        found = self.artifacts.get(kind)
        if not isinstance(found, kind):
            raise RoomError(
                f"This stage needs {kind.__name__}, which is not there yet.", "Run the stages before it first."
            )
        return found

    def number(self, name: str) -> float | None:
        """A setting as a finite positive number, or None when it is not set or not one."""
        try:
            value = float(self.settings.get(name, ""))
        except ValueError:
            return None
        return value if 0 < value < 1e6 else None

    @property
    def locked(self) -> frozenset[str]:
        """Ids of objects that no automatic step may change: edited by hand or locked, and not unlocked since."""
        edited = {edit.new_id or edit.id for edit in self.hand_edits}
        said = {c.id: c.locked for c in self.corrections.objects if c.locked is not None}
        return frozenset((edited | {i for i, on in said.items() if on}) - {i for i, on in said.items() if not on})


@dataclass(frozen=True)
class Stage:
    """A stage: its id, its title for the artist, what it reads and writes, and its generator."""

    id: str
    title: str
    reads: tuple[Reads, ...]
    writes: tuple[type[BaseModel], ...]
    run: Callable[[View], StageRun]
