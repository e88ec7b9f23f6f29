# SPDX-License-Identifier: GPL-3.0-or-later
"""What a stage may wish for. A stage yields a wish and is sent its result; it never does I/O itself.

`Ask` is answered with a list of validated replies in the order of its requests; `Build` with a `SceneSummary` of what
stands in the scene; `Render` with PNG bytes; `Portrait` with PNG bytes, empty where nothing can draw; `Tell` with None.
`FindAssets` is answered with `FoundAssets`; `PrepareAsset` with the asset's size in metres, or a sentence that says why it
cannot be had; `Dress` with a sentence for each object, by id, that stays as it was. `Paint`, `KeepImages` and `FindImages` are in
`texture_wishes.py`.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel

from ..artifacts.assets import AssetRef, ChosenAsset
from ..artifacts.camera import CameraModel
from ..artifacts.layout import Layout
from ..program.prelude.shape import Shape
from ..retrieval.match import Match, Wanted
from .texture_wishes import FindImages, KeepImages, Paint


@dataclass(frozen=True)
class Picture:
    """An encoded picture (PNG or JPEG bytes) with a short name for the prompt, such as "reference"."""

    name: str
    data: bytes


@dataclass(frozen=True)
class Request:
    """One question to the model.

    Attributes:
        key: unique within the stage's run and stable between runs, such as "01_analysis" or "03_critique/2".
        prompt: name of the template in `prompts/`, without `.md`.
        values: what the template's `{{name}}` places are filled with.
        images: the pictures, in the order the prompt speaks of them.
        reply: pydantic type of the answer.
        facts: typed data for a client that has no language model (the built-in one); never sent over a wire.
    """

    key: str
    prompt: str
    reply: type[BaseModel]
    values: Mapping[str, str] = field(default_factory=dict)
    images: tuple[Picture, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Ask:
    """Requests that may run side by side.

    Attributes:
        optional: the stage can do without an answer: a request whose answers stay unusable, or for which none is
            recorded, is answered with None. A service that fails still ends the stage.
    """

    requests: tuple[Request, ...]
    optional: bool = False


@dataclass(frozen=True)
class Build:
    """Make the scene show this room program (text after the prelude)."""

    text: str


@dataclass(frozen=True)
class Render:
    """A picture of what stands in the scene, seen through a camera, at most `long_side` pixels, PNG.

    `labels` draws ids on the proxies.
    """

    camera: CameraModel
    long_side: int = 1024
    labels: bool = False


@dataclass(frozen=True)
class Portrait:
    """Pictures of an object that is not in the room yet, one through each camera, side by side.

    Attributes:
        shapes: in the object's frame, metres; family: of its category, for shapes without a material role.
        cameras: in the object's frame; their pictures are square and of one size.
    """

    shapes: tuple[Shape, ...]
    family: str
    cameras: tuple[CameraModel, ...]


@dataclass(frozen=True)
class Tell:
    """Progress for the artist: what is being done, step of steps (0 when not counted)."""

    what: str
    step: int = 0
    steps: int = 0


@dataclass(frozen=True)
class FindAssets:
    """What fits these objects among the artist's asset libraries; the first search reads the libraries' files."""

    wanted: tuple[Wanted, ...]


@dataclass(frozen=True)
class FoundAssets:
    """What was found.

    Attributes:
        matches: by the object's id, best first. searched: how many assets there are; 0 without libraries.
        problems: a sentence for each library or file that was left out.
    """

    matches: Mapping[str, list[Match]] = field(default_factory=dict)
    searched: int = 0
    problems: tuple[str, ...] = ()


@dataclass(frozen=True)
class PrepareAsset:
    """Have an asset at hand, which nobody sees yet."""

    ref: AssetRef


@dataclass(frozen=True)
class Dress:
    """Let objects look like assets, and take assets off others, which are then built as the program says."""

    chosen: tuple[ChosenAsset, ...]
    bare: tuple[str, ...] = ()


Wish = Ask | Build | Render | Portrait | FindAssets | PrepareAsset | Dress | Paint | KeepImages | FindImages | Tell
StageRun = Generator[Wish, Any, list[BaseModel]]
"""A stage's generator; its return value is the list of artifacts that it writes."""

__all__ = [
    "Ask",
    "Build",
    "CameraModel",
    "Dress",
    "FindAssets",
    "FindImages",
    "FoundAssets",
    "KeepImages",
    "Layout",
    "Paint",
    "Picture",
    "Portrait",
    "PrepareAsset",
    "Render",
    "Request",
    "StageRun",
    "Tell",
    "Wish",
]
