# SPDX-License-Identifier: GPL-3.0-or-later
"""A build in slices that never shows half a room.

First the meshes that the scene lacks are made, one a slice, as datablocks that nothing uses yet: an artist sees nothing
of them, and a build that is dropped leaves nothing. Then one last slice puts everything in place and writes the program,
so that objects and text agree at every moment in which another operator could run. That slice looks at the scene anew:
what an undo or the artist took away in the meantime is made again.
"""

from __future__ import annotations

from typing import Any

import bpy

from ..pipeline.scene.plan import BuildPlan
from ..pipeline.scene.realise import new_mesh
from ..pipeline.scene.tags import DIGEST
from ..pipeline.scene.targets import Target
from .scene_backend import ResolvedScene


class Building:
    """One build on its way. Main thread only; no Blender data is kept between calls.

    Attributes:
        plan: what is being built.
    """

    def __init__(self, backend: ResolvedScene, plan: BuildPlan) -> None:
        self.plan = plan
        self._backend = backend
        self._waiting: list[Target] | None = None
        self._made: dict[tuple[str, str], int] = {}

    def step(self) -> bool:
        """Do one slice of what comes before `commit`; False when nothing is left of it.

        Raises:
            RoomError: the scene is gone.
        """
        if self._waiting is None:
            self._waiting = self._backend.lacking(self.plan)
        elif self._waiting:
            target = self._waiting.pop()
            self._made[target.key] = new_mesh(target, self.plan.room).session_uid
        return bool(self._waiting)

    def commit(self) -> None:
        """Put everything in place; what is not used of the prepared meshes goes.

        Raises:
            RoomError: the scene is gone.
        """
        try:
            self._backend.commit(self.plan, self._found())
        finally:
            self.drop()

    def drop(self) -> None:
        """Remove the prepared meshes that no object uses."""
        unused = [mesh for mesh in self._found().values() if mesh.users == 0]
        self._made.clear()
        if unused:
            bpy.data.batch_remove(unused)

    def _found(self) -> dict[tuple[str, str], Any]:
        """The prepared meshes that are still there as they were made: an undo may have taken them."""
        if not self._made:
            return {}
        meshes = {mesh.session_uid: mesh for mesh in bpy.data.meshes}
        digests = self.plan.room.digests
        found = {key: meshes[uid] for key, uid in self._made.items() if uid in meshes}
        return {key: mesh for key, mesh in found.items() if mesh.users == 0 and mesh.get(DIGEST) == digests[key][1]}
