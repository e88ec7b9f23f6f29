# SPDX-License-Identifier: GPL-3.0-or-later
"""A finished room through its reference camera, three times over the same pixels: as it is displayed, in base colours
alone, and which object is where."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from code_as_room.pipeline.program.prelude.enclosure import CEILING
from code_as_room.pipeline.scene.compat import quiet
from code_as_room.pipeline.scene.nodes import ensure_node_tree
from code_as_room.pipeline.scene.shoot import shooting
from code_as_room.pipeline.scene.tags import ID, KIND, find_room_collection
from numpy.typing import NDArray
from PIL import Image

CAMERA = "reference"
SAMPLES = 64
_BASE_SAMPLES = 8
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Seen:
    """One room, (height, width) pixels, first row at the top.

    Attributes:
        numbers: of the object that each pixel shows, 0 for none. ids: of the numbers 1, 2, ...; kinds: what they are
            ("proxy", "floor", "wall", ...).
        base: linear base colours (height, width, 3), without any light.
        shown: linear light of the displayed render (height, width, 3): exposure, view transform and all.
    """

    numbers: NDArray[np.int64]
    ids: tuple[str, ...]
    kinds: tuple[str, ...]
    base: Floats
    shown: Floats

    def mask(self, identifier: str) -> NDArray[np.bool_]:
        """Where an object is seen."""
        numbers = [n for n, name in enumerate(self.ids, 1) if name == identifier]
        found: NDArray[np.bool_] = np.isin(self.numbers, numbers)
        return found


def see(blend: Path, long_side: int = 512, samples: int = SAMPLES) -> Seen:
    """Render a room's .blend; what is open in this process is lost.

    Raises:
        ValueError: there is no room with a reference camera in it.
    """
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    scene: Any = next((s for s in bpy.data.scenes if find_room_collection(s) is not None), None)
    if scene is None:
        raise ValueError("there is no room in it")
    objects = [o for o in scene.objects if ID in o and o.type == "MESH"]
    for number, obj in enumerate(objects, 1):
        obj.pass_index = number
    with tempfile.TemporaryDirectory() as folder, shooting(scene, CAMERA, long_side, "CYCLES") as stage:
        stage.cycles.samples = samples  # at most: where nothing changes any more, Cycles stops earlier
        stage.cycles.time_limit = 0.0  # a measure takes as long as it takes
        shown = _displayed(stage, Path(folder) / "shown.png")
        for obj in [o for o in stage.collection.objects if o.get(KIND) == CEILING]:
            stage.collection.objects.unlink(obj)  # it is seen through only by the shader that is replaced now
        sources = [_Alone(m) for m in bpy.data.materials]
        _flatly(stage, _BASE_SAMPLES)
        base = _values(stage, Path(folder) / "base.exr")
        for source in sources:
            source.number()
        _flatly(stage, 1)
        numbers = np.rint(_values(stage, Path(folder) / "ids.exr")[..., 0]).astype(np.int64)
    ids, kinds = tuple(str(o[ID]) for o in objects), tuple(str(o.get(KIND, "")) for o in objects)
    return Seen(numbers, ids, kinds, base, shown)


def _displayed(stage: Any, path: Path) -> Floats:
    stage.render.filepath = str(path)
    with quiet():
        bpy.ops.render.render(write_still=True, scene=stage.name)
    values = np.asarray(Image.open(path).convert("RGB"), dtype=float) / 255
    found: Floats = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    return found


class _Alone:
    """A material that shines in its base colour and does nothing else."""

    def __init__(self, material: Any) -> None:
        self.tree = tree = ensure_node_tree(material)
        shader = next((n for n in tree.nodes if n.type == "BSDF_PRINCIPLED"), None)
        output = next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL" and n.is_active_output), None)
        output = output or tree.nodes.new("ShaderNodeOutputMaterial")
        self.shine = tree.nodes.new("ShaderNodeEmission")
        colour = shader.inputs["Base Color"] if shader is not None else None
        if colour is not None and colour.is_linked:
            tree.links.new(colour.links[0].from_socket, self.shine.inputs["Color"])
        else:
            self.shine.inputs["Color"].default_value = (
                material.diffuse_color if colour is None else colour.default_value
            )
        tree.links.new(self.shine.outputs["Emission"], output.inputs["Surface"])

    def number(self) -> None:
        """From now on it shines with its object's number."""
        info = self.tree.nodes.new("ShaderNodeObjectInfo")
        for link in [k for k in self.tree.links if k.to_socket == self.shine.inputs["Color"]]:
            self.tree.links.remove(link)
        self.shine.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        self.tree.links.new(info.outputs["Object Index"], self.shine.inputs["Strength"])


def _flatly(stage: Any, samples: int) -> None:
    """No light that bounces; with one sample each pixel shows one surface alone."""
    cycles = stage.cycles
    cycles.samples, cycles.max_bounces, cycles.use_denoising = samples, 0, False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    if samples == 1:
        cycles.pixel_filter_type = "BOX"
        cycles.filter_width = 0.01
    stage.world = None
    stage.render.use_persistent_data = False


def _values(stage: Any, path: Path) -> Floats:
    """A render as plain numbers."""
    settings = stage.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    stage.render.filepath = str(path)
    with quiet():
        bpy.ops.render.render(write_still=True, scene=stage.name)
    image: Any = bpy.data.images.load(str(path))
    width, height = image.size
    values = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    found: Floats = values.reshape(height, width, -1)[::-1, :, :3].astype(float)
    return found
