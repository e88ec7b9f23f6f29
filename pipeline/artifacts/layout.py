# SPDX-License-Identifier: GPL-3.0-or-later
"""The typed layout lines of a room program, and what stages 3 and 4 write."""

from __future__ import annotations

from typing import Literal

from .analysis import Finding
from .common import Artifact, Metres2, Metres3, Placement, Salience, Shape


class RoomLine(Artifact):
    """`room(size=(w, d, h), floor=[(x, y), ...])`: bounding size and floor outline, counter-clockwise."""

    size: Metres3
    floor: list[Metres2]


class WallLine(Artifact):
    """`wall(id, start, end, height=, thickness=)`.

    The segment is the wall's inner face for outer walls (the room lies to its left, that is, the floor polygon runs
    counter-clockwise) with the thickness outside; for partitions (`partition=True`) it is the centre line.
    """

    id: str
    start: Metres2
    end: Metres2
    height: float
    thickness: float = 0.12
    partition: bool = False


class DoorLine(Artifact):
    """`door(id, wall=, start, end, height=, open=)`: a leaf, hinge at `start`, `open` degrees into the room."""

    id: str
    wall: str
    start: Metres2
    end: Metres2
    height: float = 2.05
    open: float = 0.0


class WindowLine(Artifact):
    """`window(id, wall=, start, end, sill=, height=)`: glazing in a wall; height is measured from the sill."""

    id: str
    wall: str
    start: Metres2
    end: Metres2
    sill: float = 0.9
    height: float = 1.3


class OpeningLine(Artifact):
    """`opening(id, wall=, start, end, sill=, height=)`: a hole in a wall without leaf or glass."""

    id: str
    wall: str
    start: Metres2
    end: Metres2
    sill: float = 0.0
    height: float = 2.2


class ProxyLine(Artifact):
    """`proxy(id, category, centre=, size=, yaw=, ...)`: the oriented box that stands in for an object.

    `centre` is the box's centre (x, y, z), `size` its width (own x), depth (own y) and height; yaw in degrees
    counter-clockwise, 0 faces -Y. `parent` is the id of what it stands on or hangs from.
    """

    id: str
    category: str
    centre: Metres3
    size: Metres3
    yaw: float = 0.0
    placement: Placement = "floor"
    parent: str | None = None
    salience: Salience = "major"
    label: str = ""
    shape: Shape = "box"


class LightLine(Artifact):
    """`light(id, kind, at, energy=, color=, size=, target=, size_y=, kelvin=, parent=)`: linear colour, watts as Blender's.

    A sun's energy is watts a square metre, its size the angle it is seen under (radians). For area lights `size` and
    `size_y` are the sides (`size_y` 0: a square), for the others `size` is the radius. The light's colour is `color`
    times that of `kelvin` (0: white). `parent` is the window, lamp or wall that it shines from and moves with.
    """

    id: str
    kind: Literal["sun", "area", "point", "spot"]
    at: Metres3
    energy: float
    color: Metres3 = (1.0, 1.0, 1.0)
    size: float = 0.1
    target: Metres3 | None = None
    size_y: float = 0.0
    kelvin: float = 0.0
    parent: str | None = None


class WorldLine(Artifact):
    """`world(id, color=, strength=, kelvin=, background=)`: the light that comes from all around; once in a room.

    `color` (linear, times the colour of `kelvin`) and `strength` are what shines; `background` (linear) is what a camera
    sees beyond the room and through its windows.
    """

    id: str
    color: Metres3 = (1.0, 1.0, 1.0)
    strength: float = 0.5
    kelvin: float = 0.0
    background: Metres3 = (1.0, 1.0, 1.0)


class ViewLine(Artifact):
    """`view(id, exposure=, transform=, look=, ceiling=, cut=)`: how the room is shown in renders; once in a room.

    `exposure` in stops, `transform` and `look` Blender's names (where a Blender lacks them, the nearest it has).
    `ceiling` is the height of a ceiling that is seen from below only (0: none); at `cut` (0: nowhere) walls have a solid
    section, for a camera whose near clip cuts them there. Both in metres.
    """

    id: str
    exposure: float = 0.0
    transform: str = "AgX"
    look: str = ""
    ceiling: float = 0.0
    cut: float = 0.0


class CameraLine(Artifact):
    """`camera(id, kind, matrix=, fov_y=, ortho_height=, image_size=, principal=, near=, stops=)`, fields as `CameraModel`.

    What is nearer than `near` metres is cut off; its pictures are `stops` brighter than the `view` line says.
    """

    id: str
    kind: Literal["perspective", "orthographic"]
    matrix: tuple[float, ...]
    fov_y: float = 0.0
    ortho_height: float = 0.0
    image_size: tuple[int, int] = (1024, 1024)
    principal: Metres2 = (500.0, 500.0)
    near: float = 0.02
    stops: float = 0.0


Line = (
    RoomLine
    | WallLine
    | DoorLine
    | WindowLine
    | OpeningLine
    | ProxyLine
    | LightLine
    | CameraLine
    | WorldLine
    | ViewLine
)


class Layout(Artifact):
    """The layout lines of one room, in the order in which they are printed."""

    room: RoomLine
    walls: list[WallLine] = []
    doors: list[DoorLine] = []
    windows: list[WindowLine] = []
    openings: list[OpeningLine] = []
    proxies: list[ProxyLine] = []
    lights: list[LightLine] = []
    worlds: list[WorldLine] = []
    views: list[ViewLine] = []
    cameras: list[CameraLine] = []

    def proxy(self, identifier: str) -> ProxyLine | None:
        """The proxy with this id, or None."""
        return next((p for p in self.proxies if p.id == identifier), None)


class LayoutEdit(Artifact):
    """One typed edit of the layout; only the fields that the kind uses are given.

    Attributes:
        op: move (centre), resize (size), turn (yaw), add (all, or line), remove, recategorise (category, label, salience,
            shape), rename (new_id), reparent (placement and parent), line (the printed layout line that stands from now
            on for this id: a wall, door, window, opening, light, world, view or camera, or "room"). `add` with a line makes such a
            thing, `remove` takes it away.
        reason: why, in a few words.
        origin: who asked: "model", "solver", "artist"; "parent" for what only moved along with what the artist moved,
            which does not lock it.
    """

    op: Literal["move", "resize", "turn", "add", "remove", "recategorise", "rename", "reparent", "line"]
    id: str
    centre: Metres3 | None = None
    size: Metres3 | None = None
    yaw: float | None = None
    category: str | None = None
    label: str | None = None
    placement: Placement | None = None
    parent: str | None = None
    salience: Salience | None = None
    shape: Shape | None = None
    new_id: str | None = None
    line: str | None = None
    reason: str = ""
    origin: Literal["model", "solver", "artist", "parent"] = "model"


class Score(Artifact):
    """How good a layout is, each part 0..1, higher is better.

    `measured` is the weighted mean of what was measured, `model` the model's own judgement (None when it gave none),
    `total` both weighed together.
    """

    total: float
    measured: float
    coverage: float
    overlap: float
    bounds: float
    relations: float
    boxes: float
    clear: float = 1.0
    support: float = 1.0
    model: float | None = None


class Iteration(Artifact):
    """One round of the layout loop: the layout it started from, its score, and what was asked for after it."""

    number: int
    program: str
    score: Score
    edits: list[LayoutEdit] = []
    refused: list[Finding] = []
    remarks: str = ""


class LedgerEntry(Artifact):
    """What became of one detected object."""

    id: str
    category: str
    state: Literal["placed", "detailed", "deferred", "dropped"]
    reason: str = ""


class LayoutProgram(Artifact):
    """What stages 3 and 4 write: the program's text after the prelude, and how it came about.

    Attributes:
        text: the layout program (room language, without the prelude).
        stage: which stage wrote it.
        best: number of the iteration that was kept.
        ledger: from stage 4 on, one entry for each detected object.
        hand_edits: how many of the artist's edits, from the first on, are in the text.
    """

    text: str
    stage: str
    score: Score
    best: int = 0
    iterations: list[Iteration] = []
    ledger: list[LedgerEntry] = []
    findings: list[Finding] = []
    hand_edits: int = 0
