# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene without Blender, for running stages hundreds of times: it holds the layout lines of the program and no meshes.

`render` answers with a picture of the layout's boxes drawn by Pillow, farthest first, through the asked camera: places and
outlines are those that Blender would render, shading, shadows and hidden parts are not. `scene_document` is read from the
layout lines, so it says what the program asked for; that Blender builds the same is what the tests of the scene prove.
"""

from __future__ import annotations

import io
from pathlib import Path

from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import (
    DoorLine,
    Layout,
    LayoutEdit,
    OpeningLine,
    ProxyLine,
    WallLine,
    WindowLine,
)
from code_as_room.pipeline.artifacts.scene import SceneArchitecture, SceneDocument, SceneObject, SceneRoom
from code_as_room.pipeline.errors import SceneError
from code_as_room.pipeline.geometry.camera import project
from code_as_room.pipeline.geometry.footprint import box_corners
from code_as_room.pipeline.program.lines import parse_layout
from PIL import Image, ImageDraw, ImageFont

_FACES = ((0, 1, 3, 2), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5), (4, 5, 7, 6))
_LIGHT = (0.5, 0.75, 0.65, 0.7, 0.8, 1.0)
_COLOURS = ((201, 176, 148), (150, 176, 200), (178, 196, 150), (208, 160, 160), (176, 164, 204), (160, 196, 190))


class PlainBackend:
    """A `SceneBackend` that remembers the program. `shown` is what the last `render` showed, None before."""

    def __init__(self) -> None:
        self._text, self._memory = "", ""
        self._layout: Layout | None = None
        self.shown: tuple[Layout, CameraModel] | None = None

    def build(self, text: str) -> None:
        """Read the program's layout lines."""
        self._layout, self._text = parse_layout(text), text

    def render(self, camera: CameraModel, long_side: int, labels: bool) -> bytes:
        """PNG of the boxes through the camera; the walls are not drawn, the floor is."""
        layout = self._standing()
        self.shown = (layout, camera)
        width, height = camera.image_size
        scale = long_side / max(width, height)
        image = Image.new("RGB", (max(1, round(width * scale)), max(1, round(height * scale))), (64, 64, 68))
        pen = ImageDraw.Draw(image)
        _polygon(pen, image.size, project(camera, [(x, y, 0.0) for x, y in layout.room.floor]), (226, 224, 220))
        for index, proxy in enumerate(sorted(layout.proxies, key=lambda p: p.centre[2] + p.size[2] / 2)):
            _draw(pen, image.size, camera, proxy, _COLOURS[index % len(_COLOURS)], labels)
        return _png(image)

    def read_back(self) -> list[LayoutEdit]:
        """Nobody changes this scene by hand."""
        return []

    def load_memory(self) -> str:
        """The memory's text."""
        return self._memory

    def save_memory(self, text: str) -> None:
        """Keep the memory's text."""
        self._memory = text

    def program_text(self) -> str:
        """The program that was built last."""
        return self._text

    def render_view(self, long_side: int) -> bytes:
        """A grey picture: nothing is looked at from the side here."""
        return _png(Image.new("RGB", (max(1, long_side // 8), max(1, long_side // 8)), "grey"))

    def scene_document(self, image: str, camera: CameraModel) -> SceneDocument:
        """`scene.json` of what the program asks for.

        Raises:
            SceneError: nothing was built yet.
        """
        layout = self._standing()
        fittings: list[DoorLine | WindowLine | OpeningLine] = [*layout.doors, *layout.windows, *layout.openings]
        return SceneDocument(
            image=image,
            room=SceneRoom(size=layout.room.size, floor=layout.room.floor),
            camera=camera,
            architecture=[_wall(w) for w in layout.walls] + [_fitting(f) for f in fittings],
            objects=[_object(p) for p in layout.proxies],
        )

    def save_copy(self, path: Path) -> None:
        """There is no .blend of this scene.

        Raises:
            SceneError: always.
        """
        raise SceneError("A scene without Blender cannot be saved as .blend.", "Use scene.json.")

    def _standing(self) -> Layout:
        if self._layout is None:
            raise SceneError("Nothing was built yet.", "Run the layout stage first.")
        return self._layout


def _draw(
    pen: ImageDraw.ImageDraw,
    size: tuple[int, int],
    camera: CameraModel,
    proxy: ProxyLine,
    colour: tuple[int, int, int],
    label: bool,
) -> None:
    """One box, its lower and side faces before its top."""
    points = project(camera, box_corners(proxy.centre, proxy.size, proxy.yaw))
    if not bool((points == points).all()):
        return
    for face, light in zip(_FACES, _LIGHT, strict=True):
        shade = (round(colour[0] * light), round(colour[1] * light), round(colour[2] * light))
        _polygon(pen, size, points[list(face)], shade)
    if label:
        x, y = points[4:].mean(axis=0) * size / 1000.0
        font = ImageFont.load_default(size=max(10.0, max(size) / 80.0))
        pen.text((float(x), float(y)), proxy.id, fill="black", font=font, anchor="mm")


def _polygon(pen: ImageDraw.ImageDraw, size: tuple[int, int], points: object, fill: tuple[int, int, int]) -> None:
    corners = [(float(x) * size[0] / 1000.0, float(y) * size[1] / 1000.0) for x, y in points]  # type: ignore[attr-defined]
    if all(v == v for corner in corners for v in corner):
        pen.polygon(corners, fill=fill, outline=(40, 40, 40))


def _png(image: Image.Image) -> bytes:
    buffer = io.BytesIO()
    image.save(buffer, "PNG", compress_level=1)
    return buffer.getvalue()


def _wall(line: WallLine) -> SceneArchitecture:
    kind = "partition" if line.partition else "wall"
    return SceneArchitecture(id=line.id, kind=kind, start=line.start, end=line.end, height=line.height)


def _fitting(line: DoorLine | WindowLine | OpeningLine) -> SceneArchitecture:
    kind = type(line).__name__.removesuffix("Line").lower()
    sill = 0.0 if isinstance(line, DoorLine) else line.sill
    return SceneArchitecture(
        id=line.id, kind=kind, start=line.start, end=line.end, height=line.height, sill=sill, wall=line.wall
    )


def _object(line: ProxyLine) -> SceneObject:
    return SceneObject(
        id=line.id,
        category=line.category,
        label=line.label,
        centre=line.centre,
        size=line.size,
        yaw=line.yaw,
        placement=line.placement,
        parent=line.parent,
        salience=line.salience,
    )
