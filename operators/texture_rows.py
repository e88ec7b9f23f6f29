# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel shows of the images on surfaces, as plain values."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SurfaceRow:
    """One surface that an image could lie on.

    Attributes:
        title: what the artist calls it. source: where its look comes from, in words; wanted: the source that the
            artist chose for it, "" for none.
        note: why a source before that one was not taken. detail: of the image: metres, pixels, model.
        waits: another source was chosen since it was made.
    """

    surface: str
    title: str
    source: str
    wanted: str
    note: str
    detail: str
    waits: bool


@dataclass(frozen=True)
class TextureState:
    """All surfaces.

    Attributes:
        order: name of the order of preference in `run_textures.ORDERS`, "" for another one.
        painter: which image model paints, "" for none; problem: what keeps it from painting.
        paints: what it would be asked for if the textures were made anew, in words, "" for nothing.
    """

    rows: tuple[SurfaceRow, ...] = ()
    order: str = ""
    painter: str = ""
    problem: str = ""
    paints: str = ""

    @property
    def waits(self) -> bool:
        """Whether some images have to be made anew for what was chosen."""
        return any(row.waits for row in self.rows)
