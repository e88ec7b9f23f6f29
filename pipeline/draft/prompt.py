# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model is told to write a whole room in one answer: at most 30 kB with the language, the looks and the library's names."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..analysis.look import OVERLAP, enlarged
from ..artifacts.common import ImageBox
from ..library import catalogue
from ..picture import ReferencePicture
from ..program.looks_reference import looks_reference
from ..program.reference import reference

if TYPE_CHECKING:
    from .reading import Draft

LONGEST = 30_000
"""Bytes of the whole prompt text, the artist's notes apart."""
_UNUSED = frozenset({"room_door", "room_window", "plain_block"})
"""Pieces that a room's own lines make."""
_RARE = re.compile(r"^(voronoi_map|brick_map|picture|bump|wave_map)\(", re.MULTILINE)
_PLAIN_LINES = re.compile(r"^(finish\(id|A name makes).*\n", re.MULTILINE)

EXAMPLE = """\
# style: calm Scandinavian reading corner, oak, grey wool, warm white walls
room(size=(3.2, 2.6, 2.5), floor=[(-1.6, -1.3), (1.6, -1.3), (1.6, 1.3), (-1.6, 1.3)],
    seen=[(148, 862), (850, 864), (846, 160), (150, 158)], top=[(60, 956), (938, 958), (934, 66), (62, 64)],
    view="perspective", kind="living room")
window("window_1", wall="top", start=(-0.7, 1.3), end=(0.7, 1.3), sill=0.9, height=1.3, seen=(334, 70, 664, 118))
oak = wood("#B08A5E", figure=0.6)
wool = fabric("#8C9096", size=0.005)
steel = metal("#3A3B3D")
rim = 0.012
finish("floor", planks("#B98F63", size=(1.6, 0.16)))
finish("walls", plaster("#EFEBE4"))

proxy("armchair_1", "armchair", at=(-0.95, 0.72, 0), size=(0.78, 0.8, 0.84), yaw=40, front="backrest at the upper left",
    seen=(176, 178, 408, 432))
def armchair_1(size):
    w, d, h = size
    arm, seat = 0.1, 0.42
    legs = [cone(0.014, 0.16, 0.022, at=(s * (w / 2 - 0.05), t * (d / 2 - 0.06), 0.08), segments=14) for s in (-1, 1) for t in (-1, 1)]
    frame = rounded_box((w, d - 0.06, 0.1), 0.02, at=(0, 0.03, 0.2))
    arms = [rounded_box((arm, d, 0.46), 0.045, at=(s * (w - arm) / 2, 0, 0.38)) for s in (-1, 1)]
    back = tufted((w - 2 * arm + 0.01, 0.16, h - 0.22), 3, 2, 0.02, at=(0, d / 2 - 0.08, (h + 0.22) / 2))
    pad = cushion((w - 2 * arm - 0.01, d - 0.2, seat - 0.24), puff=0.3, sag=0.01, at=(0, -0.08, (seat + 0.24) / 2), seed=1)
    return [part("frame", [frame, arms], material=wool), part("back", back, material=wool), part("seat cushion", pad, material=wool),
            part("leg", legs, material=oak)]

proxy("side_table_1", "side table", at=(-0.2, 0.98, 0), size=(0.42, 0.42, 0.52), shape="round", seen=(442, 180, 546, 286))
def side_table_1(size):
    w, d, h = size
    top = cylinder(w / 2, 0.022, at=(0, 0, h - 0.011), segments=48, edge=rim / 2)
    foot = cylinder(w * 0.36, 0.012, at=(0, 0, 0.006), segments=40, edge=0.003)
    return [part("top", top, material=oak), part("stem", cylinder(0.014, h - 0.03, at=(0, 0, h / 2)), material=steel),
            part("foot", foot, material=steel)]

proxy("mug_1", "mug", at=(-0.24, 0.94, 0.52), size=(0.11, 0.08, 0.09), yaw=200, placement="surface", parent="side_table_1",
    seen=(470, 214, 494, 238), piece="mug", colors={"ceramic": "#C9604A"})
proxy("pouf_1", "pouf", at=(0.7, -0.5, 0), size=(0.5, 0.5, 0.38), shape="round", seen=(586, 558, 706, 690))
def pouf_1(size):
    return [part("pouf", pouf(size, "knit", at=(0, 0, size[2] / 2)), material=knit("#CFC4B2"))]
proxy("pouf_2", "pouf", at=(1.2, -0.2, 0), size=(0.5, 0.5, 0.38), shape="round", seen=(700, 474, 824, 606), like="pouf_1")

lighting(style="soft daylight", sun_from="top", windows=["window_1"], lamps_on=[], warmth="neutral")
build()
"""
"""Ends the prompt; a test reads it as a draft without a fault."""


_PART = 1000.0 * (0.5 + OVERLAP / 2)
QUARTERS = tuple(
    ImageBox(x_min=x, y_min=y, x_max=x + _PART, y_max=y + _PART)
    for y in (0.0, 1000.0 - _PART)
    for x in (0.0, 1000.0 - _PART)
)
"""The picture's overlapping quarters, which are shown enlarged: top left, top right, bottom left, bottom right."""


def pictures(picture: ReferencePicture) -> list[tuple[str, bytes]]:
    """What is shown: names and files."""
    parts = [(f"part {n}", enlarged(picture, part, grid=False)) for n, part in enumerate(QUARTERS, 3)]
    return [("reference", picture.for_model()), ("grid", picture.with_grid()), *parts]


def values(picture: ReferencePicture, settings: Mapping[str, str], width_m: float | None = None) -> dict[str, str]:
    """What the prompt's places are filled with.

    Args:
        settings: the artist's ("notes"). width_m: the room's inner width in metres, where it is known.
    """
    notes = []
    if width_m is not None:
        notes.append(f"The room is {width_m:g} m wide (measured).")
    if settings.get("notes", "").strip():
        notes.append(f"The artist says: {settings['notes'].strip()[:1000]}")
    return {
        "width": str(picture.width),
        "height": str(picture.height),
        "notes": "\n".join(notes),
        "reference": language(),
        "looks": looks(),
        "pieces": ", ".join(name for name in catalogue.pieces() if name not in _UNUSED),
        "example": EXAMPLE,
    }


@functools.lru_cache(maxsize=1)
def language() -> str:
    """The reference of the modelling language without its example: the draft's own one shows more."""
    return reference(example=False).rstrip() + "\n"


@functools.lru_cache(maxsize=1)
def looks() -> str:
    """The families of looks, and of what one's own are made of only the usual."""
    lines = _PLAIN_LINES.sub("", looks_reference()).splitlines()
    return "\n".join(line for line in lines if not _RARE.match(line)) + "\n"


def again_values(draft: Draft, style: str, name: str, program: str, problem: str) -> dict[str, str]:
    """What the places of the second question are filled with, for one def that could not be used."""
    thing = next((t for t in draft.things.values() if draft.def_of(t) == name), None)
    what = name
    if thing is not None:
        w, d, h = thing.size
        label = f" ({thing.label})" if thing.label else ""
        what = f"{thing.category}{label}, {w:.2f} x {d:.2f} x {h:.2f} m, {thing.placement}"
        if thing.parent:
            what += f" of {thing.parent}"
    return {
        "reference": language(),
        "style": style or "as in the picture",
        "thing": what,
        "others": ", ".join(f"{n} = {e}" for n, e in draft.palette.named.items())[:2000] or "none",
        "problem": problem,
        "program": program,
    }
