# SPDX-License-Identifier: GPL-3.0-or-later
"""Each statement of a draft is read once, whoever hears of it first: the room that grows, or the stage at its end.

Reading evaluates the programs, which is nearly all that a draft costs. So a growth keeps what it reads where the stage
finds it by the statements themselves, goes on from there, and leaves it where the stages after it look.
"""

from __future__ import annotations

import threading
import weakref
from collections import OrderedDict
from collections.abc import Sequence

from ..errors import ProgramError
from ..program.limits import DEFAULT_LIMITS
from ..program.parse_safe import parse
from .reading import Draft, read
from .statements import Split, Statement, is_prose, split

_MOST_KEPT = 2


class Reading:
    """One answer while it is read. Any thread; nobody looks into `draft` but with `lock`.

    Attributes:
        draft: what was read so far. changes: how often the room has changed by it.
    """

    def __init__(self) -> None:
        self.draft = Draft()
        self.lock = threading.RLock()
        self.changes = 0
        self._taken: list[Statement] = []

    def fits(self, statements: Sequence[Statement]) -> bool:
        """Whether these statements and those that were read are the beginning of one and the same answer."""
        return all(_same(a, b) for a, b in zip(self._taken, _said(statements), strict=False))

    @property
    def count(self) -> int:
        """How many statements were read."""
        return len(self._taken)

    def go_on(self, statements: Sequence[Statement]) -> None:
        """Read those that were not read yet. Two threads may do so; they take turns by the statement."""
        for number, statement in enumerate(_said(statements)):
            with self.lock:
                if number >= len(self._taken):
                    self.changes += self.draft.take(statement)
                    self._taken.append(statement)

    def amend(self, texts: Sequence[str]) -> None:
        """Take what was asked again, and end."""
        with self.lock:
            for text in texts:
                self.draft.amend(split(text).statements)
            self.draft.close()
            self.changes += 1


_growing: weakref.WeakSet[Reading] = weakref.WeakSet()
_kept: OrderedDict[tuple[str, tuple[str, ...]], tuple[Draft, str]] = OrderedDict()
_lock = threading.Lock()


def begin() -> Reading:
    """A reading that a stage can go on with, for as long as somebody holds it."""
    reading = Reading()
    with _lock:
        _growing.add(reading)
    return reading


def taken_over(statements: Sequence[Statement]) -> Reading:
    """The reading that has come furthest with this answer, for the caller only; a new one where there is none."""
    with _lock:
        found = max((r for r in _growing if r.count and r.fits(statements)), key=lambda r: r.count, default=None)
        if found is None or found.count > len(_said(statements)):
            return Reading()
        _growing.discard(found)
        return found


def keep(text: str, amended: Sequence[str], draft: Draft, style: str) -> None:
    """Leave a draft that was read to its end for `read_again`."""
    with _lock:
        _kept[text, tuple(amended)] = draft, style
        while len(_kept) > _MOST_KEPT:
            _kept.popitem(last=False)


def read_text(text: str, amended: Sequence[str]) -> tuple[Draft, str]:
    """An answer, what was asked again, and the room's style in its words; every question of every stage needs it."""
    key = text, tuple(amended)
    with _lock:
        if key in _kept:
            _kept.move_to_end(key)
            return _kept[key]
    written: Split = split(text)
    again = [statement for one in amended for statement in split(one).statements]
    draft = read(written.statements, again)
    keep(text, amended, draft, written.style)
    return draft, written.style


def _said(statements: Sequence[Statement]) -> list[Statement]:
    """Those that are more than sentences, which are not looked at while an answer is still written."""
    return [statement for statement in statements if not is_prose(statement.text) or _is_python(statement.text)]


def _is_python(text: str) -> bool:
    try:
        parse(text, DEFAULT_LIMITS)
    except ProgramError:
        return False
    return True


def _same(a: Statement, b: Statement) -> bool:
    return (a.text, a.first) == (b.text, b.first)
