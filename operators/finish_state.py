# SPDX-License-Identifier: GPL-3.0-or-later
"""Works out what the panel shows of the light and of what was corrected, with the rest of the room's state."""

from __future__ import annotations

from collections.abc import Mapping

from ..pipeline.artifacts.correction import CorrectionReport, Fix
from ..pipeline.artifacts.light import LightPlan
from ..pipeline.memory import Memory
from ..pipeline.stages.s10_finish import CORRECTIONS_OFF
from .finish_rows import FinishState, FixRow

_PLACES = ("outside", "blocked", "overlap", "support", "coincident")


def read(memory: Memory, titles: Mapping[str, str]) -> FinishState:
    """Light and corrections as memory has them.

    Args:
        titles: of the objects, by what they are called in the layout.
    """
    plan, report = memory.latest(LightPlan), memory.latest(CorrectionReport)
    if plan is None or report is None:
        return FinishState()
    said = set(memory.settings.get(CORRECTIONS_OFF, "").split(",")) - {""}
    fixes = tuple(_fix(fix, titles, said) for fix in report.fixes)
    left = tuple(f"{titles.get(f.about, f.about)}: {f.message}" for f in report.left)
    kinds = {word for word in said if ":" not in word}
    waits = any(row.spared for row in fixes) or kinds != set(report.off)
    return FinishState(True, _light(plan, titles), fixes, left, waits)


def _fix(fix: Fix, titles: Mapping[str, str], said: set[str]) -> FixRow:
    key = f"{fix.kind}:{fix.id}"
    if fix.kind in _PLACES:
        change = f"{100 * fix.amount:.0f} cm" if fix.amount >= 0.01 else f"{1000 * fix.amount:.0f} mm"
    else:
        change = f"{fix.before} to {fix.after}" if fix.before and len(fix.before + fix.after) < 60 else ""
    return FixRow(key, fix.id, titles.get(fix.id, fix.id), fix.message, change, key in said or fix.kind in said)


def _light(plan: LightPlan, titles: Mapping[str, str]) -> tuple[str, ...]:
    """The light in a few sentences."""
    lamps = [titles.get(name, name) for name in plan.lamps]
    lines = [f"{plan.style.capitalize()}, exposure {plan.exposure:+.1f}"]
    if plan.windows:
        lines.append(f"Through {', '.join(titles.get(name, name) for name in plan.windows)}")
    if lamps:
        lines.append(f"On: {', '.join(lamps)}" if len(lamps) <= 4 else f"{len(lamps)} lamps are on")
    for item in plan.brightness:
        lines.append(f"{item.about.capitalize()}: {item.after:.0%} bright, {item.picture:.0%} in the picture")
    return (*lines, *(finding.message for finding in plan.findings))
