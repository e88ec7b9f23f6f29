# SPDX-License-Identifier: GPL-3.0-or-later
"""All marked assets of the artist's asset libraries, read once a file and kept outside of the .blend.

A file is read again only when its time or size has changed. One that cannot be read is left out with a sentence, and
stops nothing else.
"""

from __future__ import annotations

import json
import logging
import os
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..artifacts.assets import AssetRef
from ..errors import Cancelled
from .blend_file import BlendError, FoundAsset, read_assets
from .match import Asset

log = logging.getLogger(__name__)
FORMAT = "code-as-room/assets/1"
SUFFIX = ".blend"
CATALOGS = "blender_assets.cats.txt"
MOST_FILES = 20_000
_FIELDS = ("tags", "description", "catalog", "author", "licence")
Told = Callable[[int, int], None]


@dataclass(frozen=True)
class Library:
    """One asset library as it is set up in Blender: its name and its folder; `problem` says why it cannot be read."""

    name: str
    folder: Path
    problem: str = ""


@dataclass(frozen=True)
class Index:
    """What the libraries hold.

    Attributes:
        problems: a sentence for each library and file that was left out. files: how many were looked at.
    """

    assets: tuple[Asset, ...] = ()
    problems: tuple[str, ...] = ()
    files: int = 0
    libraries: tuple[Library, ...] = ()

    @property
    def by_key(self) -> dict[str, Asset]:
        """The assets by their key."""
        return {asset.ref.key: asset for asset in self.assets}


@dataclass
class Shelf:
    """The asset libraries of one Blender. `look` may be called from any thread.

    Attributes:
        cache: the file in which it is kept what was read, None for nowhere.
        newest: the Blender version that is running.
    """

    libraries: tuple[Library, ...]
    newest: tuple[int, int]
    cache: Path | None = None
    _known: dict[str, Any] | None = None
    _made: tuple[Any, Index] | None = None
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def look(self, cancel: threading.Event | None = None, tell: Told = lambda done, of: None) -> Index:
        """What the libraries hold now.

        Args:
            tell: called with files looked at, and files in all.

        Raises:
            Cancelled: `cancel` was set; what was read so far is kept.
        """
        with self._lock:
            return self._look(cancel or threading.Event(), tell)

    def _look(self, cancel: threading.Event, tell: Told) -> Index:
        problems = [f'The asset library "{lib.name}" {lib.problem}.' for lib in self.libraries if lib.problem]
        found: list[tuple[Library, Path, str]] = []
        for library in self.libraries:
            if library.problem:
                continue
            if not library.folder.is_dir():
                problems.append(f'The folder of the asset library "{library.name}" is not there.')
                continue
            found += [(library, path, _mark(path)) for path in blend_files(library.folder)]
        if len(found) >= MOST_FILES:
            problems.append(f"Only the first {MOST_FILES} files of the asset libraries are searched.")
        found = found[:MOST_FILES]
        catalogs = {lib.name: read_catalogs(lib.folder / CATALOGS) for lib in self.libraries if not lib.problem}
        state = ([(str(path), mark) for _, path, mark in found], catalogs, problems)
        if self._made is not None and self._made[0] == state:
            return self._made[1]
        assets: list[Asset] = []
        known, changed = self._cached(), False
        try:
            for number, (library, path, mark) in enumerate(found):
                if cancel.is_set():
                    raise Cancelled
                entry = known.get(str(path))
                if not isinstance(entry, dict) or entry.get("mark") != mark:
                    known[str(path)] = entry = {"mark": mark, **self._read(path)}
                    changed = True
                try:
                    assets += _assets(entry, library, path, catalogs[library.name])
                except (KeyError, TypeError, ValueError):  # somebody edited the cache
                    known.pop(str(path), None)
                if entry.get("problem"):
                    problems = [*problems, f'"{path.name}" of {library.name} is left out, since {entry["problem"]}.']
                tell(number + 1, len(found))
        finally:
            if changed:
                self._keep(known, {str(path) for _, path, _ in found} if not cancel.is_set() else None)
        index = Index(tuple(assets), tuple(problems), len(found), self.libraries)
        self._made = (state, index)
        return index

    def _read(self, path: Path) -> dict[str, Any]:
        try:
            return {"assets": [_kept(found) for found in read_assets(path, self.newest)]}
        except BlendError as error:
            return {"assets": [], "problem": str(error)}

    def _cached(self) -> dict[str, Any]:
        if self._known is None:
            self._known = {}
            try:
                data = json.loads(self.cache.read_text(encoding="utf-8")) if self.cache is not None else {}
                # A file of a newer Blender is no problem for a newer Blender.
                if data.get("format") == FORMAT and data.get("blender") == list(self.newest):
                    self._known = dict(data["files"])
            except (OSError, ValueError, RecursionError, AttributeError, KeyError, TypeError):
                log.debug("There is no index of asset libraries that could be read")
        return self._known

    def _keep(self, known: dict[str, Any], present: set[str] | None) -> None:
        if present is not None:
            for gone in [path for path in known if path not in present]:
                del known[gone]
        if self.cache is None:
            return
        data = {"format": FORMAT, "blender": list(self.newest), "files": known}
        temporary = ""
        try:
            self.cache.parent.mkdir(parents=True, exist_ok=True)
            handle, temporary = tempfile.mkstemp(dir=self.cache.parent, prefix=f".{self.cache.name}-")
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                json.dump(data, file)
            os.replace(temporary, self.cache)
        except OSError as error:
            log.info("The index of asset libraries cannot be kept: %s", error)
            if temporary:
                Path(temporary).unlink(missing_ok=True)


def blend_files(folder: Path) -> Iterator[Path]:
    """The .blend files below a folder, in an order that stays; hidden folders are passed over."""
    for place, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for name in sorted(names):
            if name.lower().endswith(SUFFIX) and not name.startswith("."):
                yield Path(place) / name


def read_catalogs(path: Path) -> dict[str, str]:
    """The paths of a library's catalogues by their ids, from `blender_assets.cats.txt`."""
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return {}
    parts = [line.split(":") for line in lines if line.strip() and not line.startswith(("#", "VERSION"))]
    return {part[0].strip().lower(): part[1].strip() for part in parts if len(part) >= 2}


def _mark(path: Path) -> str:
    try:
        stat = path.stat()
    except OSError:
        return "gone"
    return f"{stat.st_mtime_ns}/{stat.st_size}"


def _kept(found: FoundAsset) -> dict[str, Any]:
    """What is kept of an asset; empty fields are left out."""
    kept: dict[str, Any] = {"kind": found.kind, "name": found.name, "size": found.size}
    kept |= {name: value for name in _FIELDS if (value := getattr(found, name))}
    return kept


def _assets(entry: dict[str, Any], library: Library, path: Path, catalogs: dict[str, str]) -> Iterator[Asset]:
    file = path.relative_to(library.folder).as_posix()
    for kept in entry["assets"]:
        size = kept["size"]
        yield Asset(
            AssetRef(library=library.name, file=file, kind=kept["kind"], name=kept["name"]),
            tuple(str(tag) for tag in kept.get("tags", ())),
            str(kept.get("description", "")),
            catalogs.get(str(kept.get("catalog", "")), ""),
            str(kept.get("author", "")),
            str(kept.get("licence", "")),
            None if size is None else (float(size[0]), float(size[1]), float(size[2])),
        )


def file_of(ref: AssetRef, libraries: Sequence[Library]) -> Path | None:
    """Where an asset's file is on this computer, None where its library is not set up or not there."""
    for library in libraries:
        path = library.folder / ref.file
        if library.name == ref.library and not library.problem and path.is_file():
            return path
    return None
