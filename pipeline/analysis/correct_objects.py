# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects as the artist corrected them: left out, called otherwise, in another box, or added."""

from __future__ import annotations

import math

from ..artifacts.analysis import Calibration, DetectedObject, Finding, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.corrections import AddedObject, Corrections, ObjectCorrection
from ..geometry.camera import GeometryError, to_plane
from ..geometry.footprint import lift_box, lift_on_wall
from ..geometry.polygon import as_points, nearest_wall, point_in_polygon
from .clean import SHELL_NAMES, SIDE_NAMES, fix_parents
from .merge import BOX_CORRECTED

ARTIST = "artist"
SLIGHTLY = 0.8
"""Boxes that agree better than this are one measurement: the metres are left to the fusing of both."""
TWIN = 0.6
MAJOR_SIDE = 0.4
"""Metres: what stands on the floor and is wider defines the layout."""
HEIGHT_SHARE, LOWEST, TALLEST = 0.7, 0.05, 0.9
"""Nothing in a picture from above tells a new thing's height: a part of its smaller side, between two limits (metres)."""
ON_WALL_Z = (1.1, 1.7)
INSIDE, SMALL = 0.95, 0.35
"""A new box that lies by so much inside another's, and is so much smaller, is of a thing that stands on the other."""


def corrected_objects(
    analysis: SceneAnalysis, calibration: Calibration, corrections: Corrections, findings: list[Finding]
) -> SceneAnalysis:
    """The analysis with the artist's word on each object; what changes beside that is reported in `findings`."""
    objects: list[DetectedObject] = []
    left_out: list[DetectedObject] = []
    for item in analysis.objects:
        said = corrections.of(item.id)
        if said.include is False:
            left_out.append(item)
        else:
            objects.append(_corrected(item, said, calibration, findings))
    for new in corrections.added:
        _add(new, objects, left_out, analysis, calibration, findings)
    walls = {a.id for a in analysis.architecture} | SIDE_NAMES | SHELL_NAMES
    gone = {o.id for o in left_out}
    objects = [o.model_copy(update={"parent": None}) if o.parent in gone else o for o in objects]
    return analysis.model_copy(update={"objects": fix_parents(objects, walls, []), "left_out": left_out})


def _corrected(
    item: DetectedObject, said: ObjectCorrection, calibration: Calibration, findings: list[Finding]
) -> DetectedObject:
    """One object with another category and another box; what the artist vouches for is certain."""
    update: dict[str, object] = {}
    if said.category:
        update |= {"category": said.category, "confidence": 1.0}
    if said.box is not None and said.box != item.box:
        update |= {"box": said.box, "confidence": 1.0}
        if item.box is None or item.box.iou(said.box) < SLIGHTLY:
            try:
                update |= _lifted(item, said.box, calibration)
            except GeometryError as error:
                message = f"Its metres could not follow its box: {error.message}"
                findings.append(Finding(about=item.id, message=message, severity="warning"))
    return item.model_copy(update=update) if update else item


def _lifted(item: DetectedObject, box: ImageBox, calibration: Calibration) -> dict[str, object]:
    """Centre and size by the new box. Sizes are kept where the box only moved: they were measured, the box was drawn."""
    camera, (width, depth, height) = calibration.camera, item.size
    base = item.centre[2] - height / 2
    if item.placement in ("wall", "ceiling"):
        old = item.box or box
        points = to_plane(camera, [old.centre, box.centre], item.centre[2])
        dx, dy = (float(v) for v in (points[1] - points[0])[:2])
        if not math.isfinite(dx + dy):
            raise GeometryError("the box does not lie in the room")
        if item.box is None:
            dx, dy = float(points[1][0]) - item.centre[0], float(points[1][1]) - item.centre[1]
        return {"centre": (item.centre[0] + dx, item.centre[1] + dy, item.centre[2]), "source": BOX_CORRECTED}
    lifted = lift_box(camera, box, base, height, item.yaw, item.size, shape=item.shape)
    same_size = item.box is not None and 0.8 < box.area / max(1e-9, item.box.area) < 1.25
    size = (width, depth, height) if same_size else (lifted.size[0], lifted.size[1], height)
    return {"centre": (lifted.centre[0], lifted.centre[1], item.centre[2]), "size": size, "source": BOX_CORRECTED}


def _add(
    new: AddedObject,
    objects: list[DetectedObject],
    left_out: list[DetectedObject],
    analysis: SceneAnalysis,
    calibration: Calibration,
    findings: list[Finding],
) -> None:
    """Add one object; what the analysis has found there by itself gives its metres and goes."""
    twin = next((o for o in [*objects, *left_out] if _same(o, new)), None)
    if twin is None:
        try:
            objects.append(_placed(new, objects, calibration))
        except GeometryError as error:
            message = f"What you added cannot be placed: {error.message}"
            findings.append(Finding(about=new.id, message=message, severity="warning"))
        return
    update: dict[str, object] = {"id": new.id, "category": new.category, "box": new.box, "confidence": 1.0}
    if twin in left_out:
        left_out.remove(twin)
        objects.append(twin.model_copy(update=update))
    else:
        objects[objects.index(twin)] = twin.model_copy(update=update)
        for i, item in enumerate(objects):
            if item.parent == twin.id:
                objects[i] = item.model_copy(update={"parent": new.id})
    findings.append(Finding(about=new.id, message=f"The analysis saw it too, as {twin.id}; it is there once."))


def _same(item: DetectedObject, new: AddedObject) -> bool:
    """Whether the analysis found what the artist added: boxes that agree and a word in common, or hardly a difference."""
    if item.box is None or item.source == ARTIST:
        return False
    iou = item.box.iou(new.box)
    words = set(item.category.lower().split()) & set(new.category.lower().split())
    return iou >= 0.85 or (iou >= TWIN and bool(words))


def _placed(new: AddedObject, objects: list[DetectedObject], calibration: Calibration) -> DetectedObject:
    """The new object in the room, from nothing but its box: on a wall, on another thing, or on the floor."""
    camera, box = calibration.camera, new.box
    x, y = (float(v) for v in to_plane(camera, [box.centre], 0.0)[0][:2])
    if not math.isfinite(x + y):
        raise GeometryError("its box does not lie in the room")
    if not point_in_polygon((x, y), calibration.floor):
        return _on_wall(new, (x, y), calibration)
    carrier = _carrier(box, objects)
    base = 0.0 if carrier is None else carrier.centre[2] + carrier.size[2] / 2
    height = 0.5
    for _ in range(4):
        lifted = lift_box(camera, box, base, height, 0.0)
        height = max(LOWEST, min(TALLEST, HEIGHT_SHARE * min(lifted.size[:2])))
    lifted = lift_box(camera, box, base, height, 0.0)
    major = carrier is None and max(lifted.size[:2]) > MAJOR_SIDE
    return DetectedObject(
        id=new.id,
        category=new.category,
        placement="floor" if carrier is None else "surface",
        parent=None if carrier is None else carrier.id,
        salience="major" if major else "minor",
        box=box,
        centre=lifted.centre,
        size=lifted.size,
        confidence=1.0,
        source=ARTIST,
    )


def _on_wall(new: AddedObject, point: tuple[float, float], calibration: Calibration) -> DetectedObject:
    """What is drawn outside of the floor hangs on the nearest wall, at the height of a picture."""
    floor = as_points(calibration.floor)
    wall = nearest_wall(point, floor)
    start, end = floor[wall.edge], floor[(wall.edge + 1) % len(floor)]
    high = min(ON_WALL_Z[1], calibration.height)
    lifted = lift_on_wall(calibration.camera, new.box, start, end, (max(0.0, high - 0.6), high))
    height = min(lifted.size[2], calibration.height)
    z = max(height / 2, min(calibration.height - height / 2, lifted.centre[2]))
    return DetectedObject(
        id=new.id,
        category=new.category,
        placement="wall",
        salience="minor",
        box=new.box,
        centre=(lifted.centre[0], lifted.centre[1], z),
        size=(lifted.size[0], lifted.size[1], height),
        yaw=lifted.yaw % 360.0,
        confidence=1.0,
        source=ARTIST,
    )


def _carrier(box: ImageBox, objects: list[DetectedObject]) -> DetectedObject | None:
    """The smallest thing on the floor that a small box lies on."""
    holders = [
        o
        for o in objects
        if o.box is not None
        and o.placement == "floor"
        and o.size[2] > 0.1
        and box.area < SMALL * o.box.area
        and _shared(box, o.box) > INSIDE * box.area
    ]
    return min(holders, key=lambda o: o.box.area if o.box else 0.0) if holders else None


def _shared(a: ImageBox, b: ImageBox) -> float:
    width = min(a.x_max, b.x_max) - max(a.x_min, b.x_min)
    height = min(a.y_max, b.y_max) - max(a.y_min, b.y_min)
    return max(0.0, width) * max(0.0, height)
