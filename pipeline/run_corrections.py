# SPDX-License-Identifier: GPL-3.0-or-later
"""The artist's corrections take effect: at once, without asking a model, and without losing what was done before.

Corrections are always applied to what stage 1 found, never on top of an earlier correction. A change of scale alone
multiplies everything that is known, placed and built, so that stages which were done stay done. Corrections that follow
each other with nothing in between leave one block of entries: what nobody has read yet is replaced.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

from .analysis.correct import Corrected, Known, correct_found
from .analysis.frames import Change, between, same_room
from .analysis.identity import normal
from .analysis.rescale import Similarity, rescaled_edit
from .artifacts.analysis import Calibration, Finding, SceneAnalysis
from .artifacts.corrections import Corrections, Found, Rescaled
from .artifacts.hand import HandEdits
from .artifacts.layout import LayoutEdit, LayoutProgram
from .layout.reshell import Follow, follow_scale, follow_shell, moved_program
from .memory import Entry, EntryMeta, Memory, content_hash, dump_memory, now
from .stages import all_stages
from .stages.base import Stage

if TYPE_CHECKING:
    from .run import Run

ANALYSIS = "s01_analysis"
ARTIST = "artist"
NOTE = "note on "
COPIED = "Brought to the artist's measures; nothing was asked again."
Room = tuple[SceneAnalysis, Calibration]


def corrections_of(memory: Memory) -> Corrections:
    """The artist's corrections as they stand."""
    return memory.latest(Corrections) or Corrections()


def found_of(memory: Memory) -> Found | None:
    """What stage 1 found last, before the artist's corrections; None when it has not run."""
    for entry in reversed(memory.entries):
        if entry.stage != ANALYSIS:
            continue
        if entry.type == Found.__name__:
            return Found.model_validate(entry.output)
        if entry.type == SceneAnalysis.__name__:
            calibration = memory.latest(Calibration, (ANALYSIS,))
            if calibration is None:
                return None
            return Found(analysis=SceneAnalysis.model_validate(entry.output), calibration=calibration)
    return None


def edits_of(memory: Memory) -> list[LayoutEdit]:
    """All edits by hand so far, oldest first, in the metres that hold now."""
    kept: list[LayoutEdit] = []
    for entry in memory.entries:
        if entry.type == HandEdits.__name__:
            kept += HandEdits.model_validate(entry.output).edits
        elif entry.type == Rescaled.__name__ and kept:
            change = Similarity.of(Rescaled.model_validate(entry.output))
            kept = [rescaled_edit(edit, change) for edit in kept]
    return kept


def program_of(memory: Memory, stages: tuple[str, ...] = ()) -> LayoutProgram | None:
    """The latest layout program, in the metres that hold now."""
    entry = memory.latest_entry(LayoutProgram.__name__, stages or None)
    if entry is None:
        return None
    program = LayoutProgram.model_validate(entry.output)
    # Looked for as the very same one: two entries may be equal.
    place = next(i for i, other in enumerate(memory.entries) if other is entry)
    for later in memory.entries[place + 1 :]:
        if later.type == Rescaled.__name__:
            program = moved_program(program, Similarity.of(Rescaled.model_validate(later.output)))
    return program


def inputs_of(memory: Memory, stage: Stage) -> dict[str, str]:
    """Hashes of everything that a stage depends on, by name: what it reads, and the settings and notes that it uses."""
    used = {name: value for name, value in memory.settings.items() if name in stage.settings}
    hashes = {"picture": memory.picture_hash[:20], "settings": content_hash(used)}
    for read in stage.reads:
        hashes[read.kind.__name__] = memory.hash_of(read.kind.__name__, read.stages or None)
    if stage.notes:
        hashes |= {f"{NOTE}{c.id}": content_hash(c.note) for c in corrections_of(memory).objects if c.note}
    return hashes


def known_of(settings: Mapping[str, str]) -> Known:
    """The sizes that the artist knows, from the settings."""
    return Known(_positive(settings, "known_width_m"), _positive(settings, "wall_height_m"))


def correct(run: Run, corrections: Corrections) -> list[Finding]:
    """Take over the artist's corrections and known sizes. Asks no model; main thread only.

    Stage 1 stays done. When only the scale or the height of the walls changed, every stage that was done stays done and
    the built room follows; otherwise later stages become stale. Before stage 1 has run the corrections wait for it.

    Raises:
        RoomError: the corrections cannot be (no room has such corners, a known length off the floor); nothing is changed.
    """
    found = found_of(run.memory)
    if found is None:
        run.memory.append(ARTIST, corrections, _meta())
        run.backend.save_memory(dump_memory(run.memory))
        return []
    corrections = normal(corrections, found)
    new = correct_found(found, corrections, known_of(run.memory.settings))
    if _same(new, _room(run.memory)):
        _replace(run, _reworded(run.memory, corrections))
        return list(new.findings)
    change = between(_room(run.memory)[1], new.calibration)
    if change.nothing:
        _replace(run, _block(run.memory, corrections, new, "", ""))
        return list(new.findings)
    # What was moved by hand is still in the old metres: it is taken over before they change.
    run.take_over_edits()
    standing = run.backend.program_text()
    before, built = _built(run.memory, new, standing)
    block = _block(run.memory, corrections, new, before, built)
    if built != standing:
        run.backend.build(built)
    _replace(run, block)
    return list(new.findings)


def bring_up_to_date(run: Run) -> list[Finding]:
    """Apply the corrections again when a known size was changed since; does nothing when they hold. Main thread only.

    Raises:
        RoomError: as `correct`.
    """
    found = found_of(run.memory)
    if found is None:
        return []
    corrections = normal(corrections_of(run.memory), found)
    new = correct_found(found, corrections, known_of(run.memory.settings))
    if _same(new, _room(run.memory)):
        return []
    return correct(run, corrections)


def _room(memory: Memory) -> Room:
    """The analysis and the calibration as they stand."""
    analysis, calibration = memory.latest(SceneAnalysis), memory.latest(Calibration)
    assert analysis is not None and calibration is not None, "stage 1 has run"
    return analysis, calibration


def _same(new: Corrected, room: Room) -> bool:
    return new.analysis == room[0] and new.calibration == room[1]


def _before_block(memory: Memory) -> Memory:
    """The memory without the corrections at its end that nobody has read yet."""
    count = len(memory.entries)
    while count and _is_correction(memory.entries[count - 1]):
        count -= 1
    return replace(memory, entries=memory.entries[:count])


def _is_correction(entry: Entry) -> bool:
    if COPIED in entry.meta.notes:
        return True
    kinds = (Corrections.__name__, SceneAnalysis.__name__, Calibration.__name__, Rescaled.__name__)
    return entry.stage == ARTIST and entry.type in kinds


def _follow(memory: Memory, new: Corrected, change: Change) -> Follow:
    """How a room text that was made in the memory's metres follows the corrections."""
    if change.pure:
        return follow_scale(change.metres)
    locked = frozenset(c.id for c in corrections_of(memory).objects if c.locked)
    return follow_shell(change.metres, _room(memory), (new.analysis, new.calibration), locked)


def _built(memory: Memory, new: Corrected, standing: str) -> tuple[str, str]:
    """The program that the scene shall show instead of what stands, and which one stood before the present block.

    Numbers are rounded when they are written, so a row of corrections always starts from the text before the first.
    """
    if not standing.strip():
        return "", standing
    base = _before_block(memory)
    last = replace(memory, entries=memory.entries[len(base.entries) :]).latest(Rescaled)
    if last is not None and last.before and last.after == standing:
        change = between(_room(base)[1], new.calibration)
        return last.before, _follow(base, new, change)(last.before)
    change = between(_room(memory)[1], new.calibration)
    return "" if last is not None else standing, _follow(memory, new, change)(standing)


def _block(memory: Memory, corrections: Corrections, new: Corrected, before: str, built: str) -> Memory:
    """The memory with the corrections in the place of those at its end."""
    base = _before_block(memory)
    result = replace(base, entries=list(base.entries))
    room = _room(base)
    change = between(room[1], new.calibration)
    alike = same_room(room[0], new.analysis, change.metres)
    if corrections != corrections_of(base):
        result.append(ARTIST, corrections, _meta())
    if new.analysis != room[0]:
        result.append(ARTIST, new.analysis, _meta())
    if new.calibration != room[1]:
        result.append(ARTIST, new.calibration, _meta())
    if change.metres.moves:
        entry = Rescaled(factor=change.metres.factor, shift=change.metres.shift, before=before, after=built)
        result.append(ARTIST, entry, _meta())
    follow = None if change.nothing else cache(_follow(base, new, change))
    for stage in all_stages():
        if stage.id != ANALYSIS:
            _copy(stage, base, result, follow, change, alike)
    return result


def _reworded(memory: Memory, corrections: Corrections) -> Memory:
    """The memory with corrections that change nothing of the analysis, such as notes and locks."""
    base = _before_block(memory)
    block = [e for e in memory.entries[len(base.entries) :] if e.type != Corrections.__name__]
    result = replace(base, entries=[*base.entries, *block])
    if corrections != corrections_of(base):
        result.append(ARTIST, corrections, _meta())
    return result


def _copy(stage: Stage, base: Memory, result: Memory, follow: Follow | None, change: Change, alike: bool) -> None:
    """What a stage wrote, in the new metres. It stays done when it was and nothing but the measures changed."""
    entries = [e for kind in stage.writes if (e := base.latest_entry(kind.__name__, (stage.id,))) is not None]
    if not entries:
        return
    inputs = entries[0].meta.inputs
    if alike and inputs == inputs_of(base, stage):
        # What it read is the same room in other metres; settings and notes count as they did.
        read = {kind.kind.__name__ for kind in stage.reads}
        present = inputs_of(result, stage)
        inputs = {name: present[name] if name in read else value for name, value in inputs.items()}
    if inputs == entries[0].meta.inputs and (follow is None or LayoutProgram not in stage.writes):
        return
    for entry in entries:
        output = entry.output
        if follow is not None and entry.type == LayoutProgram.__name__:
            output = moved_program(LayoutProgram.model_validate(output), change.metres, follow).model_dump(mode="json")
        notes = [*(n for n in entry.meta.notes if n != COPIED), COPIED]
        meta = entry.meta.model_copy(update={"inputs": inputs, "notes": notes})
        result.entries.append(Entry(stage=stage.id, type=entry.type, output=output, meta=meta))


def _replace(run: Run, memory: Memory) -> None:
    """Make this the run's memory and keep its text."""
    run.memory.entries = memory.entries
    run.backend.save_memory(dump_memory(run.memory))


def _meta() -> EntryMeta:
    return EntryMeta(time=now(), model=ARTIST)


def _positive(settings: Mapping[str, str], name: str) -> float | None:
    try:
        value = float(settings.get(name, ""))
    except ValueError:
        return None
    return value if 0 < value < 1e6 else None
