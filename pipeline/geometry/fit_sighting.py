# SPDX-License-Identifier: GPL-3.0-or-later
"""What a camera is fitted to: checked corners and wall tops in pixels, and what is known of the room."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..artifacts.analysis import Finding
from ..artifacts.camera import CameraModel
from ..artifacts.common import ImagePoint
from .camera import CENTRE, GeometryError, Kind, Projector, image_points
from .corners import Corners, check_corners
from .polygon import Floats

ASSUMED_HEIGHT = 2.7
CORNER_NOISE = 0.003  # of the picture's longer side: how far off corners are expected to be


@dataclass
class Sighting:
    """What both entry points have in common, in pixels."""

    corners: Corners
    floor: Floats
    tops: Floats | None
    size: Floats
    principal: Floats
    height: float
    height_given: bool
    kind: Kind | None
    findings: list[Finding]
    expected: Projector | None = None

    @staticmethod
    def of(
        image_size: tuple[int, int],
        floor: Sequence[ImagePoint],
        tops: Sequence[ImagePoint] | None,
        height: float | None,
        kind: Kind | None,
        principal: ImagePoint | None,
        expected: CameraModel | None = None,
    ) -> Sighting:
        if min(image_size) < 2:
            raise GeometryError("The picture is too small to measure in.")
        corners = check_corners(image_points(floor), None if tops is None else image_points(tops))
        unit = np.array(image_size, dtype=float) / 1000.0
        findings = corners.findings
        given = height is not None and math.isfinite(height) and 1.0 <= height <= 20.0
        if height is not None and not given:
            findings.append(
                warning("height", f"A wall height of {height:g} m cannot be right; {ASSUMED_HEIGHT} m was assumed.")
            )
        centre = CENTRE if principal is None else (principal.x, principal.y)
        return Sighting(
            corners,
            corners.floor * unit,
            None if corners.tops is None else corners.tops * unit,
            np.array(image_size, dtype=float),
            np.array(centre) * unit,
            float(height) if given and height is not None else ASSUMED_HEIGHT,
            given,
            kind,
            findings,
            None if expected is None else Projector.of(expected),
        )

    @property
    def noise(self) -> float:
        """Pixels by which a corner is expected to be off."""
        return CORNER_NOISE * float(self.size.max())


def warning(about: str, message: str) -> Finding:
    return Finding(about=about, message=message, severity="warning")


def note(about: str, message: str) -> Finding:
    return Finding(about=about, message=message)
