# SPDX-License-Identifier: GPL-3.0-or-later
"""What stage 9 wishes for beside the wishes that all stages have: painted images, and images kept beside the memory.

`Paint` is answered with a list of `Painting`, one for each request in order, or with None where no image model is set;
`KeepImages` with None.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the wishes are imported everywhere, and image services bring a lot along
    from ..models.image_base import Proportions


@dataclass(frozen=True)
class PaintRequest:
    """One image to be painted.

    Attributes:
        key: unique within the stage, such as "09_surface/floor".
        prompt, simple: names of templates in `prompts/`; the simple one is tried where the first is refused.
        values: what the places of both templates are filled with (a template takes those it has).
    """

    key: str
    prompt: str
    simple: str
    values: Mapping[str, str] = field(default_factory=dict)
    proportions: Proportions = "square"


@dataclass(frozen=True)
class Painting:
    """What came of a request: the image's bytes and the model that made it, or a plain sentence why there is none.

    Attributes:
        cost: US dollars, None when unknown; seconds, tries: what it took, 0 for an image that was painted before.
        asked: hash of what was asked, as `textures.kept.request_hash`.
    """

    data: bytes = b""
    model: str = ""
    problem: str = ""
    cost: float | None = None
    seconds: float = 0.0
    tries: int = 0
    asked: str = ""


@dataclass(frozen=True)
class Paint:
    """Images that may be painted side by side. Nothing here ends the stage: another source is taken instead."""

    requests: tuple[PaintRequest, ...]


@dataclass(frozen=True)
class FindImages:
    """Which of these images the scene has; answered with a set of names, or with None where it keeps none."""

    names: frozenset[str]


@dataclass(frozen=True)
class KeepImages:
    """Images (PNG bytes by name) to be kept beside the memory: packed into the .blend, written beside `room.py`.

    The program shows them by these names (`picture(name)`). What is there under a name with other bytes is replaced
    wherever it is shown; images of other names stay for as long as something shows them.
    """

    images: Mapping[str, bytes]
