# SPDX-License-Identifier: GPL-3.0-or-later
"""Photographs a scene with Blender: the picture, and which object every pixel shows."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from code_as_room.pipeline.geometry.camera import Projector, blender_shift
from code_as_room.pipeline.program.prelude.shape import Floats, Shape
from code_as_room.pipeline.scene.compat import quiet
from mathutils import Matrix, Vector
from PIL import Image

from .materials import linear
from .meshes import add_item
from .model import Item, Light, Look, Scene
from .shell import add_shell

_STEP = 3  # between the grey values of the objects in the picture of indices


def build(scene: Scene, things: dict[str, tuple[Item, list[Shape]]]) -> dict[str, Any]:
    """An empty Blender scene with the room in it; the items' objects by id."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    shell = add_shell(scene)
    objects = {id: add_item(item, shapes, scene.look.roles) for id, (item, shapes) in things.items()}
    for obj in shell:
        obj.color = (0, 0, 0, 1)
    for number, obj in enumerate(objects.values(), 1):
        grey = number * _STEP / 255
        obj.color = (grey, grey, grey, 1)
    if len(objects) * _STEP > 255:
        raise ValueError("Too many objects for the picture of indices.")
    for light in scene.look.lights:
        _add_light(light)
    _add_camera(scene)
    colour, strength = scene.look.sky
    world: Any = bpy.data.worlds.new("sky")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"].inputs
    background["Color"].default_value, background["Strength"].default_value = linear(colour), strength
    bpy.context.scene.world = world
    bpy.context.view_layer.update()
    return objects


def _add_light(light: Light) -> None:
    data: Any = bpy.data.lights.new(light.kind, light.kind.upper())
    data.energy, data.color = light.energy, linear(light.colour)[:3]
    if light.kind == "sun":
        data.angle = light.size
    elif light.kind == "area":
        data.size = light.size
    else:
        data.shadow_soft_size = light.size
    obj: Any = bpy.data.objects.new(light.kind, data)
    obj.location = light.at
    obj.rotation_euler = (Vector(light.towards) - Vector(light.at)).to_track_quat("-Z", "Y").to_euler()
    obj.visible_camera = obj.visible_glossy = False
    bpy.context.scene.collection.objects.link(obj)


def _add_camera(scene: Scene) -> None:
    camera = scene.camera
    data: Any = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    if camera.kind == "perspective":
        data.angle_y = camera.fov_y
    else:
        data.type, data.ortho_scale = "ORTHO", camera.ortho_height
    data.shift_x, data.shift_y = blender_shift(camera)
    data.clip_end = 200
    obj = bpy.data.objects.new("camera", data)
    obj.matrix_world = Matrix(np.array(camera.matrix).reshape(4, 4).tolist())
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.scene.camera = obj


def photograph(scene: Scene, samples: int, percent: int = 100) -> Image.Image:
    """The picture of the built scene, on paper, with what the film does to it."""
    _settings(scene, percent)
    blender: Any = bpy.context.scene
    blender.cycles.samples = samples
    blender.cycles.use_adaptive_sampling, blender.cycles.adaptive_threshold = True, 0.03
    blender.cycles.use_denoising = True
    blender.cycles.max_bounces, blender.cycles.diffuse_bounces = 8, 3
    blender.cycles.sample_clamp_indirect = 4.0
    blender.cycles.caustics_reflective = blender.cycles.caustics_refractive = False
    blender.view_settings.view_transform = "AgX"
    blender.view_settings.look = "AgX - Medium High Contrast"
    blender.view_settings.exposure = scene.look.exposure
    picture = _render()
    paper = Image.new("RGBA", picture.size, scene.look.paper)
    paper.alpha_composite(picture)
    return developed(paper.convert("RGB"), scene.look)


def developed(picture: Image.Image, look: Look) -> Image.Image:
    """The picture with darker corners, less contrast and grain (the same on every run)."""
    if not (look.vignette or look.grain or look.fade):
        return picture
    pixels = np.asarray(picture, dtype=float)
    height, width = pixels.shape[:2]
    y, x = np.mgrid[0:height, 0:width]
    away = ((2 * x / width - 1) ** 2 + (2 * y / height - 1) ** 2) / 2
    pixels = pixels * (1 - look.vignette * away**1.3)[..., None]
    pixels = pixels * (1 - 2 * look.fade) + 255 * look.fade
    if look.grain:
        pixels = pixels + np.random.default_rng(11).normal(0, look.grain, (height, width))[..., None]
    return Image.fromarray(np.clip(np.rint(pixels), 0, 255).astype(np.uint8))


def seen(scene: Scene, objects: dict[str, Any]) -> dict[str, Floats]:
    """For every object, which pixels show it (height, width), as booleans."""
    _settings(scene, 100)
    blender: Any = bpy.context.scene
    blender.cycles.samples, blender.cycles.use_denoising, blender.cycles.use_adaptive_sampling = 1, False, False
    blender.cycles.pixel_filter_type, blender.cycles.filter_width = "BOX", 0.01
    blender.cycles.max_bounces = 0
    blender.render.dither_intensity = 0.0
    blender.view_settings.view_transform, blender.view_settings.look = "Raw", "None"
    blender.view_settings.exposure = 0.0
    index: Any = bpy.data.materials.new("index")
    index.use_nodes = True
    tree = index.node_tree
    tree.nodes.clear()
    output, glow = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeEmission")
    tree.links.new(tree.nodes.new("ShaderNodeObjectInfo").outputs["Color"], glow.inputs["Color"])
    tree.links.new(glow.outputs[0], output.inputs["Surface"])
    bpy.context.view_layer.material_override = index
    try:
        grey = np.asarray(_render().convert("RGB"), dtype=int)[..., 0]
    finally:
        bpy.context.view_layer.material_override = None
    numbers = np.rint(grey / _STEP)
    return {id: numbers == number for number, id in enumerate(objects, 1)}


def _settings(scene: Scene, percent: int) -> None:
    blender: Any = bpy.context.scene
    blender.render.engine = "CYCLES"
    blender.cycles.device, blender.cycles.seed = "CPU", 1
    blender.render.film_transparent = True
    blender.render.resolution_x, blender.render.resolution_y = scene.camera.image_size
    blender.render.resolution_percentage = percent
    blender.render.image_settings.file_format = "PNG"
    blender.render.image_settings.color_mode = "RGBA"


def _render() -> Image.Image:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.png"
        blender: Any = bpy.context.scene
        blender.render.filepath = str(path)
        with quiet():
            bpy.ops.render.render(write_still=True)
        with Image.open(path) as image:
            return image.convert("RGBA")


def outline_in_picture(scene: Scene, obj: Any) -> Floats:
    """Where the camera puts an object's vertices, pixels (N, 2), as Blender has them in the scene."""
    mesh = obj.data
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    matrix = np.array(obj.matrix_world)
    world = points.reshape(-1, 3).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    return Projector.of(scene.camera).pixels(world)
