# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures that were shown through a filmic view transform, and the colours that things had before it.

Renders are mostly shown through a transform that keeps bright light from burning out (AgX, Filmic): blacks become grey, and
whatever is bright loses most of its colour. An eye takes that for the picture's manner and sees strong colours all the same.
Taken as base colours they would be too pale in any light. So where a picture's range is narrow as only such a transform leaves it,
its colours are led back through AgX; bright greys stay as bright as they are.

A room made from such a picture is shown through the same transform (`tone_of`), and so looks like the picture again.
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFilter

from ..picture import ReferencePicture
from .tone import AGX, LOOK, MEDIUM_HIGH, TRANSFORM, led_back, linear, luminance, shown

Floats = NDArray[np.float64]

_SIDE = 512
_MARGIN = 0.08
"""Part of the picture at each edge that may be a frame or the paper."""
_BLACK = (28.0, 52.0)
_WHITE = (238.0, 248.0)
"""Values of the darkest and the brightest that a picture has: from where to where it counts as washed out."""
_DIM = (180.0, 200.0)
"""Brightest values of pictures without anything white, which tell nothing."""
_SURE = 0.5
"""How washed out a picture must be to be shown through such a transform again."""
_KEPT = 75.0
"""Per cent of the picture that are darker than what keeps its brightness."""


@functools.lru_cache(maxsize=2)
def wash(picture: ReferencePicture) -> float:
    """How much a picture looks like one that was shown through a filmic transform: 0 not at all, 1 certainly."""
    image = Image.fromarray(picture.pixels())
    image.thumbnail((_SIDE, _SIDE))
    # A single pixel of black is noise, an edge that was sharpened, or a letter.
    values = np.asarray(image.filter(ImageFilter.GaussianBlur(1.0)), dtype=float)
    high, wide = (round(_MARGIN * n) for n in values.shape[:2])
    inner = values[high : values.shape[0] - high, wide : values.shape[1] - wide].reshape(-1, 3)
    if not inner.size:
        return 0.0
    # Strong colours do not come out of such a transform either: one of red, green and blue would be at its end.
    black, white = np.percentile(luminance(inner), 0.3), np.percentile(inner.max(axis=1), 99.7)
    dark = (black - _BLACK[0]) / (_BLACK[1] - _BLACK[0])
    bright = (_WHITE[1] - white) / (_WHITE[1] - _WHITE[0])
    lit = (white - _DIM[0]) / (_DIM[1] - _DIM[0])
    return float(np.clip((dark, bright, lit), 0.0, 1.0).prod())


def tone_of(picture: ReferencePicture) -> tuple[str, str]:
    """View transform and look with which a room made from the picture looks like it."""
    return (AGX, MEDIUM_HIGH) if wash(picture) >= _SURE else (TRANSFORM, LOOK)


@functools.lru_cache(maxsize=2)
def developed(picture: ReferencePicture) -> NDArray[np.uint8]:
    """The picture's pixels (height, width, 3), sRGB, with the colours that things had; the picture's own where it is not washed out.

    Not to be written into.
    """
    pixels = picture.pixels()
    share = wash(picture)
    if share > 0.0:
        screen = pixels.astype(float) / 255.0
        given, meant = linear(screen), led_back(screen)
        kept = np.percentile(luminance(given), _KEPT) / max(float(np.percentile(luminance(meant), _KEPT)), 1e-6)
        light = shown(share * kept * meant + (1.0 - share) * given, "Standard")
        pixels = np.round(light * 255.0).astype(np.uint8)
    pixels.flags.writeable = False
    return pixels
