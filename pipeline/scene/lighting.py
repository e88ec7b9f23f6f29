# SPDX-License-Identifier: GPL-3.0-or-later
"""The `world` and `view` lines in Blender: sky, exposure, the ceiling that is seen from below only.

`room.py` carries this along, so it uses only bpy and what is carried along too.

The scene's world and its colour management are the artist's as well. What a line says is written when the line is new or
has changed; what the artist changed since stays. When the line goes, what stood before it comes back.
"""

from __future__ import annotations

import json
from typing import Any

import bpy

from ..program.prelude.enclosure import CEILING, SECTION, TOPS
from ..program.prelude.kelvin import light_colour
from ..program.prelude.record import Record
from .nodes import ensure_node_tree
from .tags import FIELD, ID, KIND, LINE

WORLD_LINE = FIELD + "world_line"  # on our world, and on the room: the line that was written last
WORLD_BEFORE = FIELD + "world_before"  # on the room: the world that the scene had before ours
VIEW_LINE = FIELD + "view_line"  # on the room: the line that was written last
VIEW_BEFORE = FIELD + "view_before"  # on the room: the colour management before it
_ONE_SIDED = "Code-as-Room One-Sided"
_FLAT = "Code-as-Room Flat"
_SECTION_TONE = (0.62, 0.60, 0.58)  # linear light; a light grey, as cut walls are drawn
_NEAREST_TRANSFORMS = ("AgX", "Filmic", "Standard")


def light_scene(scene: Any, room: Any, record: Record) -> None:
    """Give a scene the world and the view of a record, and its lights and its ceiling what only objects can say.

    Mirrors and floors would show the frameless rectangles of area lights. What a bright ceiling gives back is seen in gloss where
    the view transform takes a surface's gloss away again: without it, wood and cloth would be darker than they are. Through
    others, what is dark would be grey with it.
    """
    _apply_world(scene, room, record.worlds[0] if record.worlds else None)
    _apply_view(scene, room, record.views[0] if record.views else None)
    exposure = record.views[0]["exposure"] if record.views else 0.0
    neutral = not record.views or record.views[0]["transform"] == "Khronos PBR Neutral"
    areas = [li for li in record.lights if li["kind"] == "area"]
    glossy = {li["id"]: neutral and not (li.get("target") or li.get("parent")) for li in areas}
    for obj in list(room.all_objects):  # hiding from the mouse rebuilds what is iterated over
        if obj.get(ID) in glossy:
            obj.visible_glossy = glossy[obj[ID]]
        if obj.get(KIND) in (CEILING, SECTION, TOPS) and LINE in obj:
            _dress(obj, exposure)


# ---- objects ----


def dress_light(obj: Any) -> None:
    """A light is made to shine, not to be seen: cameras see the window and the lamp that it stands for."""
    obj.visible_camera = False


def _dress(obj: Any, exposure: float) -> None:
    """The ceiling, the section and the upper faces are there for pictures: out of the way of the mouse; no ceiling in the solid view."""
    if obj.get(KIND) == SECTION:
        for slot in obj.material_slots:
            if slot.material is not None:
                _make_flat(slot.material, exposure)
    if obj.get(KIND) == CEILING:
        if obj.display_type != "WIRE":
            obj.display_type = "WIRE"
        for slot in obj.material_slots:
            if slot.material is not None:
                make_one_sided(slot.material)
    if not obj.hide_select:
        obj.hide_select = True


def make_one_sided(material: Any) -> None:
    """Let cameras see through a material from behind, and nothing else: it still holds back light from there."""
    tree = ensure_node_tree(material)
    if any(node.name == _ONE_SIDED for node in tree.nodes):
        return
    output = next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL" and n.is_active_output), None)
    if output is None or not output.inputs["Surface"].is_linked:
        return
    front = output.inputs["Surface"].links[0].from_socket
    geometry, path, behind, clear, mix = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("NewGeometry", "LightPath", "Math", "BsdfTransparent", "MixShader")
    )
    mix.name = _ONE_SIDED
    behind.operation = "MULTIPLY"
    tree.links.new(geometry.outputs["Backfacing"], behind.inputs[0])
    tree.links.new(path.outputs["Is Camera Ray"], behind.inputs[1])
    tree.links.new(behind.outputs["Value"], mix.inputs[0])
    tree.links.new(front, mix.inputs[1])
    tree.links.new(clear.outputs["BSDF"], mix.inputs[2])
    tree.links.new(mix.outputs["Shader"], output.inputs["Surface"])
    for place, node in enumerate((geometry, path, behind, clear, mix)):
        node.location = (output.location.x - 900 + 180 * place, output.location.y - 300)


def _make_flat(material: Any, exposure: float) -> None:
    """Show a material in one tone whatever the exposure: no light comes to the inside of a wall."""
    tree = ensure_node_tree(material)
    output = next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL" and n.is_active_output), None)
    if output is None:
        return
    shine = tree.nodes.get(_FLAT)
    if shine is None:
        shine = tree.nodes.new("ShaderNodeEmission")
        shine.name, shine.location = _FLAT, (output.location.x - 200, output.location.y - 150)
        shine.inputs["Color"].default_value = (*_SECTION_TONE, 1.0)
        tree.links.new(shine.outputs["Emission"], output.inputs["Surface"])
    shine.inputs["Strength"].default_value = 2.0**-exposure


# ---- world ----


def _apply_world(scene: Any, room: Any, line: dict[str, Any] | None) -> None:
    said = _text(line)
    if str(room.get(WORLD_LINE, "")) == said:
        return
    ours = next((w for w in bpy.data.worlds if w.library is None and w.get(FIELD + "room") == room), None)
    if line is None:
        if ours is not None and scene.world == ours:
            scene.world = room.get(WORLD_BEFORE)
        for key in (WORLD_LINE, WORLD_BEFORE):
            if key in room:
                del room[key]
        if ours is not None and ours.users == 0:
            bpy.data.worlds.remove(ours)
        return
    if ours is None:
        ours = bpy.data.worlds.new("Room World")
        ours[FIELD + "room"] = room
    if scene.world != ours:
        if scene.world is not None:
            room[WORLD_BEFORE] = scene.world
        scene.world = ours
    _write_world(ours, line)
    room[WORLD_LINE] = said


def _write_world(world: Any, line: dict[str, Any]) -> None:
    """Light of one colour from everywhere; cameras see another."""
    red, green, blue = light_colour(line["color"], line["kelvin"])
    world.color = line["background"]
    tree = ensure_node_tree(world)
    tree.nodes.clear()
    path, shines, seen, mix, output = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("LightPath", "Background", "Background", "MixShader", "OutputWorld")
    )
    shines.inputs["Color"].default_value = (red, green, blue, 1.0)
    shines.inputs["Strength"].default_value = line["strength"]
    seen.inputs["Color"].default_value = (*line["background"], 1.0)
    shines.label, seen.label = "Light", "What a camera sees"
    tree.links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(shines.outputs["Background"], mix.inputs[1])
    tree.links.new(seen.outputs["Background"], mix.inputs[2])
    tree.links.new(mix.outputs["Shader"], output.inputs["Surface"])
    for place, node in enumerate((path, shines, seen, mix, output)):
        node.location = (220 * place - 600, -160 * (place == 2))


# ---- view ----


def _apply_view(scene: Any, room: Any, line: dict[str, Any] | None) -> None:
    shown = {k: line[k] for k in ("exposure", "transform", "look")} if line is not None else None
    said = _text(shown)
    if str(room.get(VIEW_LINE, "")) == said:
        return
    settings = scene.view_settings
    if shown is None:
        before = json.loads(str(room.get(VIEW_BEFORE, "{}")))
        if before:
            write_view(settings, before)
        for key in (VIEW_LINE, VIEW_BEFORE):
            if key in room:
                del room[key]
        return
    if VIEW_BEFORE not in room:
        room[VIEW_BEFORE] = _text(
            {"exposure": settings.exposure, "transform": settings.view_transform, "look": settings.look}
        )
    write_view(settings, shown)
    room[VIEW_LINE] = said


def write_view(settings: Any, line: dict[str, Any]) -> None:
    """Exposure, view transform and look; the nearest transform where this Blender's configuration lacks it."""
    settings.exposure = line["exposure"]
    for name in (line["transform"], *_NEAREST_TRANSFORMS):
        try:
            settings.view_transform = name
            break
        except TypeError:  # the configuration does not have it
            continue
    for name in (line["look"], "None"):
        try:
            settings.look = name or "None"
            break
        except TypeError:
            continue


def _text(line: dict[str, Any] | None) -> str:
    return "" if line is None else json.dumps(line, sort_keys=True)
