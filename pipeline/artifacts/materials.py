# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 8: what everything is made of, and what the model is asked to answer."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from .analysis import Finding
from .common import Artifact
from .objects import ParameterReply
from .replies import Reply

MaterialSource = Literal["model", "measured", "usual", "artist", "kept"]
"""Who decided: the model; the picture's colours; what such parts usually are; the artist; an earlier run."""


class PartMaterial(Artifact):
    """What a part of an object, or a surface of the room, is made of.

    Attributes:
        part: its part name, "" for none. role: its material role.
        look: name of the look in the room's program, or its expression.
        colour: six sRGB digits of its mean colour, "" where it is not known. why: in a few words.
    """

    part: str = ""
    role: str = ""
    look: str = ""
    colour: str = ""
    why: str = ""
    source: MaterialSource = "usual"


class ObjectMaterials(Artifact):
    """The parts of one object; the shell's surfaces are under "floor", "walls", "ceiling" and the walls' ids."""

    id: str
    parts: list[PartMaterial] = []


class Materials(Artifact):
    """What stage 8 writes beside the room's program.

    Attributes:
        looks, finishes: as this stage wrote them into the program, so that what the artist changed there is known.
    """

    objects: list[ObjectMaterials] = []
    looks: dict[str, str] = {}
    finishes: dict[str, dict[str, str]] = {}
    findings: list[Finding] = []

    def of(self, identifier: str) -> ObjectMaterials | None:
        """What an object is made of, None when nothing was decided."""
        return next((o for o in self.objects if o.id == identifier), None)


class OwnFinishes(Artifact):
    """What the artist wrote of materials into the room's program: it holds against every stage.

    Attributes:
        looks: named looks that the artist wrote or changed, by name. finishes: those of objects and surfaces, by id.
    """

    looks: dict[str, str] = {}
    finishes: dict[str, dict[str, str]] = {}


class PaletteReply(Reply):
    """One material of the room: `name` such as "oak", `family` of the list, `color` "#RRGGBB" in neutral light."""

    name: str
    family: str
    color: str = ""
    options: list[ParameterReply] = Field(default_factory=list)


class PartMaterialReply(Reply):
    """One part: `material` a name of the palette or a family; `color` and `veto` only where the listed colour is wrong."""

    part: str
    material: str = ""
    color: str = ""
    veto: str = ""
    options: list[ParameterReply] = Field(default_factory=list)
    program: str = ""


class ObjectMaterialsReply(Reply):
    """The parts of one object or surface."""

    id: str
    parts: list[PartMaterialReply] = Field(default_factory=list)


class MaterialsReply(Reply):
    """Answer to prompt 08_materials."""

    palette: list[PaletteReply] = Field(default_factory=list)
    objects: list[ObjectMaterialsReply] = Field(default_factory=list)
