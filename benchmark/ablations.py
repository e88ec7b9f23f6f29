# SPDX-License-Identifier: GPL-3.0-or-later
"""What each part of the method brings, and what weaker models make of it: `python -m benchmark.ablations RECORDINGS --out DIR`.

RECORDINGS holds `<room>/<style>/replies.json`; pictures and truths are looked up in `--pictures` (`<room>/truth.json`,
`<room>/<style>.png` or the only picture there). A folder that holds `replies.json` itself is one recording, with `picture.png`
and `truth.json` in the folder above it, as the sample has them. Writes `ablations.md` and `ablations.json`.

An ablation changes one setting of the run and answers from the same recording. Where that leads to a request that was never
recorded (a third round, a critique of another layout), a stand-in answers from what the recording's model saw; such rows
are marked "simulated". Noise rows are simulated throughout (`benchmark/strengths.py`). The direct answer is always the first
reply of the same run, taken in its own metres.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.stages import all_stages

from .ablation_table import tables
from .metrics import Figures, Room, direct_answer, failed, load_truth, room_of, score
from .strengths import NONE, STRENGTHS
from .variants import Outcome, Recording, load_recording, run_variant

FULL = "full"
ABLATIONS: dict[str, dict[str, str]] = {
    FULL: {},
    "metres only": {"evidence": "metres"},
    "boxes only": {"evidence": "boxes"},
    "no second look": {"second_look": "off"},
    "no calibration": {"calibration": "off"},
    "0 rounds": {"rounds": "0"},
    "1 round": {"rounds": "1"},
    "3 rounds": {"rounds": "3"},
    "5 rounds": {"rounds": "5"},
    "no memory": {"memory": "off"},
}
BY_NAME = {strength.name: strength for strength in (NONE, *STRENGTHS)}


@dataclass(frozen=True)
class Task:
    """One run: which recording, what is changed, how weak the stand-in is."""

    room: str
    style: str
    picture: str
    replies: str
    truth: str
    variant: str
    strength: str = NONE.name
    seed: int = 0


@dataclass(frozen=True)
class Row:
    """What a run scored: the result's figures and those of the direct answer, and what it took."""

    task: Task
    figures: Figures
    direct: Figures
    calls: int = 0
    prompt_bytes: int = 0
    seconds: float = 0.0
    simulated: tuple[str, ...] = ()
    problem: str = ""


def recordings(folder: Path, pictures: Path) -> Iterator[Task]:
    """Every recording in the folder that has a picture and a truth, as a task that changes nothing.

    Raises:
        RoomError: there is none.
    """
    if (folder / "replies.json").is_file():
        above = folder.resolve().parent
        yield Task(above.name, "picture", str(above / "picture.png"), str(folder), str(above / "truth.json"), FULL)
        return
    found = 0
    for path in sorted(folder.glob("*/*/replies.json")):
        room, style = path.parent.parent.name, path.parent.name
        picture, truth = _picture(pictures / room, style), pictures / room / "truth.json"
        if picture is None or not truth.is_file():
            print(f"{room}/{style}: no picture or no truth.json in {pictures / room}; left out.", file=sys.stderr)
            continue
        found += 1
        yield Task(room, style, str(picture), str(path.parent), str(truth), FULL)
    if not found:
        raise RoomError(f"There are no recordings in {folder}.", "Expected <room>/<style>/replies.json.")


def _picture(folder: Path, style: str) -> Path | None:
    named = [folder / f"{stem}.png" for stem in (style, "picture", folder.name)]
    return next((p for p in (*named, *sorted(folder.glob("*.png"))) if p.is_file()), None)


def run_task(task: Task) -> Row:
    """Run and score; a run that fails scores the worst, and says why."""
    truth = _truth(task.truth, task.style)
    try:
        recording = _recording(task.picture, task.replies)
        outcome = run_variant(recording, settings_of(task.variant), BY_NAME[task.strength], task.seed)
    except RoomError as error:
        return Row(task, failed(), failed(), problem=str(error))
    return _scored(task, outcome, truth)


def settings_of(variant: str) -> dict[str, str]:
    """The settings of an ablation."""
    return ABLATIONS[variant]


def known_settings() -> frozenset[str]:
    """Names of the settings that some stage uses; an ablation by another one would change nothing."""
    return frozenset(name for stage in all_stages() for name in stage.settings)


def _scored(task: Task, outcome: Outcome, truth: Room) -> Row:
    result = room_of(outcome.document.model_dump(mode="json"), outcome.shapes)
    direct = direct_answer(outcome.memory)
    return Row(
        task,
        figures=score(truth, result),
        direct=failed() if direct is None else score(truth, direct),
        calls=outcome.calls,
        prompt_bytes=outcome.prompt_bytes,
        seconds=round(outcome.seconds, 2),
        simulated=outcome.simulated,
    )


@lru_cache(maxsize=32)
def _truth(path: str, style: str) -> Room:
    return load_truth(Path(path), style)


@lru_cache(maxsize=4)
def _recording(picture: str, replies: str) -> Recording:
    return load_recording(Path(picture), Path(replies))


def tasks_for(base: list[Task], seeds: int, at: list[str]) -> list[Task]:
    """Every ablation at the strengths of `at`, and the whole method at every strength over all seeds; no task twice."""
    wanted: dict[Task, None] = {}
    for one in base:
        for strength in BY_NAME:
            for seed in range(1 if strength == NONE.name else seeds):
                for variant in ABLATIONS if strength in at else (FULL,):
                    wanted[Task(**{**asdict(one), "variant": variant, "strength": strength, "seed": seed})] = None
    return list(wanted)


def run_tasks(tasks: list[Task], jobs: int) -> list[Row]:
    """All rows in the order of the tasks, on so many processes."""
    rows = []
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        for n, row in enumerate(pool.imap(run_task, tasks), 1):
            what = f"{row.task.room}/{row.task.style} {row.task.variant}, {row.task.strength} {row.task.seed}"
            print(f"{n}/{len(tasks)} {what}: {row.problem or f'{row.seconds:.1f} s'}", file=sys.stderr, flush=True)
            rows.append(row)
    return rows


def main() -> None:
    """Run everything and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recordings", type=Path, metavar="RECORDINGS")
    parser.add_argument("--pictures", type=Path, default=Path(__file__).resolve().parent / "pictures", metavar="DIR")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--seeds", type=int, default=5, metavar="N", help="how often each strength is drawn (5)")
    parser.add_argument(
        "--at", nargs="+", choices=tuple(BY_NAME), default=[NONE.name], help="strengths at which to ablate (none)"
    )
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes side by side (1)")
    options = parser.parse_args()
    try:
        tasks = tasks_for(list(recordings(options.recordings, options.pictures)), options.seeds, options.at)
    except RoomError as error:
        sys.exit(str(error))
    rows = run_tasks(tasks, max(1, options.jobs))
    unknown = {name for name, settings in ABLATIONS.items() if settings and not known_settings() & set(settings)}
    text = tables(rows, unknown)
    options.out.mkdir(parents=True, exist_ok=True)
    data = json.dumps([asdict(row) for row in rows], indent=1)
    (options.out / "ablations.json").write_text(data + "\n", encoding="utf-8")
    (options.out / "ablations.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
