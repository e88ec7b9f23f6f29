# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms drawn for these tests: a known pattern on the floor, seen through a known camera, with boxes on it."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence

import numpy as np
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine, RoomLine
from code_as_room.pipeline.geometry.camera import Projector, camera_from, tilt_rotation
from code_as_room.pipeline.geometry.footprint import box_corners
from code_as_room.pipeline.objects.colours import convex_hull
from code_as_room.pipeline.picture import ReferencePicture, read_picture
from code_as_room.pipeline.textures.pixels import to_bytes
from numpy.typing import NDArray
from PIL import Image, ImageDraw

Pattern = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]
SIZE = (720, 640)
FLOOR = [(-2.2, -1.9), (2.2, -1.9), (2.2, 1.9), (-2.2, 1.9)]
FOREIGN = (255, 0, 255)


def camera(tilt_x: float = 0.0, tilt_y: float = 0.0, perspective: bool = True, roll: float = 0.0) -> CameraModel:
    """A camera that sees the whole floor from 9 m away, tilted by degrees."""
    rotation = tilt_rotation(tilt_x, tilt_y, roll)
    eye = rotation[:, 2] * 9.0
    return camera_from("perspective" if perspective else "orthographic", eye.tolist(), rotation,
                       1150.0 if perspective else 128.0, SIZE)  # fmt: skip


def box(
    name: str, at: tuple[float, float], size: tuple[float, float, float], yaw: float = 0.0, **more: object
) -> ProxyLine:
    values = {"id": name, "category": "cabinet", "centre": (*at, size[2] / 2), "size": size, "yaw": yaw, **more}
    return ProxyLine.model_validate(values)


def layout(*proxies: ProxyLine) -> Layout:
    return Layout(room=RoomLine(size=(4.4, 3.8, 2.5), floor=FLOOR), proxies=list(proxies))


def seen_through(
    lens: CameraModel,
    floor: Pattern,
    hiding: Sequence[ProxyLine] = (),
    decals: Sequence[tuple[ProxyLine, Pattern]] = (),
    noise: float = 0.004,
) -> ReferencePicture:
    """The picture: the floor's pattern (linear colours of x, y), flat things with their own (of their own x, y), and boxes."""
    projector = Projector.of(lens)
    fine = 2
    columns, rows = np.meshgrid(np.arange(SIZE[0] * fine), np.arange(SIZE[1] * fine))
    pixels = np.stack([columns.ravel(), rows.ravel()], axis=1) / fine + 0.5 / fine
    points = projector.on_plane(pixels, 0.0)
    x, y = points[:, 0], points[:, 1]
    colours = floor(x, y)
    outside = ~((np.abs(x) < 2.2) & (np.abs(y) < 1.9))
    colours[outside] = 0.8
    for thing, pattern in decals:
        angle = np.radians(thing.yaw)
        dx, dy = x - thing.centre[0], y - thing.centre[1]
        u, v = dx * np.cos(angle) + dy * np.sin(angle), -dx * np.sin(angle) + dy * np.cos(angle)
        on = (np.abs(u) < thing.size[0] / 2) & (np.abs(v) < thing.size[1] / 2)
        colours[on] = pattern(u, v)[on]
    image = colours.reshape(SIZE[1], fine, SIZE[0], fine, 3).mean(axis=(1, 3))
    image = image + np.random.default_rng(4).normal(0, noise, image.shape)
    drawn = Image.fromarray(to_bytes(image.astype(np.float32)))
    draw = ImageDraw.Draw(drawn)
    for thing in hiding:
        hull = convex_hull(projector.pixels(box_corners(thing.centre, thing.size, thing.yaw)))
        draw.polygon([(float(a), float(b)) for a, b in hull], fill=FOREIGN)
    buffer = io.BytesIO()
    drawn.save(buffer, "PNG")
    return read_picture(buffer.getvalue(), "room.png")


def waves(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Smooth and nowhere the same: what comes back in the wrong place or size is wrong everywhere."""
    red = 0.4 + 0.25 * np.sin(3.1 * x + 0.7 * y)
    green = 0.4 + 0.25 * np.sin(2.3 * y - 1.1 * x + 1.0)
    blue = 0.4 + 0.2 * np.sin(1.7 * x + 2.9 * y + 2.0)
    return np.stack([red, green, blue], axis=1)


def planks(width: float, turn: float = 0.0) -> Pattern:
    """Boards of random tones along a direction (degrees counter-clockwise from +X), with dark joints and ends."""

    def pattern(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        angle = np.radians(turn)
        along, across = x * np.cos(angle) + y * np.sin(angle), -x * np.sin(angle) + y * np.cos(angle)
        row = np.floor(across / width).astype(int)
        start = np.random.default_rng(1).random(4000)[row % 4000]
        board = np.floor(along / 1.1 + start * 7).astype(int)
        tone = np.random.default_rng(2).random(4000)[(row * 37 + board * 11) % 4000]
        grain = np.sin(across * 160 + 2 * np.sin(along * 3 + tone * 40)) * 0.03
        light = 0.30 + 0.12 * tone + grain
        joint = (np.abs((across / width) % 1.0 - 0.5) > 0.5 - 0.006 / width) | (
            np.abs((along / 1.1 + start * 7) % 1.0 - 0.5) > 0.496
        )
        light = np.where(joint, 0.10, light)
        return light[:, None] * np.array((1.25, 1.0, 0.7))

    return pattern


def chequers(side: float) -> Pattern:
    def pattern(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        dark = (np.floor(x / side) + np.floor(y / side)) % 2 == 0
        return np.where(dark, 0.12, 0.5)[:, None] * np.array((1.0, 0.9, 0.8))

    return pattern


def plain(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """A carpet of one colour in light that falls off to one side."""
    return (0.35 + 0.05 * x)[:, None] * np.array((0.7, 0.8, 1.0))
