# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 1, analysis: what is in the picture and how it was seen. Two requests. (Paper, stage 1.)"""

from __future__ import annotations

from ..analysis.calibrate import calibrate
from ..analysis.clean import clean_analysis
from ..analysis.look import enlarged, numbered_boxes, quarters
from ..analysis.merge import merge_second_look
from ..artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.replies import AnalysisReply, SecondLookReply
from .base import Stage, View
from .wishes import Ask, Picture, Request, StageRun, Tell

ID = "s01_analysis"
CROP_NAMES = "picture 2 top left, picture 3 top right, picture 4 bottom left, picture 5 bottom right"


def run(view: View) -> StageRun:
    """Write `SceneAnalysis` and `Calibration`."""
    picture = view.reference
    yield Tell("Asking what is in the picture", 1, 3)
    [reply] = yield Ask((_first_request(view),))
    analysis = clean_analysis(reply, (picture.width, picture.height))
    yield Tell("Looking a second time for what was missed", 2, 3)
    crops = quarters(analysis)
    [second] = yield Ask((_second_request(view, analysis, crops),))
    merged = merge_second_look(analysis, second, [None, *crops])
    yield Tell("Fitting the camera", 3, 3)
    aligned, calibration = calibrate(merged, view.number("known_width_m"), view.number("wall_height_m"))
    return [aligned, calibration]


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
        images=(Picture("reference", picture.for_model()),),
        facts={"known_width_m": width} if width is not None else {},
    )


def _second_request(view: View, analysis: SceneAnalysis, crops: list[ImageBox]) -> Request:
    picture = view.reference
    images = [Picture("found", numbered_boxes(picture, analysis.objects))]
    images += [Picture(f"part {n}", enlarged(picture, crop)) for n, crop in enumerate(crops, 2)]
    return Request(
        key="01_second_look",
        prompt="01_second_look",
        reply=SecondLookReply,
        values={
            "width": str(picture.width),
            "height": str(picture.height),
            "crops": CROP_NAMES,
            "found": "\n".join(_line(n, o) for n, o in enumerate(analysis.objects, 1)) or "nothing",
            "room_width": f"{analysis.room_size[0]:.2f}",
            "room_depth": f"{analysis.room_size[1]:.2f}",
        },
        images=tuple(images),
    )


def _line(number: int, item: DetectedObject) -> str:
    box = "-" if item.box is None else " ".join(f"{v:.0f}" for v in item.box.model_dump().values())
    return f"{number}, {item.id}, {item.category}, {item.placement}, yaw {item.yaw:.0f}, {item.parent or '-'}, {box}"


STAGE = Stage(id=ID, title="Scene analysis", reads=(), writes=(SceneAnalysis, Calibration), run=run)
