# SPDX-License-Identifier: GPL-3.0-or-later
"""The rounds of the layout loop: looking at them, comparing them with the picture, and taking another one."""

from __future__ import annotations

import io
from typing import Any

import bpy
from PIL import Image

from ..pipeline.artifacts.analysis import Calibration
from ..pipeline.artifacts.layout import Iteration, LayoutProgram
from ..pipeline.errors import RoomError
from ..pipeline.report_rounds import RoundRow, text_key
from . import driver, fitted_view, own_room, room_memory, round_pictures, view_state
from .base import RoomOperator, allow, manager
from .state_reading import LOOP, kept

RUNNING = "A run is going on; wait for it, or stop it"
COMPARISON = "Picture and Layout"
MARK = "code_as_room_comparison"
_GAP = 8
_shown: dict[int, int] = {}
_fits = 0


def rows_of(scene: Any) -> tuple[RoundRow, ...]:
    """The rounds of a scene's room."""
    state = view_state.peek(scene)
    return state.rounds if state is not None else ()


def shown_round(scene: Any) -> RoundRow | None:
    """The round that the panel shows: the one that was chosen, else the one that is kept."""
    state = view_state.peek(scene)
    if state is None or not state.rounds:
        return None
    number = _shown.get(scene.session_uid)
    kept_one = next((row for row in state.rounds if row.kept), state.rounds[-1])
    return next((row for row in state.rounds if row.number == number), kept_one)


def iteration_of(scene: Any, number: int) -> Iteration:
    """A round with its program as it was rendered; RoomError when there is none."""
    program = kept(room_memory.memory_of(scene), LayoutProgram, (LOOP,))
    for item in program.iterations if program is not None else ():
        if item.number == number:
            return item
    raise RoomError("There is no such round.", "Run the major layout first.")


def picture_of_round(scene: Any, number: int) -> bytes:
    """PNG of a round, rendered when no picture of it is kept; RoomError when that cannot be."""
    item = iteration_of(scene, number)
    key = text_key(item.program)
    png = round_pictures.find(key)
    if png is None:
        calibration = kept(room_memory.memory_of(scene), Calibration)
        if calibration is None:
            raise RoomError("There is no fitted camera.", "Run the scene analysis first.")
        png = round_pictures.render(item.program, calibration.camera)
        round_pictures.keep(key, png)
    return png


class RoundOperator(RoomOperator):
    """Base of the operators about one round."""

    number: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Round",
        description="Number of the round, from 1; 0 is the one that the panel shows",
        default=0,
        min=0,
        max=99,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be rounds, and no run."""
        if driver.is_running():
            return allow(cls, RUNNING)
        state = view_state.peek(context.scene)
        return allow(cls, "" if state is not None and state.rounds else "Run the major layout first")

    def chosen(self, context: bpy.types.Context) -> int:
        """The round that this is about, as `Iteration.number`."""
        if self.number:
            return int(self.number) - 1
        row = shown_round(context.scene)
        if row is None:
            raise RoomError("There is no round yet.", "Run the major layout first.")
        return row.number


class CODE_AS_ROOM_OT_show_round(RoundOperator):
    """Show this round: what it was worth, and what the critic asked for after it"""

    bl_idname = "code_as_room.show_round"
    bl_label = "Show Layout Round"
    bl_options = {"INTERNAL"}

    def perform(self, context: bpy.types.Context) -> None:
        """Remember which one is shown."""
        scene: Any = context.scene
        _shown[scene.session_uid] = self.chosen(context)
        driver.redraw()


class CODE_AS_ROOM_OT_take_round(RoundOperator):
    """Make this round the layout, with your edits by hand on top; the auxiliary layout has to run again"""

    bl_idname = "code_as_room.take_round"
    bl_label = "Take This One"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The tooltip says why it is grey where the round is the layout already."""
        state = view_state.peek(context.scene)
        taken = next((row.number + 1 for row in state.rounds if row.kept), 0) if state is not None else 0
        return "This round is the layout already" if taken and properties.number == taken else cls.__doc__ or ""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """As for every round, and in Object mode."""
        return super().poll(context) and allow(cls, "" if context.mode == "OBJECT" else "Go back to Object mode first")

    def perform(self, context: bpy.types.Context) -> None:
        """Take it; the rounds' pictures are found under their programs with the edits on top, too."""
        from ..pipeline.run_rounds import take_round

        scene: Any = context.scene
        number = self.chosen(context)
        before = [text_key(iteration_of(scene, row.number).program) for row in rows_of(scene)]
        own_room.prepare(scene)
        run = room_memory.run_of(scene)
        taken = take_round(run, number)
        for old, item in zip(before, taken.iterations, strict=True):
            round_pictures.alias(old, text_key(item.program))
        room_memory.keep(run)
        _shown.pop(scene.session_uid, None)
        fitted_view.follow(scene)
        view_state.refresh(scene)
        driver.note_outcome(scene, f"Round {number + 1} is the layout now. Run the auxiliary layout to place the rest")


class CODE_AS_ROOM_OT_draw_rounds(RoundOperator):
    """Draw the pictures of rounds that are not kept on this computer, such as after the file came from another one"""

    bl_idname = "code_as_room.draw_rounds"
    bl_label = "Draw Layout Rounds"
    bl_options = {"REGISTER"}

    def perform(self, context: bpy.types.Context) -> None:
        """Draw what is missing."""
        scene = context.scene
        for row in rows_of(scene):
            picture_of_round(scene, row.number)
        view_state.refresh(scene)
        driver.redraw()


class CODE_AS_ROOM_OT_compare_round(RoundOperator):
    """Show the picture and this round side by side in a window of its own"""

    bl_idname = "code_as_room.compare_round"
    bl_label = "Compare with Picture"
    bl_options = {"REGISTER"}

    def perform(self, context: bpy.types.Context) -> None:
        """Make the picture, and show it in an image editor."""
        scene, number = context.scene, self.chosen(context)
        picture = room_memory.picture_of(scene)
        if picture is None:
            raise RoomError("There is no picture yet.", "Load a picture of a room first.")
        png = side_by_side(picture.data, picture_of_round(scene, number))
        show_image(context, comparison_image(png))
        view_state.refresh(scene)


def side_by_side(left: bytes, right: bytes) -> bytes:
    """Two encoded pictures beside each other at the second one's height, as PNG."""
    with Image.open(io.BytesIO(left)) as a, Image.open(io.BytesIO(right)) as b:
        second = b.convert("RGB")
        first = a.convert("RGB").resize((max(1, round(a.width * second.height / a.height)), second.height))
    both = Image.new("RGB", (first.width + _GAP + second.width, second.height), "white")
    both.paste(first, (0, 0))
    both.paste(second, (first.width + _GAP, 0))
    buffer = io.BytesIO()
    both.save(buffer, "PNG")
    return buffer.getvalue()


def comparison_image(png: bytes) -> Any:
    """The one image datablock that comparisons are shown in; it is not saved unless the artist uses it."""
    images: Any = bpy.data.images
    for old in [image for image in images if MARK in image]:
        images.remove(old)
    with Image.open(io.BytesIO(png)) as opened:
        image = images.new(COMPARISON, opened.width, opened.height)
    image.filepath_raw = "//comparison.png"
    image.file_format = "PNG"
    image.source = "FILE"
    image.pack(data=png, data_len=len(png))
    image[MARK] = True
    return image


def show_image(context: Any, image: Any) -> None:
    """Show an image in an image editor that shows a comparison already, else in a new window."""
    if bpy.app.background:
        return
    spaces = [a.spaces.active for w in manager(context).windows for a in w.screen.areas if a.type == "IMAGE_EDITOR"]
    free = [space for space in spaces if space.image is None]
    if not free:
        bpy.ops.wm.window_new()
        area = manager(context).windows[-1].screen.areas[0]
        area.ui_type = "IMAGE_EDITOR"
        free = [area.spaces.active]
    free[0].image = image
    global _fits
    _fits = 3
    if not bpy.app.timers.is_registered(_fit):
        bpy.app.timers.register(_fit, first_interval=0.2)


def _fit() -> float | None:
    """Show all of the comparison. A new editor forgets it in its first drawings, so it is done more than once."""
    global _fits
    _fits -= 1
    for window in bpy.context.window_manager.windows if bpy.context.window_manager else ():
        for area in window.screen.areas:
            space: Any = area.spaces.active
            image: Any = space.image if area.type == "IMAGE_EDITOR" else None
            if image is None or MARK not in image:
                continue
            region = next(r for r in area.regions if r.type == "WINDOW")
            with bpy.context.temp_override(window=window, area=area, region=region):
                bpy.ops.image.view_all(fit_view=True)
            region.tag_redraw()
    return 0.3 if _fits > 0 else None


def register() -> None:
    """Have the rounds' pictures ready whenever the state is worked out."""
    view_state.listeners.append(round_pictures.prepare)


def unregister() -> None:
    """Undo `register`."""
    if round_pictures.prepare in view_state.listeners:
        view_state.listeners.remove(round_pictures.prepare)
    if bpy.app.timers.is_registered(_fit):
        bpy.app.timers.unregister(_fit)
    round_pictures.forget_all()
    _shown.clear()


CLASSES = (
    CODE_AS_ROOM_OT_show_round,
    CODE_AS_ROOM_OT_take_round,
    CODE_AS_ROOM_OT_draw_rounds,
    CODE_AS_ROOM_OT_compare_round,
)
