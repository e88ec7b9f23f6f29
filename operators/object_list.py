# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of objects: `Scene.code_as_room.objects` and which of them is the active one.

Rules:

- A row holds nothing but its id (`name`). What it shows is read from `view_state`, what is set in it goes to memory as a
  correction. So the rows cannot contradict memory, and they are rewritten only when the ids change.
- Which row is active is no data of the scene: selecting in the viewport must neither change the file nor make an undo
  step. It follows the viewport's active object, and choosing a row selects in the viewport.
"""

from __future__ import annotations

import logging
from typing import Any

import bpy
from bpy.app.handlers import persistent

from ..pipeline.artifacts.corrections import Corrections
from ..pipeline.errors import RoomError
from ..pipeline.report_objects import ObjectRow
from ..pipeline.scene.tags import ID, KIND, find_room_collection, tagged_objects
from . import view_state
from .view_state import Problem, RoomState

log = logging.getLogger(__name__)
_active: dict[int, str] = {}
_owner = object()
"""Blender's message bus keeps subscriptions by their owner."""


def row_of(item: Any) -> ObjectRow | None:
    """What an item of the list shows; None while the state was not worked out."""
    state = view_state.peek(item.id_data)
    return state.by_id.get(item.name) if state is not None else None


def correct(scene: Any, identifier: str, **said: Any) -> None:
    """Say something of one object: `include`, `locked`, `note` or `category`. Main thread only.

    Raises:
        RoomError: as `correcting.apply`, such as while a run is going on.
    """
    correct_many(scene, [identifier], **said)


def correct_many(scene: Any, identifiers: list[str], **said: Any) -> None:
    """As `correct`, for several objects in one step."""
    from . import correcting

    def change(corrections: Corrections) -> Corrections:
        for identifier in identifiers:
            correction = corrections.of(identifier).model_copy(update=said)
            corrections = corrections.having(correction)
        return corrections

    correcting.apply(scene, change)


def correct_from_row(item: Any, **said: Any) -> None:
    """As `correct`, where a property was set: Blender has nobody who could be told of an error, so the panel tells it."""
    from . import driver

    scene, row = item.id_data, row_of(item)
    # A lock is of the thing that stands in the room; all else is of what was detected.
    identifier = lock_name(row) if row is not None and "locked" in said else str(item.name)
    try:
        correct(scene, identifier, **said)
    except RoomError as error:
        driver.note_outcome(scene, "", Problem.of(error))
    except Exception as error:
        log.exception("The correction of %r failed unexpectedly", identifier)
        driver.note_outcome(scene, "", Problem.of(error))


def lock_name(row: ObjectRow) -> str:
    """The id under which an object is locked: the one that it has in the layout."""
    return row.title


def _value(name: str, otherwise: Any) -> Any:
    """A getter of a row's property."""

    def get(item: Any) -> Any:
        row = row_of(item)
        return getattr(row, name) if row is not None else otherwise

    return get


# Functions, since Blender evaluates annotations where a lambda would not find this module's names.


def _say_included(item: Any, value: Any) -> None:
    correct_from_row(item, include=bool(value))


def _say_locked(item: Any, value: Any) -> None:
    correct_from_row(item, locked=bool(value))


def _say_note(item: Any, value: Any) -> None:
    correct_from_row(item, note=" ".join(str(value).split()))


def _say_category(item: Any, value: Any) -> None:
    correct_from_row(item, category=" ".join(str(value).split()))


class CodeAsRoomObject(bpy.types.PropertyGroup):
    """One row of the list of objects; its `name` is the object's id."""

    include: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="In the Room",
        description="Switch it off to leave this object out of the room; it stays in the list",
        get=_value("included", True),
        set=_say_included,
    )
    locked: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Locked",
        description="No stage may move or change a locked object. What you edit by hand is locked by itself",
        get=_value("locked", False),
        set=_say_locked,
    )
    note: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Note",
        description="A hint for the model, sent with every question about this object, such as 'it faces the window'",
        maxlen=300,
        get=_value("note", ""),
        set=_say_note,
    )
    category: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Category",
        description="What it is, such as 'armchair'. Later stages make it accordingly",
        maxlen=60,
        get=_value("category", ""),
        set=_say_category,
    )


def get_active(settings: Any) -> int:
    """The getter of `active_object`: the row's index."""
    index: int = settings.objects.find(_active.get(settings.id_data.session_uid, ""))
    return max(0, index)


def set_active(settings: Any, index: int) -> None:
    """The setter of `active_object`: choosing a row selects its object in the viewport."""
    if 0 <= index < len(settings.objects):
        scene, identifier = settings.id_data, settings.objects[index].name
        _active[scene.session_uid] = identifier
        select(scene, [identifier])


def active_row(scene: Any) -> ObjectRow | None:
    """The row that is chosen in the list."""
    settings = scene.code_as_room
    state = view_state.peek(scene)
    if state is None or not len(settings.objects):
        return None
    return state.by_id.get(settings.objects[get_active(settings)].name)


def proxies(scene: Any) -> dict[str, Any]:
    """The proxies that stand in the scene, by id."""
    room = find_room_collection(scene)
    if room is None:
        return {}
    found = tagged_objects(room).items()
    return {name: same[0] for (name, part), same in found if not part and same[0].get(KIND) == "proxy"}


def select(scene: Any, identifiers: list[str], extend: bool = False) -> int:
    """Select the objects of these rows in the viewport, the last one active; returns how many there were.

    A row that does not stand in the room leaves nothing selected: else the row of what is active would come back.
    Nothing happens outside of Object mode, and in a scene that no window shows.
    """
    state, layer = view_state.peek(scene), _view_layer(scene)
    if state is None or layer is None or bpy.context.mode not in ("OBJECT", ""):
        return 0
    standing = proxies(scene)
    names = [state.by_id[i].name for i in identifiers if i in state.by_id]
    chosen = [standing[n] for n in names if n in standing and standing[n].name in layer.objects]
    if not extend:
        for obj in layer.objects:
            if obj.select_get(view_layer=layer):
                obj.select_set(False, view_layer=layer)
    for obj in chosen:
        obj.select_set(True, view_layer=layer)
    if chosen or not extend:
        layer.objects.active = chosen[-1] if chosen else None
    return len(chosen)


def selected_names(scene: Any) -> frozenset[str]:
    """Ids (in the layout) of the proxies that are selected in the viewport."""
    layer = _view_layer(scene)
    if layer is None:
        return frozenset()
    return frozenset(name for name, obj in proxies(scene).items() if obj.name in layer.objects and _chosen(obj, layer))


def _chosen(obj: Any, layer: Any) -> bool:
    return bool(obj.select_get(view_layer=layer))


def _view_layer(scene: Any) -> Any | None:
    """The view layer in which an artist sees this scene."""
    if bpy.context.scene == scene and bpy.context.view_layer is not None:
        return bpy.context.view_layer
    windows = bpy.context.window_manager.windows if bpy.context.window_manager else ()
    return next((window.view_layer for window in windows if window.scene == scene), None)


def follow(scene: Any) -> bool:
    """Make the row of the viewport's active object the active one; True when another one became active."""
    layer, state = _view_layer(scene), view_state.peek(scene)
    obj = layer.objects.active if layer is not None else None
    if obj is None or state is None or ID not in obj:
        return False
    row = state.by_name.get(str(obj[ID]))
    if row is None or _active.get(scene.session_uid) == row.id:
        return False
    _active[scene.session_uid] = row.id
    return True


def sync(scene: Any, state: RoomState) -> None:
    """Bring the rows up to date; called after every refresh of the state. Nothing is written when nothing changed."""
    items = scene.code_as_room.objects
    ids = [row.id for row in state.objects]
    if scene.library is None and [item.name for item in items] != ids:
        items.clear()
        for identifier in ids:
            items.add().name = identifier
    follow(scene)


def _another_is_active() -> None:
    """Blender's message: the active object of some view layer is another one."""
    from . import driver

    try:
        changed = [scene for scene in bpy.data.scenes if follow(scene)]
        if changed:
            driver.redraw()
    except Exception:
        log.exception("The list could not follow the selection")


def _subscribe() -> None:
    bpy.msgbus.clear_by_owner(_owner)
    key: Any = (bpy.types.LayerObjects, "active")
    bpy.msgbus.subscribe_rna(key=key, owner=_owner, args=(), notify=_another_is_active)


@persistent  # type: ignore[untyped-decorator]
def _after_load(*_: Any) -> None:
    """Loading a file ends subscriptions, PERSISTENT ones too (seen in Blender 5.2)."""
    _active.clear()
    _subscribe()


def register() -> None:
    """Follow the viewport, in this file and in those that are opened later."""
    view_state.listeners.append(sync)
    bpy.app.handlers.load_post.append(_after_load)
    _subscribe()


def unregister() -> None:
    """Undo `register`."""
    bpy.msgbus.clear_by_owner(_owner)
    if _after_load in bpy.app.handlers.load_post:
        bpy.app.handlers.load_post.remove(_after_load)
    if sync in view_state.listeners:
        view_state.listeners.remove(sync)
    _active.clear()


CLASSES = (CodeAsRoomObject,)
