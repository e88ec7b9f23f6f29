# SPDX-License-Identifier: GPL-3.0-or-later
"""The second half of stage 7: small things that look like assets of the artist's own libraries.

What stands on the surfaces has a library piece by now. Where an asset fits words and size well enough, the object looks
like it, in the same box and pose; everything else stays. Without asset libraries nothing is done.
"""

from __future__ import annotations

from collections.abc import Collection, Generator, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..artifacts.analysis import Finding
from ..artifacts.assets import ChosenAsset, ChosenAssets
from ..artifacts.layout import Layout
from ..artifacts.objects import Descriptions, OwnModelling
from ..retrieval.fit import best_fit
from ..retrieval.match import THRESHOLD, Match, Wanted
from .base import View
from .wishes import Dress, FindAssets, FoundAssets, PrepareAsset, Tell, Wish

SETTING = "assets"
_MOST_TRIED = 3
_MOST_TOLD = 5
Retrieval = Generator[Wish, Any, "Retrieved"]


@dataclass
class Retrieved:
    """What came of it.

    Attributes:
        chosen: None where nothing was looked for and nothing changes.
    """

    chosen: ChosenAssets | None = None
    findings: list[Finding] = field(default_factory=list)


def retrieve(view: View, layout: Layout, small: Collection[str]) -> Retrieval:
    """Choose assets for these objects of the layout, and dress all objects that have one.

    Args:
        small: ids of what may get an asset now; what others have stays.
    """
    before = view.recall(ChosenAssets) or ChosenAssets()
    if view.settings.get(SETTING, "") == "off" and not before.objects:
        return Retrieved()
    wanted = _wanted(view, layout, small, before)
    present = {proxy.id for proxy in layout.proxies}
    kept = [c for c in before.objects if c.id in present and c.id not in {w.id for w in wanted}]
    result = Retrieved()
    found = FoundAssets()
    if wanted:
        yield Tell("Looking through the asset libraries")
        found = yield FindAssets(tuple(wanted))
    if not found.searched and not before.objects:
        return Retrieved(None, _told(found.problems))
    result.findings += _told(found.problems)
    chosen: list[ChosenAsset] = []
    lacking: set[str] = set()
    for number, item in enumerate(wanted):
        good = [match for match in found.matches.get(item.id, []) if match.is_good]
        if good:
            yield Tell(f"Fetching an asset for {item.id}", number + 1, len(wanted))
        choice = yield from _first_that_fits(item, good[:_MOST_TRIED], lacking, result.findings)
        former = before.of(item.id)
        if choice is None and former is not None and not found.searched:
            choice = former  # the libraries are not here, and it wears the asset still
        if choice is not None:
            chosen.append(choice)
    named = {c.id for c in (*kept, *chosen)}
    bare = tuple(c.id for c in before.objects if c.id in present and c.id not in named)
    worn = [c for c in (*kept, *chosen) if not _is_box(view, c.id)]
    failed = yield Dress(tuple(worn), bare)
    result.findings += [_stays(choice, failed[choice.id]) for choice in worn if choice.id in failed]
    result.findings += [_taken(choice) for choice in chosen if choice.id not in failed]
    chosen = [c for c in chosen if c.id not in failed or before.of(c.id) is not None]
    absent = [c for c in before.objects if c.id not in present]  # it may come back
    result.chosen = ChosenAssets(objects=[*absent, *kept, *chosen], refused=before.refused)
    return result


def _wanted(view: View, layout: Layout, small: Collection[str], before: ChosenAssets) -> list[Wanted]:
    """What an asset is looked for: what the artist left open, and what is called otherwise than before."""
    if view.settings.get(SETTING, "") == "off":
        return []
    own = view.recall(OwnModelling) or OwnModelling()
    held = {*view.locked, *before.refused, *own.boxes, *own.functions}
    described = view.need(Descriptions)
    open_ones = [p for p in layout.proxies if p.id in small and p.id not in held]
    wanted = [Wanted.of(proxy, described.of(proxy.id)) for proxy in open_ones]
    former = {c.id: c for c in before.objects}
    return [w for w in wanted if w.id not in former or _is_outdated(former[w.id], w)]


def _is_outdated(choice: ChosenAsset, wanted: Wanted) -> bool:
    return choice.by != "artist" and choice.wanted != wanted.words


def _is_box(view: View, identifier: str) -> bool:
    own = view.recall(OwnModelling)
    return own is not None and identifier in own.boxes


def _first_that_fits(
    wanted: Wanted, good: Sequence[Match], lacking: set[str], findings: list[Finding]
) -> Generator[Wish, Any, ChosenAsset | None]:
    """The best asset that can be had; one that cannot is told once."""
    for match in good:
        key = match.asset.ref.key
        if key in lacking:
            continue
        size = yield PrepareAsset(match.asset.ref)
        if isinstance(size, str):
            lacking.add(key)
            findings.append(Finding(about=wanted.id, message=f"An asset was passed over: {size}", severity="warning"))
            continue
        fit = best_fit(size, wanted.size)
        judged = Match(match.asset, match.words * fit.score, match.words, fit.score, fit.turn)
        if judged.score >= THRESHOLD:
            return judged.chosen(wanted)
    return None


def _taken(choice: ChosenAsset) -> Finding:
    asset = choice.asset
    return Finding(
        about=choice.id,
        message=f'It looks like the asset "{asset.name}" of {asset.library} (score {choice.score:.2f} = words '
        f"{choice.words:.2f} x size {choice.fit:.2f}). room.py, which runs without libraries, has its library piece.",
    )


def _stays(choice: ChosenAsset, why: str) -> Finding:
    message = f'It keeps its library piece instead of the asset "{choice.asset.name}": {why}'
    return Finding(about=choice.id, message=message, severity="warning")


def _told(problems: Sequence[str]) -> list[Finding]:
    told = [Finding(about="asset libraries", message=p, severity="warning") for p in problems[:_MOST_TOLD]]
    if len(problems) > _MOST_TOLD:
        more = f"{len(problems) - _MOST_TOLD} more files were left out; Find Asset lists them."
        told.append(Finding(about="asset libraries", message=more, severity="warning"))
    return told
