# SPDX-License-Identifier: GPL-3.0-or-later
"""Small JSON files in the add-on's own folder for the user's data: written in one step, and never in the way."""

from __future__ import annotations

import json
import logging
import os
import tempfile
from pathlib import Path
from typing import Any

log = logging.getLogger(__name__)


def read_json(path: Path | None) -> dict[str, Any]:
    """The file's object; {} when there is none, or it cannot be read."""
    if path is None:
        return {}
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return data if isinstance(data, dict) else {}


def write_json(path: Path | None, data: dict[str, Any]) -> bool:
    """Replace the file in one step; False when that is not possible."""
    if path is None:
        return False
    temporary = ""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}-")
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            json.dump(data, file, indent=1)
        os.replace(temporary, path)
    except OSError as error:
        log.info("%s cannot be written: %s", path.name, error)
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        return False
    return True
