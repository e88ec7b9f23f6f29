# SPDX-License-Identifier: GPL-3.0-or-later
"""Metres and boxes fused: two measurements of one thing become one placement.

The model's metres and its picture box, lifted through the fitted camera, are compared by reprojection. Each is weighted by
how far it can be trusted: a lift suffers from a guessed height far from the picture's centre and from turned objects, the
metres from the model's own scale. (Paper, stage 3; DESIGN.md "What was measured".)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..artifacts.analysis import Calibration, DetectedObject, ObjectResidual
from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox, Metres2, Metres3
from ..geometry.camera import project
from ..geometry.footprint import image_box_of, lift_box
from .trust import BOX_NOISE, HEIGHT_NOISE, METRES_NOISE

import numpy as np


@dataclass(frozen=True)
class Fused:
    """A placement after fusing: pose and size in metres, and the weight 0..1 that the box had."""

    centre: Metres3
    size: Metres3
    yaw: float
    box_weight: float
    residual: ObjectResidual | None
