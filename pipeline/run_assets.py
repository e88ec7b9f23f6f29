# SPDX-License-Identifier: GPL-3.0-or-later
"""Assets of the artist's libraries for objects of the room: found, worn, taken off, and remembered."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .artifacts.assets import AssetRef, ChosenAsset, ChosenAssets
from .artifacts.objects import Descriptions
from .backend import Wardrobe
from .errors import RoomError, SceneError
from .memory import EntryMeta, Memory, dump_memory, now
from .report_objects import placed_proxies
from .retrieval.fit import best_fit
from .retrieval.index import Shelf, file_of
from .retrieval.match import Asset, Match, Wanted, best_matches
from .run_corrections import ARTIST, edits_of, program_of
from .stages.wishes import Dress, FindAssets, FoundAssets, PrepareAsset

if TYPE_CHECKING:
    from .run import Run

NO_SHELF = RoomError(
    "No asset library is set up.", "Add one in Preferences, File Paths, Asset Libraries; then look again."
)


def chosen_of(memory: Memory) -> ChosenAssets:
    """Which objects look like assets."""
    return memory.latest(ChosenAssets) or ChosenAssets()


def find(run: Run, wish: FindAssets) -> FoundAssets:
    """Perform a search; any thread. Nothing is found where no libraries are known.

    Raises:
        Cancelled: the run was stopped.
    """
    if run.shelf is None:
        return FoundAssets()
    index = run.shelf.look(run.cancel)
    found = best_matches(wish.wanted, index.assets) if wish.wanted else {}
    return FoundAssets(found, len(index.assets), index.problems)


def prepare(run: Run, wish: PrepareAsset) -> tuple[float, float, float] | str:
    """Have an asset at hand; a sentence where it cannot be had. Main thread only."""
    if not isinstance(run.backend, Wardrobe):
        return "This scene has no place for assets."
    try:
        return run.backend.prepare_asset(wish.ref, file_here(run.shelf, wish.ref))
    except SceneError as error:
        return error.message


def dress(run: Run, wish: Dress) -> dict[str, str]:
    """Let objects look like assets, and others like themselves. Main thread only."""
    backend = run.backend
    if not isinstance(backend, Wardrobe):
        return {choice.id: "This scene has no place for assets." for choice in wish.chosen}
    if wish.bare and backend.undress(wish.bare):
        backend.build(backend.program_text())
    return backend.dress(wish.chosen, files_here(run.shelf, wish.chosen))


def file_here(shelf: Shelf | None, ref: AssetRef) -> Path | None:
    """Where an asset's file is on this computer, None where it is not."""
    return file_of(ref, shelf.libraries) if shelf is not None else None


def files_here(shelf: Shelf | None, chosen: Sequence[ChosenAsset]) -> dict[str, Path]:
    """The files of these assets that are on this computer, by key."""
    found = {choice.asset.key: file_here(shelf, choice.asset) for choice in chosen}
    return {key: path for key, path in found.items() if path is not None}


def wanted_of(run: Run, names: Collection[str]) -> list[Wanted]:
    """What is known of objects that stand in the room, for a search, with what was taken over of hand edits."""
    described = run.memory.latest(Descriptions) or Descriptions()
    proxies = placed_proxies(program_of(run.memory), edits_of(run.memory))
    return [Wanted.of(proxy, described.of(name)) for name, proxy in proxies.items() if name in names]


def match_of(choice: ChosenAsset) -> Match:
    """A choice as what was found, for another look at its fit."""
    return Match(Asset(choice.asset), choice.score, choice.words, choice.fit, choice.turn)


def wear(run: Run, pairs: Sequence[tuple[Wanted, Match]], turn: int | None = None) -> list[ChosenAsset]:
    """Let objects look like assets, because the artist says so; memory keeps it. Main thread only.

    Args:
        turn: quarter turns that the artist wants, None for what fits best.

    Returns:
        The choices with the fit that the assets turned out to have.

    Raises:
        RoomError: an asset cannot be had, or an object is not there; nothing is changed then.
    """
    backend = run.backend
    if not isinstance(backend, Wardrobe):
        raise SceneError("This scene has no place for assets.")
    choices = []
    for wanted, match in pairs:
        size = backend.prepare_asset(match.asset.ref, file_here(run.shelf, match.asset.ref))
        choices.append(judged(match, wanted, size, turn).model_copy(update={"by": "artist"}))
    failed = backend.dress(choices, files_here(run.shelf, choices))
    done = [choice for choice in choices if choice.id not in failed]
    if not done:
        raise SceneError(next(iter(failed.values()), "There is nothing to do."))
    note(run, chosen_of(run.memory).having(*done))
    return done


def judged(match: Match, wanted: Wanted, size: tuple[float, float, float], turn: int | None = None) -> ChosenAsset:
    """The choice with the fit of the size that the asset turned out to have."""
    fit = best_fit(size, wanted.size, turn)
    words = match.words
    return Match(match.asset, words * fit.score, words, fit.score, fit.turn).chosen(wanted)


def take_off(run: Run, names: Collection[str], refused: bool = True) -> int:
    """Give these objects their own geometry again. Main thread only.

    Args:
        refused: no later run may choose assets for them.

    Returns:
        How many wore one.

    Raises:
        RoomError: the room cannot be built; nothing is changed then.
    """
    backend = run.backend
    before = chosen_of(run.memory)
    worn = backend.undress(names) if isinstance(backend, Wardrobe) else []
    if worn:
        backend.build(backend.program_text())
    known = {choice.id for choice in before.objects if choice.id in names}
    ids = frozenset(known | set(worn))
    if ids:
        note(run, before.without(ids, refused))
    return len(ids)


def change_clothes(run: Run, bare: Collection[str], worn: Sequence[ChosenAsset], text: str) -> None:
    """Take assets off objects and let others wear theirs again, after `text` was built. Memory is not written."""
    backend = run.backend
    if not isinstance(backend, Wardrobe):
        return
    if worn:
        backend.dress(worn, files_here(run.shelf, worn))
    elif backend.undress(bare):
        backend.build(text)


def note(run: Run, chosen: ChosenAssets) -> None:
    """Keep in memory which objects look like assets."""
    run.memory.append(ARTIST, chosen, EntryMeta(time=now(), model=ARTIST))
    run.backend.save_memory(dump_memory(run.memory))
