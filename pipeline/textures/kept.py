# SPDX-License-Identifier: GPL-3.0-or-later
"""Images that were paid for, on disk the moment they arrive, by the hash of what was asked; undo and a crash lose none.

One file an image, written beside and then put in place, so that nothing half-written is ever read.
"""

from __future__ import annotations

import contextlib
import hashlib
import logging
import os
import tempfile
import time
from pathlib import Path

log = logging.getLogger(__name__)
MOST_BYTES = 500_000_000
MOST_DAYS = 90.0
_SUFFIX = ".image"


def request_hash(client: str, text: str, shape: str) -> str:
    """What an image is known by: the client's name, the words and the shape that was asked for."""
    digest = hashlib.sha256()
    for part in (client, text, shape):
        data = part.encode("utf-8", "replace")
        digest.update(len(data).to_bytes(8, "big"))
        digest.update(data)
    return digest.hexdigest()


class KeptImages:
    """A folder of images. Any thread; nothing here raises because of the disk."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def keep(self, asked: str, data: bytes) -> None:
        """Keep the bytes of an image."""
        temporary = ""
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            handle, temporary = tempfile.mkstemp(dir=self._folder, prefix=".image-")
            with os.fdopen(handle, "wb") as file:
                file.write(data)
            os.replace(temporary, self._path(asked))
        except OSError as error:
            log.warning("An image could not be kept: %s", error.strerror)
            if temporary:
                with contextlib.suppress(OSError):
                    Path(temporary).unlink(missing_ok=True)

    def find(self, asked: str) -> bytes | None:
        """The image that was made for this request, None when there is none."""
        try:
            return self._path(asked).read_bytes() or None
        except OSError:
            return None

    def prune(self) -> None:
        """Drop what is old, and the oldest where there is too much."""
        try:
            files = sorted(
                ((p.stat().st_mtime, p.stat().st_size, p) for p in self._folder.glob("*" + _SUFFIX)), reverse=True
            )
        except OSError:
            return
        total = 0
        for changed, size, path in files:
            total += size
            if total > MOST_BYTES or time.time() - changed > MOST_DAYS * 86_400:
                with contextlib.suppress(OSError):
                    path.unlink()

    def _path(self, asked: str) -> Path:
        if not (len(asked) == 64 and all(c in "0123456789abcdef" for c in asked)):
            raise ValueError("an image is known by a sha256")
        return self._folder / (asked + _SUFFIX)
