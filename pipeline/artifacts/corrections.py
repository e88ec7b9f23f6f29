# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist corrected of the analysis: corners, a known length, boxes, and what is to be made of each object."""

from __future__ import annotations

from .analysis import Calibration, SceneAnalysis
from .common import Artifact, ImageBox, ImagePoint, Metres2


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
        seen: where the analysis had it when this was said, so that it is found again when another analysis calls it
            otherwise; filled in by `correct`.
    """

    id: str
    include: bool | None = None
    locked: bool | None = None
    note: str = ""
    box: ImageBox | None = None
    category: str = ""
    seen: ImageBox | None = None

    @property
    def says_nothing(self) -> bool:
        """Whether everything is left to the analysis."""
        said = (self.include is False, self.locked is not None, self.note, self.box, self.category)
        return not any(said)


class AddedObject(Artifact):
    """Something that the analysis missed, drawn into the picture by the artist. `correct` makes the id a clean one."""

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


class Found(Artifact):
    """What stage 1 found before anything of the artist's was applied to it.

    Written only where the artist's corrections or known sizes change it; else the analysis itself is what was found.
    """

    analysis: SceneAnalysis
    calibration: Calibration


class Rescaled(Artifact):
    """All metres written before this entry are meant times `factor`, then moved by `shift`.

    A known length changes the factor; moved floor corners also move the origin, which is the floor's centre.

    Attributes:
        before: the program that stood in the scene before. after: the one that was built instead; "" for none.
    """

    factor: float
    shift: Metres2 = (0.0, 0.0)
    before: str = ""
    after: str = ""
