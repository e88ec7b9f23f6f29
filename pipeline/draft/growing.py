# SPDX-License-Identifier: GPL-3.0-or-later
"""A room that grows while its draft is written: the text so far in, a whole room's text out whenever something new stands."""

from __future__ import annotations

from ..artifacts.layout import CameraLine
from .camera import first_camera
from .prompt import EXAMPLE
from .reading import Draft
from .statements import Statement, split
from .text import room_text


class DraftGrowth:
    """What builds while a draft is written (`stages.base.Growth`).

    Attributes:
        draft: what was read so far. latest: a sentence on what was read last, for the artist.
    """

    def __init__(self, image_size: tuple[int, int] = (1000, 1000)) -> None:
        self._image_size = image_size
        self._begin()

    def _begin(self) -> None:
        self.draft = Draft()
        self._taken: list[Statement] = []
        self._camera: CameraLine | None = None
        self._shown = ""
        self._most = 0
        self.latest = ""

    def warm(self) -> None:
        """Have at hand what the first statements need, such as the library: before there is anything to hear."""
        type(self)(self._image_size).hear(EXAMPLE)

    def hear(self, text_so_far: str) -> str | None:
        """See `stages.base.Growth`. Nothing is raised; a statement that cannot be used changes nothing."""
        statements = split(text_so_far, whole=False).statements
        if [s.text for s in statements[: len(self._taken)]] != [s.text for s in self._taken]:
            # Another try: it begins anew, and what stands is shown until it has more.
            shown, most = self._shown, max(self._most, len(self.draft.things))
            self._begin()
            self._shown, self._most = shown, most
        changed = False
        for statement in statements[len(self._taken) :]:
            changed |= self.draft.take(statement)
            self._taken.append(statement)
        if not changed or self.draft.room is None or len(self.draft.things) < self._most:
            return None
        if self._camera is None:
            self._camera = first_camera(self.draft.room, self._image_size)
        text = room_text(self.draft, self._camera)
        if not text or text == self._shown:
            return None
        self._shown = text
        count = len(self.draft.things)
        newest = next(reversed(self.draft.things), "")
        self.latest = (
            f"{newest} stands: {count} object{'s' if count != 1 else ''} so far" if newest else "The walls stand"
        )
        return text
