# SPDX-License-Identifier: GPL-3.0-or-later
"""Assets that stand for objects: which of the artist's own asset libraries' things an object looks like."""

from __future__ import annotations

from typing import Literal

from .common import Artifact


class AssetRef(Artifact):
    """A marked asset, named so that it is found again on every computer that has the library.

    Attributes:
        library: the library's name in Blender's preferences. file: its file below the library's folder, with slashes.
        kind, name: of the datablock.
    """

    library: str
    file: str
    kind: Literal["object", "collection"] = "object"
    name: str

    @property
    def key(self) -> str:
        """All of it in one text."""
        return "|".join((self.library, self.file, self.kind, self.name))


class ChosenAsset(Artifact):
    """The asset that an object looks like, in its proxy's place.

    Attributes:
        id: of the object. score: words x fit, 0 to 1.
        words: how well words and synonyms agree; fit: how well the size does.
        turn: quarter turns counter-clockwise about z.
        by: who chose it. wanted: the words that it was looked for with.
    """

    id: str
    asset: AssetRef
    score: float = 0.0
    words: float = 0.0
    fit: float = 0.0
    turn: int = 0
    by: Literal["stage", "artist"] = "stage"
    wanted: str = ""


class ChosenAssets(Artifact):
    """All objects that look like assets; the latest entry replaces the ones before it.

    Attributes:
        refused: ids of objects for which the artist wants none.
    """

    objects: list[ChosenAsset] = []
    refused: list[str] = []

    def of(self, identifier: str) -> ChosenAsset | None:
        """The asset of one object, None when it has none."""
        return next((chosen for chosen in self.objects if chosen.id == identifier), None)

    def having(self, *chosen: ChosenAsset) -> ChosenAssets:
        """The same with these instead of what their objects had."""
        ids = {c.id for c in chosen}
        return ChosenAssets(
            objects=[*(c for c in self.objects if c.id not in ids), *chosen],
            refused=[i for i in self.refused if i not in ids],
        )

    def without(self, ids: frozenset[str], refused: bool = False) -> ChosenAssets:
        """The same without assets for these; `refused` keeps later runs from choosing others."""
        kept = [i for i in self.refused if i not in ids]
        return ChosenAssets(
            objects=[c for c in self.objects if c.id not in ids],
            refused=[*kept, *sorted(ids)] if refused else self.refused,
        )
