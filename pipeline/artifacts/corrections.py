# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist corrected of the analysis: corners, a known length, boxes, and what is to be made of each object."""

from __future__ import annotations

from .common import Artifact, ImageBox, ImagePoint


class KnownLength(Artifact):
    """Two points on the floor in the picture, and how far they are apart in metres."""

    start: ImagePoint
    end: ImagePoint
    metres: float


class ObjectCorrection(Artifact):
    """What the artist says of one detected object; None or "" where nothing is said.

    Attributes:
        include: False leaves it out of the room. locked: True keeps it from every automatic change, False frees an
            object that a hand edit locked.
        note: a hint for the model, sent with every question about this object. box: where it is in the picture.
    """

    id: str
    include: bool | None = None
    locked: bool | None = None
    note: str = ""
    box: ImageBox | None = None
    category: str = ""


class AddedObject(Artifact):
    """Something that the analysis missed, drawn into the picture by the artist."""

    id: str
    category: str
    box: ImageBox


class Corrections(Artifact):
    """All corrections as they stand; the latest entry replaces the ones before it.

    Attributes:
        floor_polygon: the floor's corners in the picture, in the order of `SceneAnalysis.floor_polygon`; None as found.
    """

    floor_polygon: list[ImagePoint] | None = None
    known_length: KnownLength | None = None
    objects: list[ObjectCorrection] = []
    added: list[AddedObject] = []

    def of(self, identifier: str) -> ObjectCorrection:
        """What is said of one object; an empty correction when nothing is."""
        return next((c for c in self.objects if c.id == identifier), ObjectCorrection(id=identifier))

    def having(self, correction: ObjectCorrection) -> Corrections:
        """The corrections with this one in the place of what was said of its object before."""
        others = [c for c in self.objects if c.id != correction.id]
        return self.model_copy(update={"objects": [*others, correction]})
