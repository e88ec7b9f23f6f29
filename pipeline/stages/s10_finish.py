# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 10, light and views: lights as in the picture, an exposure to match, cameras, and a last look for faults.

The model is asked once what kind of light the picture has, and everything works without its answer. Watts, exposure and
cameras are worked out here: rays are followed through the room's boxes, since a render would take longer and would have to
be waited for. (Paper, stage 10.)
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

from ..artifacts.analysis import Calibration, Finding, SceneAnalysis
from ..artifacts.common import Metres3
from ..artifacts.correction import FAULT_KINDS, CorrectionReport
from ..artifacts.layout import (
    CameraLine,
    Layout,
    LayoutEdit,
    LayoutProgram,
    LightLine,
    ProxyLine,
    ViewLine,
    WindowLine,
    WorldLine,
)
from ..artifacts.light import Brightness, LightPlan, LightReply
from ..artifacts.objects import RoomStyle
from ..correction.correct import Options, correct
from ..correction.looks import pictures_of
from ..errors import ProgramError, RoomError
from ..geometry.polygon import Floats
from ..layout.hand import apply_hand_edits
from ..light.albedo import room_albedo
from ..light.colour_match import matched_tint
from ..light.decide import Decision, decide
from ..light.developed import tone_of
from ..light.exposure import matched
from ..light.glowing import switched
from ..light.lamps import is_lamp
from ..light.levels import levelled
from ..light.lights import Lit, make_lights
from ..light.measure import Places, shines, small, surround, visible_places
from ..light.photograph import stops_for
from ..light.space import Space, space_of
from ..light.standing import as_it_stands, with_former_fixes
from ..light.tint import background_light, light_tint
from ..light.tone import LOOK, NEUTRAL, TRANSFORM
from ..light.upper_faces import with_upper_faces
from ..light.views import EYES, TOP, cut_height, eye_cameras, top_camera
from ..materials.tops import top_colour
from ..objects.asking import picture_box
from ..objects.text import relaid
from ..program.edits import LISTS
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout
from ..program.prelude.proxies import proxy_shapes
from ..program.prelude.record import Record
from ..program.prelude.shape import Shape
from .base import Reads, Stage, View
from .wishes import Ask, Build, FindImages, Picture, Request, StageRun, Tell, Wish

ID = "s10_finish"
REFERENCE = "reference"
CORRECTIONS_OFF = "corrections_off"
"""Setting: kinds of faults that are found but not mended, with commas between; "kind:id" spares one thing alone."""
_OWN = ("light", "world", "view", "camera")
_BEFORE = ("s07_surfaces", "s08_materials", "s09_textures")


def run(view: View) -> StageRun:
    """Write the `LayoutProgram` with lights, sky, exposure and cameras, and `LightPlan`, which says why they are so.

    Then the finished room is looked through for faults; `CorrectionReport` lists what was mended and what was not.
    """
    before = view.need(LayoutProgram)
    layout, findings = apply_hand_edits(parse_layout(before.text), view.hand_edits, before.hand_edits)
    yield Tell("Looking at the light", 1, 4)
    record = evaluate(relaid(before.text, layout), FINISHED_ROOM_LIMITS)
    lamps = [p for p in layout.proxies if is_lamp(p)]
    if view.only is None:
        finished, plan = yield from _lit_anew(view, layout, lamps, record)
    else:
        finished, plan = _as_it_stood(view, layout, lamps, record)
    held, more = _as_the_artist_left_it(finished, view.hand_edits)
    yield Tell("Looking for faults", 3, 4)
    shown = pictures_of(record)
    pictures = (yield FindImages(shown)) if shown else None
    text = switched(relaid(before.text, held), held, lamps, record.furnished)
    text, report = _corrected(view, with_upper_faces(text, held, _tops_seen(view, held)), pictures)
    if view.only is not None:
        report = with_former_fixes(report, view.recall(CorrectionReport), held)
    yield Tell("Building the room", 4, 4)
    yield Build(text)
    plan = plan.model_copy(update={"findings": [*plan.findings, *(f for f in more if f not in plan.findings)]})
    new = [f for f in findings if f not in before.findings]
    program = before.model_copy(
        update={
            "text": text,
            "stage": ID,
            "findings": [*before.findings, *new],
            "hand_edits": len(view.hand_edits),
        }
    )
    return [program, plan, report]


def _lit_anew(
    view: View, layout: Layout, lamps: Sequence[ProxyLine], record: Record
) -> Generator[Wish, Any, tuple[Layout, LightPlan]]:
    """The layout with light and views as in the picture, and the reasons; the model is asked once."""
    calibration = view.need(Calibration)
    space = space_of(layout, room_albedo(record))
    places = _places(view, space, calibration)
    request = _request(view, layout, lamps)
    reply: LightReply | None = None
    if request is not None:
        (reply,) = yield Ask((request,), optional=True)
    decision = decide(space, places, layout.windows, lamps, _shining(view, calibration, lamps, places), reply)
    yield Tell("Placing lights and cameras", 2, 4)
    return _finished(view, space, places, decision, record)


def _as_it_stood(view: View, layout: Layout, lamps: Sequence[ProxyLine], record: Record) -> tuple[Layout, LightPlan]:
    """The layout with light and views as they stand, in the lamps as they are now, and the reasons of then."""
    standing, plan = view.recall(LayoutProgram), view.recall(LightPlan)
    if standing is None or plan is None:
        raise RoomError("The room has no light yet that could be kept.", "Run the whole stage first.")
    there, _ = apply_hand_edits(parse_layout(standing.text), view.hand_edits, standing.hand_edits)
    return as_it_stands(layout, there, lamps, _shapes_of(lamps, record), plan.style), plan


def _shapes_of(lamps: Sequence[ProxyLine], record: Record) -> dict[str, Sequence[Shape]]:
    return {p.id: record.furnished.get(p.id) or proxy_shapes(p.model_dump()) for p in lamps}


def _corrected(view: View, text: str, pictures: frozenset[str] | None) -> tuple[str, CorrectionReport]:
    """The text without the faults that can be mended, and what was mended; what the artist holds is not touched."""
    swings = {a.id: a.swing or "" for a in view.need(SceneAnalysis).architecture if a.kind == "door"}
    said = view.settings.get(CORRECTIONS_OFF, "").split(",")
    off = frozenset(kind for kind in FAULT_KINDS if kind in said)
    spared = frozenset((kind, name) for kind, sign, name in (word.partition(":") for word in said) if sign)
    try:
        corrected = correct(text, Options(off, view.locked, spared, pictures, swings))
    except ProgramError as error:
        message = f"The room could not be looked through for faults: {str(error)[:200].rstrip('.')}."
        return text, CorrectionReport(left=[Finding(about="room", message=message, severity="warning")])
    return corrected.text, corrected.report


def _places(view: View, space: Space, calibration: Calibration) -> Places | None:
    """Floor and walls in the picture, as the view transform is to show them; None for a drawn plan, whose light says nothing."""
    if view.need(SceneAnalysis).view == "plan":
        return None
    places = visible_places(space, calibration.camera, view.reference, _led_back(tone_of(view.reference)))
    return places if len(places.points) else None


def _led_back(tone: tuple[str, str]) -> bool:
    """Whether the colours that things had are what a view transform is to show: else it makes the picture's of them."""
    return tone[0] == NEUTRAL


def _tops_seen(view: View, layout: Layout) -> Floats | None:
    """Linear colour of the walls' upper faces in the picture; None for a drawn plan, or where it does not show them."""
    if view.need(SceneAnalysis).view == "plan":
        return None
    return top_colour(layout, view.need(Calibration).camera, small(view.reference, _led_back(tone_of(view.reference))))


def _shining(view: View, calibration: Calibration, lamps: Sequence[ProxyLine], places: Places | None) -> list[str]:
    """Ids of the lamps that the picture shows as bright spots."""
    if places is None:
        return []
    boxes = {lamp.id: picture_box(lamp, calibration.camera, view.need(SceneAnalysis)) for lamp in lamps}
    return [name for name, box in boxes.items() if box is not None and shines(view.reference, box)]


def _request(view: View, layout: Layout, lamps: Sequence[ProxyLine]) -> Request | None:
    """The question on the light; None for a plan drawing, whose light is nobody's."""
    if view.need(SceneAnalysis).view == "plan":
        return None
    windows = "\n".join(f"- {w.id}: {_side(w)}, {_width(w):.1f} m wide" for w in layout.windows)
    lit = "\n".join(f"- {p.id}: {p.label or p.category}" for p in lamps)
    return Request(
        key="10_light",
        prompt="10_light",
        values={"windows": windows or "- none", "lamps": lit or "- none", "room": ""},
        images=(Picture("reference", view.reference.for_model()),),
        reply=LightReply,
    )


def _side(window: WindowLine) -> str:
    """Where a window lies, as the picture shows it."""
    x, y = ((a + b) / 2 for a, b in zip(window.start, window.end, strict=True))
    if abs(window.end[1] - window.start[1]) > abs(window.end[0] - window.start[0]):
        return "in a wall on the right" if x > 0 else "in a wall on the left"
    return "in a wall at the top" if y > 0 else "in a wall at the bottom"


def _width(window: WindowLine) -> float:
    return float(((window.end[0] - window.start[0]) ** 2 + (window.end[1] - window.start[1]) ** 2) ** 0.5)


def _finished(
    view: View, space: Space, places: Places | None, decision: Decision, record: Record
) -> tuple[Layout, LightPlan]:
    """The layout with everything that this stage adds, and the reasons."""
    layout = space.layout
    style = view.recall(RoomStyle)
    shapes = _shapes_of(decision.lamps, record)
    transform, look = tone_of(view.reference) if places is not None else (TRANSFORM, LOOK)
    tint = light_tint(style.gains if style is not None and places is not None else None)
    lit = make_lights(
        space, decision.style, shapes, decision.lamps, decision.windows, decision.sun, tint, decision.warmth
    )
    held = len(layout.lights)
    own_lights = levelled(space, [*layout.lights, *lit.lights], lit.world.strength, places, transform, look, held)
    own_lights, world = _in_colour(layout, record, own_lights[held:], lit.world, places, tint, transform)
    lights = [*layout.lights, *own_lights]
    exposure, brightness = matched(space, lights, world.strength, places, transform, look)
    seen = surround(view.reference) if places is not None else None
    sky = world.model_copy(update={"background": background_light(seen, decision.style, exposure, transform, look)})
    cut = cut_height(space)
    shown = ViewLine(id="view", exposure=exposure, transform=transform, look=look, ceiling=space.height, cut=cut)
    taken = {line.id for name in ("proxies", *LISTS) for line in getattr(layout, name)} - {TOP, *EYES}
    names = tuple(name if name not in taken else f"{name}_view" for name in EYES)
    eyes, coverage = eye_cameras(space, names)
    if decision.style not in ("evening", "night"):  # what is dark then is meant to be dark
        eyes = [e.model_copy(update={"stops": stops_for(space, lights, sky.strength, e, shown)}) for e in eyes]
    cameras = [top_camera(space, cut, TOP if TOP not in taken else f"{TOP}_view"), *eyes]
    own = {c.id for c in cameras}
    kept: list[CameraLine] = [c for c in layout.cameras if c.id not in own]
    finished = layout.model_copy(
        update={"lights": lights, "worlds": [sky], "views": [shown], "cameras": [*kept, *cameras]}
    )
    return finished, _plan(decision, lit, exposure, brightness, [c.id for c in finished.cameras], coverage)


def _in_colour(
    layout: Layout,
    record: Record,
    own: Sequence[LightLine],
    world: WorldLine,
    places: Places | None,
    tint: Metres3,
    transform: str,
) -> tuple[list[LightLine], WorldLine]:
    """The lights and the sky with the daylight in the colour that makes floor and walls those of the picture."""
    if places is None:
        return list(own), world
    spaces = [space_of(layout, room_albedo(record, of)) for of in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    tinted = frozenset(light.id for light in own if light.color == tint)
    better = matched_tint(spaces, [*layout.lights, *own], world, tinted, places, tint, transform)
    lights = [light.model_copy(update={"color": better}) if light.id in tinted else light for light in own]
    return lights, world.model_copy(update={"color": better})


def _plan(
    decision: Decision,
    lit: Lit,
    exposure: float,
    brightness: list[Brightness],
    cameras: list[str],
    seen: dict[str, float],
) -> LightPlan:
    """Why the lights are as they are."""
    return LightPlan(
        style=decision.style,
        direction=lit.sun.azimuth if lit.sun is not None else None,
        elevation=lit.sun.elevation if lit.sun is not None else None,
        windows=lit.windows,
        lamps=lit.lamps,
        warmth=lit.world.kelvin,
        exposure=exposure,
        source="model" if decision.asked else "measured",
        brightness=brightness,
        cameras=cameras,
        seen={name: round(share, 3) for name, share in seen.items()},
        findings=decision.findings,
    )


def _as_the_artist_left_it(layout: Layout, edits: Sequence[LayoutEdit]) -> tuple[Layout, list[Finding]]:
    """The layout with what the artist did to lights, sky, view and cameras by hand, whenever that was."""
    names = {line.id for group in ("lights", "worlds", "views", "cameras") for line in getattr(layout, group)}
    names -= {REFERENCE}

    def is_own(edit: LayoutEdit) -> bool:
        if edit.op == "line" and edit.line is not None:
            return edit.line.lstrip().startswith(_OWN)
        return edit.op == "remove"

    own = [edit for edit in edits if edit.id in names and edit.origin == "artist" and is_own(edit)]
    return apply_hand_edits(layout, own)


STAGE = Stage(
    id=ID,
    title="Light and views",
    reads=(Reads(SceneAnalysis), Reads(Calibration), Reads(LayoutProgram, _BEFORE)),
    writes=(LayoutProgram, LightPlan, CorrectionReport),
    run=run,
    settings=(CORRECTIONS_OFF,),
    partial=True,
    recalls=(Reads(RoomStyle), Reads(LayoutProgram, (ID,)), Reads(LightPlan), Reads(CorrectionReport)),
)
