# SPDX-License-Identifier: GPL-3.0-or-later
"""What stages 5 and 6 write, and what the model is asked to answer in them."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from .analysis import Finding
from .common import Artifact, Metres3
from .replies import Reply

Source = Literal["program", "library", "artist", "proxy"]
"""Who modelled an object: the model, the library, the artist; "proxy" is a box on which nobody did anything."""


class MeasuredColour(Artifact):
    """One colour of an object in the picture: six sRGB digits, white balance taken out, and its share of the object."""

    code: str
    share: float


class ObjectDescription(Artifact):
    """One object in words, and its colours as measured in the picture.

    Attributes:
        colour, material, function, structure, style: a few words each, "" where nothing was said.
        code: the model's own idea of the main colour as six sRGB digits, "" for none.
        measured: largest share first; empty where too little of the object is seen.
        seen: share of the object's outline that nothing hides, 0..1.
    """

    id: str
    colour: str = ""
    material: str = ""
    function: str = ""
    structure: str = ""
    style: str = ""
    code: str = ""
    measured: list[MeasuredColour] = []
    seen: float = 0.0

    @property
    def words(self) -> str:
        """All that was said of it, in one line."""
        said = (self.colour, self.material, self.structure, self.style, self.function)
        return "; ".join(part for part in said if part)


class Descriptions(Artifact):
    """What stage 5 writes: one description for each placed object."""

    objects: list[ObjectDescription] = []
    findings: list[Finding] = []

    def of(self, identifier: str) -> ObjectDescription:
        """The description of one object; an empty one when there is none."""
        return next((o for o in self.objects if o.id == identifier), ObjectDescription(id=identifier))


class RoomStyle(Artifact):
    """The room's style in a few words, the colour of the light as gains on linear red, green and blue."""

    style: str = ""
    gains: Metres3 = (1.0, 1.0, 1.0)


class ObjectProgram(Artifact):
    """How one object of the room is modelled.

    Attributes:
        id: of the proxy. function: of the def that the room text furnishes it with, "" for a bare proxy.
        source: who modelled it. like: id of the object that it shares its function with, "" for none.
        piece: the library's piece, "" for none; parameters: its parameters as they are written in the program.
        note: why it is not what was asked for, in one sentence, "" when it is.
    """

    id: str
    function: str = ""
    source: Source = "library"
    like: str = ""
    piece: str = ""
    parameters: dict[str, str] = {}
    note: str = ""


class Geometry(Artifact):
    """What stage 6 writes beside the room's program: who modelled what."""

    objects: list[ObjectProgram] = []
    findings: list[Finding] = []

    def of(self, identifier: str) -> ObjectProgram | None:
        """How one object is modelled, None when it is not."""
        return next((o for o in self.objects if o.id == identifier), None)


class OwnModelling(Artifact):
    """What the artist says of single objects' geometry; the latest entry replaces the ones before it.

    Attributes:
        functions: text of the functions that the artist edited in the program, by object id; they stay as they are.
        boxes: ids of objects that are shown as plain proxies.
    """

    functions: dict[str, str] = {}
    boxes: list[str] = []


class DescribedReply(Reply):
    """One object in a few words each; `main_colour` is "#RRGGBB" as painted in neutral light."""

    id: str
    colour: str = ""
    main_colour: str = ""
    material: str = ""
    function: str = ""
    structure: str = ""
    style: str = ""


class DescriptionsReply(Reply):
    """Answer to prompt 05_descriptions."""

    room_style: str = ""
    objects: list[DescribedReply] = Field(default_factory=list)


class ParameterReply(Reply):
    """One parameter of a library piece, its value written as in the list ("round", 3, True)."""

    name: str
    value: str


class RoleColourReply(Reply):
    """A material role of the piece and its colour "#RRGGBB" in neutral light."""

    role: str
    colour: str


class Furnishing(Artifact):
    """The room's text as it was last furnished; stages that lay out anew keep what is still there (never stored itself).

    Attributes:
        hand_edits: how many hand edits it holds.
    """

    text: str
    hand_edits: int = 0


class PieceReply(Reply):
    """The library piece that comes nearest to one object; "" when none does."""

    id: str
    piece: str = ""
    parameters: list[ParameterReply] = Field(default_factory=list)
    colours: list[RoleColourReply] = Field(default_factory=list)


class PiecesReply(Reply):
    """Answer to prompt 06_pieces."""

    objects: list[PieceReply] = Field(default_factory=list)


class ProgramReply(Reply):
    """The program of one object: one def that takes the size and returns its shapes."""

    id: str
    program: str = ""
    keep: bool = False


class ProgramsReply(Reply):
    """Answer to prompts 06_programs and 06_correct."""

    objects: list[ProgramReply] = Field(default_factory=list)
