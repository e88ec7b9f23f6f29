# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 9, textures: for each surface that an image could lie on, an image model's, the picture's own, or none.

Each surface goes through its sources in the order that the artist chose; what cannot be used says why, and the next one
is taken. The last one, a made material, needs no image and is always there.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..artifacts.analysis import Calibration, Finding, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.layout import Layout, LayoutProgram
from ..artifacts.objects import Descriptions, RoomStyle
from ..artifacts.textures import Texture, TextureChoices, Textures, TextureSource
from ..errors import ProgramError, RoomError
from ..layout.hand import apply_hand_edits
from ..materials.shell import shell_colours
from ..models.image_base import Proportions
from ..objects.colours import ColourMeter, from_code, to_code
from ..objects.text import relaid
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout
from ..program.prelude.record import Record
from ..textures.decor import decor_texture
from ..textures.floors import TILE, floor_texture
from ..textures.looks import finished_text
from ..textures.names import image_name
from ..textures.painted import painted_face, painted_tile
from ..textures.pixels import Pixels, to_png
from ..textures.shading import typical_colour
from ..textures.shown import LIGHTEST, Flat, NotUsable, Shown
from ..textures.targets import FLOOR, Target, targets_of
from .base import Reads, Stage, View
from .carrying import carried_on
from .texture_wishes import KeepImages, Paint, Painting, PaintRequest
from .wishes import Build, StageRun, Tell

ID = "s09_textures"
_MOST_GAIN = 3.0
"""By which a floor's tile is made brighter or darker at most."""


def run(view: View) -> StageRun:
    """Write the `LayoutProgram` with images in its finishes, and `Textures`; the images go beside the memory.

    At most one round of painting, side by side.
    """
    before, calibration = view.need(LayoutProgram), view.need(Calibration)
    layout, findings = apply_hand_edits(parse_layout(before.text), view.hand_edits, before.hand_edits)
    text = relaid(before.text, layout)
    record = evaluate(text, FINISHED_ROOM_LIMITS)
    targets = targets_of(layout, record.furnished)
    work = _Work(view, layout, calibration, view.recall(TextureChoices) or TextureChoices())
    yield Tell("Taking surfaces out of the picture", 1, 3)
    work.from_picture(targets)
    requests = work.requests(targets)
    if requests:
        yield Tell("Painting surfaces", 2, 3)
        painted = yield Paint(tuple(requests.values()))
        work.take(requests, painted)
    found = [work.chosen(target) for target in targets]
    textures = Textures(surfaces=found, findings=work.findings)
    text = _sound(text, textures, record)
    yield Tell("Keeping the images", 3, 3)
    if work.images:
        yield KeepImages(work.images)
    yield Build(text)
    return [carried_on(view, before, ID, text, layout, findings, before.ledger), textures]


def _sound(text: str, textures: Textures, record: Record) -> str:
    """The text with the images on their surfaces, as it was where that cannot be."""
    try:
        made = finished_text(text, textures, record)
        evaluate(made, FINISHED_ROOM_LIMITS)
    except ProgramError as error:
        message = f"The images could not be used ({str(error)[:200].rstrip('.')}); made materials stand."
        textures.findings.append(Finding(about="textures", message=message, severity="warning"))
        return text
    return made


@dataclass
class _Work:
    """The surfaces on their way to an image.

    Attributes:
        images: PNG bytes by name. flats, reasons: by surface and source, what each gave or why it gave nothing.
    """

    view: View
    layout: Layout
    calibration: Calibration
    choices: TextureChoices
    images: dict[str, bytes] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    flats: dict[tuple[str, TextureSource], Flat] = field(default_factory=dict)
    reasons: dict[tuple[str, TextureSource], str] = field(default_factory=dict)
    models: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        style = self.view.artifacts.get(RoomStyle) or self.view.recalled.get(RoomStyle)
        self.style = style if isinstance(style, RoomStyle) else RoomStyle()
        words = self.view.artifacts.get(Descriptions) or self.view.recalled.get(Descriptions)
        self.words = words if isinstance(words, Descriptions) else Descriptions()
        gains = self.style.gains
        if gains == (1.0, 1.0, 1.0):
            red, green, blue = ColourMeter(self.view.reference, self.calibration.camera, self.layout).gains
            gains = (float(red), float(green), float(blue))
        self.shown = Shown(self.view.reference, self.calibration.camera, self.layout, gains, self._unplaced())

    def _unplaced(self) -> list[ImageBox]:
        """Where the picture shows things that are not in the room."""
        analysis = self.view.artifacts.get(SceneAnalysis)
        if not isinstance(analysis, SceneAnalysis):
            return []
        placed = {p.id for p in self.layout.proxies}
        names = self.view.names(analysis)
        return [
            o.box
            for o in [*analysis.objects, *analysis.left_out]
            if o.box is not None and o.id not in placed and names.get(o.id) not in placed
        ]

    def from_picture(self, targets: Sequence[Target]) -> None:
        """Take out of the picture what may be needed: an image model may fail, so it is not waited for."""
        for target in targets:
            if "picture" not in self.choices.order(target.surface):
                continue
            try:
                self.flats[target.surface, "picture"] = (
                    self._as_bright_as_seen(floor_texture(self.shown))
                    if target.kind == "floor"
                    else decor_texture(self.shown, target.face, target.kind, target.without, target.round)
                )
            except NotUsable as reason:
                self.reasons[target.surface, "picture"] = str(reason)
            except RoomError as error:
                self.reasons[target.surface, "picture"] = error.message

    def _as_bright_as_seen(self, flat: Flat) -> Flat:
        """The floor's tile in the colour of the whole floor that is seen: it was taken where little stands, not where light is."""
        gains = np.array(self.shown.gains)
        code = shell_colours(self.layout, self.shown.camera, self.shown.reference, gains).floor
        if not code:
            return flat
        own = typical_colour(flat.pixels, np.ones(flat.pixels.shape[:2], dtype=bool))
        gain = np.clip(from_code(code) / np.maximum(own, 1e-3), 1 / _MOST_GAIN, _MOST_GAIN).astype(np.float32)
        return replace(flat, pixels=np.clip(flat.pixels * gain, 0.0, LIGHTEST).astype(np.float32))

    def requests(self, targets: Sequence[Target]) -> dict[str, PaintRequest]:
        """What an image model is to paint, by surface: what wants it first, or has nothing better."""
        found = {}
        for target in targets:
            order = self.choices.order(target.surface)
            if "model" not in order:
                continue
            before = order[: order.index("model")]
            if not any((target.surface, source) in self.flats or source == "procedural" for source in before):
                found[target.surface] = self._request(target)
        return found

    def _request(self, target: Target) -> PaintRequest:
        words = self.words.of(target.surface)
        size = (TILE, TILE) if target.kind == "floor" else target.face.size
        colours = ", ".join("#" + c.code for c in words.measured) or "#" + _code(self._colour(target))
        said = "; ".join(part for part in (words.colour, words.material, words.structure) if part)
        values = {
            "what": f"{self._floor_words()}" if target.kind == "floor" else target.words,
            "width": f"{size[0]:.2f}",
            "depth": f"{size[1]:.2f}",
            "colours": f"{said} ({colours})" if said else colours,
            "pattern": self._pattern(target),
            "style": self.style.style or "plain and calm",
        }
        ratio = size[0] / size[1]
        proportions: Proportions = "wide" if ratio > 1.25 else "tall" if ratio < 0.8 else "square"
        prompt = "09_surface" if target.kind == "floor" else "09_decor"
        return PaintRequest(f"{prompt}/{target.surface}", prompt, "09_simple", values, proportions)

    def _floor_words(self) -> str:
        flat = self.flats.get((FLOOR, "picture"))
        if flat is None or flat.quality is None:
            return "a floor covering"
        both = min(flat.quality.period) > 0
        return "a tiled floor" if both else "a floor of planks"

    def _pattern(self, target: Target) -> str:
        flat = self.flats.get((target.surface, "picture"))
        if target.kind != "floor" or flat is None:
            return ""
        across, along = flat.quality.period
        if across and along:
            return f"The pattern repeats every {across:.2f} by {along:.2f} m."
        if across or along:
            way = "from top to bottom" if across else "from left to right"
            return f"Its planks run {way}."
        return ""

    def _colour(self, target: Target) -> Pixels:
        """The surface's usual colour in the picture, linear, without the room's light; middle grey where it is hidden."""
        flat = self.flats.get((target.surface, "picture"))
        if flat is not None:
            return typical_colour(flat.pixels, np.ones(flat.pixels.shape[:2], dtype=bool))
        try:
            seen = self.shown.see(target.face, target.without)
        except NotUsable:
            return np.full(3, 0.4, dtype=np.float32)
        found = typical_colour(seen.pixels, seen.seen)
        light: Pixels = self.shown.balanced(found[None])[0]
        return light

    def take(self, requests: Mapping[str, PaintRequest], painted: Sequence[Painting] | None) -> None:
        """Keep what was painted; None where there is no image model."""
        if painted is None:
            return
        problems = set()
        for (surface, _), painting in zip(requests.items(), painted, strict=True):
            if painting.problem:
                problems.add(painting.problem)
                self.reasons[surface, "model"] = painting.problem
            if not painting.data:
                continue
            try:
                self.flats[surface, "model"] = self._painted(surface, painting.data)
                self.models[surface] = painting.model
            except NotUsable as reason:
                self.reasons[surface, "model"] = str(reason)
        self.findings += [Finding(about="textures", message=p, severity="warning") for p in sorted(problems)]

    def _painted(self, surface: str, data: bytes) -> Flat:
        target = next(t for t in targets_of(self.layout) if t.surface == surface)
        if target.kind == "floor":
            return painted_tile(data, (TILE, TILE), self._colour(target))
        # A picture on a wall has its own colours; a rug has those that were measured.
        return painted_face(data, target.face.size, self._colour(target) if target.kind in ("rug", "cloth") else None)

    def chosen(self, target: Target) -> Texture:
        """The best source that there is, with what was wrong with the ones before it."""
        notes: list[str] = []
        for source in self.choices.order(target.surface):
            flat = self.flats.get((target.surface, source))
            if source == "procedural":
                break
            if flat is not None:
                return self._entry(target, source, flat, " ".join(notes))
            if (target.surface, source) in self.reasons:
                notes.append(self.reasons[target.surface, source])
        colour = _code(self._colour(target)) if target.kind == "floor" and not self.shown.drawn else ""
        return Texture(
            surface=target.surface, part=target.part, kind=target.kind, colour=colour, note=" ".join(notes)[:300]
        )

    def _entry(self, target: Target, source: TextureSource, flat: Flat, note: str) -> Texture:
        data = to_png(flat.pixels)
        sha256 = hashlib.sha256(data).hexdigest()
        name = image_name(target.surface, sha256)
        self.images[name] = data
        whole = np.ones(flat.pixels.shape[:2], dtype=bool)
        return Texture(
            surface=target.surface,
            part=target.part,
            kind=target.kind,
            source=source,
            name=name,
            sha256=sha256,
            pixels=(flat.pixels.shape[1], flat.pixels.shape[0]),
            size=(round(flat.size[0], 4), round(flat.size[1], 4)),
            tiles=target.kind == "floor",
            turned=round(flat.turned, 2),
            colour=_code(typical_colour(flat.pixels, whole)),
            quality=flat.quality,
            model=self.models.get(target.surface, "") if source == "model" else "",
            note=note[:300],
        )


def _code(colour: Pixels) -> str:
    """A linear colour as six sRGB digits."""
    return to_code(colour.astype(np.float64))


STAGE = Stage(
    id=ID,
    title="Textures",
    reads=(
        Reads(SceneAnalysis),
        Reads(Calibration),
        Reads(LayoutProgram, ("s07_surfaces", "s08_materials")),
        Reads(Descriptions),
        Reads(RoomStyle),
    ),
    writes=(LayoutProgram, Textures),
    run=run,
    recalls=(Reads(TextureChoices),),
)
