# SPDX-License-Identifier: GPL-3.0-or-later
"""A model for each group of stages: seeing wants the best eyes, the layout a steady hand, details may be cheaper."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Mapping

from .base import ModelClient, Prompt, Reply

GROUPS: dict[str, tuple[str, range]] = {
    "seeing": ("Seeing", range(1, 2)),
    "layout": ("Layout", range(2, 5)),
    "modelling": ("Modelling", range(5, 8)),
    "surfaces": ("Surfaces and light", range(8, 11)),
}
"""Id of a group: its title and the numbers of its stages."""
TEXT = "text"
"""Id of what answers questions without pictures, of whatever stage: a model that needs no eyes."""
_NUMBER = re.compile(r"s(\d+)(?:_|$)")


def model_of(models: Mapping[str, str], main: str, stage: str, pictures: int = 1) -> str:
    """The model that answers.

    Args:
        models: by group, "" or none for the main one; pictures: how many the question has.
    """
    blind = models.get(TEXT, "").strip() if not pictures else ""
    return blind or models.get(group_of(stage), "").strip() or main.strip()


def group_of(stage: str) -> str:
    """The group of a stage's id such as "s03_layout"; "" when it is in none."""
    match = _NUMBER.match(stage)
    number = int(match.group(1)) if match else 0
    return next((group for group, (_, numbers) in GROUPS.items() if number in numbers), "")


class RoutingClient:
    """Hands each prompt to the client of its stage's group, and all others to the main one.

    Answers stay kept under the name of the client that gave them, so that choosing another model for one group makes
    no other answer be asked for again.
    """

    def __init__(self, main: ModelClient, groups: Mapping[str, ModelClient]) -> None:
        self.main = main
        self._groups = dict(groups)
        self.name = main.name
        titles = {**{group: title for group, (title, _) in GROUPS.items()}, TEXT: "Without pictures"}
        others = [f"{titles[group]}: {client.describes}" for group, client in self._groups.items()]
        self.describes = "; ".join([main.describes, *others])

    def client_for(self, stage: str) -> ModelClient:
        """Who answers a stage."""
        return self._groups.get(group_of(stage), self.main)

    def name_for(self, stage: str) -> str:
        """The name of who answers a stage."""
        return self.client_for(stage).name

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """As `ModelClient.answer`."""
        blind = self._groups.get(TEXT) if not prompt.images else None
        return (blind or self.client_for(prompt.stage)).answer(prompt, cancel, progress)
