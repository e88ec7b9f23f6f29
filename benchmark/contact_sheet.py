# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact sheets of the furniture library: every piece from two sides, in its typical size.

python -m benchmark.contact_sheet [--out DIR] [--group NAME] [--piece NAME ...]
"""

from __future__ import annotations

import argparse
import math
import tempfile
from pathlib import Path
from typing import Any

import bpy
from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.program.prelude.palette import category_family, role_colour
from code_as_room.pipeline.program.prelude.shape import Shape
from mathutils import Vector
from PIL import Image, ImageDraw

CELL = (340, 300)
COLUMNS = 4
VIEWS = ((-0.55, -1.0, 0.55), (0.9, 0.75, 1.1))


def shapes_of(piece: catalogue.Piece) -> list[Shape]:
    """The piece in its typical size."""
    text = catalogue.source([piece.name]) + f"\n\ndef made():\n    return {piece.name}({piece.typical!r})\n"
    return evaluate_object(text, "made")


def show(shapes: list[Shape], family: str) -> None:
    """Put the shapes into the empty scene, each with its role's colour."""
    for shape in shapes:
        mesh = bpy.data.meshes.new("piece")
        mesh.from_pydata(shape.vertices.tolist(), [], [list(f) for f in shape.faces])
        mesh.polygons.foreach_set("use_smooth", [shape.smooth] * len(mesh.polygons))
        mesh.set_sharp_from_angle(angle=math.radians(35))
        obj = bpy.data.objects.new("piece", mesh)
        obj.color = role_colour(shape.material, family)
        bpy.context.scene.collection.objects.link(obj)


def prepare() -> Any:
    """An empty scene with a camera and even light; returns the camera's object."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene: Any = bpy.context.scene
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.resolution_x, scene.render.resolution_y = CELL
    scene.world = bpy.data.worlds.new("grey")
    scene.world.color = (0.62, 0.62, 0.62)
    shading = scene.display.shading
    shading.light, shading.color_type = "STUDIO", "OBJECT"
    shading.show_cavity, shading.cavity_type, shading.show_shadows = True, "BOTH", True
    scene.view_settings.view_transform = "Standard"
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera


def draw(piece: catalogue.Piece, path: Path) -> list[Image.Image]:
    """Render the piece from its front and from behind."""
    camera = prepare()
    show(shapes_of(piece), category_family(piece.words[0]))
    width, depth, height = piece.typical
    reach = math.hypot(width, depth, height)
    pictures = []
    for view in VIEWS:
        direction = Vector(view).normalized()
        middle = Vector((0, 0, height / 2))
        camera.location = middle + direction * reach * 1.4
        camera.rotation_euler = (-direction).to_track_quat("-Z", "Y").to_euler()
        camera.data.lens, camera.data.clip_start, camera.data.clip_end = 55, reach / 50, reach * 10
        scene: Any = bpy.context.scene
        scene.render.filepath = str(path)
        bpy.ops.render.render(write_still=True)
        with Image.open(path) as image:
            pictures.append(image.convert("RGB"))
    return pictures


def sheet(pieces: list[catalogue.Piece], out: Path) -> None:
    """One picture of these pieces."""
    wide, high = 2 * CELL[0], CELL[1] + 18
    rows = math.ceil(len(pieces) / COLUMNS)
    page = Image.new("RGB", (min(COLUMNS, len(pieces)) * wide, rows * high), "white")
    pen = ImageDraw.Draw(page)
    with tempfile.TemporaryDirectory() as folder:
        for number, piece in enumerate(pieces):
            x, y = number % COLUMNS * wide, number // COLUMNS * high
            try:
                for k, picture in enumerate(draw(piece, Path(folder) / "view.png")):
                    page.paste(picture, (x + k * CELL[0], y))
                pen.text((x + 6, y + CELL[1] + 2), f"{piece.name}  {piece.typical}", fill="black")
            except Exception as error:
                pen.text((x + 6, y + 20), f"{piece.name}: {error}", fill="red")
    page.thumbnail((2000, 10_000))
    page.save(out)
    print(out)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("out/library"))
    parser.add_argument("--group")
    parser.add_argument("--piece", action="append")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    groups: dict[str, list[catalogue.Piece]] = {}
    for piece in catalogue.pieces().values():
        if (not options.group or piece.group == options.group) and (not options.piece or piece.name in options.piece):
            groups.setdefault(piece.group, []).append(piece)
    for group, found in groups.items():
        for start in range(0, len(found), 16):
            sheet(found[start : start + 16], options.out / f"{group}-{start // 16 + 1}.png")


if __name__ == "__main__":
    main()
