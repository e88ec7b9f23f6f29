# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs that try to get out, to use up the machine or to crash it: each is refused with a line and a sentence."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("resource")
HERE = Path(__file__).parent
SPEC = importlib.util.spec_from_file_location("attacks_data", HERE / "attacks_data.py")
assert SPEC and SPEC.loader
data = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(data)


def note(called: list[tuple[Any, ...]], *arguments: Any, **keywords: Any) -> None:
    """A line that only says that it was called."""
    called.append((arguments, keywords))


@pytest.fixture(scope="module")
def results() -> Any:
    """What became of all attacks, run one after the other in a fresh process."""
    command = [sys.executable, "-W", "error", str(HERE / "run_attacks.py")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stderr == ""
    return json.loads(done.stdout)


def test_there_are_enough() -> None:
    assert len(data.ATTACKS) == len(dict(data.ATTACKS)) >= 150


@pytest.mark.parametrize("name", [name for name, _ in data.ATTACKS])
def test_attack_is_refused(results: Any, name: str) -> None:
    kind, line, sentence, _seconds = results["outcomes"][name]
    assert kind == "refused"
    lines = dict(data.ATTACKS)[name].replace("\r\n", "\n").count("\n") + 1
    assert 0 <= line <= lines
    assert 10 < len(sentence) < 1500
    assert "Traceback" not in sentence and "needs too much memory" not in sentence


def test_attacks_take_little_memory(results: Any) -> None:
    assert results["memory"] < 200 * 2**20


@pytest.mark.parametrize("group", ["outside", "formats", "shadowing", "lookalikes", "failing"])
def test_small_refusals_have_a_line(results: Any, group: str) -> None:
    """Only what concerns the whole text has no line."""
    missing = [name for name, _ in data.ATTACKS if name.startswith(f"{group}-") and not results["outcomes"][name][1]]
    assert not missing


@pytest.mark.parametrize("group", ["outside", "shadowing", "lookalikes"])
def test_refused_before_anything_runs(group: str) -> None:
    """A layout line in front of the attack must not have reached the recorder."""
    from code_as_room.pipeline.errors import ProgramError
    from code_as_room.pipeline.program.evaluate import Evaluation
    from code_as_room.pipeline.program.vocabulary import room_vocabulary

    vocabulary = room_vocabulary()
    for name, program in data.GROUPS[group].items():
        called: list[tuple[Any, ...]] = []
        lines = {line: partial(note, called) for line in vocabulary.lines}
        with pytest.raises(ProgramError):
            Evaluation(vocabulary, lines).feed(f"build()\n{program}\n")
        assert not called, name
