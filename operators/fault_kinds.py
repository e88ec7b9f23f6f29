# SPDX-License-Identifier: GPL-3.0-or-later
"""The kinds of faults as the artist reads them, and what they have switched off as the stages read it."""

from __future__ import annotations

from typing import Any

from ..pipeline.artifacts.correction import FAULT_KINDS, FaultKind

NAMES: dict[FaultKind, tuple[str, str]] = {
    "material": ("Missing materials", "Parts that nothing says the material of get that of their object"),
    "picture": ("Missing images", "Where an image does not exist, a plain colour stands for it"),
    "light": ("Lights too strong or weak", "Lights of impossible strength are brought within what lamps give"),
    "outside": ("Outside the room", "What stands outside or in a wall is moved into the room"),
    "blocked": ("Blocked doors", "What stands where a door opens is moved out of its way"),
    "overlap": ("Overlapping objects", "Objects inside each other are moved apart"),
    "support": ("Floating or sunken", "What floats or is sunken is put onto what carries it"),
    "coincident": ("Faces in one plane", "Faces that would flicker are moved apart by a hair"),
    "camera": ("Cameras in the way", "Cameras inside walls or furniture are moved out"),
}
KIND_ITEMS = tuple((kind, *NAMES[kind], 1 << place) for place, kind in enumerate(FAULT_KINDS))


def off_text(settings: Any) -> str:
    """The setting of stage 10 that says what is not mended."""
    kinds = [kind for kind in FAULT_KINDS if kind not in settings.corrections]
    spared = [word for word in settings.spared.split("\n") if word]
    return ",".join([*kinds, *spared])


def show_off_text(settings: Any, text: str) -> None:
    """The inverse of `off_text`."""
    words = [word for word in text.split(",") if word]
    settings.corrections = {kind for kind in FAULT_KINDS if kind not in words}
    settings.spared = "\n".join(word for word in words if ":" in word)
