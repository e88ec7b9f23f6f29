# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 7, small objects: what stands or lies on something is put onto the built surfaces, where the picture shows it.

Nothing is asked: surfaces, free area and heights are known from the geometry by now. What fits an asset of the artist's
own libraries looks like it afterwards (`s07_retrieval`). (Paper, stage 7.)
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ..artifacts.analysis import Calibration, DetectedObject, Finding, SceneAnalysis
from ..artifacts.assets import ChosenAssets
from ..artifacts.layout import Layout, LayoutProgram, LedgerEntry, ProxyLine
from ..artifacts.objects import Descriptions, Geometry, ObjectProgram, OwnModelling, RoomStyle
from ..artifacts.surfaces import SmallObjects, SmallPlace
from ..errors import ProgramError
from ..layout.auxiliary import order_by_depth
from ..layout.hand import apply_hand_edits
from ..layout.initial import proxy_of
from ..layout.pins import pinned
from ..objects.cloths import is_lying_cloth
from ..objects.detailing import Detailing
from ..objects.text import relaid
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout
from ..program.prelude.proxies import proxy_shapes
from ..program.prelude.shape import Shape
from ..surfaces.choose import Carriers, Seated, carriers_under
from ..surfaces.frame import base_of
from ..surfaces.hang import is_hung, on_its_rail, under_rail
from .base import Reads, Stage, View
from .carrying import carried_on
from .s07_retrieval import SETTING, retrieve
from .wishes import Build, StageRun, Tell

ID = "s07_surfaces"
REPORT = 0.05
"""Metres of moving that are told of."""


def run(view: View) -> StageRun:
    """Write the `LayoutProgram` with every small object on its surface, and `SmallObjects`, which says where and why."""
    before = view.need(LayoutProgram)
    layout, findings = apply_hand_edits(parse_layout(before.text), view.hand_edits, before.hand_edits)
    layout = _as_it_stands(view, layout)
    yield Tell("Looking for surfaces", 1, 3)
    text = relaid(before.text, layout)
    seating = _Seating(view, layout, shapes_of(text))
    yield Tell("Putting things onto surfaces", 2, 3)
    seating.run()
    text = seating.on_rails(seating.sound(text, layout))
    geometry = view.need(Geometry)
    if seating.new:
        text, geometry = _modelled(view, seating, text, geometry)
    yield Tell("Building the room", 3, 3)
    yield Build(text)
    assets = yield from retrieve(view, seating.layout, seating.open_names())
    ledger = [seating.ledger_line(entry) for entry in before.ledger]
    program = carried_on(view, before, ID, text, layout, findings, ledger)
    small = SmallObjects(places=seating.places, findings=[*seating.findings, *assets.findings])
    return [program, small, geometry, *([assets.chosen] if assets.chosen is not None else [])]


def _as_it_stands(view: View, layout: Layout) -> Layout:
    """The layout with what is locked, and what is not chosen, where this stage put it the last time."""
    standing = view.recall(LayoutProgram)
    if standing is None:
        return layout
    analysis = view.need(SceneAnalysis)
    names = view.names(analysis)
    there, _ = apply_hand_edits(parse_layout(standing.text), view.hand_edits, standing.hand_edits)
    small = {p.id for p in there.proxies if p.placement == "surface"}
    chosen = {name for o in analysis.objects if view.chosen(o.id) and (name := names[o.id]) is not None}
    held = (small & view.locked) | (small - chosen)
    return pinned(layout, there, held, names.values())


def shapes_of(text: str) -> dict[str, list[Shape]]:
    """The parts of every object of a room text in its own frame, cloths not laid yet; a bare proxy's are its box."""
    record = evaluate(text, FINISHED_ROOM_LIMITS)
    made = record.furnished | record.plain
    return {line["id"]: made.get(line["id"]) or proxy_shapes(line) for line in record.proxies}


@dataclass
class _Seating:
    """Small objects on their way onto surfaces.

    Attributes:
        layout: where everything stands by now; shapes: the parts of each thing in its own frame.
        new: ids that had no proxy before.
    """

    view: View
    layout: Layout
    shapes: dict[str, list[Shape]]
    places: list[SmallPlace] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    new: list[str] = field(default_factory=list)
    _reasons: dict[str, str] = field(default_factory=dict)

    def run(self) -> None:
        """Seat every detected object that stands on another, parents first, larger ones first among equals."""
        analysis = self.view.need(SceneAnalysis)
        calibration = self.view.need(Calibration)
        names = self.view.names(analysis)
        open_ids: dict[str, DetectedObject] = {}
        for item in analysis.objects:
            name = names[item.id]
            if name is not None and self._is_open(name, item):
                open_ids[name] = item.model_copy(
                    update={"id": name, "parent": names.get(item.parent or "", item.parent)}
                )
        carriers = Carriers(self.shapes)
        # What stays takes its place before anything else does.
        for proxy in order_by_depth(self.layout.proxies):
            if proxy.id not in open_ids:
                carriers.add(proxy)
        ordered = order_by_depth(sorted(open_ids.values(), key=lambda o: -o.size[0] * o.size[1]))
        # Clothes hang over what stands below them.
        for item in sorted(ordered, key=lambda o: is_hung(f"{o.category} {o.label}")):
            self._seat(item, carriers, calibration)

    def sound(self, text: str, before: Layout) -> str:
        """The room's text with this layout; where a program cannot be made in the size it has now, the thing keeps its former one.

        Args:
            text: with the layout `before`.
        """
        resized = [p for p in before.proxies if (now := self.layout.proxy(p.id)) is not None and now.size != p.size]
        if not resized:  # the build will evaluate it, and nothing here can have broken it
            return relaid(text, self.layout)
        for former in [None, *resized]:
            if former is not None:
                now = self.layout.proxy(former.id) or former
                centre = (*now.centre[:2], base_of(now) + former.size[2] / 2)
                self._place(now.model_copy(update={"size": former.size, "centre": centre}))
                message = "Its program cannot be made in another size, so it stays as large as it was."
                self.findings.append(Finding(about=former.id, message=message))
            made = relaid(text, self.layout)
            try:
                evaluate(made, FINISHED_ROOM_LIMITS)
            except ProgramError:
                continue
            return made
        return relaid(text, self.layout)

    def on_rails(self, text: str) -> str:
        """The room's text after a second look at clothes that were hung: what they are in their new size is known only now."""
        hung = [p.id for p in self.places if p.part == "rail" and p.id not in self.new]
        if not hung:
            return text
        shapes, before = shapes_of(text), self.layout
        for name in hung:
            proxy = self.layout.proxy(name)
            carrier = self.layout.proxy(proxy.parent) if proxy is not None and proxy.parent else None
            if proxy is not None and carrier is not None:
                self._place(on_its_rail(proxy, carrier, shapes))
        return text if self.layout == before else self.sound(text, before)

    def open_names(self) -> set[str]:
        """Ids of the small objects that this run places."""
        analysis = self.view.need(SceneAnalysis)
        names = self.view.names(analysis)
        return {name for o in analysis.objects if (name := names[o.id]) is not None and self._is_open(name, o)}

    def _is_open(self, name: str, item: DetectedObject) -> bool:
        proxy = self.layout.proxy(name)
        if name in self.view.locked or not self.view.chosen(item.id):
            return False
        return proxy.placement == "surface" if proxy is not None else item.placement == "surface"

    def _seat(self, item: DetectedObject, carriers: Carriers, calibration: Calibration) -> None:
        standing = self.layout.proxy(item.id)
        parent = (standing.parent if standing is not None else None) or item.parent or ""
        lying = None
        if standing is not None and standing.parent == parent and parent in carriers.proxies:
            lying = carriers.lain(standing) if is_lying_cloth(standing) else carriers.spread(standing)
        if lying is not None:
            carriers.add(lying)
            self._place(lying)
            self.places.append(SmallPlace(id=item.id, on=parent, height=base_of(lying)))
            return
        if self._hang(item, standing, parent, carriers, calibration):
            return
        seated = carriers.seat(item, calibration, parent)
        if seated is None:
            lifted = standing or proxy_of(item, calibration)[0]
            for carrier in carriers_under(lifted.centre[:2], list(carriers.proxies.values())):
                seated = carriers.seat(item, calibration, carrier.id) if carrier.id != item.id else None
                if seated is not None:
                    break
        if seated is None:
            self._left(item, standing, carriers)
            return
        proxy = self._line(seated.proxy, standing)
        carriers.add(proxy)
        self._place(proxy)
        self._note(item, seated, proxy)

    def _hang(
        self,
        item: DetectedObject,
        standing: ProxyLine | None,
        parent: str,
        carriers: Carriers,
        calibration: Calibration,
    ) -> bool:
        """Hang clothes from the rail of what they are in; False for all else, and where there is none."""
        carrier = carriers.proxies.get(parent)
        if carrier is None:
            return False
        hung = under_rail(self._line(standing or proxy_of(item, calibration)[0], standing), carrier, carriers)
        if hung is not None:
            carriers.proxies[hung.id] = hung
            self._place(hung)
            self.places.append(SmallPlace(id=item.id, on=parent, part="rail", height=base_of(hung)))
        return hung is not None

    def _line(self, proxy: ProxyLine, standing: ProxyLine | None) -> ProxyLine:
        """The seated proxy under the words that the room's program has for it."""
        if standing is None:
            return proxy
        kept = {"category": standing.category, "label": standing.label, "shape": standing.shape}
        return proxy.model_copy(update=kept)

    def _left(self, item: DetectedObject, standing: ProxyLine | None, carriers: Carriers) -> None:
        if standing is not None:
            carriers.add(standing)
            message = f"No surface for it was found; it stays at {base_of(standing):.2f} m, where the layout put it."
        else:
            message = "Nothing in the room has a surface that it could stand on."
            self._reasons[item.id] = "no surface for it was found"
        self.findings.append(Finding(about=item.id, message=message, severity="warning"))

    def _place(self, proxy: ProxyLine) -> None:
        proxies = list(self.layout.proxies)
        index = next((i for i, p in enumerate(proxies) if p.id == proxy.id), None)
        if index is None:
            self.new.append(proxy.id)
            proxies.append(proxy)
        else:
            proxies[index] = proxy
        self.layout = self.layout.model_copy(update={"proxies": proxies})

    def _note(self, item: DetectedObject, seated: Seated, proxy: ProxyLine) -> None:
        on = f"{proxy.parent} ({seated.part})" if seated.part else str(proxy.parent)
        self.places.append(
            SmallPlace(id=item.id, on=proxy.parent or "", part=seated.part, height=base_of(proxy), moved=seated.moved)
        )
        words = []
        if seated.moved > REPORT:
            words.append(f"moved {100 * seated.moved:.0f} cm to a free place on {on}")
        if seated.scale < 1:
            words.append(f"made {1 - seated.scale:.0%} smaller to fit on {on}")
        if item.parent and proxy.parent != item.parent:
            words.append(f"put onto {proxy.parent}, since {item.parent} has no place for it")
        if words:
            self.findings.append(Finding(about=item.id, message=f"It was {' and '.join(words)}."))

    def ledger_line(self, entry: LedgerEntry) -> LedgerEntry:
        """What became of a detected object by now."""
        analysis = self.view.need(SceneAnalysis)
        name = self.view.names(analysis).get(entry.id)
        if name in self.new:
            return entry.model_copy(update={"state": "detailed", "reason": "placed on a surface that was found for it"})
        if name in self._reasons and entry.state == "deferred":
            return entry.model_copy(update={"state": "dropped", "reason": self._reasons[name]})
        return entry


def _modelled(view: View, seating: _Seating, text: str, geometry: Geometry) -> tuple[str, Geometry]:
    """The room's text with library pieces for what was placed only now."""
    kept = frozenset(p.id for p in seating.layout.proxies if p.id not in seating.new)
    detailing = Detailing.begin(
        seating.layout,
        view.need(Descriptions),
        view.need(RoomStyle),
        text,
        geometry,
        view.recall(OwnModelling) or OwnModelling(),
        kept,
    )
    detailing.from_library()
    text = detailing.sound_text()
    made: list[ObjectProgram] = [o for o in detailing.geometry().objects if o.id in seating.new]
    return text, geometry.model_copy(update={"objects": [*geometry.objects, *made]})


STAGE = Stage(
    id=ID,
    title="Small objects",
    reads=(
        Reads(SceneAnalysis),
        Reads(Calibration),
        Reads(LayoutProgram, ("s06_geometry",)),
        Reads(Geometry, ("s06_geometry",)),
        Reads(Descriptions),
        Reads(RoomStyle),
    ),
    writes=(LayoutProgram, SmallObjects, Geometry),
    run=run,
    partial=True,
    settings=(SETTING,),
    recalls=(Reads(LayoutProgram, (ID,)), Reads(OwnModelling), Reads(ChosenAssets)),
)
