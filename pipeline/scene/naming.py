# SPDX-License-Identifier: GPL-3.0-or-later
"""Ids for what an artist renames, copies or adds: lower case, as a program writes them."""

from __future__ import annotations

import re
import unicodedata

_LONGEST = 60


def id_from_name(name: str) -> str:
    """An id from an object's name, "" when nothing usable is in it. Blender's ".001" does not count."""
    plain = unicodedata.normalize("NFKD", re.sub(r"\.\d{3,}$", "", name)).encode("ascii", "ignore").decode().lower()
    words = re.sub(r"[^a-z0-9]+", "_", plain).strip("_")[:_LONGEST].strip("_")
    return words if words[:1].isalpha() else f"object_{words}" if words else ""


def free_id(wish: str, used: set[str]) -> str:
    """The wish if it is free, else the next number behind it."""
    return wish if wish not in used else next_id(wish, used)


def next_id(identifier: str, used: set[str]) -> str:
    """The id with the lowest number from 2 on that is free: "bed_1" gives "bed_2"."""
    stem = re.sub(r"_\d+$", "", identifier)
    number = 2
    while f"{stem}_{number}" in used:
        number += 1
    return f"{stem}_{number}"


def category_from_name(name: str) -> str:
    """Words for a category from an object's name: "Floor Lamp.002" is "floor lamp"."""
    words = re.sub(r"[_\d]+", " ", id_from_name(name)).split()
    return " ".join(words) or "object"
