# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 6, geometry: every proxy gets a function of its own that models it; the room's program furnishes it with that.

Everything has its library piece first, in the picture's colours. A model may then choose better pieces, or write
programs; what fails leaves the library piece in place, with a note.
"""

from __future__ import annotations

from ..artifacts.analysis import Calibration, Finding, SceneAnalysis
from ..artifacts.draft import DraftProgram
from ..artifacts.layout import Layout, LayoutProgram, LedgerEntry
from ..artifacts.objects import Descriptions, Geometry, ObjectProgram, OwnModelling, RoomStyle
from ..draft.kept import DRAFTED, LOOKED
from ..errors import RoomError
from ..layout.hand import apply_hand_edits, name_now
from ..layout.pins import pinned
from ..objects.detailing import Detailing
from ..program.lines import parse_layout
from .base import Reads, Stage, View
from .carrying import Renames, carried_on
from .s06_asking import choose_pieces, write_programs
from .wishes import Build, StageRun, Tell

ID = "s06_geometry"


def run(view: View) -> StageRun:
    """Write the `LayoutProgram` with everything furnished, and `Geometry`, which says who modelled what."""
    before = view.need(LayoutProgram)
    layout, findings = apply_hand_edits(parse_layout(before.text), view.hand_edits, before.hand_edits)
    standing, names = view.recall(LayoutProgram), _Names(view.hand_edits, layout)
    if view.only is not None:
        if standing is None:
            raise RoomError("Nothing is modelled yet that could be kept.", "Run the whole stage first.")
        layout = _small_things_stay(view, layout, standing)
    detailing = Detailing.begin(
        layout,
        names.in_descriptions(view.need(Descriptions)),
        view.need(RoomStyle),
        names.in_text(standing.text) if standing is not None else "",
        names.in_geometry(view.recall(Geometry) or Geometry()),
        names.in_own(view.recall(OwnModelling) or OwnModelling()),
        _kept(view, layout),
        _as_drafted(view, names),
    )
    yield Tell("Choosing from the library", 1, 3)
    detailing.from_library()
    yield Tell("Modelling the objects", 2, 3)
    if detailing.todo and view.settings.get("objects") in ("programs", DRAFTED, LOOKED):
        yield from write_programs(view, detailing)
    elif detailing.todo:
        yield from choose_pieces(view, detailing)
    text = detailing.sound_text()
    geometry = detailing.geometry()
    yield Tell("Building the room", 3, 3)
    yield Build(text)
    ledger = [_ledger_line(view, entry, geometry) for entry in before.ledger]
    program = carried_on(view, before, ID, text, layout, findings, ledger, iterations=[])
    return [program, geometry.model_copy(update={"findings": [*geometry.findings, _summary(geometry)]})]


def _as_drafted(view: View, names: _Names) -> dict[str, str] | None:
    """Which things the draft makes like others, where it answers this stage; None where the measurements say it."""
    draft = view.recall(DraftProgram) if view.settings.get("objects") in (DRAFTED, LOOKED) else None
    return None if draft is None else {names.now(i): names.now(first) for i, first in draft.twins.items()}


class _Names(Renames):
    """What objects that were renamed by hand since are called now, in everything that this stage reads."""

    def in_descriptions(self, found: Descriptions) -> Descriptions:
        """Descriptions under present ids."""
        return found.model_copy(
            update={"objects": [o.model_copy(update={"id": self.now(o.id)}) for o in found.objects]}
        )

    def in_geometry(self, found: Geometry) -> Geometry:
        """Who modelled what under present ids."""
        changed = [o.model_copy(update={"id": self.now(o.id), "like": self.now(o.like)}) for o in found.objects]
        return found.model_copy(update={"objects": changed})

    def in_own(self, own: OwnModelling) -> OwnModelling:
        """What the artist says under present ids."""
        functions = {self.now(i): self.in_text(code) for i, code in own.functions.items()}
        return OwnModelling(functions=functions, boxes=[self.now(i) for i in own.boxes])


def _small_things_stay(view: View, layout: Layout, standing: LayoutProgram) -> Layout:
    """The layout with small things where stage 7 put them: only a part is done anew, and nothing else is to jump."""
    there, _ = apply_hand_edits(parse_layout(standing.text), view.hand_edits, standing.hand_edits)
    return pinned(layout, there, {p.id for p in there.proxies if p.placement == "surface"}, ())


def _kept(view: View, layout: Layout) -> frozenset[str]:
    """Ids that stay as they are: what is not chosen, and what is locked."""
    if view.only is None:
        return view.locked
    return frozenset(p.id for p in layout.proxies if not view.chosen(p.id))


def _ledger_line(view: View, entry: LedgerEntry, geometry: Geometry) -> LedgerEntry:
    """What became of a detected object by now."""
    name = name_now(view.hand_edits, entry.id)
    made = geometry.of(name) if name is not None else None
    if name is None:
        return entry.model_copy(update={"state": "dropped", "reason": entry.reason or "removed by hand"})
    if entry.state not in ("placed", "detailed", "deferred") or made is None:
        return entry
    if made.source == "proxy":
        return entry.model_copy(update={"state": "placed", "reason": made.note})
    return entry.model_copy(update={"state": "detailed", "reason": _how(made)})


def _how(made: ObjectProgram) -> str:
    words = {"program": "modelled by its own program", "artist": "modelled by your function"}
    said = words.get(made.source, f"library: {made.piece.replace('_', ' ')}")
    return f"{said}, like {made.like}" if made.like else said


def _summary(geometry: Geometry) -> Finding:
    counts = {s: sum(o.source == s for o in geometry.objects) for s in ("program", "library", "artist", "proxy")}
    words = {"program": "by programs", "library": "from the library", "artist": "by you", "proxy": "left as boxes"}
    said = ", ".join(f"{counts[s]} {words[s]}" for s in words if counts[s])
    return Finding(about="objects", message=f"{len(geometry.objects)} objects: {said or 'none'}.")


STAGE = Stage(
    id=ID,
    title="Geometry",
    reads=(
        Reads(SceneAnalysis),
        Reads(Calibration),
        Reads(LayoutProgram, ("s04_auxiliary",)),
        Reads(Descriptions),
        Reads(RoomStyle),
    ),
    writes=(LayoutProgram, Geometry),
    run=run,
    settings=("objects",),
    notes=True,
    partial=True,
    recalls=(Reads(LayoutProgram, (ID, "s07_surfaces")), Reads(Geometry), Reads(OwnModelling), Reads(DraftProgram)),
)
