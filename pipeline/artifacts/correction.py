# SPDX-License-Identifier: GPL-3.0-or-later
"""What the correction pass found wrong with a finished room, and what it did about it."""

from __future__ import annotations

from typing import Literal

from .analysis import Finding
from .common import Artifact

FaultKind = Literal[
    "material", "picture", "light", "outside", "blocked", "overlap", "support", "coincident", "camera"
]  # fmt: skip
FAULT_KINDS: tuple[FaultKind, ...] = (
    "material", "picture", "light", "outside", "blocked", "overlap", "support", "coincident", "camera",
)  # fmt: skip
"""Every kind of fault, in the order in which they are mended. "support" is what floats or is sunken."""


class Fix(Artifact):
    """One thing that was mended.

    Attributes:
        id: of the object, light or camera. other: what it was in conflict with, "" for nothing.
        before, after: the value that was changed, as it is written in the room's program.
        amount: how far it was moved in metres; for lights the factor; 1 for materials and pictures.
    """

    kind: FaultKind
    id: str
    other: str = ""
    before: str
    after: str
    amount: float
    message: str


class CorrectionReport(Artifact):
    """What one correction pass did.

    Attributes:
        left: faults that stay, and why: nothing could mend them, their object is locked, or their kind is switched off.
    """

    fixes: list[Fix] = []
    left: list[Finding] = []
    off: list[FaultKind] = []
