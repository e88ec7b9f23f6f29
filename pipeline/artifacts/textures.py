# SPDX-License-Identifier: GPL-3.0-or-later
"""What stage 9 writes: which image lies on which surface, and why. The images themselves are never kept in memory.

An image is kept as a packed image beside the room's memory, under its `name`, and known by its `sha256`. It can be made
again from the picture; what an image model made cannot, and is kept on disk as well (`textures/kept.py`).
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .analysis import Finding
from .common import Artifact, Metres2
from .replies import Reply

TextureSource = Literal["model", "picture", "procedural"]
"""Where a surface's look comes from: an image model, the reference picture itself, or a made material."""
TextureKind = Literal["floor", "wall", "rug", "cloth", "picture", "screen"]
SOURCES: tuple[TextureSource, ...] = ("model", "picture", "procedural")


class TextureQuality(Artifact):
    """How well a texture came out.

    Attributes:
        seen: share of the surface that the picture shows, 0..1.
        detail: pixels of the picture for a metre, along the less clear direction.
        sharpness: fine detail kept, 1 is all. seam: how much seams show, 1 is not at all.
        contrast: usual variation of the logarithm of brightness; filled: share that was made up, 0..1.
        period: metres after which the pattern repeats, 0 for none; sure: how sure that is, 0..1.
    """

    seen: float = 1.0
    detail: float = 0.0
    sharpness: float = 1.0
    seam: float = 1.0
    contrast: float = 0.0
    filled: float = 0.0
    period: Metres2 = (0.0, 0.0)
    sure: float = 0.0


class Texture(Artifact):
    """The look of one surface from an image, or why it has none.

    Attributes:
        surface: "floor", or the id of an object; part: which of its parts, "" for all of it.
        kind: what it is for. source: where it comes from; "procedural" has no image.
        name: of the packed image, "" for none; sha256: of its PNG bytes; pixels: its width and height.
        size: metres that the image covers: of a repeat where it tiles, else of the face that it fills once.
        tiles: whether it repeats. turned: degrees counter-clockwise by which it lies on its surface.
        colour: its mean as six sRGB digits.
        quality: measured; None for no image. model: which image model made it, "" for none.
        note: why a preferred source was not taken, in one plain sentence.
    """

    surface: str
    part: str = ""
    kind: TextureKind
    source: TextureSource = "procedural"
    name: str = ""
    sha256: str = ""
    pixels: tuple[int, int] = (0, 0)
    size: Metres2 = (0.0, 0.0)
    tiles: bool = False
    turned: float = 0.0
    colour: str = ""
    quality: TextureQuality | None = None
    model: str = ""
    note: str = ""


class Textures(Artifact):
    """What stage 9 writes: one entry for each surface that an image could lie on."""

    surfaces: list[Texture] = []
    findings: list[Finding] = []

    def of(self, surface: str, part: str = "") -> Texture | None:
        """The entry of a surface, None when there is none."""
        return next((t for t in self.surfaces if t.surface == surface and t.part == part), None)

    @property
    def images(self) -> list[Texture]:
        """The entries that have an image."""
        return [t for t in self.surfaces if t.name]


class TextureChoice(Artifact):
    """What the artist says of one surface's look: the source to take, or None for the best there is."""

    surface: str
    source: TextureSource | None = None


class TextureChoices(Artifact):
    """All that the artist says of textures; the latest entry replaces the ones before it.

    Attributes:
        first: the sources in order of preference for all surfaces.
    """

    first: list[TextureSource] = list(SOURCES)
    surfaces: list[TextureChoice] = []

    def order(self, surface: str) -> tuple[TextureSource, ...]:
        """The sources to try for a surface, best first; always ends with "procedural", which never fails."""
        chosen = next((c.source for c in self.surfaces if c.surface == surface), None)
        wanted = [chosen] if chosen is not None else list(dict.fromkeys(self.first))
        return tuple(wanted) if "procedural" in wanted else (*wanted, "procedural")


class TextureWordsReply(Reply):
    """One surface in words for an image model."""

    surface: str
    words: Annotated[str, Field(max_length=2000)] = ""
