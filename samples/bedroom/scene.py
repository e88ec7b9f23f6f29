"""Puts the parts into Blender: objects under one empty an item, light, camera, render settings."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy
import numpy as np
import shell
import soft
from description import CAMERA_HEIGHT, IMAGE_SIZE, ITEMS, ROOM_SIZE, VIEW_HEIGHT_ON_FLOOR, WINDOW, Item
from furniture import MODELS
from materials import material, rgb
from mathutils import Matrix
from shapes import Array, Part


def add_part(part: Part, parent: bpy.types.Object | None, name: str) -> bpy.types.Object:
    """A mesh object of a part, under its parent."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(part.verts.tolist(), [], part.faces)
    mesh.materials.append(material(part.material))
    if part.uv is not None:
        index = np.empty(len(mesh.loops), int)
        mesh.loops.foreach_get("vertex_index", index)
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", part.uv[index].ravel())
    mesh.polygons.foreach_set("use_smooth", np.full(len(mesh.polygons), part.smooth))
    mesh.update()
    obj = bpy.data.objects.new(name, mesh)
    obj.parent = parent
    bpy.context.scene.collection.objects.link(obj)
    return obj


def placement_matrix(item: Item) -> Matrix:
    """Local frame to world: origin at the middle of the footprint, at the underside of the box."""
    return Matrix.Translation((item.x, item.y, item.base)) @ Matrix.Rotation(math.radians(item.yaw), 4, "Z")


def item_parts(item: Item, bed: Item) -> list[Part]:
    """The parts of an item in its local frame."""
    if item.model == "throw":  # simulated where it lies, in the bed's frame; bring it into its own
        to_own = np.array(placement_matrix(item).inverted() @ placement_matrix(bed))
        parts = soft.throw()
        for p in parts:
            p.verts = p.verts @ to_own[:3, :3].T + to_own[:3, 3]
        return parts
    return MODELS[item.model](item.size, **item.options)


def add_items() -> dict[str, bpy.types.Object]:
    """All items; returns the empty that carries each."""
    bed = next(i for i in ITEMS if i.model == "bed")
    roots = {}
    for item in ITEMS:
        root = bpy.data.objects.new(item.id, None)
        bpy.context.scene.collection.objects.link(root)
        root.matrix_world = placement_matrix(item)
        for k, part in enumerate(item_parts(item, bed)):
            add_part(part, root, f"{item.id}.{k:02d}.{part.name}")
        roots[item.id] = root
    bpy.context.view_layer.update()
    return roots


def add_shell() -> None:
    boards, tone = shell.floor_boards()
    obj = add_part(boards, None, "floor")
    obj.data.attributes.new("tone", "FLOAT", "POINT").data.foreach_set("value", tone)
    under = shell.rectangle((-2.42, -2.07, -0.006), (2.42, -2.07, -0.006), (2.42, 2.07, -0.006), "soil")
    groups: list[tuple[str, Sequence[Part]]] = [
        *shell.walls(),
        ("door", shell.door()),
        ("window", shell.window()),
        ("wall_tops", [shell.wall_tops()]),
        ("outside", shell.outside()),
        ("subfloor", [under]),
    ]
    for name, parts in groups:
        for k, part in enumerate(parts):
            add_part(part, None, f"{name}.{k:02d}")
    w, d, h = ROOM_SIZE
    lid = shell.rectangle((-w / 2, -d / 2, h), (w / 2, -d / 2, h), (w / 2, d / 2, h), "paper")
    ceiling = add_part(lid, None, "ceiling")
    ceiling.visible_camera = False  # light behaves as in a closed room, the camera looks through


def area_light(
    name: str,
    place: tuple[float, float, float],
    turn: tuple[float, float, float],
    size: tuple[float, float],
    watts: float,
    colour: str,
) -> None:
    light = bpy.data.lights.new(name, "AREA")
    light.shape, light.size, light.size_y = "RECTANGLE", *size
    light.energy, light.color = watts, rgb(colour)[:3]
    obj = bpy.data.objects.new(name, light)
    obj.location, obj.rotation_euler = place, [math.radians(t) for t in turn]
    obj.visible_camera = obj.visible_glossy = False
    bpy.context.scene.collection.objects.link(obj)


def add_light(roots: dict[str, bpy.types.Object]) -> None:
    """Daylight by the window, a soft fill from the ceiling, the lamps, and a sun that reaches the floor."""
    w, d, h = ROOM_SIZE
    x = (WINDOW.start[0] + WINDOW.end[0]) / 2
    z = WINDOW.sill + WINDOW.height / 2
    area_light("daylight", (x, d / 2 + 0.25, z + 0.1), (-72, 0, 0), (1.9, 1.7), 85.0, "#f2f5ff")
    area_light("fill", (0, 0, h - 0.02), (0, 0, 0), (w - 0.5, d - 0.5), 70.0, "#fffaf2")
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle, sun.color = 7.5, math.radians(2.5), rgb("#ffe9cc")[:3]
    obj = bpy.data.objects.new("sun", sun)
    obj.rotation_euler = (math.radians(-52), 0, math.radians(24))
    bpy.context.scene.collection.objects.link(obj)
    for name, root in roots.items():
        bulb = next((c for c in root.children if c.name.endswith(".bulb")), None)
        if bulb is None:
            continue
        light = bpy.data.lights.new(name, "POINT")
        light.energy, light.color, light.shadow_soft_size = (
            (9.0 if name == "floor_lamp" else 5.0),
            rgb("#ffc98a")[:3],
            0.035,
        )
        lamp = bpy.data.objects.new(name + ".light", light)
        corners = np.array([list(c) for c in bulb.bound_box])
        lamp.location = root.matrix_world @ Matrix.Translation(corners.mean(0)).translation
        lamp.location.z += 0.05
        bpy.context.scene.collection.objects.link(lamp)
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value, background.inputs["Strength"].default_value = rgb("#e8f0ff"), 1.0
    bpy.context.scene.world = world


def camera_fov_y() -> float:
    """Vertical field of view in radians that shows VIEW_HEIGHT_ON_FLOOR metres of floor."""
    return 2 * math.atan(VIEW_HEIGHT_ON_FLOOR / 2 / CAMERA_HEIGHT)


def add_camera() -> bpy.types.Object:
    """Over the room's centre, looking straight down, +Y up in the picture."""
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle_y = camera_fov_y()
    obj = bpy.data.objects.new("camera", data)
    obj.location = (0, 0, CAMERA_HEIGHT)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.scene.camera = obj
    bpy.context.view_layer.update()
    return obj


def set_render(samples: int, percent: int) -> None:
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = True
    scene.cycles.adaptive_threshold = 0.03
    scene.cycles.use_denoising = True
    scene.cycles.max_bounces, scene.cycles.diffuse_bounces = 8, 4
    scene.cycles.sample_clamp_indirect = 4.0
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.cycles.seed = 1
    scene.render.film_transparent = True
    scene.render.resolution_x, scene.render.resolution_y = IMAGE_SIZE
    scene.render.resolution_percentage = percent
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Medium High Contrast"
    scene.view_settings.exposure = 0.2


def local_bounds(root: bpy.types.Object) -> tuple[Array, Array]:
    """Lowest and highest corner of an item's finished meshes in its local frame, read back from Blender."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    inverse = np.array(root.matrix_world.inverted())
    points = []
    for child in root.children:
        if child.type != "MESH":
            continue
        mesh = child.evaluated_get(depsgraph).data
        v = np.empty(len(mesh.vertices) * 3)
        mesh.vertices.foreach_get("co", v)
        m = inverse @ np.array(child.matrix_world)
        points.append(v.reshape(-1, 3) @ m[:3, :3].T + m[:3, 3])
    allp = np.vstack(points)
    return allp.min(0), allp.max(0)
