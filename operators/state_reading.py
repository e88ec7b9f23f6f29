# SPDX-License-Identifier: GPL-3.0-or-later
"""Works out what the panel shows of a room (`view_state.RoomState`) from its memory, its picture and the settings.

Memory's entries never change once they are written, so an artifact is validated once and kept as long as its entry.
"""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar

from pydantic import BaseModel

from ..pipeline.analysis.scale import scale_sentence
from ..pipeline.artifacts.analysis import Calibration, SceneAnalysis
from ..pipeline.artifacts.assets import ChosenAssets
from ..pipeline.artifacts.corrections import Corrections
from ..pipeline.artifacts.draft import DraftProgram
from ..pipeline.artifacts.hand import HandEdits
from ..pipeline.artifacts.layout import LayoutEdit, LayoutProgram
from ..pipeline.draft.verdict import judge
from ..pipeline.errors import RoomError
from ..pipeline.memory import Entry, Memory
from ..pipeline.models.base import ModelClient
from ..pipeline.picture import ReferencePicture
from ..pipeline.program.words import edit_in_words
from ..pipeline.report import all_findings, floor_size
from ..pipeline.report_objects import ObjectRow, object_rows
from ..pipeline.report_rounds import round_rows
from ..pipeline.run import Run
from ..pipeline.run_corrections import edits_of, found_of, program_of
from ..pipeline.stages.base import Stage, View
from . import clients, finish_state, journals, reference, room_memory, texture_state, view_state, ways
from .view_state import Problem, RoomState, StageRow

A = TypeVar("A", bound=BaseModel)
LOOP = "s03_layout"
_MOST_ARTIFACTS, _MOST = 64, 6
_artifacts: OrderedDict[int, tuple[Entry, BaseModel]] = OrderedDict()
_known: OrderedDict[tuple[int, ...], tuple[list[Entry], dict[str, Any]]] = OrderedDict()


def read(scene: Any) -> RoomState:
    """The state of one scene's room. Main thread only.

    Raises:
        RoomError: the picture or the memory cannot be read; what is known without them is lost to the caller.
    """
    state, client = RoomState(), clients.NOBODY
    try:
        client = clients.current_client()
        state = replace(state, answers=client.describes, uses_model=client.name != "builtin", **_way(client))
    except RoomError as error:
        state = replace(state, client_problem=Problem.of(error), uses_model=True)
    picture = room_memory.picture_of(scene)
    if picture is None:
        was_there = bool(scene.code_as_room.picture_name)
        return replace(state, problem=Problem.of(reference.missing(scene))) if was_there else state
    state = replace(state, picture_name=picture.name, picture_size=(picture.width, picture.height))
    try:
        run = room_memory.run_of(scene)
        run.client = client  # answers are kept by who gave them
        run.journal = run.journal or journals.journal_of(picture.sha256)
    except RoomError as error:
        return replace(state, problem=Problem.of(error), has_memory=True)
    return _with_memory(state, scene.session_uid, run)


def _with_memory(state: RoomState, uid: int, run: Run) -> RoomState:
    known, stages = _facts(run.memory, run.picture), _stages(run, uid, ways.path_of(state.way))
    titles = {row.name: row.title for row in known["objects"] if row.name}
    textures, finish = texture_state.read(run.memory, titles), finish_state.read(run.memory, titles)
    state = replace(
        state, **known, stages=stages, textures=textures, finish=finish, has_memory=bool(run.memory.entries)
    )
    if not state.uses_model or state.client_problem is not None:
        return state
    return replace(state, estimate=_estimate(run, stages), spending=_spending(run))


def _estimate(run: Run, stages: tuple[StageRow, ...]) -> str:
    """What the stages that are left may cost, "" where nothing is asked of a service."""
    left = [row.id for row in stages if not row.is_done and row.status != "answered"]
    if ways.DRAFT in left:
        left = [ways.DRAFT]  # the others are answered from it
    rounds = run.memory.settings.get("iterations", "")
    try:
        estimate = clients.run_estimate(left, int(rounds) if rounds.isdigit() else 5) if left else None
    except RoomError:
        return ""  # the run itself says what is wrong
    return estimate.sentence() if estimate is not None else ""


def _spending(run: Run) -> str:
    """What this room has cost, and the cap; "" where no money is spent."""
    try:
        meter = clients.room_meter(run.picture.sha256, run.memory.cost()[2])
    except RoomError:
        return ""
    words = f"${meter.spent:.2f} spent" if meter.spent else ""
    words += (
        f" of at most ${meter.cap:.2f}" if meter.cap and words else f"At most ${meter.cap:.2f}" if meter.cap else ""
    )
    share = 100 * meter.cached // max(1, meter.tokens[0])
    words += f"; {share} % of what was sent came from the service's cache" if words and share else ""
    unpriced = f"; the price of {', '.join(meter.unpriced)} is not known" if meter.unpriced else ""
    return words + unpriced if words else unpriced.removeprefix("; ").capitalize()


def _facts(memory: Memory, picture: ReferencePicture) -> dict[str, Any]:
    """What memory alone decides, worked out once for the same entries: most refreshes change nothing of it."""
    written = [entry for entry in memory.entries if entry.type != "Answer"]
    key = tuple(id(entry) for entry in written)
    # The entries are kept beside what follows from them, so that their ids cannot become those of others.
    found = _known.get(key)
    if found is None:
        found = _known[key] = (written, _read_facts(memory, picture))
        while len(_known) > _MOST:
            _known.popitem(last=False)
    return found[1]


def _read_facts(memory: Memory, picture: ReferencePicture) -> dict[str, Any]:
    """Fields of `RoomState`."""
    program, edits = program_of(memory), edits_of(memory)
    rows = _object_rows(memory, picture, program, edits)
    last = kept(memory, HandEdits)
    # What only moved along with what carries it is no edit of the artist's.
    made = [edit for edit in last.edits if edit.origin != "parent"] if last is not None else []
    findings = all_findings(memory)
    return {
        **_camera_facts(memory),
        **_draft_facts(memory),
        "score": program.score.total if program is not None else None,
        "has_layout": program is not None,
        "hand_edits": len([e for e in edits if e.origin != "parent"]),
        "last_edits": tuple(edit_in_words(edit) for edit in made[-view_state.MOST_EDITS :]),
        "last_count": len(made),
        "ledger": tuple(Counter(row.state for row in rows).items()),
        "severities": tuple(Counter(f.severity for f in findings).items()),
        "findings": tuple(findings),
        "objects": rows,
        "assets": tuple((kept(memory, ChosenAssets) or ChosenAssets()).objects),
        "rounds": round_rows(kept(memory, LayoutProgram, (LOOP,))),
    }


def _camera_facts(memory: Memory) -> dict[str, Any]:
    calibration = kept(memory, Calibration)
    if calibration is None:
        return {}
    return {
        "room_size": (*floor_size(calibration), calibration.height),
        "camera_kind": calibration.camera.kind,
        "camera_name": calibration.tried[0].name if calibration.tried else "",
        "scale_words": scale_sentence(calibration),
        "error_px": calibration.error_px,
    }


def _object_rows(
    memory: Memory, picture: ReferencePicture, program: LayoutProgram | None, edits: list[LayoutEdit]
) -> tuple[ObjectRow, ...]:
    found, analysis = found_of(memory), kept(memory, SceneAnalysis)
    corrections = kept(memory, Corrections) or Corrections()
    return object_rows(
        found.analysis if found is not None else analysis,
        analysis,
        kept(memory, Calibration),
        program,
        corrections,
        edits,
        View(picture, hand_edits=tuple(edits), corrections=corrections).locked,
    )


def kept(memory: Memory, kind: type[A], stages: tuple[str, ...] = ()) -> A | None:
    """As `Memory.latest`, validated once for each entry. What comes back is shared: never change it."""
    entry = memory.latest_entry(kind.__name__, stages or None)
    if entry is None:
        return None
    # The entry is kept beside its artifact, so that its id cannot become another's.
    found = _artifacts.get(id(entry))
    if found is None:
        found = _artifacts[id(entry)] = (entry, kind.model_validate(entry.output))
        while len(_artifacts) > _MOST_ARTIFACTS:
            _artifacts.popitem(last=False)
    artifact = found[1]
    return artifact if isinstance(artifact, kind) else None


def forget_all() -> None:
    """Another file is opened."""
    _artifacts.clear()
    _known.clear()


def _draft_facts(memory: Memory) -> dict[str, Any]:
    """Fields of `RoomState`: what is said of the draft."""
    verdict = judge(memory) if kept(memory, DraftProgram) is not None else None
    if verdict is None:
        return {}
    return {"has_draft": True, "verdict": verdict.sentence, "is_poor": verdict.is_poor}


def _way(client: ModelClient) -> dict[str, Any]:
    """Fields of `RoomState`: how the room is made."""
    return {"way": ways.chosen(client), "offers_draft": ways.offers_draft(client)}


def _stages(run: Run, uid: int, path: Sequence[Stage]) -> tuple[StageRow, ...]:
    rows: list[StageRow] = []
    blocked = ""
    for stage in path:
        status: str = run.status(stage)
        entry = run.memory.latest_entry(stage.writes[0].__name__, (stage.id,))
        by_draft = entry is None or ways.is_derived(entry)
        status = "drafted" if status == "done" and entry is not None and by_draft else status
        failure = view_state.failure(uid, stage.id)
        detail = "What it was made from has changed" if status == "stale" else ""
        shown = status if failure is None else "failed"
        detail = detail if failure is None else failure.sentence
        rows.append(StageRow(stage.id, stage.title, shown, detail, blocked, stage.partial, by_draft))
        if status in ("not run", "answered") and not blocked:
            blocked = f"It needs the stage before it: {stage.title}"
    return tuple(rows)
