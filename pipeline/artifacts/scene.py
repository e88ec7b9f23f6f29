# SPDX-License-Identifier: GPL-3.0-or-later
"""`scene.json`, the interchange format: what the benchmark and other programs read."""

from __future__ import annotations

from typing import Literal

from .camera import CameraModel
from .common import Artifact, Metres2, Metres3, Placement, Salience


class SceneRoom(Artifact):
    """Size (width, depth, height) and floor outline in metres."""

    size: Metres3
    floor: list[Metres2]


class SceneArchitecture(Artifact):
    """A wall, partition, door, window or opening as a segment on the floor."""

    id: str
    kind: str
    start: Metres2
    end: Metres2
    height: float
    sill: float = 0.0
    wall: str | None = None


class SceneObject(Artifact):
    """An object as its oriented bounding box."""

    id: str
    category: str
    label: str = ""
    centre: Metres3
    size: Metres3
    yaw: float
    placement: Placement
    parent: str | None = None
    salience: Salience


class SceneDocument(Artifact):
    """The whole file."""

    format: Literal["code-as-room/scene/1"] = "code-as-room/scene/1"
    image: str
    room: SceneRoom
    camera: CameraModel
    architecture: list[SceneArchitecture]
    objects: list[SceneObject]
