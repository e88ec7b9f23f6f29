# SPDX-License-Identifier: GPL-3.0-or-later
"""The layout table from the recordings: `python -m benchmark.replay` replays stages 1 to 4 and prints the table.

Every recording in `benchmark/recordings` is replayed as it is, without noise, and scored beside the direct answer (the first
reply's own metres); `samples/bedroom` is taken along. How the recordings were made: `benchmark/recordings/README.md`.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from code_as_room.pipeline.errors import RoomError

from . import table
from .ablations import Task, recordings
from .variants import load_recording, run_variant, write_run

HERE = Path(__file__).resolve().parent
SAMPLE = HERE.parent / "samples" / "bedroom" / "replies"


def replay(task: Task, runs: Path, truths: Path) -> str:
    """Replay one recording into `runs`, link its truth into `truths`; says which answers were simulated, "" for none."""
    outcome = run_variant(load_recording(Path(task.picture), Path(task.replies)))
    write_run(outcome, runs / task.room / task.style)
    (truths / task.room).mkdir(parents=True, exist_ok=True)
    (truths / task.room / "truth.json").write_bytes(Path(task.truth).read_bytes())
    return ", ".join(outcome.simulated)


def main(arguments: Sequence[str] | None = None) -> int:
    """Replay everything and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--recordings", type=Path, default=HERE / "recordings", metavar="DIR")
    parser.add_argument("--pictures", type=Path, default=HERE / "pictures", metavar="DIR")
    parser.add_argument("--out", type=Path, default=Path("out/replay"), metavar="DIR")
    options = parser.parse_args(arguments)
    try:
        tasks = list(recordings(options.recordings, options.pictures))
        if options.recordings == HERE / "recordings":
            tasks += list(recordings(SAMPLE, options.pictures))
        for task in tasks:
            simulated = replay(task, options.out / "runs", options.out / "truths")
            print(f"{task.room}/{task.style}" + (f": not recorded, simulated: {simulated}" if simulated else ""))
    except RoomError as error:
        print(error, file=sys.stderr)
        return 1
    wanted = ["--json", os.fspath(options.out / "table.json"), "--markdown", os.fspath(options.out / "table.md")]
    return table.main([os.fspath(options.out / "runs"), os.fspath(options.out / "truths"), *wanted])


if __name__ == "__main__":
    sys.exit(main())
