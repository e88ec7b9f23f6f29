# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist says of single objects' geometry: functions edited in the program, objects shown as boxes.

It is kept in memory, so that it survives whatever builds the room anew; stage 6 takes it over.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from .artifacts.layout import Layout, LayoutProgram
from .artifacts.objects import Geometry, ObjectProgram, OwnModelling
from .errors import ProgramError, RoomError
from .memory import EntryMeta, Memory, dump_memory, now
from .objects.cloths import furnish_line
from .objects.text import Modelling, read_modelling, with_statements, without_statements
from .program.lines import parse_layout
from .run_assets import change_clothes, chosen_of
from .run_corrections import ARTIST, program_of

if TYPE_CHECKING:
    from .run import Run

GEOMETRY = "s06_geometry"


def own_of(memory: Memory) -> OwnModelling:
    """What the artist says of the objects' geometry."""
    return memory.latest(OwnModelling) or OwnModelling()


def note_own_functions(memory: Memory, text: str) -> list[str]:
    """Keep the functions that the artist edited in the program's text.

    Returns:
        Ids of the objects whose functions are new.
    """
    own, stages = own_of(memory), {e.stage for e in memory.entries if e.type == LayoutProgram.__name__}
    programs = [p.text for stage in stages if (p := program_of(memory, (stage,))) is not None]
    try:
        edited = read_modelling(text)
        made = [read_modelling(program) for program in programs]
    except ProgramError:
        return []
    functions, boxes = dict(own.functions), list(own.boxes)
    changed = []
    for identifier in edited.furnished:
        code = snippet(edited, identifier)
        if code not in (own.functions.get(identifier, ""), *(snippet(m, identifier) for m in made)):
            functions[identifier] = code
            changed.append(identifier)
            boxes = [other for other in boxes if other != identifier]
    if functions != own.functions or boxes != own.boxes:
        memory.append(ARTIST, OwnModelling(functions=functions, boxes=boxes), EntryMeta(time=now(), model=ARTIST))
    return changed


def snippet(modelling: Modelling, identifier: str) -> str:
    """An object's function with its helpers and its furnish statement, "" when it is not furnished."""
    if identifier not in modelling.furnished:
        return ""
    return "\n\n\n".join(p for p in (modelling.code_of(identifier), modelling.furnished[identifier]) if p)


def show_as_boxes(run: Run, names: Collection[str], boxes: bool) -> int:
    """Show these objects as their plain proxies, or detailed again. Main thread only.

    Returns:
        How many objects look different now.

    Raises:
        RoomError: none of them has geometry of its own, or the room cannot be built; nothing is changed then.
    """
    run.take_over_edits()
    text = run.backend.program_text()
    standing = read_modelling(text)
    program = program_of(run.memory)
    own, geometry = own_of(run.memory), run.memory.latest(Geometry) or Geometry()
    chosen = chosen_of(run.memory)
    if boxes:
        changed = [i for i in standing.furnished if i in names]
        built = without_statements(text, changed)
    else:
        known = {i: own.functions.get(i, "") for i in names if i in own.boxes and i not in standing.furnished}
        layout = parse_layout(text)
        statements = {i: _statement(i, code, geometry, standing, layout) for i, code in known.items()}
        changed = [i for i, statement in statements.items() if statement]
        built = with_statements(text, [statements[i] for i in changed])
    dressed = [c for c in chosen.objects if c.id in names and (c.id in own.boxes) != boxes]
    changed += [c.id for c in dressed if c.id not in changed]
    if not changed:
        raise RoomError(
            "These objects are boxes already." if boxes else "These objects have no geometry that could be shown.",
            "" if boxes else "Use Detail Again.",
        )
    run.backend.build(built)
    change_clothes(run, changed, [] if boxes else dressed, built)
    left = [i for i in own.boxes if i not in changed]
    meta = EntryMeta(time=now(), model=ARTIST)
    run.memory.append(ARTIST, own.model_copy(update={"boxes": [*left, *changed] if boxes else left}), meta)
    if program is not None:
        _note(run.memory, program, built)
    run.backend.save_memory(dump_memory(run.memory))
    return len(changed)


def _statement(identifier: str, code: str, geometry: Geometry, standing: Modelling, layout: Layout) -> str:
    """The furnish statement that an object had."""
    if code:
        return read_modelling(code).furnished.get(identifier, "")
    made = geometry.of(identifier)
    name = made.function if made is not None else ""
    proxy = layout.proxy(identifier)
    return furnish_line(proxy, name) if name in standing.defs and proxy is not None else ""


def _note(memory: Memory, program: LayoutProgram, text: str) -> None:
    """Memory's program has what the scene shows; the stage that wrote it stays as done or as stale as it was."""
    entry = memory.latest_entry(LayoutProgram.__name__)
    assert entry is not None
    meta = entry.meta.model_copy(update={"time": now()})
    memory.append(entry.stage, program.model_copy(update={"text": text}), meta)


def forget_own(memory: Memory, names: Collection[str]) -> None:
    """Stage 6 may model these objects anew, whatever the artist said of their geometry before."""
    own = own_of(memory)
    functions = {i: code for i, code in own.functions.items() if i not in names}
    boxes = [i for i in own.boxes if i not in names]
    if functions != own.functions or boxes != own.boxes:
        memory.append(ARTIST, OwnModelling(functions=functions, boxes=boxes), EntryMeta(time=now(), model=ARTIST))


def function_line(text: str, identifier: str) -> int:
    """The line of an object's function in a room text, 1-based; 0 when it has none."""
    modelling = read_modelling(text)
    name = modelling.functions.get(identifier, "")
    lines = text.splitlines()
    return next((n for n, line in enumerate(lines, 1) if line.startswith(f"def {name}(")), 0) if name else 0


def made_of(memory: Memory) -> dict[str, ObjectProgram]:
    """How each object is modelled, by its id."""
    geometry = memory.latest(Geometry)
    return {o.id: o for o in geometry.objects} if geometry is not None else {}
