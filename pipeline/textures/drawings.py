# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells a drawn plan from a picture of a room: drawings have few colours, each exactly the same everywhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .pixels import Mask

_ENOUGH = 200_000  # pixels that tell it
_EXACT = 12
_EXACT_SHARE = 0.6
_MOST_CHROMA = 14
_GREY_SHARE = 0.97
_MIDDLE_SHARE = 0.3


def is_drawing(pixels: NDArray[np.uint8], inside: Mask) -> bool:
    """Whether a picture is a line plan or a flatly coloured one.

    Args:
        pixels: sRGB 0-255; inside: the part that shows the room.
    """
    found = pixels[inside]
    found = found[:: 1 + len(found) // _ENOUGH].astype(np.int64)
    if len(found) < 100:
        return True
    code = (found[:, 0] << 16) | (found[:, 1] << 8) | found[:, 2]
    counts = np.sort(np.unique(code, return_counts=True)[1])[::-1]
    if counts[:_EXACT].sum() > _EXACT_SHARE * len(found):
        return True
    grey = found.max(axis=1) - found.min(axis=1) < _MOST_CHROMA
    light = found.mean(axis=1)
    middle = (light > 60) & (light < 215)
    # Scanned or compressed line plans: paper and ink, and hardly anything between.
    return bool(grey.mean() > _GREY_SHARE and middle.mean() < _MIDDLE_SHARE)
