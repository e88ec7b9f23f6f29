"""The layout table is reproduced from the recordings by one command."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmark import replay
from benchmark.ablations import recordings


def test_every_recording_has_its_picture_and_truth() -> None:
    found = {task.room for task in recordings(replay.HERE / "recordings", replay.HERE / "pictures")}
    assert found == {path.parent.name for path in (replay.HERE / "pictures").glob("*/truth.json")}


def test_a_replayed_recording_is_scored_beside_the_direct_answer(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    room = tmp_path / "recordings" / "flat_plan" / "picture"
    room.mkdir(parents=True)
    source = replay.HERE / "recordings" / "flat_plan" / "picture" / "replies.json"
    (room / "replies.json").write_bytes(source.read_bytes())
    assert replay.main(["--recordings", str(tmp_path / "recordings"), "--out", str(tmp_path / "out")]) == 0
    assert "layout IoU" in capsys.readouterr().out
    [row] = [
        r for r in json.loads((tmp_path / "out" / "table.json").read_text())["runs"] if r["picture"] == "flat_plan"
    ]
    assert row["result"]["layout_iou"] > 0.9 and row["direct"]["layout_iou"] > 0.9
    assert row["result"]["self_overlap"] < 0.005
