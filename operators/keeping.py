# SPDX-License-Identifier: GPL-3.0-or-later
"""memory.json of a run of the command: written after every stage and when a stage fails, and never at an earlier
run's cost."""

from __future__ import annotations

import os
from pathlib import Path

from ..pipeline.errors import MemoryFormatError, OutputError, RoomError
from ..pipeline.memory import Memory, load_memory
from .outputs import write_memory

NAME = "memory.json"
EARLIER = "memory.earlier.json"


class MemoryFile:
    """The memory of one output folder.

    A run that does not resume leaves an earlier run's memory.json alone until it has an answer of its own to keep; the
    earlier one is then set aside as memory.earlier.json until the new room is finished.
    """

    def __init__(self, folder: Path, resume: bool) -> None:
        self.folder = folder
        self._resume = resume
        self._aside: Path | None = None

    def load(self) -> Memory:
        """What to go on from: the file's memory when resuming, else an empty one.

        Raises:
            RoomError: the file cannot be read; it stays as it is.
        """
        path = self.folder / NAME
        if not self._resume:
            return Memory()
        fix = f"Mend {path}, or run without --resume to begin anew."
        try:
            return load_memory(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            print(f"Nothing to resume in {self.folder}; beginning anew.")
            self._resume = False
            return Memory()
        except MemoryFormatError as error:
            raise RoomError(error.message, fix) from error
        except UnicodeDecodeError as error:
            raise RoomError(f"{NAME} is not a text that can be read.", fix) from error
        except OSError as error:
            raise RoomError(f"{NAME} cannot be read: {error.strerror or error}.", fix) from error

    def keep(self, memory: Memory) -> None:
        """Write the memory, when there is anything in it.

        Raises:
            OutputError: it cannot be written.
        """
        if not memory.entries:
            return
        path = self.folder / NAME
        if not self._resume and self._aside is None and path.is_file():
            self._aside = self.folder / EARLIER
            try:
                os.replace(path, self._aside)
            except OSError as error:
                raise OutputError(f"{NAME} cannot be set aside: {error.strerror or error}.") from error
        # From now on the file is this run's own.
        self._resume = True
        write_memory(memory, self.folder)

    def told(self) -> str:
        """A sentence on the earlier memory that was set aside, "" when there was none."""
        return f"The earlier {NAME} is kept as {EARLIER}." if self._aside is not None else ""

    def finish(self) -> None:
        """The new room is whole and stands in the earlier one's place."""
        if self._aside is not None:
            self._aside.unlink(missing_ok=True)
            self._aside = None
