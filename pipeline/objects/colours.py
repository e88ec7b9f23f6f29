# SPDX-License-Identifier: GPL-3.0-or-later
"""The colours of an object, measured in the picture: inside its outline, beside what hides it, in neutral light.

Everything is worked out in linear light. Shadows darken a part of an object, and gloss lightens a spot of it, so a
colour is the trimmed mean of its own cluster's middle brightness.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox
from ..artifacts.layout import Layout, ProxyLine
from ..artifacts.objects import MeasuredColour
from ..geometry.camera import project
from ..geometry.footprint import box_corners
from ..light.developed import developed
from ..picture import ReferencePicture
from .outlines import Floats as Floats
from .outlines import area, fitted, grown, not_around, some, wider
from .outlines import convex_hull as convex_hull

LONG_SIDE = 800
"""Pixels of the copy of the picture that is measured."""
_LEAST_PIXELS = 24
_MOST_PIXELS = 4000
_CLUSTERS = 3
_INSET = 0.9
_UNSURE = 4.0
"""Pixels of the measured copy by which the place of an object is usually wrong."""
_LEAK = 2.0
"""Pixels round what lies on an object that may show either."""
_OWN = 0.35
"""Least share of an object that has colours of its own; of fewer pixels they are a foot or a shadow."""
_BURNT = 0.93
"""Linear light of the least of three colours, from which a pixel has no hue left."""
BRIGHTEST = 0.86
"""Linear light that the whitest usual paint gives back."""
_WHITE = 0.8
"""Linear brightness of what is white in a picture that is lit as usual."""


class ColourMeter:
    """Measures objects of one layout in one picture.

    Args:
        layout: where everything stands; camera: through which the picture was seen.
        boxes: where the picture shows objects, by id, as far as that was looked up.
    """

    def __init__(
        self,
        picture: ReferencePicture,
        camera: CameraModel,
        layout: Layout,
        boxes: Mapping[str, ImageBox] | None = None,
    ) -> None:
        self._pixels = _linear(_small(developed(picture)))
        self._camera = camera
        self._layout = layout
        self._boxes = boxes or {}
        height, width = self._pixels.shape[:2]
        self._scale = np.array((width, height)) / 1000.0
        self._size = (width, height)
        inside = self._room()
        self.gains = light_gains(self._pixels[inside] if inside.any() else self._pixels.reshape(-1, 3))
        self._outlines = {p.id: self._outline(p) for p in layout.proxies}

    def measure(self, proxy: ProxyLine) -> tuple[list[MeasuredColour], float]:
        """Up to three colours of an object, largest share first, and the share of its outline that is seen."""
        outline = self._outlines.get(proxy.id)
        if outline is None:
            return [], 0.0
        whole = self._mask([grown(outline, _INSET)])
        if not whole.any():
            return [], 0.0
        hidden = self._hidden(proxy)
        seen = float((whole & ~hidden).sum() / whole.sum())
        found = self._own(outline, whole, hidden)
        if len(found) < _LEAST_PIXELS:
            return [], seen
        if len(found) > _MOST_PIXELS:
            found = found[np.linspace(0, len(found) - 1, _MOST_PIXELS).astype(int)]
        return dominant(as_paint(found, self.gains)), seen

    def _hidden(self, proxy: ProxyLine) -> NDArray[np.bool_]:
        """The pixels of what may stand before an object or lies on it, with the rims of what lies on it."""
        above = _ancestors(proxy, self._layout)
        outlines: list[Floats] = []
        for other in self._layout.proxies:
            shape = self._outlines[other.id]
            if shape is None or other.id in above or not _hides(other, proxy, self._layout):
                continue
            on_it = other.parent == proxy.id
            outlines.append(wider(shape, _LEAK) if on_it else shape)
            box = self._boxes.get(other.id)
            if on_it and box is not None:
                outlines.append(wider(self._corners(box), _LEAK / 2))
        return self._mask(outlines) if outlines else np.zeros(self._pixels.shape[:2], dtype=bool)

    def _own(self, outline: Floats, whole: NDArray[np.bool_], hidden: NDArray[np.bool_]) -> Floats:
        """The pixels inside an outline that are an object's own: not at its rim, and not in its surroundings' colours.

        The place of a small thing is less sure than it is wide, so of small ones only the inner part counts.
        """
        across = float(np.sqrt(max(area(outline), 1.0)))
        for inset in (np.clip(1.0 - 2 * _UNSURE / across, 0.55, _INSET), _INSET):
            inside = self._mask([grown(outline, float(inset))]) & ~hidden
            if inside.sum() >= 2 * _LEAST_PIXELS:
                break
        found = self._pixels[inside]
        ring = self._mask([wider(grown(outline, 1.15), 4.0)]) & ~self._mask([wider(outline, 1.0)]) & ~hidden
        if min(len(found), int(ring.sum())) < _LEAST_PIXELS:
            return found
        own = found[not_around(_perceived(found), _perceived(some(self._pixels[ring], 1500)))]
        # An object of its surroundings' own colour is all of it.
        return own if len(own) > _OWN * len(found) else found

    def _corners(self, box: ImageBox) -> Floats:
        """A box of the picture as an outline in pixels of the measured copy."""
        x = (box.x_min, box.x_max, box.x_max, box.x_min)
        y = (box.y_min, box.y_min, box.y_max, box.y_max)
        corners: Floats = np.stack([x, y], axis=1) * self._scale
        return corners

    def _room(self) -> NDArray[np.bool_]:
        """The pixels of the floor and the walls' insides, without what is drawn round a room."""
        low = [(x, y, 0.0) for x, y in self._layout.room.floor]
        high = [(x, y, self._layout.room.size[2]) for x, y in self._layout.room.floor]
        points = project(self._camera, np.array([*low, *high]))
        points = points[np.isfinite(points).all(axis=1)]
        hull = convex_hull(points * self._scale) if len(points) > 2 else np.zeros((0, 2))
        return self._mask([hull]) if len(hull) >= 3 else np.zeros(self._pixels.shape[:2], dtype=bool)

    def _outline(self, proxy: ProxyLine) -> Floats | None:
        """Where the picture shows a proxy, in pixels of the measured copy: its own outline, moved to where it was found."""
        points = project(self._camera, box_corners(proxy.centre, proxy.size, proxy.yaw))
        if not np.isfinite(points).all():
            return None
        hull = convex_hull(points * self._scale)
        if len(hull) < 3:
            return None
        box = self._boxes.get(proxy.id)
        return hull if box is None else fitted(hull, self._corners(box))

    def _mask(self, outlines: Sequence[Floats]) -> NDArray[np.bool_]:
        image = Image.new("1", self._size)
        draw = ImageDraw.Draw(image)
        for outline in outlines:
            draw.polygon([(float(x), float(y)) for x, y in outline], fill=1)
        return np.array(image, dtype=bool)


def _ancestors(proxy: ProxyLine, layout: Layout) -> list[str]:
    """What an object stands on or hangs from, and what that does, nearest first."""
    found: list[str] = []
    parents = {p.id: p.parent for p in layout.proxies}
    at = proxy.parent
    while at is not None and at not in found:
        found.append(at)
        at = parents.get(at)
    return found


def _hides(other: ProxyLine, proxy: ProxyLine, layout: Layout) -> bool:
    """Whether something may stand between the camera, which is above, and an object; rugs hide nothing."""
    if other.id == proxy.id or other.size[2] < 0.05:
        return False
    if proxy.id in _ancestors(other, layout):
        return True
    top, other_top = (p.centre[2] + p.size[2] / 2 for p in (proxy, other))
    return other_top > top + 0.02


def light_gains(pixels: Floats) -> Floats:
    """Gains on linear red, green and blue that take the light's colour and strength out, from what is bright and grey.

    Walls, ceilings and linen are near white in most rooms. The gains are held within reason, since a room may be
    painted any colour.
    """
    light = pixels.mean(axis=1)
    spread = pixels.max(axis=1) - pixels.min(axis=1)
    grey = (spread < 0.35 * pixels.max(axis=1)) & (light < 0.985)
    if grey.sum() < 200:
        return np.ones(3)
    bright = pixels[grey][light[grey] >= np.percentile(light[grey], 80)]
    white = np.median(bright, axis=0)
    colour = np.clip(white.mean() / np.maximum(white, 1e-4), 0.8, 1.3)
    strength = float(np.clip(_WHITE / max(float(white.mean()), 1e-4), 1.0, 1.6))
    gains: Floats = colour * strength
    return gains


def as_paint(colours: Floats, gains: Floats) -> Floats:
    """Linear colours (..., 3) in neutral light, no brighter than paint is.

    What would be brighter keeps its hue: cut off colour by colour, a pale pink would turn yellow, a pale blue white. What is
    burnt out in the picture has no hue to keep.
    """
    paint = colours * gains
    peak = paint.max(axis=-1, keepdims=True)
    burnt = colours.min(axis=-1, keepdims=True) > _BURNT
    result: Floats = np.where((peak > BRIGHTEST) & ~burnt, paint * (BRIGHTEST / np.maximum(peak, 1e-6)), paint)
    return np.minimum(result, 1.0)


def dominant(pixels: Floats) -> list[MeasuredColour]:
    """Up to three colours of linear pixels (N, 3), largest share first."""
    points = _perceived(pixels)
    centres = points[np.argsort(points[:, 0])[np.linspace(0, len(points) - 1, 2 * _CLUSTERS + 1).astype(int)[1::2]]]
    nearest = np.zeros(len(points), dtype=int)
    for _ in range(12):
        nearest = ((points[:, None] - centres[None]) ** 2).sum(axis=2).argmin(axis=1)
        moved = np.array(
            [points[nearest == k].mean(axis=0) if (nearest == k).any() else centres[k] for k in range(_CLUSTERS)]
        )
        if np.abs(moved - centres).max() < 1e-3:
            break
        centres = moved
    groups = _merged(nearest, centres)
    colours = [
        (float(mask.mean()), _middle(pixels[mask]))
        for k in sorted(set(groups))
        if (mask := groups[nearest] == k).mean() > 0.06
    ]
    colours.sort(key=lambda item: -item[0])
    return [MeasuredColour(code=to_code(colour), share=round(share, 3)) for share, colour in colours]


def _merged(nearest: NDArray[np.int64], centres: Floats) -> NDArray[np.int64]:
    """Clusters of nearly one hue count as one: the darker is the lighter in shadow."""
    groups = np.arange(_CLUSTERS)
    order = np.argsort(-np.bincount(nearest, minlength=_CLUSTERS))
    for i, a in enumerate(order):
        for b in order[:i]:
            apart = np.abs(centres[a] - centres[b])
            if apart[0] < 0.17 and np.hypot(apart[1], apart[2]) < 0.035:
                groups[a] = groups[b]
                break
    return groups


def _middle(pixels: Floats) -> Floats:
    """The mean of what is neither in shadow nor glossy."""
    light = pixels.mean(axis=1)
    low, high = np.percentile(light, (30, 80))
    kept = pixels[(light >= low) & (light <= high)]
    middle: Floats = (kept if len(kept) else pixels).mean(axis=0)
    return middle


def _perceived(pixels: Floats) -> Floats:
    """Linear sRGB (N, 3) as Oklab: equal distances look equally different."""
    to_cone = np.array(((0.4122, 0.5363, 0.0514), (0.2119, 0.6807, 0.1074), (0.0883, 0.2817, 0.6300)))
    to_lab = np.array(((0.2105, 0.7936, -0.0041), (1.9780, -2.4286, 0.4506), (0.0259, 0.7828, -0.8087)))
    lab: Floats = np.cbrt(np.maximum(pixels, 0.0) @ to_cone.T) @ to_lab.T
    return lab


def colour_distance(one: str, other: str) -> float:
    """How different two colours of six sRGB digits look; black to white is 1."""
    a, b = _perceived(np.array([from_code(one), from_code(other)]))
    return float(np.linalg.norm(a - b))


def lightness(code: str) -> float:
    """How light a colour of six sRGB digits looks, 0 (black) to 1 (white)."""
    return float(_perceived(np.array([from_code(code)]))[0, 0])


def from_code(code: str) -> Floats:
    """Six sRGB digits as linear red, green and blue, 0..1."""
    return _linear(np.array([int(code[i : i + 2], 16) for i in (0, 2, 4)], dtype=np.uint8))


def to_code(colour: Floats) -> str:
    """Linear red, green and blue as six sRGB digits."""
    values = np.clip(colour, 0.0, 1.0)
    encoded = np.where(values <= 0.0031308, values * 12.92, 1.055 * values ** (1 / 2.4) - 0.055)
    return "".join(f"{round(float(v) * 255):02X}" for v in encoded)


def clean_code(text: str) -> str:
    """Six sRGB digits of what a model wrote as a colour, "" when it is none."""
    code = text.strip().lstrip("#")
    return code.upper() if len(code) == 6 and all(c in "0123456789abcdefABCDEF" for c in code) else ""


def _linear(values: NDArray[np.uint8]) -> Floats:
    scaled = values.astype(np.float64) / 255.0
    linear: Floats = np.where(scaled <= 0.04045, scaled / 12.92, ((scaled + 0.055) / 1.055) ** 2.4)
    return linear


def _small(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    image = Image.fromarray(pixels)
    image.thumbnail((LONG_SIDE, LONG_SIDE))
    return np.array(image)
