# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene keeps for the artist: `Scene.code_as_room`. Everything that stages write is in memory, not here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.stages.s10_finish import CORRECTIONS_OFF
from . import fault_kinds, object_list, view_state, ways


def _background_changed(settings: Any, context: Any) -> None:
    """The camera's background image follows the sliders."""
    from . import fitted_view

    fitted_view.show_background(settings.id_data)


def _overlay_changed(settings: Any, context: Any) -> None:
    """Handles and boxes come and go."""
    from .overlay import shown

    shown.redraw()


def _changed(settings: Any, context: Any) -> None:
    """Settings are inputs of every stage, so what the panel says of the stages may change with them."""
    view_state.refresh(settings.id_data)


def _size_changed(settings: Any, context: Any) -> None:
    """A size that the artist knows: what stands follows at once, and nothing is asked again."""
    from . import correcting, driver

    scene = settings.id_data
    try:
        correcting.follow_settings(scene)
    except RoomError as error:
        view_state.refresh(scene)
        if view_state.has_something(scene):
            driver.note_outcome(scene, "", view_state.Problem.of(error))


def _width_switched(settings: Any, context: Any) -> None:
    """A width that was never given begins with the one that was found, so that a tick alone changes nothing."""
    _begin_with_present(settings, "use_known_width", "known_width", 0)
    _size_changed(settings, context)


def _height_switched(settings: Any, context: Any) -> None:
    """As `_width_switched`, for the height of the walls."""
    _begin_with_present(settings, "use_wall_height", "wall_height", 2)
    _size_changed(settings, context)


def _begin_with_present(settings: Any, switch: str, value: str, axis: int) -> None:
    state = view_state.peek(settings.id_data)
    if getattr(settings, switch) and not settings.is_property_set(value) and state is not None and state.room_size:
        setattr(settings, value, state.room_size[axis])


def _get_way(settings: Any) -> int:
    state = view_state.peek(settings.id_data)
    return WAYS.index("DRAFT" if state is not None and state.way == "draft" else "STAGES")


def _set_way(settings: Any, value: int) -> None:
    ways.choose("draft" if WAYS[value] == "DRAFT" else "stages")
    view_state.refresh_all()


WAYS = ("DRAFT", "STAGES")


class CodeAsRoomSettings(bpy.types.PropertyGroup):
    """The reference image and the numbers that the artist knows."""

    picture: bpy.props.PointerProperty(  # type: ignore[valid-type]
        name="Reference image",
        description="The picture of the room, kept inside the .blend file",
        type=bpy.types.Image,
    )
    picture_name: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Picture", description="File name of the reference image"
    )
    reference_opacity: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Opacity",
        description="How much of the picture is seen when looking through its camera",
        subtype="FACTOR",
        default=0.5,
        min=0.0,
        max=1.0,
        update=_background_changed,
    )
    reference_in_front: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="In Front",
        description="Draw the picture over the layout instead of behind it",
        default=True,
        update=_background_changed,
    )
    show_corners: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Show Corners",
        description="Show the floor's corners when looking through the fitted camera: drag a corner to where the picture "
        "shows it and the camera is fitted anew. Drag at the plus on an edge to add a corner, Ctrl-click one to remove it",
        default=True,
        update=_overlay_changed,
    )
    show_boxes: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Show Boxes",
        description="Show the objects' boxes when looking through the fitted camera: blue is detected, green placed, "
        "yellow put off, red dropped, grey left out. Click a name to make its object active, drag its box to correct it",
        default=False,
        update=_overlay_changed,
    )
    use_known_width: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Known width",
        description="You know the room's inner width, left to right in the picture; every size follows from it",
        update=_width_switched,
    )
    known_width: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Known width",
        description="The room's inner width, left to right in the picture",
        subtype="DISTANCE",
        unit="LENGTH",
        default=4.0,
        min=0.5,
        max=100.0,
        precision=3,
        update=_size_changed,
    )
    use_wall_height: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Wall height", description="You know how high the walls are", update=_height_switched
    )
    wall_height: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Wall height",
        description="Height of the walls from floor to ceiling",
        subtype="DISTANCE",
        unit="LENGTH",
        default=2.6,
        min=1.0,
        max=20.0,
        precision=3,
        update=_size_changed,
    )
    way: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="How",
        description="How the room is made; remembered for each provider",
        items=(
            ("DRAFT", "Draft", "The model writes the whole room in one answer, which grows while it is written; "
             "then refine what needs it. For strong models", 0),
            ("STAGES", "Stages", "One step after the other, each with questions of its own: see and decide at every step. "
             "For weaker models too", 1),
        ),
        get=_get_way,
        set=_set_way,
        options={"SKIP_SAVE"},
    )  # fmt: skip
    notes: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Notes",
        description="A hint for the model, such as 'the bed is 1.4 m wide'. The built-in analysis cannot read it",
        maxlen=1000,
        update=_changed,
    )
    iterations: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Rounds",
        description="Most rounds of revising the layout; each may cost one question to the model",
        default=5,
        min=1,
        max=5,
        update=_changed,
    )
    modelling: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Modelling",
        description="How objects get their geometry. A change counts from the next run of the stage Geometry on",
        items=(
            ("AUTO", "By Model", "Strong models write programs, small and local ones choose from the library", 0),
            ("PROGRAMS", "Programs", "The model writes a program for each larger object, and mends it after a look", 1),
            ("LIBRARY", "Library", "The library's furniture, in the picture's colours; one question at most", 2),
        ),
        update=_changed,
    )
    use_assets: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Use My Assets",
        description="Let small things look like assets of your own asset libraries (Preferences, File Paths) where one "
        "fits well enough. A change counts from the next run of the stage Small objects on",
        default=True,
        update=_changed,
    )
    corrections: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Corrections",
        description="Faults that are mended in the finished room. What is not ticked is found and told of, and stays",
        items=fault_kinds.KIND_ITEMS,
        options={"ENUM_FLAG"},
        default={item[0] for item in fault_kinds.KIND_ITEMS},
        update=_changed,
    )
    spared: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Kept as it was",
        description="What is not corrected, one a line: the kind of fault, a colon, the object",
        update=_changed,
    )
    render_engine: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Engine",
        description="What renders the room's views",
        items=(
            ("CYCLES", "Cycles", "Follows the light: the picture to show, on the graphics card if Cycles may use it"),
            ("EEVEE", "EEVEE", "Quick on a graphics card, with less exact light"),
        ),
    )
    render_quality: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Quality",
        description="How large and how carefully the views are rendered",
        items=(
            ("PREVIEW", "Preview", "768 pixels, about a minute a picture on a small processor"),
            ("FINE", "Fine", "1536 pixels, many minutes a picture without a graphics card"),
        ),
    )
    objects: bpy.props.CollectionProperty(  # type: ignore[valid-type]
        name="Objects",
        description="A row for each object that was detected or added",
        type=object_list.CodeAsRoomObject,
    )
    active_object: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Object",
        description="Choose an object to see what became of it; it is selected in the viewport",
        get=object_list.get_active,
        set=object_list.set_active,
        options={"SKIP_SAVE"},
    )


def memory_settings(settings: Any, earlier: dict[str, str]) -> dict[str, str]:
    """The settings as memory keeps them (see `View.settings`); names that are not the panel's stay as they were."""
    result = dict(earlier)
    values = {
        "known_width_m": f"{settings.known_width:.6g}" if settings.use_known_width else "",
        "wall_height_m": f"{settings.wall_height:.6g}" if settings.use_wall_height else "",
        "notes": settings.notes.strip(),
        "iterations": str(settings.iterations),
        "assets": "" if settings.use_assets else "off",
        CORRECTIONS_OFF: fault_kinds.off_text(settings),
        "objects": "" if settings.modelling == "AUTO" else settings.modelling.lower(),
    }
    for name, value in values.items():
        if value:
            result[name] = value
        else:
            result.pop(name, None)
    return result


def show_settings(settings: Any, memory: Mapping[str, str]) -> None:
    """The inverse of `memory_settings`: the panel's settings say what memory's do."""
    for name, switch, value in (
        ("known_width_m", "use_known_width", "known_width"),
        ("wall_height_m", "use_wall_height", "wall_height"),
    ):
        if memory.get(name):
            setattr(settings, value, float(memory[name]))
        setattr(settings, switch, bool(memory.get(name)))
    settings.notes = memory.get("notes", "")
    settings.iterations = max(1, int(memory.get("iterations", "5")))
    settings.use_assets = memory.get("assets", "") != "off"
    settings.modelling = memory.get("objects", "").upper() or "AUTO"
    fault_kinds.show_off_text(settings, memory.get(CORRECTIONS_OFF, ""))


CLASSES = (*object_list.CLASSES, CodeAsRoomSettings)
