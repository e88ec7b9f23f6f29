# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs all attacks in one process of their own and prints what became of each, and the memory they took, as JSON."""

from __future__ import annotations

import json
import resource
import sys
from pathlib import Path

from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.program.evaluate import evaluate

sys.path.insert(0, str(Path(__file__).parent))
from attacks_data import ATTACKS


def peak() -> int:
    """The most memory the process has held, in bytes."""
    size = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return size if sys.platform == "darwin" else size * 1024


def outcome(text: str) -> list[object]:
    """What evaluating the text ends with: kind, line, sentence, seconds of processor time."""
    start = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    try:
        evaluate(text)
        end: list[object] = ["accepted", 0, ""]
    except ProgramError as error:
        end = ["refused", error.line, str(error)]
    except BaseException as error:
        end = [type(error).__name__, 0, str(error)[:200]]
    return [*end, resource.getrusage(resource.RUSAGE_SELF).ru_utime - start]


def main() -> None:
    """Run everything."""
    evaluate("room(size=(1, 1, 1), floor=[(0, 0), (1, 0), (0, 1)])\nbuild()\n")
    before = peak()
    outcomes = {name: outcome(text) for name, text in ATTACKS}
    json.dump({"outcomes": outcomes, "memory": peak() - before}, sys.stdout)


if __name__ == "__main__":
    main()
