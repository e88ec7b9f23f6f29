# SPDX-License-Identifier: GPL-3.0-or-later
"""From the model's answer to a `SceneAnalysis`: everything odd is repaired or dropped, and reported."""

from __future__ import annotations

import re

from ..artifacts.analysis import ArchitectureItem, DetectedObject, Finding, SceneAnalysis, Zone
from ..artifacts.common import ImageBox, ImagePoint
from ..artifacts.replies import AnalysisReply, ArchitectureReply, BoxReply, ObjectReply, PointReply
from ..errors import PictureError, ReplyError
from .door_leaves import without_leaves

MAX_OBJECTS = 300
MAX_METRES = 100.0
SIDE_NAMES = frozenset({"left", "right", "top", "bottom"})
SHELL_NAMES = frozenset({"room", "floor", "reference", "wall_n", "wall_e", "wall_s", "wall_w"})
"""What the layout itself calls the room, its outer walls and its camera; nothing that was seen may be called so."""
FACING_YAW = {
    "down": 0.0,
    "down-right": 45.0,
    "right": 90.0,
    "up-right": 135.0,
    "up": 180.0,
    "up-left": 225.0,
    "left": 270.0,
    "down-left": 315.0,
}


def clean_id(text: str, taken: set[str], fallback: str) -> str:
    """A unique lower-case identifier made from `text`; it is added to `taken`."""
    base = re.sub(r"[^a-z0-9]+", "_", text[:200].lower()).strip("_")[:40] or fallback
    if base[0].isdigit() or _is_shell_name(base):
        base = f"{fallback}_{base}"
    name, number = base, 2
    while name in taken:
        name, number = f"{base}_{number}", number + 1
    taken.add(name)
    return name


def _is_shell_name(name: str) -> bool:
    # Rooms of many corners have a wall_n_2, wall_n_3, ...
    return name in SHELL_NAMES or re.fullmatch(r"wall_[nesw]_\d+", name) is not None


def clean_box(box: BoxReply | None) -> ImageBox | None:
    """A box inside the picture with its corners in order, or None when nothing of it is left."""
    if box is None:
        return None
    x = sorted(min(1000.0, max(0.0, v)) for v in (box.x_min, box.x_max))
    y = sorted(min(1000.0, max(0.0, v)) for v in (box.y_min, box.y_max))
    if x[1] - x[0] < 1.0 or y[1] - y[0] < 1.0:
        return None
    return ImageBox(x_min=x[0], y_min=y[0], x_max=x[1], y_max=y[1])


def facing_yaw(facing: str, yaw: float) -> float:
    """Yaw in degrees, 0..360: the number, unless it contradicts the word by more than 60 degrees."""
    yaw = yaw % 360.0
    word = FACING_YAW.get(facing)
    if word is None:
        return yaw
    apart = abs((yaw - word + 180.0) % 360.0 - 180.0)
    return word if apart > 60.0 else yaw


def clean_object(reply: ObjectReply, taken: set[str], findings: list[Finding], source: str) -> DetectedObject | None:
    """One detected object, or None when it cannot be used; parents are checked later."""
    name = clean_id(reply.id or reply.category, taken, "object")
    box = clean_box(reply.box)
    if box is None:
        findings.append(Finding(about=name, message="Its box lies outside the picture; only its metres are used."))
    raw = (reply.box.x_min, reply.box.y_min, reply.box.x_max, reply.box.y_max)
    if box is not None and (raw[0] > raw[2] or raw[1] > raw[3]):
        findings.append(Finding(about=name, message="Its box was inside out; the corners were put in order."))
    size = _clean_size(reply, name, findings)
    said = (reply.centre_m.x_m, reply.centre_m.y_m, reply.base_m)
    x, y = (max(-MAX_METRES, min(MAX_METRES, v)) for v in said[:2])
    base = max(0.0, min(10.0, reply.base_m))
    if max(abs(x - said[0]), abs(y - said[1]), abs(base - said[2])) > 0.05:
        message = f"Its place {said[0]:.4g}, {said[1]:.4g}, {said[2]:.4g} m is not possible; it was brought nearer."
        findings.append(Finding(about=name, message=message))
    yaw = facing_yaw(reply.facing, reply.yaw_deg)
    if abs((yaw - reply.yaw_deg % 360 + 180) % 360 - 180) > 1:
        findings.append(
            Finding(about=name, message=f"Yaw {reply.yaw_deg:g} contradicts facing {reply.facing}; the word won.")
        )
    return DetectedObject(
        id=name,
        category=reply.category.strip()[:60] or "object",
        label=reply.label.strip()[:120],
        placement=reply.placement,
        parent=reply.parent or None,
        salience=reply.salience,
        zone=(reply.zone or "")[:60] or None,
        shape=reply.shape,
        box=box,
        centre=(x, y, base + size[2] / 2),
        size=(size[0], size[1], size[2]),
        yaw=yaw,
        confidence=max(0.0, min(1.0, reply.confidence)),
        source=source,
        front=reply.front.strip()[:80],
    )


def _clean_size(reply: ObjectReply, name: str, findings: list[Finding]) -> list[float]:
    """Width, depth and height above 1 mm and up to `MAX_METRES`."""
    said = (reply.size_m.width, reply.size_m.depth, reply.size_m.height)
    size = [min(MAX_METRES, abs(v)) for v in said]
    if min(said) < 0:
        findings.append(Finding(about=name, message="A negative size was taken without its sign."))
    if max(map(abs, said)) > MAX_METRES:
        findings.append(Finding(about=name, message=f"A size of more than {MAX_METRES:g} m was cut to that."))
    if min(size) < 0.001:
        size = [max(0.01, v) for v in size]
        findings.append(Finding(about=name, message="A size of zero was raised to 1 cm."))
    return size


def fix_parents(objects: list[DetectedObject], walls: set[str], findings: list[Finding]) -> list[DetectedObject]:
    """Parents that do not exist or run in a circle are cut; a surface object without parent gets one by its box."""
    by_id = {o.id: o for o in objects}
    fixed: list[DetectedObject] = []
    for item in objects:
        parent = item.parent
        if parent is not None and parent not in by_id and parent not in walls:
            findings.append(Finding(about=item.id, message=f"Its parent {parent!r} does not exist."))
            parent = None
        seen, step = {item.id}, parent
        while step is not None and step in by_id:
            if step in seen:
                findings.append(Finding(about=item.id, message="Its parents ran in a circle, which was cut here."))
                parent = None
                break
            seen.add(step)
            step = by_id[step].parent
        if parent is None and item.placement == "surface":
            parent = _carrier(item, objects)
        changed = item.model_copy(update={"parent": parent})
        by_id[item.id] = changed
        fixed.append(changed)
    return fixed


def _carrier(item: DetectedObject, objects: list[DetectedObject]) -> str | None:
    """The smallest floor object whose box holds the middle of this object's box."""
    if item.box is None:
        return None
    x, y = item.box.centre
    holders = [
        o
        for o in objects
        if o.id != item.id
        and o.box is not None
        and o.placement == "floor"
        and o.size[2] > 0.1
        and o.box.x_min <= x <= o.box.x_max
        and o.box.y_min <= y <= o.box.y_max
        and o.box.area > item.box.area
    ]
    return min(holders, key=lambda o: o.box.area if o.box else 0.0).id if holders else None


def clean_architecture(items: list[ArchitectureReply], findings: list[Finding]) -> list[ArchitectureItem]:
    """Partitions, doors, windows, openings and built-ins with unique ids and finite, sensible sizes."""
    taken: set[str] = set()
    result = []
    for item in items[:100]:
        name = clean_id(item.id or item.kind, taken, item.kind)
        start, end = ((max(-MAX_METRES, min(MAX_METRES, v)) for v in (p.x_m, p.y_m)) for p in (item.start, item.end))
        a, b = tuple(start), tuple(end)
        if abs(a[0] - b[0]) + abs(a[1] - b[1]) < 0.02:
            findings.append(Finding(about=name, message="It has no length and was dropped."))
            continue
        result.append(
            ArchitectureItem(
                id=name,
                kind=item.kind,
                start=(a[0], a[1]),
                end=(b[0], b[1]),
                height=max(0.1, min(10.0, item.height_m)),
                sill=max(0.0, min(5.0, item.sill_m)),
                thickness=max(0.02, min(1.0, item.thickness_m)),
                wall=item.wall or None,
                box=clean_box(item.box),
                swing=item.swing[:200],
            )
        )
    return result


def clean_polygon(points: list[PointReply]) -> list[ImagePoint]:
    """Corners inside (or just outside) the picture, without repeated neighbours."""
    result: list[ImagePoint] = []
    for point in points[:64]:
        x, y = max(-200.0, min(1200.0, point.x)), max(-200.0, min(1200.0, point.y))
        if not result or abs(result[-1].x - x) + abs(result[-1].y - y) > 1.0:
            result.append(ImagePoint(x=x, y=y))
    if len(result) > 1 and abs(result[0].x - result[-1].x) + abs(result[0].y - result[-1].y) <= 1.0:
        result.pop()
    return result


def clean_analysis(reply: AnalysisReply, image_size: tuple[int, int]) -> SceneAnalysis:
    """The artifact that the reply means; `floor` is filled in by the calibration.

    Raises:
        PictureError: the picture is not a room seen from above.
        ReplyError: no floor can be made of the answer, or it says that nothing is there.
    """
    if reply.view == "other":
        problem = reply.view_problem.strip().rstrip(".")[:160] or "the model sees no room from above in it"
        raise PictureError(
            f"This picture cannot be used: {problem}.",
            "Choose a picture that shows one whole room from above: a photo, a render or a plan.",
        )
    findings: list[Finding] = []
    floor = clean_polygon(reply.floor_polygon)
    if len(floor) < 3:
        raise ReplyError(
            "The model found no floor in the picture.",
            "Use a picture that shows the whole room from above, or give the floor's corners by hand.",
        )
    top = clean_polygon(reply.wall_top_polygon) if reply.wall_top_polygon else None
    if top is not None and len(top) != len(floor):
        findings.append(
            Finding(about="wall_top_polygon", message="It has another number of corners than the floor; unused.")
        )
        top = None
    if len(reply.objects) > MAX_OBJECTS:
        findings.append(
            Finding(
                about="objects",
                message=f"{len(reply.objects)} objects were answered; the first {MAX_OBJECTS} are used.",
            )
        )
    if not reply.objects:
        findings.append(Finding(about="objects", message="No objects were recognised.", severity="warning"))
    architecture = clean_architecture(reply.architecture, findings)
    kept = _clean_objects(reply.objects[:MAX_OBJECTS], {a.id for a in architecture}, findings)
    kept, architecture = without_leaves(kept, architecture, findings)
    zone_ids: set[str] = set()
    zones = [Zone(id=clean_id(z.id, zone_ids, "zone"), label=z.label[:80]) for z in reply.zones[:20]]
    return SceneAnalysis(
        image_size=image_size,
        view=reply.view,
        room_type=reply.room_type[:60] or "room",
        room_size=(
            _metres(reply.room_width_m, "room width", findings),
            _metres(reply.room_depth_m, "room depth", findings),
            _wall_height(reply.wall_height_m, findings),
        ),
        floor=[],
        floor_polygon=floor,
        wall_top_polygon=top,
        zones=zones,
        architecture=architecture,
        objects=kept,
        findings=findings,
    )


def _clean_objects(replies: list[ObjectReply], architecture: set[str], findings: list[Finding]) -> list[DetectedObject]:
    """The objects with ids that nothing else in the room has, and parents named by those ids."""
    taken = set(architecture)
    objects: list[DetectedObject] = []
    named: dict[str, str] = {}
    for reply in replies:
        item = clean_object(reply, taken, findings, "analysis")
        if item is not None:
            objects.append(item)
            named.setdefault(reply.id, item.id)
    own = {o.id for o in objects} | architecture | SIDE_NAMES
    # A model that calls a thing "Night stand" calls it so again where it is a parent.
    renamed = [
        o if o.parent is None or o.parent in own else o.model_copy(update={"parent": named.get(o.parent, o.parent)})
        for o in objects
    ]
    return fix_parents(renamed, architecture | SIDE_NAMES, findings)


def _wall_height(value: float, findings: list[Finding]) -> float:
    height = max(1.8, min(8.0, value))
    if height != value:
        message = f"The wall height {value:g} m is not possible; {height:g} m is used."
        findings.append(Finding(about="room", message=message, severity="warning"))
    return height


def _metres(value: float, name: str, findings: list[Finding]) -> float:
    if 0.5 <= value <= MAX_METRES:
        return value
    findings.append(
        Finding(about="room", message=f"The {name} {value:g} m is not possible; 4 m is assumed.", severity="warning")
    )
    return 4.0
