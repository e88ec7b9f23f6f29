# SPDX-License-Identifier: GPL-3.0-or-later
"""Our materials without their patterns, for exports that know no nodes (glTF, USD).

Exporters read the sockets of the Principled shader. What a pattern is linked to then is the constant that the socket holds;
a picture that is the colour stays, and where it lies is written into UVs, since few programs follow nodes that move it.
Everything is put back when the block ends, however it ends.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .tags import COLOUR

Floats = NDArray[np.float64]
Places = Callable[[Floats, Floats], Floats]
"""Where a picture lies: UVs (N, 2) and places in the object's own space (N, 3) to the picture's UVs."""
_SHOWN = ("Base Color", "Emission Color")
_CLEAR = 0.75
"""How much of what is behind thin glass is seen where only opacity can say so."""


@contextlib.contextmanager
def plain_materials(clear_as_opacity: bool = False) -> Iterator[None]:
    """Our materials as plain Principled shaders inside the `with` block.

    Args:
        clear_as_opacity: glass is told by its opacity, for formats that know no transmission (USD's preview surface).
    """
    with contextlib.ExitStack() as undo:
        laid: dict[int, Places] = {}
        ours: list[Any] = list(bpy.data.materials)
        for material in ours:
            if COLOUR not in material or material.library is not None or material.node_tree is None:
                continue
            shader = next((n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED"), None)
            if shader is None:
                continue
            _shader_alone(undo, material.node_tree, shader)
            image = _unlink_patterns(undo, material.node_tree, shader)
            places = _take_places(undo, material.node_tree, image) if image is not None else None
            if places is not None:
                laid[material.session_uid] = places
            if clear_as_opacity:
                _opacity(undo, shader)
        _lay_pictures(undo, laid)
        yield


def _shader_alone(undo: contextlib.ExitStack, tree: Any, shader: Any) -> None:
    """The shader goes straight to the output: what is mixed with it (thin glass, one-sidedness) exporters cannot say."""
    output = next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL" and n.is_active_output), None)
    if output is None or not output.inputs["Surface"].is_linked:
        return
    former = output.inputs["Surface"].links[0].from_socket
    if former.node != shader:
        undo.callback(tree.links.new, former, output.inputs["Surface"])
        tree.links.new(shader.outputs["BSDF"], output.inputs["Surface"])


def _unlink_patterns(undo: contextlib.ExitStack, tree: Any, shader: Any) -> Any:
    """Take away all that is linked to a shader but a picture that is its colour; returns that picture's node."""
    image = None
    for link in [link for link in tree.links if link.to_node == shader]:
        source = link.from_node
        shown = source.type == "TEX_IMAGE" and source.image is not None and link.to_socket.name in _SHOWN
        if shown and (image is None or image == source):
            image = source
            continue
        _set_mean(undo, source, link.to_socket)
        undo.callback(tree.links.new, link.from_socket, link.to_socket)
        tree.links.remove(link)
    return image


def _set_mean(undo: contextlib.ExitStack, source: Any, target: Any) -> None:
    """Let a number's socket hold the middle of the range that its pattern had; colours hold their look's mean already."""
    if source.type != "MAP_RANGE" or target.type != "VALUE":
        return
    ends = [source.inputs[name] for name in ("To Min", "To Max")]
    if not any(end.is_linked for end in ends):
        _set(undo, target, (ends[0].default_value + ends[1].default_value) / 2)


def _set(undo: contextlib.ExitStack, target: Any, value: float) -> None:
    undo.callback(setattr, target, "default_value", target.default_value)
    target.default_value = value


def _opacity(undo: contextlib.ExitStack, shader: Any) -> None:
    clear, alpha = shader.inputs.get("Transmission Weight"), shader.inputs.get("Alpha")
    if clear is not None and alpha is not None and clear.default_value > 0:
        _set(undo, alpha, alpha.default_value * (1 - _CLEAR * clear.default_value))


def _take_places(undo: contextlib.ExitStack, tree: Any, image: Any) -> Places | None:
    """Where a picture lies, taken off its nodes; None where it lies on the mesh's UVs as they are."""
    link = next((link for link in tree.links if link.to_node == image and link.to_socket.name == "Vector"), None)
    moves: list[Floats] = []
    at = link
    while at is not None and at.from_node.type == "MAPPING":
        node = at.from_node
        moves.insert(0, _matrix(node))
        at = next((other for other in tree.links if other.to_node == node and other.to_socket.name == "Vector"), None)
    if link is None or at is None or at.from_node.type != "TEX_COORD":
        return None
    on_uvs = at.from_socket.name == "UV"
    undo.callback(tree.links.new, link.from_socket, link.to_socket)
    tree.links.remove(link)
    return None if on_uvs and not moves else _placing(on_uvs, moves)


def _matrix(node: Any) -> Floats:
    """What a Mapping node does to a point, 4 x 4."""
    from mathutils import Matrix

    shift, turn, scale = (node.inputs[name].default_value for name in ("Location", "Rotation", "Scale"))
    return np.array(Matrix.LocRotScale(shift, turn.to_quaternion(), scale), dtype=float)


def _placing(on_uvs: bool, moves: list[Floats]) -> Places:
    def places(uvs: Floats, points: Floats) -> Floats:
        found = np.ones((len(points), 4))
        found[:, 2] = 0.0
        found[:, : 2 if on_uvs else 3] = uvs if on_uvs else points
        for move in moves:
            found = found @ move.T
        return found[:, :2]

    return places


def _lay_pictures(undo: contextlib.ExitStack, laid: dict[int, Places]) -> None:
    """Let objects use copies of their meshes whose UVs say where pictures lie. The originals are not written to."""
    for mesh in list(bpy.data.meshes) if laid else ():
        found = [
            (i, laid[m.session_uid]) for i, m in enumerate(mesh.materials) if m is not None and m.session_uid in laid
        ]
        users = [obj for obj in bpy.data.objects if obj.data == mesh and obj.library is None]
        if found and users and mesh.library is None:
            _exchange(undo, mesh, users, found)


def _exchange(undo: contextlib.ExitStack, mesh: Any, users: list[Any], laid: list[tuple[int, Places]]) -> None:
    name = mesh.name
    copy = mesh.copy()
    undo.callback(_rename, mesh, name)
    undo.callback(bpy.data.meshes.remove, copy)
    _write_uvs(copy, laid)
    mesh.name = f"{name} (kept)"
    copy.name = name
    for obj in users:
        undo.callback(setattr, obj, "data", mesh)
        obj.data = copy


def _rename(data: Any, name: str) -> None:
    data.name = name


def _write_uvs(mesh: Any, laid: list[tuple[int, Places]]) -> None:
    """The UVs of the faces with these slots as their pictures lie."""
    if not len(mesh.polygons):
        return
    layer = mesh.uv_layers.active or mesh.uv_layers.new(name="UVMap")
    uvs = np.empty(2 * len(mesh.loops), dtype=np.float32)
    layer.uv.foreach_get("vector", uvs)
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    slots, counts = (np.empty(len(mesh.polygons), dtype=np.int32) for _ in range(2))
    mesh.polygons.foreach_get("material_index", slots)
    mesh.polygons.foreach_get("loop_total", counts)
    slot, pairs, at = np.repeat(slots, counts), uvs.reshape(-1, 2), points.reshape(-1, 3)[corners]
    for index, places in laid:
        chosen = slot == index
        pairs[chosen] = places(pairs[chosen].astype(float), at[chosen].astype(float))
    # Through `layer.uv`, 4.5 and 5.0 write into the arrays that a copy shares with its original.
    mesh.attributes[layer.name].data.foreach_set("vector", pairs.ravel())
