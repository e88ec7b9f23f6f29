# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel shows of the light and of what was corrected, as plain values."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class FixRow:
    """One thing that was mended, or that would have been.

    Attributes:
        key: "kind:id", as the setting that spares it has it. title: what the artist calls the thing.
        message: what was wrong and what was done. change: from what to what, "" where it says nothing to an artist.
        spared: the artist keeps it as it was, from the next run on.
    """

    key: str
    id: str
    title: str
    message: str
    change: str
    spared: bool


@dataclass(frozen=True)
class FinishState:
    """The light, and what was corrected.

    Attributes:
        ran: the stage has run. light: a few sentences on it. fixes: what was mended; left: sentences on what was not.
        waits: the artist switched something since.
    """

    ran: bool = False
    light: tuple[str, ...] = ()
    fixes: tuple[FixRow, ...] = ()
    left: tuple[str, ...] = ()
    waits: bool = False
