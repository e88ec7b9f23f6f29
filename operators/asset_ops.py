# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that look like assets of the artist's own libraries: found, chosen, turned, taken off again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.retrieval.match import Match
from ..pipeline.run import Run
from ..pipeline.run_assets import chosen_of, match_of, take_off, wanted_of, wear
from . import asset_search, driver, object_list, own_room, room_memory, view_state
from .base import RoomOperator, allow, busy_blocker
from .scene_backend import ResolvedScene


def blocker(context: Any) -> str:
    """Why no object can be given an asset now, "" when one can. No I/O: polls call it on every redraw."""
    busy = busy_blocker(context)
    if busy:
        return busy
    if asset_search.is_searching():
        return "A search for assets is going on; wait for it"
    state = view_state.peek(context.scene)
    return "" if state is not None and state.has_layout else "Run the stages up to the layout first"


class AssetOperator(RoomOperator):
    """Base of the operators about assets; `identifier` is one object, or "" for what is selected."""

    bl_options = {"REGISTER", "UNDO"}

    identifier: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Object", description="Id of one object; empty for what is selected", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a layout, and nothing going on."""
        return allow(cls, blocker(context))

    def names(self, scene: Any) -> frozenset[str]:
        """Ids of the objects that it is about.

        Raises:
            RoomError: there are none.
        """
        names = frozenset([self.identifier]) if self.identifier else object_list.selected_names(scene)
        if not names:
            raise RoomError("No object of the room is selected.", "Select one in the list or in the viewport.")
        return names

    def begin(self, scene: Any) -> Run:
        """A run with what was edited by hand taken over."""
        own_room.prepare(scene)
        run = room_memory.run_of(scene)
        run.take_over_edits()
        return run

    def end(self, scene: Any, run: Run, said: str) -> None:
        """Write memory, and show what was done."""
        notices: Sequence[str] = ()
        if isinstance(run.backend, ResolvedScene):
            run.backend.flush()
            notices = run.backend.notices
        view_state.refresh(scene)
        driver.note_outcome(scene, said, notices=tuple(notices))
        self.report({"INFO"}, said)


class CODE_AS_ROOM_OT_find_assets(AssetOperator):
    """Look through your asset libraries for what fits; the best takes its place, in the same box, if it fits well"""

    bl_idname = "code_as_room.find_assets"
    bl_label = "Find Asset"
    bl_options = {"REGISTER"}

    def perform(self, context: bpy.types.Context) -> None:
        """Start the search; it makes its own undo step."""
        asset_search.start(context.scene, self.names(context.scene))


class CODE_AS_ROOM_OT_use_asset(AssetOperator):
    """Let the object look like this asset, in the same box and place"""

    bl_idname = "code_as_room.use_asset"
    bl_label = "Use Asset"

    asset: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Asset", description="Library, file, kind and name, as the search found it", options={"SKIP_SAVE"}
    )

    def perform(self, context: bpy.types.Context) -> None:
        """Put it on."""
        scene = context.scene
        run = self.begin(scene)
        wanted = wanted_of(run, self.names(scene))
        if not wanted:
            raise RoomError("This object does not stand in the room.", "Run the stages first.")
        match = self._match(run, scene, wanted[0].id)
        done = wear(run, [(item, match) for item in wanted])
        self.end(scene, run, f'"{match.asset.ref.name}" is used, score {done[0].score:.2f}')

    def _match(self, run: Run, scene: Any, name: str) -> Match:
        found = asset_search.found_for(scene, name) or ()
        match = next((m for m in found if m.asset.ref.key == self.asset), None)
        if match is None and run.shelf is not None:
            asset = run.shelf.look().by_key.get(self.asset)
            match = Match(asset, 1.0, 1.0, 1.0) if asset is not None else None
        if match is None:
            raise RoomError("This asset is not in your libraries any more.", "Look for assets again.")
        return match


class CODE_AS_ROOM_OT_turn_asset(AssetOperator):
    """Turn the asset by a quarter inside its object's box; the object itself stays as it is"""

    bl_idname = "code_as_room.turn_asset"
    bl_label = "Turn Asset"

    def perform(self, context: bpy.types.Context) -> None:
        """Fit it anew."""
        scene = context.scene
        run = self.begin(scene)
        chosen = chosen_of(run.memory)
        done = 0
        for wanted in wanted_of(run, self.names(scene)):
            choice = chosen.of(wanted.id)
            if choice is not None:
                done += len(wear(run, [(wanted, match_of(choice))], (choice.turn + 1) % 4))
        if not done:
            raise RoomError("This object does not look like an asset.", "Use Find Asset first.")
        self.end(scene, run, "Turned by a quarter")


class CODE_AS_ROOM_OT_drop_assets(AssetOperator):
    """Take the asset off: the object gets its library piece, or its own program, again"""

    bl_idname = "code_as_room.drop_assets"
    bl_label = "Without Asset"

    def perform(self, context: bpy.types.Context) -> None:
        """Build the object as the program says."""
        scene = context.scene
        run = self.begin(scene)
        count = take_off(run, self.names(scene))
        if not count:
            raise RoomError("These objects do not look like assets.")
        self.end(scene, run, f"{count} object{'' if count == 1 else 's'} without asset")


CLASSES = (
    CODE_AS_ROOM_OT_find_assets,
    CODE_AS_ROOM_OT_use_asset,
    CODE_AS_ROOM_OT_turn_asset,
    CODE_AS_ROOM_OT_drop_assets,
)
