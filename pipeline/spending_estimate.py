# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run may cost, told before it begins: calls, tokens and a range of prices."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .models.prices import Price


@dataclass(frozen=True)
class StageWork:
    """What a stage asks, for the estimate before a run: calls, and tokens of one call."""

    fewest: int
    most: int
    prompt_tokens: int
    completion_tokens: int


def stage_work(stage: str, rounds: int) -> StageWork:
    """What a stage asks.

    Args:
        rounds: most rounds of the layout loop.
    """
    known = {
        "s00_draft": StageWork(1, 4, 10_000, 16_000),
        "s01_analysis": StageWork(2, 4, 9_000, 5_000),
        "s02_graph": StageWork(1, 2, 4_000, 2_500),
        "s03_layout": StageWork(min(1, rounds), max(0, rounds), 7_000, 2_000),
        "s04_auxiliary": StageWork(0, 2, 4_000, 2_000),
        "s05_descriptions": StageWork(2, 6, 4_500, 1_200),
        "s06_geometry": StageWork(1, 11, 12_000, 7_000),
    }
    return known.get(stage, StageWork(1, 6, 8_000, 5_000))


@dataclass(frozen=True)
class RunEstimate:
    """What a run may cost: fewest and most calls, tokens and US dollars; `unpriced` names models without a price."""

    calls: tuple[int, int]
    tokens: tuple[int, int]
    dollars: tuple[float, float] | None
    unpriced: tuple[str, ...] = ()

    def sentence(self) -> str:
        """One line for the artist."""
        few, many = self.calls
        calls = f"{few} to {many} questions" if few != many else f"{many} question{'' if many == 1 else 's'}"
        tokens = f"about {_round(self.tokens[0])} to {_round(self.tokens[1])} tokens"
        if self.dollars is None:
            return f"{calls}, {tokens}; the price of {', '.join(self.unpriced)} is not known"
        if self.dollars[1] == 0.0:
            return f"{calls}, {tokens}, free"
        return f"{calls}, {tokens}, {money(self.dollars[0])} to {money(self.dollars[1])}"


def estimate_run(
    stages: Sequence[str], rounds: int, price_of: Callable[[str], tuple[str, Price | None]]
) -> RunEstimate:
    """What a run of these stages may cost.

    Args:
        stages: ids of the stages that will be run; rounds: most rounds of the layout loop.
        price_of: model and price for a stage.
    """
    calls, tokens, dollars = [0, 0], [0, 0], [0.0, 0.0]
    unpriced: list[str] = []
    for stage in stages:
        work = stage_work(stage, rounds)
        model, price = price_of(stage)
        for end, number in enumerate((work.fewest, work.most)):
            calls[end] += number
            # The most: every answer twice as long as usual, with thinking.
            answered = work.completion_tokens * (1 + 2 * end)
            tokens[end] += number * (work.prompt_tokens + answered)
            dollars[end] += price.of(number * work.prompt_tokens, number * answered) if price else 0.0
        if price is None and model not in unpriced and work.most:
            unpriced.append(model)
    known = None if unpriced else (dollars[0], dollars[1])
    return RunEstimate((calls[0], calls[1]), (tokens[0], tokens[1]), known, tuple(unpriced))


def money(dollars: float) -> str:
    """An amount for the artist: "$0.042", "$1.30"."""
    if dollars and dollars < 0.1:
        return f"${dollars:.3f}" if dollars >= 0.0005 else "less than $0.001"
    return f"${dollars:.2f}"


def _round(tokens: int) -> str:
    return f"{round(tokens / 1000)}k" if tokens >= 1000 else str(tokens)
