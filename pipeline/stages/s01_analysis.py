# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 1, analysis: what is in the picture and how it was seen. Two requests. (Paper, stage 1.)

What was found is kept apart from what the artist says of it: corrections and known sizes are applied to it here, and
again whenever they change, without asking anything.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

from pydantic import BaseModel

from ..analysis.again import described_anew, surroundings
from ..analysis.calibrate import calibrate, uncalibrated
from ..analysis.clean import clean_analysis
from ..analysis.correct import Corrected, Known, correct_found
from ..analysis.doubts import asked as questions
from ..analysis.doubts import doubts
from ..analysis.edges import refined_yaws
from ..analysis.facing import checked_facings
from ..analysis.frames import between
from ..analysis.identity import found_again, keep_ids, normal
from ..analysis.look import dense_surfaces, enlarged, numbered_boxes, quarters
from ..analysis.merge import merge_second_look
from ..analysis.reliability import learn_trust
from ..analysis.residuals import residual
from ..artifacts.analysis import Calibration, DetectedObject, Finding, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.corrections import Corrections, Found, Rescaled
from ..artifacts.layout import LayoutProgram
from ..artifacts.replies import AnalysisReply, SecondLookReply
from ..artifacts.trust import Sources
from ..draft.kept import DRAFTED
from ..errors import RoomError
from ..layout.hand import apply_hand_edits
from ..layout.reshell import follow_scale, follow_shell
from ..program.lines import parse_layout, print_layout
from .base import Reads, Stage, View
from .wishes import Ask, Build, Picture, Request, StageRun, Tell, Wish

ID = "s01_analysis"
CROP_NAMES = ("top left", "top right", "bottom left", "bottom right")
MOST_AGAIN = 8
"""Objects that one request can describe anew: each has an enlarged picture of its own."""


def run(view: View) -> StageRun:
    """Write `SceneAnalysis` and `Calibration`, and `Found` where the artist's word changes what was found."""
    found = yield from _anew(view) if view.only is None else _again(view)
    new, corrections = _with_corrections(view, found)
    written: list[BaseModel] = [new.analysis, new.calibration]
    if new.analysis != found.analysis or new.calibration != found.calibration:
        written.append(found)
    if corrections != view.corrections:
        written.append(corrections)
    return written + (yield from _room_follows(view, new))


def _anew(view: View) -> Generator[Wish, Any, Found]:
    """What is found when everything is asked."""
    picture = view.reference
    yield Tell("Asking what is in the picture", 1, 3)
    [reply] = yield Ask((_first_request(view),))
    stated = merged = clean_analysis(reply, (picture.width, picture.height))
    first = None
    if view.settings.get("second_look") != "off":
        # Fitted already now, so that what contradicts itself can be asked about; and what is no room is refused here.
        first = _fitted(view, stated)
        yield Tell("Looking a second time for what was missed", 2, 3)
        crops = quarters(stated)
        surfaces = dense_surfaces(stated.objects, crops[0])
        [second] = yield Ask((_second_request(view, stated, first, crops, surfaces),))
        merged = merge_second_look(stated, second, [None, *crops, *(part for _, part in surfaces)])
    yield Tell("Fitting the camera", 3, 3)
    before = view.recall(Found)
    # A draft's programs are known by its own ids.
    if before is not None and view.settings.get("objects") != DRAFTED:
        merged = keep_ids(before.analysis, merged)
    return first if first is not None and merged == stated else _fitted(view, merged)


def _fitted(view: View, stated: SceneAnalysis) -> Found:
    """The analysis in the frame of the fitted floor, its directions checked, and what it tells of its own errors."""
    fit = uncalibrated if view.settings.get("calibration") == "off" else calibrate
    analysis, calibration = fit(stated)
    analysis = checked_facings(analysis, calibration)
    sources = _sources(view)
    if sources != "metres":
        analysis = refined_yaws(analysis, calibration, view.reference.pixels())
    residuals = [r for o in analysis.objects if (r := residual(o, calibration.camera)) is not None]
    trust = learn_trust(analysis, calibration, sources)
    return Found(analysis=analysis, calibration=calibration.model_copy(update={"residuals": residuals, "trust": trust}))


def _sources(view: View) -> Sources:
    """Which measurements placements are made from: both, unless it is tried out what one alone is worth."""
    wanted = view.settings.get("evidence")
    return "metres" if wanted == "metres" else "boxes" if wanted == "boxes" else "both"


def _again(view: View) -> Generator[Wish, Any, Found]:
    """What was found before, with the chosen objects described anew. One request."""
    found, present = view.recall(Found), view.recall(SceneAnalysis)
    if found is None or present is None:
        raise RoomError("There is nothing yet that could be looked at again.", "Run the whole stage first.")
    asked = [o for o in present.objects if view.chosen(o.id)]
    if not asked:
        raise RoomError(
            "Nothing that is selected was found by the analysis.", "Select objects of the room, or run the whole stage."
        )
    if len(asked) > MOST_AGAIN:
        raise RoomError(
            f"At most {MOST_AGAIN} objects can be looked at again in one go.", "Select fewer, or run the whole stage."
        )
    yield Tell("Looking again at what is selected", 1, 2)
    crops = [None if o.box is None else surroundings(o.box) for o in asked]
    [reply] = yield Ask((_again_request(view, found.analysis, present, asked, crops),))
    yield Tell("Taking it over", 2, 2)
    shown = [None, *(crop for crop in crops if crop is not None)]
    return described_anew(found, reply, asked, shown)[0]


def _with_corrections(view: View, found: Found) -> tuple[Corrected, Corrections]:
    """What was found with the artist's word on it; corrections that do not fit it any more cost nothing of it."""
    by_hand = {name for edit in view.hand_edits for name in (edit.id, edit.new_id) if name}
    corrections, findings = found_again(view.corrections, found.analysis, by_hand)
    corrections = normal(corrections, found)
    known = Known(view.number("known_width_m"), view.number("wall_height_m"))
    try:
        new = correct_found(found, corrections, known)
    except RoomError as error:
        message = f"Your corners or your known length do not fit this analysis and are not used: {error.message}"
        findings.append(Finding(about="room", message=message, severity="warning"))
        corrections = corrections.model_copy(update={"floor_polygon": None, "known_length": None})
        new = correct_found(found, corrections, known)
    if findings:
        analysis = new.analysis.model_copy(update={"findings": [*new.analysis.findings, *findings]})
        new = Corrected(analysis, new.calibration, [*new.findings, *findings])
    return new, corrections


def _room_follows(view: View, new: Corrected) -> StageRun:
    """Where a room stands already, it and all hand edits go over into the metres of the new analysis."""
    old, analysis, program = view.recall(Calibration), view.recall(SceneAnalysis), view.recall(LayoutProgram)
    if old is None or analysis is None:
        return []
    change = between(old, new.calibration)
    if change.nothing:
        return []
    if program is not None:
        layout, _ = apply_hand_edits(parse_layout(program.text), view.hand_edits, program.hand_edits)
        rooms = (analysis, old), (new.analysis, new.calibration)
        follow = follow_scale(change.metres) if change.pure else follow_shell(change.metres, *rooms, view.locked)
        yield Build(follow(print_layout(layout)))
    return [Rescaled(factor=change.metres.factor, shift=change.metres.shift)] if change.metres.moves else []


def _first_request(view: View) -> Request:
    picture = view.reference
    notes = []
    width = view.number("known_width_m")
    if width is not None:
        notes.append(f"The room is {width:g} m wide (measured).")
    if view.settings.get("notes"):
        notes.append(view.settings["notes"][:1000])
    return Request(
        key="01_analysis",
        prompt="01_analysis",
        reply=AnalysisReply,
        values={"width": str(picture.width), "height": str(picture.height), "notes": "\n".join(notes)},
        images=(Picture("reference", picture.for_model()), Picture("grid", picture.with_grid())),
        facts={"known_width_m": width} if width is not None else {},
    )


def _second_request(
    view: View, stated: SceneAnalysis, fitted: Found, crops: list[ImageBox], surfaces: list[tuple[str, ImageBox]]
) -> Request:
    """Asked in the metres that the model spoke in, so that both answers are of one measure."""
    picture = view.reference
    names = [*CROP_NAMES, *(f"around {name}" for name, _ in surfaces)]
    parts = [*crops, *(part for _, part in surfaces)]
    images = [Picture("found", numbered_boxes(picture, stated.objects))]
    images += [Picture(f"part {n}", enlarged(picture, part)) for n, part in enumerate(parts, 2)]
    return Request(
        key="01_second_look",
        prompt="01_second_look",
        reply=SecondLookReply,
        values={
            "width": str(picture.width),
            "height": str(picture.height),
            "crops": ", ".join(f"picture {n} {name}" for n, name in enumerate(names, 2)),
            "found": _list(stated.objects) + view.noted(o.id for o in stated.objects),
            "doubts": _doubtful(questions(doubts(stated, fitted.analysis, fitted.calibration))),
            "room_width": f"{stated.room_size[0]:.2f}",
            "room_depth": f"{stated.room_size[1]:.2f}",
        },
        images=tuple(images),
    )


def _again_request(
    view: View,
    found: SceneAnalysis,
    present: SceneAnalysis,
    asked: Sequence[DetectedObject],
    crops: Sequence[ImageBox | None],
) -> Request:
    """Asked in the metres of what was found, so that the answer can take its place there."""
    picture = view.reference
    shown = [(o, crop) for o, crop in zip(asked, crops, strict=True) if crop is not None]
    images = [Picture("found", numbered_boxes(picture, present.objects))]
    images += [Picture(f"part {n}", enlarged(picture, crop)) for n, (_, crop) in enumerate(shown, 2)]
    return Request(
        key="01_again",
        prompt="01_again",
        reply=SecondLookReply,
        values={
            "width": str(picture.width),
            "height": str(picture.height),
            "asked": ", ".join(o.id for o in asked),
            "crops": ", ".join(f"picture {n} {o.id}" for n, (o, _) in enumerate(shown, 2)) or "none",
            "found": _list(present.objects) + view.noted(o.id for o in asked),
            "room_width": f"{found.room_size[0]:.2f}",
            "room_depth": f"{found.room_size[1]:.2f}",
        },
        images=tuple(images),
    )


def _doubtful(said: str) -> str:
    """The paragraph on what contradicts itself, empty where nothing does."""
    if not said:
        return ""
    return f"""
Doubtful, since box and metres contradict each other (a leaning or half hidden thing may explain it):
{said}
Look at each of these first. Answer it in `corrections` with the tight `box`, and with `centre_m` and `size_m` measured
anew.
"""


def _list(objects: Sequence[DetectedObject]) -> str:
    return "\n".join(_line(n, o) for n, o in enumerate(objects, 1)) or "nothing"


def _line(number: int, item: DetectedObject) -> str:
    box = "-" if item.box is None else " ".join(f"{v:.0f}" for v in item.box.model_dump().values())
    return f"{number}, {item.id}, {item.category}, {item.placement}, yaw {item.yaw:.0f}, {item.parent or '-'}, {box}"


STAGE = Stage(
    id=ID,
    title="Scene analysis",
    reads=(),
    writes=(SceneAnalysis, Calibration),
    run=run,
    settings=("notes", "evidence", "second_look", "calibration"),
    partial=True,
    recalls=(Reads(Found), Reads(SceneAnalysis), Reads(Calibration), Reads(LayoutProgram)),
)
