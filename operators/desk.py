# SPDX-License-Identifier: GPL-3.0-or-later
"""Where questions wait that the artist asks a chat by hand, and the client that lays them there."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from ..pipeline.models.manual import Desk, ManualClient

DESK = Desk()
_FOLDER = "by_hand"
_is_tidy = False


def make_client(folder: str) -> ManualClient:
    """The client that waits for the artist. Main thread only.

    Args:
        folder: where pictures are saved while their question waits, "" for the add-on's own.
    """
    global _is_tidy
    own = own_folder()
    if not _is_tidy and not DESK.waiting:
        # What a session left behind that ended while a question waited.
        shutil.rmtree(own, ignore_errors=True)
        _is_tidy = True
    return ManualClient(DESK, Path(folder) if folder else own)


def own_folder() -> Path:
    """The add-on's own folder for the pictures of questions; a temporary one where it has none. Main thread only."""
    from . import clients

    folder = clients.user_folder()
    return folder / _FOLDER if folder is not None else Path(tempfile.gettempdir()) / "code_as_room_by_hand"
