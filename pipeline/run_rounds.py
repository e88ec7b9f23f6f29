# SPDX-License-Identifier: GPL-3.0-or-later
"""Making another round of the layout loop the layout: it stands as if stage 3 had kept it, so stage 4 becomes stale."""

from __future__ import annotations

from collections.abc import Sequence

from .artifacts.layout import LayoutEdit, LayoutProgram, ProxyLine
from .errors import RoomError
from .layout.hand import apply_hand_edits
from .memory import dump_memory, now
from .program.lines import parse_layout, print_layout
from .run import Run
from .run_corrections import program_of
from .stages import s03_layout

TAKEN = "Taken by the artist."


def take_round(run: Run, number: int) -> LayoutProgram:
    """Make this round of stage 3 the layout, with the artist's edits on top, and build it. Main thread only.

    What is locked stays where it stands. Stage 3 stays as done or as stale as it was.

    Args:
        number: as `Iteration.number`.

    Raises:
        RoomError: there is no such round, or its program cannot be built; nothing is changed then.
    """
    program = program_of(run.memory, (s03_layout.ID,))
    entry = run.memory.latest_entry(LayoutProgram.__name__, (s03_layout.ID,))
    found = next((i for i in program.iterations if i.number == number), None) if program is not None else None
    if program is None or entry is None or found is None:
        raise RoomError(f"There is no round {number + 1}.", "Run the major layout first.")
    run.take_over_edits()
    edits = run.hand_edits()
    # All rounds get the edits, since `hand_edits` counts for the whole program and another may be taken next.
    iterations = [
        item.model_copy(update={"program": _with_edits(item.program, edits, program.hand_edits)})
        for item in program.iterations
    ]
    text = _with_locked(next(item.program for item in iterations if item.number == number), _locked_lines(run))
    taken = program.model_copy(
        update={
            "text": text,
            "score": found.score,
            "best": number,
            "iterations": iterations,
            "hand_edits": len(edits),
        }
    )
    run.backend.build(text)
    notes = [note for note in entry.meta.notes if note != TAKEN]
    run.memory.append(s03_layout.ID, taken, entry.meta.model_copy(update={"time": now(), "notes": [*notes, TAKEN]}))
    run.backend.save_memory(dump_memory(run.memory))
    return taken


def _with_edits(text: str, edits: Sequence[LayoutEdit], done: int) -> str:
    """A round's program with the edits that it does not hold yet."""
    return print_layout(apply_hand_edits(parse_layout(text), edits, done)[0])


def _with_locked(text: str, locked: dict[str, ProxyLine]) -> str:
    """The program with what is locked as it stands. The rounds themselves keep theirs: it may be unlocked again."""
    layout = parse_layout(text)
    return print_layout(layout.model_copy(update={"proxies": [locked.get(p.id, p) for p in layout.proxies]}))


def _locked_lines(run: Run) -> dict[str, ProxyLine]:
    """The locked proxies as they stand in the scene."""
    locked = run.view(s03_layout.STAGE).locked
    text = run.backend.program_text()
    if not locked or not text:
        return {}
    return {proxy.id: proxy for proxy in parse_layout(text).proxies if proxy.id in locked}
