# SPDX-License-Identifier: GPL-3.0-or-later
"""The model client that needs no model: it looks at the picture with numpy and Pillow."""

from __future__ import annotations

import json
import math
import threading
import time
from collections.abc import Callable

from ...errors import Cancelled, ModelError, RoomError
from ..base import Prompt, Reply
from .analyse import see
from .answer import answer_of
from .decode import decode
from .empty import empty_value

ANALYSIS = "01_analysis"


class BuiltinClient:
    """Answers the first analysis from the picture itself, and every other request with "nothing to add"."""

    name = "builtin"
    describes = "No model: the built-in picture analysis, which finds shapes and sizes and guesses what things are."

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Answer one prompt; see `ModelClient.answer`.

        Raises:
            PictureError: the picture cannot be read.
            ModelError: the request has no picture, or the analysis failed.
            Cancelled: `cancel` was set.
        """
        if cancel.is_set():
            raise Cancelled
        start = time.monotonic()
        if prompt.plain:
            raise ModelError("The built-in analysis writes no drafts.", "Choose a model, or go stage by stage.")
        if not prompt.key.startswith(ANALYSIS):
            text = json.dumps(empty_value(prompt.schema))
            return Reply(text, self.name, seconds=time.monotonic() - start)
        text, notes = self._analyse(prompt, cancel, progress)
        return Reply(text, self.name, seconds=time.monotonic() - start, notes=tuple(notes))

    def _analyse(
        self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None
    ) -> tuple[str, list[str]]:
        if not prompt.images:
            raise ModelError("There is no picture to look at.", "Load a picture of a room seen from above.")

        def tell(text: str) -> None:
            if cancel.is_set():
                raise Cancelled
            if progress is not None:
                progress(text)

        picture = decode(prompt.images[0])
        try:
            seen = see(picture, _positive(prompt.facts.get("known_width_m")), tell)
            answer = answer_of(seen, (picture.lab.shape[0], picture.lab.shape[1]))
        except RoomError:
            raise
        except (ArithmeticError, LookupError, ValueError, TypeError) as error:
            raise ModelError(
                f"The built-in picture analysis failed on this picture ({type(error).__name__}).",
                "Try another picture, or set up a model in the preferences.",
            ) from error
        return json.dumps(answer, allow_nan=False), seen.notes


def _positive(value: object) -> float | None:
    """A finite number above zero, or None."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if math.isfinite(value) and value > 0 else None
