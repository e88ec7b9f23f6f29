# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist does with the geometry of one object: shown as a box, its function edited, modelled again."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
from window import PAUSE, call, check, first_proxy, object_of, part, results, shoot, statuses, until_idle

CATEGORY = "desk"
"""Something that nothing else in the room shares its function with."""
_DIGEST = "code_as_room_digest"


def model_one_object() -> Iterator[float]:
    """Every step on one object alone: the others keep meshes and places, and each step is undone and done again."""
    name = first_proxy(CATEGORY)["code_as_room_id"]
    _select(name)
    yield PAUSE
    yield from _boxes(name)
    yield from _edited(name)
    yield from _again(name)
    windows = bpy.context.window_manager.windows
    if len(windows) > 1:
        with bpy.context.temp_override(window=windows[-1]):
            bpy.ops.wm.window_close()
    yield PAUSE


def _boxes(name: str) -> Iterator[float]:
    before = _meshes()
    call(bpy.ops.code_as_room.show_boxes, "INVOKE_DEFAULT", True, boxes=True)
    yield PAUSE
    boxed = _meshes()
    check("one object is shown as a box", not object_of(name)["code_as_room_furnished"])
    check("and no other", boxed[name] != before[name] and _others(boxed, name) == _others(before, name))
    shoot("6_box")
    call(bpy.ops.ed.undo)
    yield PAUSE
    results["numbers"]["what else became a box"] = [k for k in before if k != name and boxed.get(k) != before[k]]
    check("undo shows its geometry again", _meshes() == before)
    call(bpy.ops.ed.redo)
    yield PAUSE
    check("redo shows the box again", _meshes() == boxed)
    _select(name)
    call(bpy.ops.code_as_room.show_boxes, "INVOKE_DEFAULT", True, boxes=False)
    yield PAUSE
    check("the button shows its geometry again", _meshes() == before)
    check("no stage became stale by that", set(statuses()) == {"done"})


def _edited(name: str) -> Iterator[float]:
    """One more line in its function makes it half as high."""
    before, height = _meshes(), _height(name)
    _select(name)
    call(bpy.ops.code_as_room.edit_function)
    yield PAUSE
    text = part("operators.rooms").room_text(bpy.context.scene, "PROGRAM")
    line = text.current_line.body
    check("the text is shown at the object's function", line.startswith("def ") and "(size)" in line)
    check("a text editor shows it", any(a.spaces.active.text == text for a in _areas("TEXT_EDITOR")))
    shoot("6_function")
    lines = text.as_string().split("\n")
    at = next(i for i, found in enumerate(lines) if found == line)
    lines.insert(at + 1, "    size = (size[0], size[1], size[2] / 2)")
    text.from_string("\n".join(lines))
    call(bpy.ops.code_as_room.apply_program, "INVOKE_DEFAULT", True)
    yield PAUSE
    edited = _meshes()
    check("an edited function changes its object", abs(_height(name) - height / 2) < 0.02 * height)
    check("and nothing else", _others(edited, name) == _others(before, name))
    call(bpy.ops.ed.undo)
    yield PAUSE
    check("undo takes the edited function's geometry back", _meshes() == before)
    call(bpy.ops.ed.redo)
    yield PAUSE
    check("redo brings it back", _meshes() == edited)


def _again(name: str) -> Iterator[float]:
    """Nothing was recorded for a question about one object alone, so the library's piece comes."""
    before, places = _meshes(), _places()
    _select(name)
    call(bpy.ops.code_as_room.detail_again, "INVOKE_DEFAULT")
    yield from until_idle(400.0)
    yield PAUSE
    outcome = part("operators.driver").outcome_of(bpy.context.scene)
    results["numbers"]["outcome of detailing again"] = repr(outcome)
    again = _meshes()
    check("one object is modelled again", again[name] != before[name] and object_of(name)["code_as_room_furnished"])
    check("all others stay as they are", _others(again, name) == _others(before, name))
    check("every object stays where it is", _places() == places)
    results["numbers"]["what else is modelled otherwise"] = [
        k for k in before if k != name and again.get(k) != before[k]
    ]
    results["numbers"]["what moved, m"] = {
        k: [round(a[3] - b[3], 4) for a, b in zip(_places()[k], places[k], strict=True)]
        for k in places
        if _places().get(k) != places[k]
    }
    shoot("6_again")
    call(bpy.ops.ed.undo)
    yield PAUSE
    check("undo brings the artist's own function back", _meshes() == before)
    call(bpy.ops.ed.redo)
    yield PAUSE
    check("redo takes the new model", _meshes() == again)


def _select(name: str) -> None:
    for obj in bpy.context.scene.objects:
        obj.select_set(obj.get("code_as_room_id") == name and "code_as_room_part" not in obj)
    bpy.context.view_layer.objects.active = object_of(name)


def _proxies() -> list[Any]:
    return [o for o in bpy.context.scene.objects if o.get("code_as_room_kind") == "proxy"]


def _meshes() -> dict[str, str]:
    """What each object's mesh was made from, and how many vertices it has."""
    return {o["code_as_room_id"]: f"{o.data.get(_DIGEST)} {len(o.data.vertices)}" for o in _proxies()}


def _places() -> dict[str, Any]:
    return {o["code_as_room_id"]: tuple(map(tuple, o.matrix_world)) for o in _proxies()}


def _others(found: dict[str, str], name: str) -> dict[str, str]:
    return {key: value for key, value in found.items() if key != name}


def _height(name: str) -> float:
    return max(v.co.z for v in object_of(name).data.vertices)


def _areas(kind: str) -> list[Any]:
    return [a for w in bpy.context.window_manager.windows for a in w.screen.areas if a.type == kind]
