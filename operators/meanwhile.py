# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist does to a room while a stage runs is never lost, and never overwritten.

- Objects that were moved, added, deleted: read back right before every build and before the former room is put back.
  They go to memory as hand edits and into the text that is built, whatever the stage knows of them; the next stage
  begins with them.
- Undo, redo, or an edit of the memory's text: the file's memory counts. Answers that it does not hold yet are added to
  it, results of stages that the artist took back stay away. Whether the running stage still fits is decided by the
  hashes of what it read.
"""

from __future__ import annotations

import logging
from typing import Any

import bpy

from ..pipeline.artifacts.analysis import Finding
from ..pipeline.artifacts.hand import HandEdits
from ..pipeline.artifacts.layout import LayoutEdit
from ..pipeline.errors import RoomError
from ..pipeline.memory import Entry, EntryMeta, Memory, dump_memory, now
from ..pipeline.program.patch import patch_text
from ..pipeline.run import Run, StageSession
from ..pipeline.scene.plan import plan_build
from . import properties, reference, room_memory
from .building import Building
from .scene_backend import ResolvedScene, scene_by_uid

log = logging.getLogger(__name__)
TOUCHES = ("TRANSFORM_OT_", "OBJECT_OT_", "MESH_OT_", "CODE_AS_ROOM_OT_")
"""Modal operators that have objects in their hands; a build would pull these away."""


class NotApplied(RoomError):
    """A stage was answered, but what it was made from was changed meanwhile."""


def in_hand() -> str:
    """What the artist has in hand that a build would break into, as a sentence; "" when nothing. Main thread only."""
    if bpy.app.background:
        return ""
    manager: Any = bpy.context.window_manager
    for window in manager.windows:
        active = window.view_layer.objects.active
        if active is not None and active.mode != "OBJECT":
            return "Waiting until you are back in Object mode"
        if any(modal.bl_idname.startswith(TOUCHES) for modal in getattr(window, "modal_operators", ())):
            return "Waiting until you have finished what you are doing"
    return ""


class Meanwhile:
    """Watches one room for the length of a job.

    Attributes:
        standing: the program that stood before the present stage, with what the artist did since.
    """

    def __init__(self, run: Run, backend: ResolvedScene) -> None:
        self._run, self._backend = run, backend
        self._known = backend.memory_in_file()
        self._edits_before = 0
        self.standing = ""

    def begin_stage(self) -> None:
        """A stage is about to start; what was edited until now is in the program already. Main thread only."""
        self.standing = self._backend.program_text()
        self._edits_before = len(self._run.hand_edits())

    def check_scene(self) -> Any:
        """The scene; RoomError when it was deleted."""
        scene = scene_by_uid(self._backend.uid)
        if scene is None:
            raise RoomError(
                "The scene was deleted while its run was going on.",
                "Undo that, or load the picture again; what was answered is not asked again.",
            )
        return scene

    def check_inputs(self, session: StageSession | None) -> None:
        """What the stage was made from must still hold: the picture, the settings, and what it read.

        Raises:
            NotApplied: it does not.
        """
        scene, run = self.check_scene(), self._run
        if reference.picture_mark(scene) != run.picture.sha256:
            raise NotApplied(
                "Answered, not applied: the picture was changed while a stage was running.",
                "What was answered is kept; run the stage again.",
            )
        run.memory.settings = properties.memory_settings(scene.code_as_room, run.memory.settings)
        if session is not None and session.is_outdated:
            raise outdated(session.stage.title)

    def edits(self) -> list[LayoutEdit]:
        """What the artist edited since the stage began, as far as it was taken over."""
        return self._run.hand_edits()[self._edits_before :]

    def patched(self, text: str, fresh: list[LayoutEdit]) -> tuple[str, list[Finding]]:
        """A text of the stage with everything that the artist edited since it began; any thread.

        Where an edit cannot be written into it, the text is as it was: the next reading back finds it again.
        """
        edits = [*self.edits(), *fresh]
        if not edits:
            return text, []
        try:
            return patch_text(text, edits)
        except RoomError as error:
            log.warning("Edits by hand do not fit the new layout: %s", error)
            return text, []

    def take_over(self, edits: list[LayoutEdit], findings: list[Finding]) -> None:
        """Keep these edits in memory. The scene is built with them right afterwards. Main thread only."""
        if self.standing:
            self.standing, _ = self.patched(self.standing, edits)
        entry = HandEdits(edits=edits, findings=findings)
        self._run.memory.append("artist", entry, EntryMeta(time=now(), model="artist"))

    def former_room(self) -> Building | None:
        """The build that `put_back` commits, to be prepared in slices; None where there is nothing to build."""
        if not self.standing or self._backend.program_text() == self.standing:
            return None
        return Building(self._backend, plan_build(self.standing, meshes=False))

    def put_back(self, prepared: Building | None = None) -> None:
        """The room that stood before the stage stands again, with what the artist did since. Main thread only.

        Args:
            prepared: what `former_room` gave, as far as it was prepared.
        """
        if not self.standing:
            return
        edits = self._backend.read_back()
        if not edits and self._backend.program_text() == self.standing:
            return
        text, findings = self.patched(self.standing, edits)
        if edits:
            self.take_over(edits, findings)
        if prepared is not None and prepared.plan.text == text:
            prepared.commit()
        else:
            self._backend.build(text)

    def flush(self, is_whole: bool) -> bool:
        """Write the memory's text that waits; False when the file's memory was changed behind the job's back.

        Args:
            is_whole: no worker is at the memory, so that the text is all of it and need not be parsed by others.
        """
        if self.was_changed():
            return False
        self._backend.flush()
        self._known = self._backend.memory_in_file()
        if is_whole:
            room_memory.remember(self._known, room_memory.copy_of(self._run.memory))
        return True

    def was_changed(self) -> bool:
        """Whether the file's memory is not the one that this job knows of: undo, redo, an edit of its text."""
        return self._backend.memory_in_file() != self._known

    def agree(self) -> None:
        """Make the job's memory agree with the file's when that was changed. Only while no worker uses it."""
        if not self.was_changed():
            return
        self._known = self._backend.memory_in_file()
        try:
            memory = room_memory.memory_of(self.check_scene())
        except RoomError:
            return  # broken by hand: it is set aside when the memory is written
        missing = missing_answers(self._run.memory, memory)
        self._run.memory.entries[:] = [*memory.entries, *missing]
        if missing:
            self._backend.save_memory(dump_memory(self._run.memory))


def outdated(title: str) -> NotApplied:
    """What is told of a stage whose result does not fit any more."""
    return NotApplied(
        f"{title}: answered, not applied. What it was made from was changed while it was running.",
        "What was answered is kept; run the stage again.",
    )


def missing_answers(memory: Memory, other: Memory) -> list[Entry]:
    """The answers of one memory that another does not hold."""
    held = {_mark(entry) for entry in other.entries if entry.type == "Answer"}
    return [entry for entry in memory.entries if entry.type == "Answer" and _mark(entry) not in held]


def _mark(entry: Entry) -> tuple[Any, ...]:
    return entry.meta.prompt_hash, entry.meta.client, entry.output.get("text")
