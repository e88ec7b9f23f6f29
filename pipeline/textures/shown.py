# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference picture with everything that is needed to take a surface out of it; and what comes of that."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from PIL import Image, ImageDraw

from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox
from ..artifacts.layout import Layout
from ..artifacts.textures import TextureQuality
from ..geometry.camera import project
from ..light.developed import developed
from ..objects.colours import convex_hull
from ..picture import ReferencePicture
from .drawings import is_drawing
from .occluders import Solid, hidden_pixels, solids_of
from .pixels import Mask, Pixels, to_linear
from .planes import Face, Rectified, rectify

LIGHTEST = 0.92
"""Nothing in a room reflects more, linear."""


class NotUsable(Exception):
    """A surface cannot be taken from the picture; the message is a plain reason for the artist."""


@dataclass(frozen=True)
class Flat:
    """A surface as a flat picture, ready to be used.

    Attributes:
        pixels: linear light, without the room's light.
        size: metres that it covers; turned: degrees counter-clockwise by which it lies on its surface.
    """

    pixels: Pixels
    size: tuple[float, float]
    turned: float
    quality: TextureQuality


@dataclass
class Shown:
    """A room in its picture.

    Attributes:
        gains: on linear red, green and blue, which take the light's colour and strength out.
        boxes: what the picture shows that is not in the layout, 0-1000.
    """

    reference: ReferencePicture
    camera: CameraModel
    layout: Layout
    gains: tuple[float, float, float] = (1.0, 1.0, 1.0)
    boxes: Sequence[ImageBox] = ()
    _solids: list[Solid] = field(default_factory=list)

    @cached_property
    def picture(self) -> Pixels:
        """The picture in linear light, with the colours that things had."""
        return to_linear(developed(self.reference))

    @cached_property
    def drawn(self) -> bool:
        """Whether the picture is a drawing, from which nothing can be taken."""
        floor = self.layout.room.floor
        corners = np.array([(x, y, z) for x, y in floor for z in (0.0, self.layout.room.size[2])])
        points = project(self.camera, corners)
        points = points[np.isfinite(points).all(axis=1)]
        size = (self.reference.width, self.reference.height)
        inside = Image.new("1", size)
        hull = convex_hull(points * np.array(size) / 1000.0) if len(points) > 2 else np.zeros((0, 2))
        if len(hull) >= 3:
            ImageDraw.Draw(inside).polygon([(float(x), float(y)) for x, y in hull], fill=1)
        mask = np.array(inside, dtype=bool)
        return is_drawing(self.reference.pixels(), mask if mask.sum() > 1000 else np.ones_like(mask))

    def see(self, face: Face, without: Collection[str] = (), scale: float | None = None) -> Rectified:
        """A face straight on.

        Args:
            without: ids that are not in front of it: what it belongs to.

        Raises:
            NotUsable: the camera does not see it.
        """
        if not self._solids:
            self._solids = solids_of(self.layout)
        size = (self.reference.width, self.reference.height)
        hidden = hidden_pixels(self.camera, size, face, self._solids, without, self.boxes)
        found = rectify(self.picture, self.camera, face, hidden, scale)
        if found is None:
            raise NotUsable("The picture does not show it from where it can be recognised.")
        return found

    def balanced(self, pixels: Pixels) -> Pixels:
        """Colours without the light's, within what surfaces reflect."""
        found: Pixels = np.clip(pixels * np.array(self.gains, dtype=np.float32), 0.0, LIGHTEST).astype(np.float32)
        return found

    def part(self, rectified: Rectified, seen: Mask) -> Rectified:
        """The same with less of it seen."""
        return replace(rectified, seen=rectified.seen & seen)
