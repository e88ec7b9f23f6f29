# SPDX-License-Identifier: GPL-3.0-or-later
"""How weak a stand-in for a vision model is: every number of the noise model (`benchmark/noise.py`), and why.

The kinds of error are those that are reported of vision models; how large they are at the three strengths is our own
choice, set by what they make of the direct answer to the sample, not by what the method makes of them:
layout IoU 0.94 as recorded, then 0.82, 0.66 and 0.47 (mean of 12 seeds), the last like the paper's direct call with 0.46,
recall 0.96, 0.87, 0.79 and 0.63, facing 1.0, 0.90, 0.76 and 0.51 with what is missing counted. What is known of models, and
what it stands for here:

- Small things are overlooked far more often than large ones, and enlarging the part helps (Zhang et al. 2025, "MLLMs Know
  Where to Look": accuracy falls from things above 5 % of the picture to things below 0.5 %): `drop`, `zoom`.
- Models do semantic tasks notably better than geometric ones (Ramachandran et al. 2025, "How Well Does GPT-4o Understand
  Vision?"), so boxes and metres err more than categories: `confuse` is far smaller than the rest.
- Facing is near chance for many (Tasnim et al. 2025, DORI: the best reach 54 % on coarse questions): `turn`, `snap`.
- Sizes and distances in metres are guessed from what is usual, a room's size too (Yang et al. 2024, VSI-Bench; Liao et al.
  2024, Q-Spatial Bench): one scale error of the whole room, which sizes share by half, besides one of each thing.
- Coordinates are read off with a common error of the whole picture and are given in round numbers: `reading`, `grid`.

Confidences stay as the strong model said them: weak models do not know how wrong they are, and no number may tell the
harness what was disturbed. Hallucinated things are not modelled (duplicates are), nor answers that are no valid JSON.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Strength:
    """How weak the stand-in is. Chances are 0..1, box units 0-1000 of the picture, sigmas are standard deviations.

    Attributes:
        drop: chance to overlook a thing of 1 % of the picture; it goes with area to the power -0.35, 0.3 to 2.5 times this.
        edge, edge_share: sigma of each edge of a box, in units and as a share of the box's side.
        reading: sigma of the common offset of all coordinates, in units; 0.2 % of common scale comes with each unit.
        grid: boxes are given in multiples of this many units (0: as they are).
        corner: sigma of the floor's and the walls' corners, units.
        corners_lost: chance that an outline of more than four corners is given as its bounding rectangle.
        tops_lost: chance that the walls' upper corners are not given at all.
        place: sigma of a centre as a share of the room's mean side; pull: how far centres are drawn to the room's middle.
        step: metres are given in multiples of this.
        room, aspect: sigma of the log of the room's scale and of its width against its depth.
        size, side: sigma of the log of a thing's size as a whole, and of each side by itself.
        height: sigma of the log of heights; base: sigma of an underside above the floor, metres.
        turn: chance that a front is taken for another side: a side face four times in seven, the back in the rest.
        snap: chance that a slanting thing is taken for a straight one.
        confuse: chance of a neighbouring category; orphan: that what carries a thing is not said.
        double: chance that a thing is listed twice.
        found: chance that the second look finds what is missing; mend: that something visibly wrong is put right by
            a later answer; harm: that a later answer makes something right worse.
        zoom: errors of boxes in later answers, which see enlarged parts or drawn outlines, against those of the first.
        flatter: how much of what a layout lacks is overlooked in its score.
    """

    name: str
    drop: float = 0.0
    edge: float = 0.0
    edge_share: float = 0.0
    reading: float = 0.0
    grid: float = 0.0
    corner: float = 0.0
    corners_lost: float = 0.0
    tops_lost: float = 0.0
    place: float = 0.0
    pull: float = 0.0
    step: float = 0.0
    room: float = 0.0
    aspect: float = 0.0
    size: float = 0.0
    side: float = 0.0
    height: float = 0.0
    base: float = 0.0
    turn: float = 0.0
    snap: float = 0.0
    confuse: float = 0.0
    orphan: float = 0.0
    double: float = 0.0
    found: float = 1.0
    mend: float = 1.0
    harm: float = 0.0
    zoom: float = 0.7
    flatter: float = 0.0


NONE = Strength("none")
SLIGHT = Strength(
    "slight", drop=0.05, edge=2.0, edge_share=0.015, reading=2.0, grid=1.0, corner=4.0, corners_lost=0.02, tops_lost=0.05,
    place=0.009, pull=0.01, step=0.05, room=0.04, aspect=0.02, size=0.025, side=0.025, height=0.06, base=0.03,
    turn=0.03, snap=0.15, confuse=0.02, orphan=0.05, double=0.01, found=0.85, mend=0.75, harm=0.01, flatter=0.2,
)  # fmt: skip
MEDIUM = Strength(
    "medium", drop=0.15, edge=5.0, edge_share=0.04, reading=6.0, grid=5.0, corner=10.0, corners_lost=0.1, tops_lost=0.2,
    place=0.025, pull=0.03, step=0.1, room=0.1, aspect=0.05, size=0.06, side=0.06, height=0.15, base=0.08,
    turn=0.1, snap=0.4, confuse=0.06, orphan=0.15, double=0.03, found=0.65, mend=0.55, harm=0.04, flatter=0.4,
)  # fmt: skip
STRONG = Strength(
    "strong", drop=0.3, edge=9.0, edge_share=0.08, reading=12.0, grid=10.0, corner=22.0, corners_lost=0.35, tops_lost=0.5,
    place=0.06, pull=0.07, step=0.2, room=0.2, aspect=0.1, size=0.14, side=0.12, height=0.3, base=0.2,
    turn=0.25, snap=0.8, confuse=0.14, orphan=0.4, double=0.07, found=0.45, mend=0.35, harm=0.1, flatter=0.6,
)  # fmt: skip
STRENGTHS = (SLIGHT, MEDIUM, STRONG)
