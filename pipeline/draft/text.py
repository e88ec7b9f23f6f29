# SPDX-License-Identifier: GPL-3.0-or-later
"""The room text of a draft, or of as much of it as there is: what the scene shows while it is written."""

from __future__ import annotations

import re
from collections.abc import Mapping

from ..artifacts.analysis import ArchitectureItem, Calibration, SceneAnalysis
from ..artifacts.common import ImagePoint
from ..artifacts.layout import CameraLine, Layout, ProxyLine
from ..errors import ProgramError, RoomError
from ..geometry.camera import camera_straight_down
from ..layout.walls import shell
from ..objects.cloths import furnish_line
from ..objects.text import compose, function_name, read_modelling
from ..program import finishes
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout
from ..program.prelude.registry import RESERVED
from .reading import Draft, proxy_line
from .things import Fixed, RoomSaid, Thing

_MARGIN = 0.3
_TRIES = 12


def room_text(draft: Draft, camera: CameraLine | None = None) -> str:
    """The room as it is by now; "" while there is nothing of which a room could be made. It can always be evaluated."""
    room = draft.room or room_of(draft)
    if room is None:
        return ""
    layout = layout_of(draft, room, camera)
    left_out: set[str] = set()
    for _ in range(_TRIES):
        text = _composed(draft, layout, left_out)
        try:
            evaluate(text, FINISHED_ROOM_LIMITS)
            parse_layout(text)
            return text
        except ProgramError as error:
            culprit = _culprit(text, error.line, set(draft.made) | set(draft.pieces), left_out)
            if culprit is None:
                break
            left_out.add(culprit)
    bare = _composed(draft, layout, {*draft.made, *draft.pieces}, False)
    try:
        evaluate(bare, FINISHED_ROOM_LIMITS)
    except ProgramError:
        return ""
    return bare


def _culprit(text: str, line: int, furnished: set[str], gone: set[str]) -> str | None:
    """The object in whose def or statement a line of the text is; else any that is furnished."""
    rows = text.split("\n")[: max(0, line)]
    for row in reversed(rows):
        if match := re.match(r"furnish\(\"([^\"]+)\"", row):
            return match.group(1) if match.group(1) not in gone else None
        if match := re.match(r"def (\w+)", row):
            name = match.group(1)
            found = [
                i for i in sorted(furnished - gone, key=len, reverse=True) if name.startswith(function_name(i, ()))
            ]
            if found:
                return found[0]
            break
    return max(furnished - gone, default=None)


def layout_of(draft: Draft, room: RoomSaid, camera: CameraLine | None = None) -> Layout:
    """The lines of the room language that the draft's lines mean."""
    height = room.size[2]
    analysis = SceneAnalysis(
        image_size=(1000, 1000),
        view="orthographic",
        room_size=room.size,
        floor=list(room.floor),
        floor_polygon=[ImagePoint(x=0, y=0)],
        architecture=[_item(f) for f in draft.fixed.values()],
    )
    over = camera_straight_down("orthographic", room.size[0], room.size[1], (1000, 1000), margin=0.1)
    standing = Calibration(camera=over, floor=list(room.floor), height=height, error_px=0.0, scale_source="model")
    line, walls, doors, windows, openings, _ = shell(analysis, standing)
    taken = {w.id for w in walls} | {w.id for w in doors} | {w.id for w in windows} | {w.id for w in openings}
    things = [proxy_line(t) for t in draft.things.values() if t.id not in taken]
    proxies = _with_parents(things, taken)
    return Layout(
        room=line,
        walls=walls,
        doors=doors,
        windows=windows,
        openings=openings,
        proxies=proxies,
        cameras=[camera] if camera else [],
    )


def _item(fixed: Fixed) -> ArchitectureItem:
    return ArchitectureItem.model_validate(
        {
            "id": fixed.id,
            "kind": fixed.kind,
            "start": fixed.start,
            "end": fixed.end,
            "height": fixed.height,
            "sill": fixed.sill,
            "thickness": fixed.thickness,
            "wall": fixed.wall,
            "swing": fixed.swing,
        }
    )


def _with_parents(proxies: list[ProxyLine], fixed: set[str]) -> list[ProxyLine]:
    """Proxies whose parents are there, and run in no circle."""
    by_id = {p.id: p for p in proxies}
    found = []
    for proxy in proxies:
        seen, at = {proxy.id}, proxy.parent
        while at in by_id and at not in seen:
            seen.add(at)
            at = by_id[at].parent
        sound = (
            proxy.parent is not None
            and (at is None or at not in seen)
            and (proxy.parent in by_id or proxy.parent in fixed)
        )
        found.append(proxy if sound or proxy.parent is None else proxy.model_copy(update={"parent": None}))
        by_id[proxy.id] = found[-1]
    return found


def _composed(draft: Draft, layout: Layout, left_out: set[str], looks: bool = True) -> str:
    defs: dict[str, str] = {}
    statements: dict[str, str] = {}
    others: list[str] = []
    for proxy in layout.proxies:
        thing = draft.things[proxy.id]
        name = _furnished(draft, thing, defs, others, left_out)
        if name:
            statements[proxy.id] = furnish_line(proxy, name)
    text = compose(layout, defs, statements, list(dict.fromkeys(others)))
    if not looks:
        return text
    try:
        return finishes.with_materials(text, _materials(draft, layout, statements, text))
    except RoomError:
        return text


def _furnished(draft: Draft, thing: Thing, defs: dict[str, str], others: list[str], left_out: set[str]) -> str:
    """The name of the def that a thing is furnished with; its text goes to `defs`. "" where it stays a box."""
    if thing.id in left_out:
        return ""
    first = draft.first_of(thing)
    like = first if first in draft.made and first not in left_out and thing.id in draft.made else thing.id
    name = function_name(like, ())
    if like in draft.made:
        code = read_modelling(draft.made[like].written.code)
        defs.update(code.defs)
        others += code.others
        return name
    if thing.id in draft.pieces:
        defs[name] = draft.pieces[thing.id].text(name, thing.label or thing.category.replace("_", " "))
        return name
    return ""


def _materials(draft: Draft, layout: Layout, furnished: Mapping[str, str], text: str) -> finishes.Materials:
    """The draft's looks, named, and what has them."""
    found = finishes.Materials()
    taken = set(re.findall(r"[A-Za-z_]\w*", text))
    names: dict[str, str] = {}

    def named(expression: str) -> str:
        key = draft.palette.look(expression).key
        if key not in names:
            base = draft.palette.named_as(key) or key.partition("(")[0]
            name, number = base, 1
            while name in RESERVED or name in taken or name in names.values():
                number += 1
                name = f"{base}_{number}" if number > 2 or base not in RESERVED else f"{base}_1"
            names[key] = name
        return names[key]

    present = finishes.present_names(layout)
    for identifier in furnished:
        made = draft.made.get(identifier)
        if made is None:
            continue
        own = {s.material for s in made.written.shapes}
        pairs = {m: named(e) for m, e in draft.palette.roles.items() if m in own}
        said = {key: named(e) for key, e in draft.finishes.get(identifier, {}).items()}
        if pairs or said:
            found.finishes[identifier] = {**pairs, **said}
    for identifier, looks in draft.finishes.items():
        if identifier in present and identifier not in found.finishes and identifier not in draft.things:
            found.finishes[identifier] = {key: named(e) for key, e in looks.items()}
    found.looks = {name: key for key, name in names.items()}
    return found


def room_of(draft: Draft) -> RoomSaid | None:
    """A room line for a draft that has none: round its walls, else round its things; None where there is neither."""
    points = [p for f in [*draft.outer, *draft.fixed.values()] for p in (f.start, f.end)]
    margin = 0.0
    if len(points) < 3:
        margin = _MARGIN
        points += [
            (t.at[0] + a * t.size[0] / 2, t.at[1] + b * t.size[1] / 2)
            for t in draft.things.values()
            for a in (-1, 1)
            for b in (-1, 1)
        ]
    if not points:
        return None
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    x0, x1, y0, y1 = min(xs) - margin, max(xs) + margin, min(ys) - margin, max(ys) + margin
    if x1 - x0 < 0.5:
        x0, x1 = x0 - 1.0, x1 + 1.0
    if y1 - y0 < 0.5:
        y0, y1 = y0 - 1.0, y1 + 1.0
    height = max([2.6, *(f.height for f in draft.outer)])
    return RoomSaid((x1 - x0, y1 - y0, min(8.0, height)), ((x0, y0), (x1, y0), (x1, y1), (x0, y1)))
