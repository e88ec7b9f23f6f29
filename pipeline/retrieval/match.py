# SPDX-License-Identifier: GPL-3.0-or-later
"""Which asset comes nearest to an object: words and synonyms x size."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from ..artifacts.assets import AssetRef, ChosenAsset
from ..artifacts.layout import ProxyLine
from ..artifacts.objects import ObjectDescription
from .fit import best_fit
from .words import concepts_of, heads_of, is_modifier, things

THRESHOLD = 0.55
"""Below this score an object keeps its own geometry."""
SHOWN = 0.25
"""Below this score an asset is not even a runner-up."""
_OTHER_THING = 0.55
"""What is left of the words' score where the name says that it is another thing: a bed's tag on a lamp."""


@dataclass(frozen=True)
class Asset:
    """A marked asset of a library, as its file describes it.

    Attributes:
        catalog: path of its catalogue, such as "Furniture/Chairs". size: metres, None where it is not known.
    """

    ref: AssetRef
    tags: tuple[str, ...] = ()
    description: str = ""
    catalog: str = ""
    author: str = ""
    licence: str = ""
    size: tuple[float, float, float] | None = None

    @cached_property
    def terms(self) -> Terms:
        """Its words."""
        tags = tuple(dict.fromkeys(concepts_of(tag) for tag in self.tags))
        return Terms(
            concepts_of(self.ref.name),
            tags,
            concepts_of(self.catalog.rpartition("/")[2]),
            frozenset(concepts_of(self.description)),
        )


@dataclass(frozen=True)
class Terms:
    """What an asset says of itself, as words under one name for all synonyms; `everything` is all of them."""

    name: tuple[str, ...]
    tags: tuple[tuple[str, ...], ...]
    catalog: tuple[str, ...]
    description: frozenset[str]
    everything: frozenset[str] = field(init=False)

    def __post_init__(self) -> None:
        every = {*self.name, *self.catalog, *self.description, *(word for tag in self.tags for word in tag)}
        object.__setattr__(self, "everything", frozenset(every))


@dataclass(frozen=True)
class Wanted:
    """An object for which an asset is looked for; metres."""

    id: str
    category: str
    label: str
    details: str
    size: tuple[float, float, float]
    placement: str = "floor"

    @classmethod
    def of(cls, proxy: ProxyLine, described: ObjectDescription | None = None) -> Wanted:
        """What is known of an object of the layout."""
        words = described.words if described is not None else ""
        category = proxy.category.replace("_", " ")
        return cls(proxy.id, category, proxy.label, words, proxy.size, proxy.placement)

    @property
    def words(self) -> str:
        """What it is looked for with, in one text."""
        return " | ".join((self.category, self.label, self.details))


@dataclass(frozen=True)
class Match:
    """An asset for an object; all scores from 0 to 1."""

    asset: Asset
    score: float
    words: float
    fit: float
    turn: int = 0

    @property
    def is_good(self) -> bool:
        """Whether it is good enough to be taken without asking."""
        return self.score >= THRESHOLD

    def chosen(self, wanted: Wanted, by_artist: bool = False) -> ChosenAsset:
        """The asset as that of an object."""
        return ChosenAsset(
            id=wanted.id,
            asset=self.asset.ref,
            score=round(self.score, 3),
            words=round(self.words, 3),
            fit=round(self.fit, 3),
            turn=self.turn,
            by="artist" if by_artist else "stage",
            wanted=wanted.words,
        )


def matches(wanted: Wanted, assets: Iterable[Asset], most: int = 6) -> list[Match]:
    """The assets that may stand for an object, best first; none below `SHOWN`."""
    category, details = concepts_of(wanted.category), _details(wanted)
    found: list[Match] = []
    for asset in assets:
        words = agreement(category, details, asset) if category else 0.0
        if words >= SHOWN:
            fit = best_fit(asset.size, wanted.size)
            found.append(Match(asset, words * fit.score, words, fit.score, fit.turn))
    found = [match for match in found if match.score >= SHOWN]
    return sorted(found, key=lambda m: (-m.score, m.asset.ref.key))[:most]


def agreement(category: tuple[str, ...], details: frozenset[str], asset: Asset) -> float:
    """How well what is wanted and what an asset says of itself agree, 0 to 1."""
    terms = asset.terms
    if category[-1] not in terms.everything:
        return 0.0
    said = 0.95 * max((_named(category, tag) for tag in terms.tags), default=0.0)
    said = max(said, 0.75 * _named(category, terms.catalog))
    if category[-1] in terms.description:
        said = max(said, 0.6 if terms.description.issuperset(category) else 0.5)
    if _is_another(category, terms.name):
        said *= _OTHER_THING
    best = max(_named(category, terms.name), said)
    # Even the right name leaves room for the colours and materials that the picture shows.
    return float(0.92 * best + 0.04 * min(2, len(details & terms.everything))) if best else 0.0


def _named(wanted: tuple[str, ...], name: tuple[str, ...]) -> float:
    """How well one name fits, 0 to 1."""
    if not name:
        return 0.0
    is_head = wanted[-1] in heads_of(name)
    # Colours, materials and styles are no other kind of thing.
    more = [c for c in name if c not in wanted and not is_modifier(c)]
    kinds = [c for c in wanted[:-1] if not is_modifier(c)]
    if set(kinds) | {wanted[-1]} <= set(name):
        whole = is_head or len(wanted) > 1
        return max(0.7, 1.0 - 0.08 * len(more)) if whole else _OTHER_THING * 0.9
    if is_head:
        # A floor lamp is not what a table lamp is; a lamp may be.
        return 0.78 if not more else 0.55
    return 0.0


def _is_another(wanted: tuple[str, ...], name: tuple[str, ...]) -> bool:
    """Whether a name says that it is a known thing, and another one."""
    heads = heads_of(name)
    return wanted[-1] not in heads and bool(heads & things())


def _details(wanted: Wanted) -> frozenset[str]:
    """Words beyond the category that an asset may agree with."""
    said = {*concepts_of(wanted.label), *concepts_of(wanted.details)}
    return frozenset(said - set(concepts_of(wanted.category)))


def best_matches(wanted: Sequence[Wanted], assets: Sequence[Asset], most: int = 6) -> dict[str, list[Match]]:
    """As `matches`, for several objects by their ids."""
    return {item.id: matches(item, assets, most) for item in wanted}
