# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 1: what is in the picture (`SceneAnalysis`) and how it was seen (`Calibration`)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator

from .camera import CameraModel
from .common import Artifact, ImageBox, ImagePoint, Metres2, Metres3, Placement, Salience, Shape
from .trust import Trust

ArchitectureKind = Literal["wall", "partition", "door", "window", "opening", "builtin"]
ViewKind = Literal["perspective", "orthographic", "plan"]


class Zone(Artifact):
    """A part of the room with a use of its own."""

    id: str
    label: str


class ArchitectureItem(Artifact):
    """A wall, or something in a wall, as a segment on the floor in metres.

    Attributes:
        start, end: ends of the segment (centre line for partitions, inner face for walls).
        height: top above the item's lower edge; sill: lower edge above the floor (windows).
        wall: id of the wall that a door, window or opening lies in.
        swing: for doors, how they open and stand, in the model's words (`layout/doors.py` reads them): "in", "out",
            "sliding", "into the room, hinge at the right end, slightly open"; "" when unknown.
    """

    id: str
    kind: ArchitectureKind
    start: Metres2
    end: Metres2
    height: float
    sill: float = 0.0
    thickness: float = 0.12
    wall: str | None = None
    box: ImageBox | None = None
    swing: str = ""


class DetectedObject(Artifact):
    """One thing that the analysis saw: both where the picture shows it and where it is in metres.

    Attributes:
        box: the whole visible object in the picture.
        centre: centre of its oriented bounding box (x, y, z) in metres, z half-way up the object.
        size: width along its own x, depth along its own y, height; metres.
        yaw: degrees counter-clockwise; 0 faces -Y (down in the picture).
        confidence: 0..1, the model's own or the analyser's.
        source: which request or pass found it.
        front: by what its front was recognised, in the model's words ("headboard at the top").
    """

    id: str
    category: str
    label: str = ""
    placement: Placement = "floor"
    parent: str | None = None
    salience: Salience = "major"
    zone: str | None = None
    shape: Shape = "box"
    box: ImageBox | None
    centre: Metres3
    size: Metres3
    yaw: float = 0.0
    confidence: float = 1.0
    source: str = "analysis"
    front: str = ""


def _short(text: str) -> str:
    # A finding may quote what a model wrote, and that may be of any length.
    return text if len(text) <= 300 else text[:299] + "\u2026"


class Finding(Artifact):
    """Something that was repaired, dropped or doubted, in one plain sentence."""

    about: Annotated[str, AfterValidator(_short)]
    message: Annotated[str, AfterValidator(_short)]
    severity: Literal["note", "warning", "error"] = "note"


class SceneAnalysis(Artifact):
    """Everything that stage 1 knows of the picture.

    Attributes:
        view: how the room was seen.
        room_size: width, depth, height of the floor's bounding rectangle and the walls, metres.
        floor: floor outline in metres, counter-clockwise, origin at its bounding rectangle's centre.
        floor_polygon: the same corners in the picture, in the same order, at floor level.
        wall_top_polygon: inner upper edges of the same walls in the picture, same order, or None.
        left_out: objects that were found and that the artist wants left out of the room.
    """

    image_size: tuple[int, int]
    view: ViewKind
    room_type: str = "room"
    room_size: Metres3
    floor: list[Metres2]
    floor_polygon: list[ImagePoint]
    wall_top_polygon: list[ImagePoint] | None = None
    zones: list[Zone] = []
    architecture: list[ArchitectureItem] = []
    objects: list[DetectedObject] = []
    left_out: list[DetectedObject] = []
    findings: list[Finding] = []


class ObjectResidual(Artifact):
    """How well an object's metres, projected through the fitted camera, cover its picture box."""

    id: str
    iou: float
    shift: Metres2


class TriedCamera(Artifact):
    """A kind of camera that was fitted, and how well it explains the picture.

    Attributes:
        name: how the picture would have been taken, in plain words ("straight down", "at an angle").
        cost: what it leaves unexplained and what its own freedom costs; lower is better.
        error_px: of the corners; objects_px: usual distance of box edges from where the metres put them, if known.
    """

    name: str
    cost: float
    error_px: float
    objects_px: float | None = None


class Calibration(Artifact):
    """The fitted camera and the room's outline in metres that belongs to it.

    Attributes:
        error_px: root mean square reprojection error of the corners, pixels.
        scale_source: what fixed the scale ("model", "model and 5 anchors", "known length", ...).
        scale_spread: relative uncertainty of the scale, 0 when it is given.
        tried: the cameras that were fitted, the chosen one first.
        trust: what was learnt from this picture of how good its boxes and its metres are; None when nothing was.
    """

    camera: CameraModel
    floor: list[Metres2]
    height: float
    error_px: float
    scale_source: str
    scale_spread: float = 0.0
    tried: list[TriedCamera] = []
    trust: Trust | None = None
    residuals: list[ObjectResidual] = []
    findings: list[Finding] = []
