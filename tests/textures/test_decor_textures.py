# SPDX-License-Identifier: GPL-3.0-or-later
"""Rugs and pictures from the reference picture: cut along their edges, holes filled by symmetry, or refused in words."""

from __future__ import annotations

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.layout import ProxyLine
from code_as_room.pipeline.textures.decor import decor_texture
from code_as_room.pipeline.textures.pixels import Pixels, resized
from code_as_room.pipeline.textures.shown import Flat, NotUsable, Shown
from code_as_room.pipeline.textures.targets import kind_of, targets_of
from numpy.typing import NDArray

from .drawn_rooms import box, camera, layout, plain, seen_through

Array = NDArray[np.float64]
RUG = box("rug", (0.1, -0.1), (2.0, 1.4, 0.01), yaw=20, category="rug")


def bordered(u: Array, v: Array) -> Array:
    """A rug that is the same from both sides: a dark border line and a diamond on a light ground."""
    light = np.full(len(u), 0.6)
    frame = np.maximum(np.abs(u) / 1.0, np.abs(v) / 0.7)
    light[(frame > 0.78) & (frame < 0.88)] = 0.08
    light[np.abs(u) + np.abs(v) < 0.4] = 0.2
    return light[:, None] * np.array((1.0, 0.75, 0.5))


def lopsided(u: Array, v: Array) -> Array:
    return np.stack([0.3 + 0.28 * np.sin(2 * u + v), 0.3 + 0.2 * np.sin(3 * v), 0.25 + 0.2 * np.cos(2.5 * u)], axis=1)


def taken(pattern: object, *hiding: ProxyLine, placed: ProxyLine = RUG, tilt: float = 15.0) -> Flat:
    lens = camera(tilt, 8)
    picture = seen_through(lens, plain, hiding, [(RUG, pattern)])  # type: ignore[list-item]
    shown = Shown(picture, lens, layout(placed, *hiding))
    target = next(t for t in targets_of(shown.layout) if t.surface == "rug")
    return decor_texture(shown, target.face, target.kind, target.without)


def truth(pattern: object, shape: tuple[int, ...]) -> Pixels:
    rows, columns = shape[:2]
    u, v = np.meshgrid(((np.arange(columns) + 0.5) / columns - 0.5) * 2.0, (0.5 - (np.arange(rows) + 0.5) / rows) * 1.4)
    return pattern(u.ravel(), v.ravel()).reshape(rows, columns, 3).astype(np.float32)  # type: ignore[operator,no-any-return]


def likeness(found: Pixels, true: Pixels) -> float:
    small = (64, 45)
    a, b = resized(found, small).ravel(), resized(true, small).ravel()
    return float(np.corrcoef(a, b)[0, 1])


def test_a_rug_comes_back_straight_and_whole() -> None:
    flat = taken(lopsided)
    assert flat.pixels.shape[1] / flat.pixels.shape[0] == pytest.approx(2.0 / 1.4, rel=0.04)
    assert likeness(flat.pixels, truth(lopsided, flat.pixels.shape)) > 0.95


def test_what_hides_a_symmetric_rug_is_replaced_by_its_other_side() -> None:
    table = box("table", (0.7, 0.3), (0.7, 0.6, 0.5))
    flat = taken(bordered, table)
    assert flat.quality.filled > 0.1
    assert likeness(flat.pixels, truth(bordered, flat.pixels.shape)) > 0.9
    # No trace of the magenta table.
    assert not ((flat.pixels[..., 2] > 0.3) & (flat.pixels[..., 1] < 0.1)).any()


@pytest.mark.parametrize("away", ((0.0, 0.0), (0.06, -0.04), (-0.05, 0.05)))
def test_a_rug_that_was_placed_a_little_wrong_is_cut_at_its_own_edges(away: tuple[float, float]) -> None:
    wrong = RUG.model_copy(update={"centre": (RUG.centre[0] + away[0], RUG.centre[1] + away[1], RUG.centre[2])})
    flat = taken(bordered, placed=wrong)
    assert likeness(flat.pixels, truth(bordered, flat.pixels.shape)) > 0.88
    # The floor is blue: none of it lies along the edges.
    rim = np.concatenate([flat.pixels[:, 0], flat.pixels[:, -1], flat.pixels[0], flat.pixels[-1]])
    ground = np.abs(rim / rim.sum(axis=1, keepdims=True) - np.array((0.28, 0.32, 0.4))).max(axis=1) < 0.02
    assert ground.mean() < 0.1


@pytest.mark.parametrize(
    ("pattern", "hiding", "words"),
    [
        (lopsided, box("sofa", (0.1, -0.1), (2.0, 1.3, 0.5), 20), "hide"),
        (plain, None, "one colour"),
    ],
)
def test_what_cannot_be_used_says_why(pattern: object, hiding: ProxyLine | None, words: str) -> None:
    with pytest.raises(NotUsable, match=words):
        taken(pattern, *([hiding] if hiding else []))


def test_a_picture_seen_too_flat_is_refused() -> None:
    lens = camera(1.5)
    frame = box("frame", (0, 1.88), (0.8, 0.03, 0.6), category="framed picture", placement="wall")
    shown = Shown(seen_through(lens, plain), lens, layout(frame))
    target = next(t for t in targets_of(shown.layout) if t.surface == "frame")
    with pytest.raises(NotUsable, match="too small or too flat"):
        decor_texture(shown, target.face, target.kind, target.without)


@pytest.mark.parametrize(
    ("category", "placement", "size", "kind"),
    [
        ("area rug", "floor", (2, 1.5, 0.01), "rug"),
        ("rugs", "floor", (2, 1.5, 0.01), "rug"),
        ("framed pictures", "wall", (0.8, 0.03, 0.6), "picture"),
        ("throw blanket", "surface", (1.5, 0.6, 0.1), "cloth"),
        ("wall mirror", "wall", (0.8, 0.03, 0.6), None),
        ("framed mirror", "wall", (0.8, 0.03, 0.6), None),
        ("picture shelf", "wall", (0.8, 0.1, 0.1), None),
        ("tv stand", "floor", (1.5, 0.4, 0.5), None),
        ("wall clock", "wall", (0.3, 0.03, 0.3), None),
    ],
)
def test_mirrors_and_furniture_never_become_posters(
    category: str, placement: str, size: tuple[float, float, float], kind: str | None
) -> None:
    assert kind_of(box("it", (0, 0), size, category=category, placement=placement)) == kind
