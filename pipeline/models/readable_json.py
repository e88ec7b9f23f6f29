# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints JSON for people: whatever fits on a line stands on one line."""

from __future__ import annotations

import json
from typing import Any


def readable_json(data: Any, width: int = 110) -> str:
    """JSON text in which lists and objects are broken over lines only where they are longer than `width`.

    Raises:
        ValueError: the data holds a non-finite number.
    """
    return _printed(data, width, 0)


def _printed(data: Any, width: int, indent: int) -> str:
    flat = json.dumps(data, ensure_ascii=False, allow_nan=False)
    if len(flat) + indent <= width or not isinstance(data, (dict, list)) or not data:
        return flat
    pad = " " * (indent + 1)
    if isinstance(data, dict):
        lines = [
            f"{pad}{json.dumps(str(key), ensure_ascii=False)}: {_printed(value, width, indent + 1)}"
            for key, value in data.items()
        ]
        return "{\n" + ",\n".join(lines) + "\n" + " " * indent + "}"
    lines = [pad + _printed(value, width, indent + 1) for value in data]
    return "[\n" + ",\n".join(lines) + "\n" + " " * indent + "]"
