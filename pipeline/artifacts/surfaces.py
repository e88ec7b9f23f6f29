# SPDX-License-Identifier: GPL-3.0-or-later
"""What stage 7 writes."""

from __future__ import annotations

from .analysis import Finding
from .common import Artifact


class SmallPlace(Artifact):
    """Where one small object stands.

    Attributes:
        on: id of what carries it; part: the part of that whose surface it is.
        height: of its base above the floor, metres; moved: metres from where the picture shows it.
    """

    id: str
    on: str
    part: str = ""
    height: float
    moved: float = 0.0


class SmallObjects(Artifact):
    """All small objects on their surfaces, and what had to be changed for that."""

    places: list[SmallPlace] = []
    findings: list[Finding] = []
