# SPDX-License-Identifier: GPL-3.0-or-later
"""What a stage is, and what it may see."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Protocol, TypeVar

from pydantic import BaseModel

from ..artifacts.analysis import SceneAnalysis
from ..artifacts.corrections import Corrections
from ..artifacts.layout import LayoutEdit
from ..errors import RoomError
from ..layout.hand import name_now
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
        recalled: what the stage may look at without depending on it, in the metres that hold now.
        only: ids of the objects that are to be done anew, everything else is frozen; None for all.
    """

    reference: ReferencePicture
    artifacts: Mapping[type[BaseModel], BaseModel] = field(default_factory=dict)
    settings: Mapping[str, str] = field(default_factory=dict)
    hand_edits: tuple[LayoutEdit, ...] = ()
    corrections: Corrections = field(default_factory=Corrections)
    only: frozenset[str] | None = None
    recalled: Mapping[type[BaseModel], BaseModel] = field(default_factory=dict)

    def recall(self, kind: type[A]) -> A | None:
        """An artifact that the stage does not depend on, None when there is none."""
        found = self.recalled.get(kind)
        return found if isinstance(found, kind) else None

    def names(self, analysis: SceneAnalysis) -> dict[str, str | None]:
        """What the artist calls each detected object by now, None when it was removed by hand; left out ones too."""
        return {o.id: name_now(self.hand_edits, o.id) for o in [*analysis.objects, *analysis.left_out]}

    def chosen(self, identifier: str) -> bool:
        """Whether a detected object is to be done anew, whatever the artist calls it by now."""
        return self.only is None or not self.only.isdisjoint((identifier, name_now(self.hand_edits, identifier)))

    def noted(self, ids: Iterable[str]) -> str:
        """The artist's notes on these objects for a question about them, "" when there are none."""
        asked = set(ids)
        notes = []
        for said in self.corrections.objects:
            name = next((i for i in (said.id, name_now(self.hand_edits, said.id)) if i in asked), None)
            if said.note and name is not None:
                notes.append(f"{name}: {said.note}")
        return "\n\nThe artist says of these:\n" + "\n".join(notes) if notes else ""

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
        edited = {edit.new_id or edit.id for edit in self.hand_edits if edit.origin != "parent"}
        return frozenset((edited | self._said(True)) - self.freed)

    @property
    def freed(self) -> frozenset[str]:
        """Ids of objects that the artist unlocked."""
        return self._said(False)

    def _said(self, locked: bool) -> frozenset[str]:
        """Ids of objects that the artist locked or unlocked, under the names that they had then and have now."""
        ids = {c.id for c in self.corrections.objects if c.locked is locked}
        return frozenset(ids | {name for i in ids if (name := name_now(self.hand_edits, i)) is not None})


class Growth(Protocol):
    """Makes rooms of an answer that is still being written.

    One may also have `warm()`, which is called before there is anything to hear; `latest`, a sentence on what stands; and
    `record`, what the text that it gave last means, so that nobody evaluates it.
    """

    def hear(self, text_so_far: str) -> str | None:
        """A whole valid room program when a new statement became complete, else None; after another try of the question
        the text may be shorter. Called in one thread at a time; never raises.
        """
        ...


@dataclass(frozen=True)
class Stage:
    """A stage: its id, its title for the artist, what it reads and writes, and its generator.

    Attributes:
        settings: names of the settings that it uses; a change of another one does not make it stale.
        notes: whether it asks the model about objects, so that the artist's notes on them go along.
        partial: whether it can do chosen objects anew and leave the rest (`View.only`).
        recalls: what it may look at without depending on it, such as what it wrote itself the last time.
        growth: what makes rooms of its first answer while that is being written; such a stage ends with what was heard
            until then when it is stopped.
    """

    id: str
    title: str
    reads: tuple[Reads, ...]
    writes: tuple[type[BaseModel], ...]
    run: Callable[[View], StageRun]
    settings: tuple[str, ...] = ()
    notes: bool = False
    partial: bool = False
    recalls: tuple[Reads, ...] = ()
    growth: Callable[[View], Growth] | None = None
