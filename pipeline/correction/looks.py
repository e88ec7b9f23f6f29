# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of objects that no look covers, and looks that show an image which does not exist. Both are mended in the text."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from typing import Any

from ..program.finishes import finished
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import called_name, quoted
from ..program.parse_safe import parse
from ..program.prelude.dressing import look_of_role, usual_look
from ..program.prelude.looks import Look
from ..program.prelude.maps import Map
from ..program.prelude.palette import FAMILY_COLOURS, ROLE_COLOURS, category_family, split_role
from ..program.prelude.record import Record
from ..program.prelude.shape import Shape
from .faults import Fault

_PLAIN = "#A9A39B"
Change = tuple[int, int, str]
"""Replace the bytes from the first to before the second by a text."""


def find_bare_parts(record: Record) -> list[Fault]:
    """Furnished parts that neither a finish nor their material role says anything of."""
    found: dict[tuple[str, str], Fault] = {}
    for line in record.proxies:
        for shape in record.furnished.get(line["id"], ()):
            if shape.vertex_count and _is_bare(shape, record, line):
                name = shape.part or shape.material
                said = f"Its part {name!r} has no material." if name else "A part of it has no material."
                found[line["id"], name] = Fault("material", line["id"], name, 1.0, said)
    return list(found.values())


def _is_bare(shape: Shape, record: Record, line: dict[str, Any]) -> bool:
    finish = record.finishes.get(line["id"])
    if finish is not None and look_of_role(shape.material, [finish], shape.part) is not None:
        return False
    role, code = split_role(shape.material)
    return (
        not code and role not in ROLE_COLOURS and usual_look(shape.material, category_family(line["category"])) is None
    )


def find_lost_pictures(record: Record, pictures: frozenset[str] | None) -> list[Fault]:
    """Finishes that show an image whose name is not among those that exist; nothing where these are not known."""
    if pictures is None:
        return []
    found: dict[tuple[str, str], Fault] = {}
    for identifier, looks in record.finishes.items():
        for look in looks.values():
            for name in _pictures(value for _, value in look.inputs):
                if name not in pictures:
                    said = f"It shows the image {name!r}, which does not exist."
                    found[identifier, name] = Fault("picture", identifier, name, 1.0, said)
    return list(found.values())


def pictures_of(record: Record) -> frozenset[str]:
    """Names of all images that the finishes of a room show."""
    looks = [look for finish in record.finishes.values() for look in finish.values()]
    return frozenset(_pictures(value for look in looks for _, value in look.inputs))


def _pictures(values: Iterable[Any]) -> Iterator[str]:
    """Names of images in values and the maps that these are made of."""
    for value in values:
        if isinstance(value, Map):
            if value.kind == "picture":
                yield str(value["name"])
            yield from _pictures(inner for _, inner in value.values)
        elif isinstance(value, (tuple, list)):
            yield from _pictures(value)


def mend_bare_part(text: str, record: Record, fault: Fault) -> tuple[str, str] | None:
    """The text with a look for this part, and how that look is written; None where the text has no place for it."""
    look = _look_for(record, fault)
    tree = parse(text, FINISHED_ROOM_LIMITS)
    entry = f"{quoted(fault.other)}: {look.key}"
    for node in tree.body:
        if finished(node) != fault.id or not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Call):
            continue
        given = [*node.value.args[1:], *(k.value for k in node.value.keywords if k.arg == "looks")]
        if len(given) != 1 or not isinstance(given[0], ast.Dict) or not given[0].values:
            return None
        end = _span(text, given[0].values[-1])[1]
        return _changed(text, [(end, end, f", {entry}")]), look.key
    for node in tree.body:
        if called_name(node) == "build":
            start = _span(text, node)[0]
            return _changed(text, [(start, start, f"finish({quoted(fault.id)}, {{{entry}}})\n")]), look.key
    return None


def _look_for(record: Record, fault: Fault) -> Look:
    """What most of the object looks like, else what things of its family usually do."""
    line = next(p for p in record.proxies if p["id"] == fault.id)
    finish = record.finishes.get(fault.id, {})
    sizes: dict[Look, int] = {}
    for shape in record.furnished[fault.id]:
        look = look_of_role(shape.material, [finish], shape.part)
        if look is not None:
            sizes[look] = sizes.get(look, 0) + shape.vertex_count
    if sizes:
        return max(sizes, key=lambda look: (sizes[look], look.key))
    family = category_family(line["category"])
    found = usual_look(f"#{FAMILY_COLOURS[family]}", family)
    assert found is not None
    return found


def mend_lost_picture(text: str, record: Record, fault: Fault) -> tuple[str, str] | None:
    """The text with a plain colour in the place of an image that does not exist; None where it is not written plainly."""
    line = next((p for p in record.proxies if p["id"] == fault.id), None)
    colour = f"#{FAMILY_COLOURS[category_family(line['category'])]}" if line is not None else _PLAIN
    calls = [
        node
        for node in ast.walk(parse(text, FINISHED_ROOM_LIMITS))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "picture"
        and fault.other in (a.value for a in [*node.args[:1], *(k.value for k in node.keywords if k.arg == "name")]
                            if isinstance(a, ast.Constant))
    ]  # fmt: skip
    if not calls:
        return None
    return _changed(text, [(*_span(text, call), quoted(colour)) for call in calls]), colour


def _span(text: str, node: ast.stmt | ast.expr) -> tuple[int, int]:
    """First byte of a node in the text as UTF-8, and the one after its last."""
    starts = [0]
    for line in text.encode().splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    end = starts[(node.end_lineno or node.lineno) - 1] + (node.end_col_offset or 0)
    return starts[node.lineno - 1] + node.col_offset, end


def _changed(text: str, changes: list[Change]) -> str:
    data = text.encode()
    for start, end, new in sorted(changes, reverse=True):
        data = data[:start] + new.encode() + data[end:]
    return data.decode()
