# SPDX-License-Identifier: GPL-3.0-or-later
"""From a model's text to a validated reply: tolerant reading, safe corrections, pydantic, problems in words."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from ..errors import ReplyError
from .repair import repair_reply
from .tolerant import read_json_noted

_Reply = TypeVar("_Reply", bound=BaseModel)
_MOST_PROBLEMS = 15
Location = tuple[int | str, ...]


Mend = Callable[[Any], tuple[Any, tuple[str, ...]]]


def validate_reply(
    text: str, model: type[_Reply], salvage: bool = False, mend: Mend | None = None
) -> tuple[_Reply, tuple[str, ...]]:
    """Read a model's answer as `model`.

    Args:
        salvage: leave out list entries that stay invalid (at most a quarter of a list, never all of it) rather than
            refuse the whole answer; each one is reported.
        mend: changes what was read before it is judged, and says what it changed.

    Returns:
        The reply and sentences on everything that was forgiven, corrected or left out.

    Raises:
        CutReplyError, ReplyError: the answer cannot be used; `problems` says why in words a model understands.
    """
    data, read_notes = read_json_noted(text)
    if mend is not None:
        data, changed = mend(data)
        read_notes = (*read_notes, *changed)
    data, mend_notes = repair_reply(data, model)
    notes = (*read_notes, *mend_notes)
    try:
        return _finite(model.model_validate(data)), notes
    except ValidationError as error:
        failure = error
    if salvage:
        rest, dropped = _without_bad_entries(data, [detail["loc"] for detail in failure.errors(include_url=False)])
        if dropped:
            try:
                return _finite(model.model_validate(rest)), (*notes, *dropped)
            except ValidationError:
                pass
    problems = _problems(failure)
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    raise ReplyError(f"The model's answer does not fit: {problems[0]}{more}.", "Run the stage again.", problems)


def _finite(reply: _Reply) -> _Reply:
    """The reply, once it is known that all of its numbers are finite.

    Raises:
        ReplyError: one is not; places where the repair does not look are the only ones where this can be.
    """
    place = next(_not_finite(reply.model_dump(), ()), None)
    if place is not None:
        problem = f"{_path(place, exact=True) or 'the answer'}: Input should be a finite number"
        raise ReplyError(f"The model's answer does not fit: {problem}.", "Run the stage again.", (problem,))
    return reply


def _not_finite(value: Any, place: Location) -> Iterator[Location]:
    if isinstance(value, float) and not math.isfinite(value):
        yield place
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _not_finite(item, (*place, str(key)))
    elif isinstance(value, (list, tuple)):
        for number, item in enumerate(value):
            yield from _not_finite(item, (*place, number))


def _problems(error: ValidationError) -> tuple[str, ...]:
    """The validation errors as short lines, alike ones together, at most fifteen."""
    first: dict[tuple[str, str], str] = {}
    count: dict[tuple[str, str], int] = {}
    for detail in error.errors(include_url=False, include_context=False):
        message = detail["msg"]
        kind = (_path(detail["loc"], exact=False), message)
        given = detail.get("input")
        shown = f", not {str(given)[:40]!r}" if isinstance(given, (str, int, float)) else ""
        first.setdefault(kind, f"{_path(detail['loc'], exact=True) or 'the answer'}: {message}{shown}")
        count[kind] = count.get(kind, 0) + 1
    more = {kind: f" (and {number - 1} more like it)" for kind, number in count.items() if number > 1}
    lines = [text + more.get(kind, "") for kind, text in first.items()]
    if len(lines) > _MOST_PROBLEMS:
        lines = [*lines[: _MOST_PROBLEMS - 1], f"and {len(lines) - _MOST_PROBLEMS + 1} more problems"]
    return tuple(lines)


def _path(location: Location, exact: bool) -> str:
    """A location in words, such as `objects[3].size[0]`; indices left blank unless `exact`."""
    text = ""
    for part in location:
        if isinstance(part, int):
            text += f"[{part}]" if exact else "[]"
        else:
            text += f".{part}" if text else part
    return text


def _without_bad_entries(data: Any, locations: list[Location]) -> tuple[Any, tuple[str, ...]]:
    """`data` without the list entries (objects only) that hold the errors; empty notes when that is not allowed."""
    doomed: dict[Location, set[int]] = {}
    for location in locations:
        entry = _entry_of(data, location)
        if entry is None:
            return data, ()
        doomed.setdefault(entry[:-1], set()).add(int(entry[-1]))
    notes: list[str] = []
    # Inner lists first, so that indices on the way to them still hold.
    for place in sorted(doomed, key=len, reverse=True):
        entries = _at(data, place)
        bad = doomed[place]
        if len(bad) > max(1, len(entries) // 4) or len(bad) == len(entries):
            return data, ()
        names = [str(entries[index].get("id", index))[:40] for index in sorted(bad)]
        notes.append(f"{_path(place, exact=True)}: left out, since they stayed invalid: {', '.join(names)}")
        data = _replaced(data, place, [value for index, value in enumerate(entries) if index not in bad])
    return data, tuple(notes)


def _entry_of(data: Any, location: Location) -> Location | None:
    """The innermost list entry, itself an object, on the way to a location."""
    found: Location | None = None
    here = data
    for step, part in enumerate(location):
        if isinstance(part, int) and isinstance(here, list) and part < len(here):
            here = here[part]
            if isinstance(here, dict):
                found = location[: step + 1]
        elif isinstance(here, dict) and part in here:
            here = here[part]
        else:
            break
    return found


def _at(data: Any, place: Location) -> Any:
    for part in place:
        data = data[part]
    return data


def _replaced(data: Any, place: Location, value: Any) -> Any:
    """A copy of `data` along `place` with `value` put there."""
    if not place:
        return value
    copy: Any = list(data) if isinstance(data, list) else dict(data)
    copy[place[0]] = _replaced(data[place[0]], place[1:], value)
    return copy
