# SPDX-License-Identifier: GPL-3.0-or-later
"""What the model is asked to answer, stage by stage, as pydantic types.

They are looser than the artifacts: a stage repairs what can be repaired, reports it, and only then writes an artifact.
Field names carry their units, since models follow names more reliably than prose.
"""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

Facing = Literal["down", "down-right", "right", "up-right", "up", "up-left", "left", "down-left", "none"]


class Reply(BaseModel):
    """Base of all replies: unknown fields are ignored, since models like to add some."""

    model_config = ConfigDict(extra="ignore")


class PlainReply(Reply):
    """An answer that is a text as it is, such as a program: it is not read as JSON, and its beginning is of use too."""

    text: str


class PointReply(Reply):
    """A point of the picture, 0-1000 of its width (x, right) and height (y, down)."""

    x: float
    y: float


class BoxReply(Reply):
    """A box of the picture, 0-1000 of its width (x, right) and height (y, down)."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float


class MetresReply(Reply):
    """A point on the floor: metres from the room's centre, x right, y up in the picture."""

    x_m: float
    y_m: float


class SizeReply(Reply):
    """Width along the object's own left-right, depth front to back, height; metres."""

    width: float
    depth: float
    height: float


class ZoneReply(Reply):
    """A part of the room with a use of its own."""

    id: str
    label: str


class ArchitectureReply(Reply):
    """A partition, door, window, opening or built-in as a segment on the floor."""

    id: str
    kind: Literal["wall", "partition", "door", "window", "opening", "builtin"]
    start: MetresReply
    end: MetresReply
    height_m: float = 2.6
    sill_m: float = 0.0
    thickness_m: float = 0.12
    wall: str | None = None
    box: BoxReply | None = None
    swing: str = ""


class ObjectReply(Reply):
    """One thing in the room: where the picture shows it, and where it is in metres."""

    id: str
    category: str
    label: str = ""
    placement: Literal["floor", "wall", "ceiling", "surface"] = "floor"
    parent: str | None = None
    salience: Literal["major", "minor"] = "major"
    zone: str | None = None
    shape: Literal["box", "round", "l_shape"] = "box"
    box: BoxReply
    centre_m: MetresReply
    base_m: float = 0.0
    size_m: SizeReply
    facing: Facing = "none"
    yaw_deg: float = 0.0
    front: str = ""
    confidence: float = 1.0


class AnalysisReply(Reply):
    """Answer to prompt 01_analysis."""

    view: Literal["perspective", "orthographic", "plan", "other"]
    view_problem: str = ""
    room_type: str = "room"
    room_width_m: float
    room_depth_m: float
    wall_height_m: float = 2.6
    floor_polygon: list[PointReply]
    wall_top_polygon: list[PointReply] | None = None
    zones: list[ZoneReply] = Field(default_factory=list)
    architecture: list[ArchitectureReply] = Field(default_factory=list)
    objects: list[ObjectReply] = Field(default_factory=list)


class CorrectionReply(Reply):
    """A better box, place, size or name for an object that was found; null fields stay as they are.

    `picture` is the number of the picture whose 0-1000 the box uses (1 is the whole).
    """

    id: str
    wrong: str = ""
    remove: bool = False
    category: str | None = None
    picture: int = 1
    box: BoxReply | None = None
    centre_m: MetresReply | None = None
    base_m: float | None = None
    size_m: SizeReply | None = None
    facing: Facing | None = None
    yaw_deg: float | None = None
    placement: Literal["floor", "wall", "ceiling", "surface"] | None = None
    parent: str | None = None


class MissedReply(ObjectReply):
    """An object that was missed; `picture` is the number of the picture whose 0-1000 its box uses (1 is the whole)."""

    picture: int = 1


class SecondLookReply(Reply):
    """Answer to prompt 01_second_look: only what is missing or wrong."""

    missed: list[MissedReply] = Field(default_factory=list)
    corrections: list[CorrectionReply] = Field(default_factory=list)


class AttributeReply(Reply):
    """Facts on one object in a few words."""

    id: str
    color: str = ""
    material: str = ""
    form: str = ""


class RelationReply(Reply):
    """`source relation target` between two known ids."""

    source: str
    relation: Literal[
        "on", "under", "in_front_of", "behind", "beside", "faces", "belongs_to", "hangs_on", "lights", "against_wall"
    ]
    target: str


class GraphReply(Reply):
    """Answer to prompt 02_graph."""

    attributes: list[AttributeReply] = Field(default_factory=list)
    relations: list[RelationReply] = Field(default_factory=list)


class EditReply(Reply):
    """One change of the layout. Fields that the change does not use are null."""

    op: Literal["move", "resize", "turn", "remove", "recategorise", "add"]
    id: str
    reason: str = ""
    box: BoxReply | None = None
    size_m: SizeReply | None = None
    facing: Facing | None = None
    yaw_deg: float | None = None
    category: str | None = None
    base_m: float | None = None


class CritiqueReply(Reply):
    """Answer to prompt 03_critique: how well the render matches the picture, 0..100, and what to change."""

    score: float | None = None
    remarks: str = ""
    edits: list[EditReply] = Field(default_factory=list)


class AuxiliaryPlacementReply(Reply):
    """Where an object that the picture leaves open belongs."""

    id: str
    placement: Literal["floor", "wall", "ceiling", "surface"]
    parent: str | None = None
    base_m: float
    height_m: float | None = None
    drop: bool = False
    reason: str = ""


class AuxiliaryReply(Reply):
    """Answer to prompt 04_auxiliary."""

    placements: list[AuxiliaryPlacementReply] = Field(default_factory=list)
