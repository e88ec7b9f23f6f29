# SPDX-License-Identifier: GPL-3.0-or-later
"""One object's program in stage 6, from what the model wrote first to what the room takes over."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..artifacts.layout import ProxyLine
from ..artifacts.objects import ProgramReply
from ..errors import ProgramError
from ..objects.checks import check
from ..objects.detailing import Detailing
from ..objects.mending import mended
from ..objects.written import STRETCH, Written, take_program

_BETTER = 0.02


class OnItsWay:
    """One object's program on its way.

    Attributes:
        made: the best version that can be used so far; problem: why the last one could not be.
    """

    def __init__(self, proxy: ProxyLine, reply: ProgramReply | None) -> None:
        self.proxy = proxy
        self.source = reply.program.strip() if reply is not None else ""
        self.made: Written | None = None
        self.problem = ""
        self.render = b""

    @property
    def written_by_model(self) -> bool:
        """Whether there is anything to mend."""
        return bool(self.source)

    def take(self, detailing: Detailing, stretch: float = STRETCH) -> None:
        """Evaluate and check what was written."""
        if self.source:
            self.made, self.problem, self.source = self._evaluated(detailing, self.source, stretch)

    def mend(self, detailing: Detailing, reply: ProgramReply | None) -> None:
        """Take a correction where it is better by the checks, or as good: it was written after a look."""
        if reply is None or reply.keep or not reply.program.strip():
            return
        made, problem, _ = self._evaluated(detailing, reply.program)
        if made is None:
            self.problem = self.problem or problem
        elif self.made is None or made.checked.penalty <= self.made.checked.penalty + _BETTER:
            self.made, self.problem = made, ""

    def keep(self, detailing: Detailing) -> None:
        """Hand over what can be used; the library's piece stays where nothing can."""
        identifier = self.proxy.id
        if self.made is not None and self.made.checked.penalty < 1.0:
            detailing.written[identifier] = self.made
            return
        worst = self.problem or (self.made.checked.findings[0] if self.made is not None else "none was written")
        detailing.notes[identifier] = (
            f"Its program could not be used ({worst[:160].rstrip('.')}); a library piece is there."
        )

    def keep_drafted(self, detailing: Detailing) -> None:
        """Hand over what a draft has, unless it is of no use even when it is fitted into its box."""
        made = self.made
        if made is not None and made.checked.penalty >= 1.0:
            fitted = check(made.shapes, self.proxy.size, self.proxy.placement)
            self.made = replace(made, checked=fitted)
        self.keep(detailing)

    def _evaluated(
        self, detailing: Detailing, source: str, stretch: float = STRETCH
    ) -> tuple[Written | None, str, str]:
        """What the program makes, or why it cannot be used; and the program itself, rewritten where it had to be."""
        name = detailing.names[self.proxy.id]
        taken = {*detailing.standing.defs, *(n for i, n in detailing.names.items() if i != self.proxy.id)}
        try:
            return take_program(source, self.proxy, name, taken, stretch), "", source
        except ProgramError as error:
            problem = str(error)
        try:
            rewritten = mended(source)
            if rewritten is None:
                return None, problem, source
            source = rewritten
            return take_program(source, self.proxy, name, taken, stretch), "", source
        except ProgramError as error:
            return None, str(error), source

    def told(self, facts: Sequence[str]) -> str:
        """The program, what it is to look like, and what is wrong with it, for the second round."""
        checked = self.made.checked.findings if self.made is not None else (self.problem,)
        wrong = "\n".join(f"- {sentence}" for sentence in checked if sentence) or "- nothing was measured to be wrong"
        box = f"{self.proxy.id}, box {' x '.join(f'{v:.2f}' for v in self.proxy.size)}"
        return f"{'; '.join((box, *facts))}\n{wrong}\n```\n{self.source}\n```"
