"""The table of ablations: every row once, honest marks, and a lead that has the right sign."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from code_as_room.pipeline.errors import RoomError

from benchmark import ablations
from benchmark.ablation_table import lead, tables
from benchmark.ablations import ABLATIONS, FULL, Row, Task, known_settings, recordings, run_task, tasks_for
from benchmark.metrics import BY_NAME, failed

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "bedroom"
TASK = Task("bedroom", "picture", "picture.png", "replies", "truth.json", FULL)


def row(variant: str, strength: str, seed: int, recall: float, direct: float, simulated: tuple[str, ...] = ()) -> Row:
    base = failed()
    task = Task("bedroom", "picture", "p", "r", "t", variant, strength, seed)
    return Row(task, {**base, "object_recall": recall}, {**base, "object_recall": direct}, 4, 9000, 1.0, simulated)


def test_a_folder_of_recordings_is_matched_with_pictures_and_truths(tmp_path: Path) -> None:
    for room, style in (("attic", "persp"), ("attic", "ortho"), ("nowhere", "persp")):
        (tmp_path / "recordings" / room / style).mkdir(parents=True)
        (tmp_path / "recordings" / room / style / "replies.json").write_text("{}")
    (tmp_path / "pictures" / "attic").mkdir(parents=True)
    for name in ("persp.png", "ortho.png", "truth.json"):
        (tmp_path / "pictures" / "attic" / name).write_bytes(b"")
    found = list(recordings(tmp_path / "recordings", tmp_path / "pictures"))
    assert [(t.room, t.style, Path(t.picture).name) for t in found] == [
        ("attic", "ortho", "ortho.png"),
        ("attic", "persp", "persp.png"),
    ]
    with pytest.raises(RoomError, match="no recordings"):
        list(recordings(tmp_path / "pictures", tmp_path / "pictures"))


def test_the_whole_method_runs_at_every_strength_and_the_ablations_where_they_are_asked_for() -> None:
    tasks = tasks_for([TASK], seeds=3, at=["none", "medium"])
    assert len(tasks) == len(set(tasks)) == len(ABLATIONS) * (1 + 3) + 2 * 3
    assert {t.variant for t in tasks if t.strength == "strong"} == {FULL}
    assert {t.seed for t in tasks if t.strength == "none"} == {0}


def test_a_lead_is_positive_where_the_result_is_better_whichever_way_the_column_counts() -> None:
    overlap = BY_NAME["self_overlap"]
    better = row(FULL, "none", 0, 0.9, 0.7)
    better.figures["self_overlap"], better.direct["self_overlap"] = 0.1, 0.3
    assert lead(BY_NAME["object_recall"], [better]) == pytest.approx(20.0)
    assert lead(overlap, [better]) == pytest.approx(20.0)


def test_the_table_shows_spread_marks_what_was_simulated_and_names_failures() -> None:
    rows = [row(FULL, "none", 0, 0.95, 0.9), row("3 rounds", "none", 0, 0.95, 0.9, ("03_critique/1",))]
    rows += [row(FULL, "medium", seed, recall, 0.5, ("01_analysis",)) for seed, recall in enumerate((0.7, 0.9))]
    text = tables(
        [*rows, Row(Task("attic", "x", "p", "r", "t", FULL), failed(), failed(), problem="No corners.")], {"3 rounds"}
    )
    lines = text.splitlines()
    assert any(line.startswith("| 3 rounds°† | ") for line in lines)
    assert any(line.startswith("| full° | 80.0 ± 14.1 ") for line in lines)
    assert "- attic/x, full, none noise, seed 0: No corners." in lines
    leads = lines[lines.index("## Lead over the direct answer, in percentage points") :]
    assert any(line.startswith("| medium | +30.0 ") for line in leads)


def test_a_run_that_fails_counts_with_the_worst_figures_and_says_why(tmp_path: Path) -> None:
    (tmp_path / "replies.json").write_text('{"format": "code-as-room/replies/1", "replies": {}}')
    result = run_task(Task("b", "p", str(SAMPLE / "picture.png"), str(tmp_path), str(SAMPLE / "truth.json"), FULL))
    assert "no answer" in result.problem and result.figures["object_recall"] == 0.0
    json.dumps(ablations.asdict(result))


def test_every_ablation_is_by_a_setting_that_some_stage_knows() -> None:
    unknown = [name for name, changed in ABLATIONS.items() if not set(changed) <= known_settings()]
    assert unknown == []
