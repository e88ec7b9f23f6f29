# SPDX-License-Identifier: GPL-3.0-or-later
"""A room that grows while its draft is written: the text so far in, a whole room's text out whenever something new stands."""

from __future__ import annotations

from ..artifacts.layout import CameraLine
from ..errors import RoomError
from ..program.finishes import with_first_materials
from ..program.parse_safe import uncollected
from ..program.prelude.record import Record
from .camera import first_camera
from .parts import RoomParts
from .prompt import EXAMPLE
from .reading import Draft
from .readings import Reading, begin
from .record import Cloths, record_of
from .statements import split
from .text import room_text


class DraftGrowth:
    """What builds while a draft is written (`stages.base.Growth`).

    Attributes:
        latest: a sentence on what was read last, for the artist. record: what the room text means that was given last, None
            where it has to be evaluated. parts: of that room.
    """

    def __init__(self, image_size: tuple[int, int] = (1000, 1000)) -> None:
        self._image_size = image_size
        self._shown = self._text_so_far = ""
        self._most = 0
        self._begin()

    def _begin(self) -> None:
        self._reading: Reading = begin()
        self._heard = self._changes = 0
        self._camera: CameraLine | None = None
        self.parts, self._cloths = RoomParts(), Cloths()
        self.record: Record | None = None
        self.latest = ""

    @property
    def draft(self) -> Draft:
        """What was read so far."""
        return self._reading.draft

    def warm(self) -> None:
        """Have at hand what the first statements need, such as the library: before there is anything to hear."""
        type(self)(self._image_size).hear(EXAMPLE)

    def hear(self, text_so_far: str) -> str | None:
        """See `stages.base.Growth`. Nothing is raised; a statement that cannot be used changes nothing."""
        before, self._text_so_far = self._text_so_far, text_so_far
        if before and before[-1] != "\n" and text_so_far.startswith(before) and "\n" not in text_so_far[len(before) :]:
            return None  # only the end of a line, or the beginning of another one, completes a statement
        statements = split(text_so_far, whole=False).statements
        if len(statements) < self._heard or not self._reading.fits(statements):
            # Another try: it begins anew, and what stands is shown until it has more.
            self._most = max(self._most, len(self.draft.things))
            self._begin()
        self._heard = len(statements)
        self._reading.go_on(statements)
        with self._reading.lock, uncollected():
            return self._room()

    def _room(self) -> str | None:
        """The room's text where it has changed."""
        draft, reading = self.draft, self._reading
        if reading.changes == self._changes or draft.room is None or len(draft.things) < self._most:
            return None
        self._changes = reading.changes
        if self._camera is None:
            self._camera = first_camera(draft.room, self._image_size)
        text = self._text(draft, self._camera)
        if not text or text == self._shown:
            return None
        self._shown = text
        count = len(draft.things)
        newest = next(reversed(draft.things), "")
        self.latest = (
            f"{newest} stands: {count} object{'s' if count != 1 else ''} so far" if newest else "The walls stand"
        )
        return text

    def _text(self, draft: Draft, camera: CameraLine | None) -> str:
        """The room's text and its record, from its parts; evaluated as a whole only where they do not go together."""
        self.record = None
        assert draft.room is not None
        try:
            composed = self.parts.composed(draft, draft.room, camera)
            if composed.is_plain:
                self.record = record_of(composed, self._cloths)
                return with_first_materials(composed.text, composed.materials)
        except (RoomError, ValueError, TypeError, LookupError, ArithmeticError):
            pass  # told where it is evaluated
        return room_text(draft, camera, self.parts)
