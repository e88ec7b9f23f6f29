# SPDX-License-Identifier: GPL-3.0-or-later
"""Chosen objects described anew, and what was found changed in them and in nothing else."""

from __future__ import annotations

from collections.abc import Sequence

from ..artifacts.analysis import DetectedObject, Finding
from ..artifacts.common import ImageBox
from ..artifacts.corrections import Found
from ..artifacts.replies import MissedReply, SecondLookReply
from .clean import SHELL_NAMES, SIDE_NAMES, clean_id, clean_object, fix_parents
from .merge import to_whole_picture, with_corrections
from .residuals import residual

MARGIN = 0.6
"""How much of its own size is shown around an object, on each side."""
LEAST_MARGIN = 20.0


def surroundings(box: ImageBox) -> ImageBox:
    """The part of the picture (0-1000) that shows a box and what is around it."""
    dx = max(LEAST_MARGIN, MARGIN * (box.x_max - box.x_min))
    dy = max(LEAST_MARGIN, MARGIN * (box.y_max - box.y_min))
    return ImageBox(
        x_min=max(0.0, box.x_min - dx),
        y_min=max(0.0, box.y_min - dy),
        x_max=min(1000.0, box.x_max + dx),
        y_max=min(1000.0, box.y_max + dy),
    )


def described_anew(
    found: Found, reply: SecondLookReply, asked: Sequence[DetectedObject], crops: Sequence[ImageBox | None]
) -> tuple[Found, list[Finding]]:
    """What was found, with the asked objects as they are described now; everything else stays as it is.

    Args:
        asked: in the metres of `found`; things that the artist added are not in it yet.
        crops: for each picture of the request, what part of the whole it shows; None for the whole.
    """
    analysis = found.analysis
    findings: list[Finding] = []
    ids = {o.id for o in asked}
    objects = with_corrections(analysis.objects, [c for c in reply.corrections if c.id in ids], findings, crops)
    known = {o.id for o in objects}
    taken = {*known, *ids, *(a.id for a in analysis.architecture)}
    answered = set()
    for said in reply.missed:
        if said.id not in ids or said.id in answered or not 1 <= said.picture <= len(crops):
            findings.append(Finding(about=said.id, message="It was not asked about; what was said of it is not used."))
            continue
        answered.add(said.id)
        item = _described(said, crops[said.picture - 1], findings)
        if item is None:
            continue
        if said.id in known:
            objects = [item if o.id == said.id else o for o in objects]
        elif said.id not in {o.id for o in analysis.objects}:
            # The artist drew it. The analysis has it under a name of its own, and the two are brought together.
            objects.append(item.model_copy(update={"id": clean_id(f"{said.id}_seen", taken, "object")}))
    walls = {a.id for a in analysis.architecture} | SIDE_NAMES | SHELL_NAMES
    objects = fix_parents(objects, walls, findings)
    camera = found.calibration.camera
    residuals = [r for o in objects if (r := residual(o, camera)) is not None]
    changed = analysis.model_copy(update={"objects": objects, "findings": [*analysis.findings, *findings]})
    return Found(analysis=changed, calibration=found.calibration.model_copy(update={"residuals": residuals})), findings


def _described(said: MissedReply, crop: ImageBox | None, findings: list[Finding]) -> DetectedObject | None:
    whole = said.model_copy(update={"box": to_whole_picture(said.box, crop)})
    item = clean_object(whole, set(), findings, "analysis")
    return None if item is None else item.model_copy(update={"id": said.id})
