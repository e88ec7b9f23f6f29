# SPDX-License-Identifier: GPL-3.0-or-later
"""What a weaker vision model would have answered: seeded errors put on the recorded answer of a strong one.

It is a model of models, and it knows nothing but the recording: ground truth is never looked at, so what the strong model
got wrong stays wrong at every strength. Strength "none" changes nothing. `benchmark/strengths.py` has every number, and why.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from code_as_room.pipeline.analysis.clean import FACING_YAW, clean_id
from code_as_room.pipeline.artifacts.replies import (
    AnalysisReply,
    ArchitectureReply,
    BoxReply,
    Facing,
    MetresReply,
    ObjectReply,
    PointReply,
    SizeReply,
)

from .confusions import confused
from .draws import Draws, Errors, alike
from .strengths import NONE, Strength

_TURNS = tuple(
    (word, ring, i)
    for ring in (
        ("top", "left", "bottom", "right"),
        ("upper", "left", "lower", "right"),
        ("up", "left", "down", "right"),
    )
    for i, word in enumerate(ring)
)


@dataclass(frozen=True)
class NoisyAnalysis:
    """A weaker model's first answer.

    Attributes:
        reply: the answer; ids: by true id, what the thing is called in it; doubles: ids listed twice, by true id.
    """

    reply: AnalysisReply
    ids: dict[str, str]
    doubles: dict[str, str]


def noised_analysis(
    reply: AnalysisReply, strength: Strength, draws: Draws, errors: Errors | None = None
) -> NoisyAnalysis:
    """The first answer of a weaker model. `reply.objects` must have unique ids.

    Args:
        errors: the picture's common errors, when they are drawn already.
    """
    errors = errors or Errors.of(reply, strength, draws)
    kept = [o for o in reply.objects if not overlooked(o, strength, draws)]
    items: list[ObjectReply] = []
    for item in kept:
        items.append(noised_object(item, strength, draws, errors, "first"))
        if draws.share("double", item.id) < strength.double:
            items.append(noised_object(item, strength, draws, errors, "again").model_copy(update={"id": item.id + "*"}))
    architecture = [
        noised_architecture(a, strength, draws, errors)
        for a in reply.architecture
        if draws.share("drop", "architecture", a.id) >= strength.drop / 2
    ]
    taken = {a.id for a in architecture}
    names = {o.id: o.id if strength == NONE else new_id(o.category, taken) for o in items}
    ids = {o.id: names[o.id] for o in kept}
    known = {*ids, *(a.id for a in architecture), "left", "right", "top", "bottom"}
    gone = {o.id for o in reply.objects} - set(ids) | {a.id for a in reply.architecture} - known
    renamed = [
        o.model_copy(
            update={"id": names[o.id], "parent": None if o.parent in gone else ids.get(o.parent or "", o.parent)}
        )
        for o in items
    ]
    update: dict[str, object] = {
        "room_width_m": reply.room_width_m * errors.metres[0],
        "room_depth_m": reply.room_depth_m * errors.metres[1],
        "wall_height_m": reply.wall_height_m * math.exp(strength.height / 2 * draws.normal("walls")),
        "architecture": architecture,
        "objects": renamed,
        **_outlines(reply, strength, draws, errors),
    }
    doubles = {o.id[:-1]: names[o.id] for o in items if o.id not in ids}
    return NoisyAnalysis(reply.model_copy(update=update), ids, doubles)


def overlooked(item: ObjectReply, strength: Strength, draws: Draws) -> bool:
    """Whether the first look overlooks this thing; the smaller, the likelier."""
    area = max(1e-5, abs((item.box.x_max - item.box.x_min) * (item.box.y_max - item.box.y_min)) / 1e6)
    chance = strength.drop * max(0.3, min(2.5, (area / 0.01) ** -0.35))
    return bool(draws.share("drop", item.id) < chance)


def noised_object(
    item: ObjectReply, strength: Strength, draws: Draws, errors: Errors, look: str, zoom: float = 1.0
) -> ObjectReply:
    """One thing as a weaker model sees it; id and parent stay true, but for a parent that is not said.

    Args:
        look: names the answer; boxes and metres err anew in each, what is grossly mistaken stays so.
        zoom: factor on the errors of the box.
    """
    turned = _turned(item, strength, draws)
    base = item.base_m
    if base > 0.02:
        base = max(0.0, _stepped(base + strength.base * draws.error(look, "base", item.id), strength.step / 2))
    orphan = item.parent is not None and draws.share("orphan", item.id) < strength.orphan
    update: dict[str, object] = {
        "box": noised_box(item.box, item.id, strength, draws, errors, look, zoom),
        "centre_m": noised_centre(item.centre_m, item.id, strength, draws, errors, look),
        "size_m": noised_size(turned.size_m, item.id, strength, draws, errors, look),
        "base_m": base,
        "category": confused(item.category, draws.share("which", item.id))
        if draws.share("confuse", item.id) < strength.confuse
        else item.category,
        "parent": None if orphan else item.parent,
    }
    return turned.model_copy(update=update)


def noised_box(
    box: BoxReply, name: str, strength: Strength, draws: Draws, errors: Errors, look: str, zoom: float = 1.0
) -> BoxReply:
    """A box whose edges err each by itself, and all together with whatever else is read off the picture."""
    spans = {"x": abs(box.x_max - box.x_min), "y": abs(box.y_max - box.y_min)}
    values = {}
    for edge, error in draws.edges(look, name).items():
        sigma = zoom * (strength.edge + strength.edge_share * spans[edge[0]])
        values[edge] = getattr(box, edge) + sigma * error
    low, high = errors.read(values["x_min"], values["y_min"]), errors.read(values["x_max"], values["y_max"])
    result = [_stepped(v, strength.grid) for v in (*low, *high)]
    if strength != NONE:
        for axis in (0, 1):
            # A thing that was seen has an extent, however badly it is measured.
            a, b = sorted((result[axis], result[axis + 2]))
            least = max(3.0, strength.grid)
            result[axis], result[axis + 2] = (a, b) if b - a >= least else ((a + b - least) / 2, (a + b + least) / 2)
    return BoxReply(x_min=result[0], y_min=result[1], x_max=result[2], y_max=result[3])


def noised_centre(
    centre: MetresReply, name: str, strength: Strength, draws: Draws, errors: Errors, look: str
) -> MetresReply:
    """A place in metres: in a room of another size, drawn to its middle, and off by itself."""
    sigma, edges = strength.place * errors.mean_side, draws.edges(look, name)
    # Down in the picture is back in the room.
    moved = {
        axis: sign * (edges[f"{axis}_min"] + edges[f"{axis}_max"]) / math.sqrt(2)
        for axis, sign in (("x", 1), ("y", -1))
    }
    x, y = (
        _stepped(
            v * g * (1 - strength.pull) + sigma * alike(draws.error(look, "place", axis, name), moved[axis]),
            strength.step,
        )
        for axis, v, g in zip("xy", (centre.x_m, centre.y_m), errors.metres, strict=True)
    )
    return MetresReply(x_m=x, y_m=y)


def noised_size(size: SizeReply, name: str, strength: Strength, draws: Draws, errors: Errors, look: str) -> SizeReply:
    """A size in metres: half of the room's scale error, one of the thing as a whole, and one of each side."""
    edges = draws.edges(look, name)
    grown = (edges["x_max"] - edges["x_min"] + edges["y_max"] - edges["y_min"]) / 2
    whole = strength.size * alike(draws.error(look, "size", name), grown)
    shared = (errors.metres[0] * errors.metres[1]) ** 0.25 * math.exp(whole)
    width, depth = (
        v * shared * math.exp(strength.side * draws.error(look, "side", side, name))
        for side, v in (("width", size.width), ("depth", size.depth))
    )
    height = size.height * math.exp(strength.height * draws.error(look, "height", name))
    return SizeReply(width=width, depth=depth, height=height)


def noised_architecture(item: ArchitectureReply, strength: Strength, draws: Draws, errors: Errors) -> ArchitectureReply:
    """A door, window or partition whose ends are where a weaker model puts them."""
    start = noised_centre(item.start, item.id + "/start", strength, draws, errors, "first")
    end = noised_centre(item.end, item.id + "/end", strength, draws, errors, "first")
    box = None if item.box is None else noised_box(item.box, item.id, strength, draws, errors, "first")
    return item.model_copy(update={"start": start, "end": end, "box": box})


def new_id(category: str, taken: set[str]) -> str:
    """The next free id of the form that models give; it is added to `taken`."""
    name = next(n for k in range(1, 1000) if (n := clean_id(f"{category}_{k}", set(), "thing")) not in taken)
    taken.add(name)
    return name


def turned_words(text: str, quarters: int) -> str:
    """A text with its directions turned counter-clockwise: a mistaken front is explained as it was mistaken."""
    found: dict[str, str] = {}
    for word, ring, i in _TURNS:
        found.setdefault(word, ring[(i + quarters) % 4])
    if quarters % 4 == 0:
        return text
    return re.sub(rf"\b({'|'.join(found)})\b", lambda match: found[match.group(1)], text)


def facing_of(yaw: float) -> Facing:
    """The word for a yaw in degrees, the nearest of the eight."""
    word = min(FACING_YAW, key=lambda name: abs((FACING_YAW[name] - yaw + 180) % 360 - 180))
    return word  # type: ignore[return-value]


def _turned(item: ObjectReply, strength: Strength, draws: Draws) -> ObjectReply:
    """The thing with the front that a weaker model takes for its front. What has none is only straightened."""
    update: dict[str, object] = {}
    yaw = item.yaw_deg
    straight = round(yaw / 90) * 90.0
    if abs(yaw - straight) > 1 and draws.share("snap", item.id) < strength.snap:
        yaw = straight % 360
    quarters = 0
    if item.facing != "none" and draws.share("turn", item.id) < strength.turn:
        quarters = (1, 3, 1, 3, 2, 2, 2)[draws.pick(7, "side", item.id)]
        yaw = (yaw + 90 * quarters) % 360
        # Half of those who mistake a side face give the sides as the picture shows them, so the footprint stays.
        if quarters != 2 and draws.share("sides", item.id) < 0.5:
            size = item.size_m
            update["size_m"] = SizeReply(width=size.depth, depth=size.width, height=size.height)
    if yaw == item.yaw_deg:
        return item
    if item.facing != "none":
        update["facing"] = facing_of(yaw)
    words = getattr(item, "front", "")
    if words:
        update["front"] = turned_words(words, quarters)
    return item.model_copy(update={"yaw_deg": yaw, **update})


def _outlines(reply: AnalysisReply, strength: Strength, draws: Draws, errors: Errors) -> dict[str, object]:
    """The floor's corners and the walls' upper ones."""
    floor, tops = reply.floor_polygon, reply.wall_top_polygon
    if len(floor) > 4 and draws.share("corners") < strength.corners_lost:
        floor, tops = _rectangle(floor), None if tops is None else _rectangle(tops)
    if draws.share("tops") < strength.tops_lost:
        tops = None
    return {
        "floor_polygon": _corners(floor, "floor", strength, draws, errors),
        "wall_top_polygon": None if tops is None else _corners(tops, "top", strength, draws, errors),
    }


def _corners(points: list[PointReply], name: str, strength: Strength, draws: Draws, errors: Errors) -> list[PointReply]:
    moved = []
    for n, point in enumerate(points):
        x, y = errors.read(
            point.x + strength.corner * draws.normal("corner", name, n, "x"),
            point.y + strength.corner * draws.normal("corner", name, n, "y"),
        )
        moved.append(PointReply(x=_stepped(x, strength.grid), y=_stepped(y, strength.grid)))
    return moved


def _rectangle(points: list[PointReply]) -> list[PointReply]:
    xs, ys = [p.x for p in points], [p.y for p in points]
    corners = ((min(xs), max(ys)), (max(xs), max(ys)), (max(xs), min(ys)), (min(xs), min(ys)))
    return [PointReply(x=x, y=y) for x, y in corners]


def _stepped(value: float, step: float) -> float:
    return value if step <= 0 else round(round(value / step) * step, 6)
