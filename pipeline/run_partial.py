# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a stage is done after only chosen objects were redone: it is when nothing else had changed since."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeVar

from pydantic import BaseModel

from .artifacts.analysis import Calibration, SceneAnalysis
from .artifacts.graph import SceneGraph
from .artifacts.layout import LayoutProgram
from .artifacts.objects import Descriptions, Geometry, RoomStyle
from .layout.hand import name_now
from .memory import Memory, content_hash
from .program.lines import parse_layout
from .run_corrections import NOTE, edits_of, inputs_of
from .stages.base import Stage

A = TypeVar("A", bound=BaseModel)


def inputs_after(memory: Memory, stage: Stage, only: frozenset[str]) -> dict[str, str]:
    """What a stage counts as made from, after the objects of `only` were redone.

    That is what it reads now when only those objects had changed; else what it was made from before, so that a stage
    that was stale for another reason stays stale.
    """
    present = inputs_of(memory, stage)
    entry = memory.latest_entry(stage.writes[0].__name__, (stage.id,))
    if entry is None or entry.meta.inputs == present:
        return present
    before = entry.meta.inputs
    edits = edits_of(memory)
    analysis = memory.latest(SceneAnalysis)
    detected = [] if analysis is None else [*analysis.objects, *analysis.left_out]
    # Under the names of the analysis and under those that the artist gave.
    chosen = set(only) | {o.id for o in detected if name_now(edits, o.id) in only}
    notes = {f"{NOTE}{identifier}" for identifier in chosen}
    changed = {k for k in {*before, *present} if before.get(k) != present.get(k)} - notes
    kinds = {read.kind.__name__: read.kind for read in stage.reads}
    same = all(
        name in kinds and _same_but(memory, kinds[name], before.get(name, ""), present[name], chosen)
        for name in changed
    )
    return present if same else before


def _same_but(memory: Memory, kind: type[A], old: str, new: str, chosen: set[str]) -> bool:
    """Whether two artifacts of memory, given by their hashes, differ in nothing but the chosen objects."""
    found = {content_hash(e.output): e.output for e in memory.entries if e.type == kind.__name__}
    if old not in found or new not in found:
        return False
    a, b = (_without(kind.model_validate(found[key]), chosen) for key in (old, new))
    return bool(a == b)


def _without(artifact: BaseModel, chosen: set[str]) -> Any:
    """What an artifact says of everything but the chosen objects."""
    if isinstance(artifact, SceneAnalysis):
        kept = {name: _others(getattr(artifact, name), chosen) for name in ("objects", "left_out")}
        return artifact.model_copy(update={**kept, "findings": []})
    if isinstance(artifact, Calibration):
        return artifact.model_copy(update={"residuals": [], "findings": []})
    if isinstance(artifact, SceneGraph):
        edges = [e for e in artifact.edges if not chosen & {e.source, e.target}]
        return sorted(str(e) for e in edges)
    if isinstance(artifact, Descriptions | Geometry):
        return _others(artifact.objects, chosen)
    if isinstance(artifact, RoomStyle):
        return None
    if isinstance(artifact, LayoutProgram):
        layout = parse_layout(artifact.text)
        if artifact.stage == "s06_geometry":
            # What is modelled in part has small things where stage 7 put them; where they belong is not its word.
            layout = layout.model_copy(update={"proxies": [p for p in layout.proxies if p.placement != "surface"]})
        return layout.model_copy(update={"proxies": _others(layout.proxies, chosen)})
    return artifact


def _others(items: Iterable[Any], chosen: set[str]) -> list[Any]:
    return sorted((i for i in items if i.id not in chosen), key=lambda i: str(i.id))
