# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 10: how the room is lit and looked at."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from .analysis import Finding
from .common import Artifact
from .replies import Reply

LightStyle = Literal["soft daylight", "sunny", "overcast", "evening", "night", "studio"]
STYLES: tuple[LightStyle, ...] = ("soft daylight", "sunny", "overcast", "evening", "night", "studio")


class Brightness(Artifact):
    """How bright one kind of surface is in the picture and, worked out, in the render: 0..1 as on the screen.

    Attributes:
        before: with the exposure that the lights would have without the picture; after: with the one that was set.
        places: how many places were compared.
    """

    about: Literal["floor", "walls"]
    picture: float
    before: float
    after: float
    places: int


class LightPlan(Artifact):
    """What stage 10 writes beside the room's program: why the lights are as they are.

    Attributes:
        style: of the light. direction: degrees counter-clockwise from +X in which the sun stands, None without one;
            elevation: degrees above the horizon.
        windows: ids that bring light; lamps: ids of the objects that are on.
        warmth: kelvin of the daylight.
        source: who decided: the model, or what was measured.
        cameras: ids of the cameras that were chosen, in the order in which they are rendered.
        seen: for each of them the share of the room's larger objects that it sees.
    """

    style: LightStyle
    direction: float | None = None
    elevation: float | None = None
    windows: list[str] = []
    lamps: list[str] = []
    warmth: float = 6500.0
    exposure: float = 0.0
    source: Literal["model", "measured"] = "measured"
    brightness: list[Brightness] = []
    cameras: list[str] = []
    seen: dict[str, float] = {}
    findings: list[Finding] = []


class LightReply(Reply):
    """Answer to prompt 10_light: the light of the picture."""

    style: str = ""
    sun_from: str = ""
    windows: list[str] = Field(default_factory=list)
    lamps_on: list[str] = Field(default_factory=list)
    warmth: str = ""
