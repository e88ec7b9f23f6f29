# SPDX-License-Identifier: GPL-3.0-or-later
"""The table over folders of runs: result beside direct answer, stars, costs, failed runs, and the drawn overlay."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline.memory import EntryMeta, Memory, dump_memory
from PIL import Image

from benchmark import table
from benchmark.metrics import compare, load_truth
from benchmark.metrics.runs import costs_of, read_run
from benchmark.overlays import draw_overlay

FLOOR = [[-2, -1.5], [2, -1.5], [2, 1.5], [-2, 1.5]]


def things(bed_x: float, name: str = "double bed") -> list[dict[str, Any]]:
    bed = {"id": "bed", "category": name, "centre": [bed_x, 0.4, 0.45], "size": [1.6, 2, 0.9], "yaw": 0.0}
    desk = {"id": "desk", "category": "desk", "centre": [1.0, -1.1, 0.375], "size": [1.2, 0.6, 0.75], "yaw": 180.0}
    return [{**item, "placement": "floor", "parent": None, "salience": "major"} for item in (bed, desk)]


def reply(bed_x: float) -> str:
    """The model's first answer: the bed at another place than in the result."""
    box = {"x_min": 0, "y_min": 0, "x_max": 9, "y_max": 9}
    objects = [
        {
            **{key: item[key] for key in ("id", "category", "placement", "salience")},
            "box": box,
            "centre_m": {"x_m": item["centre"][0], "y_m": item["centre"][1]},
            "size_m": dict(zip(("width", "depth", "height"), item["size"], strict=True)),
            "yaw_deg": item["yaw"],
        }
        for item in things(bed_x)
    ]
    corners = [(0, 1000), (1000, 1000), (1000, 0), (0, 0)]
    floor = [{"x": x, "y": y} for x, y in corners]
    said = {"view": "plan", "room_width_m": 4, "room_depth_m": 3, "floor_polygon": floor, "objects": objects}
    return json.dumps(said)


def memory(bed_x: float) -> Memory:
    kept = Memory()
    for stage, key, number, tries in (
        ("s01_analysis", "01_analysis", 1, 2),
        ("s01_analysis", "01_second_look/1", 2, 1),
        ("s01_analysis", "01_second_look/2", 2, 1),
        ("s02_graph", "02_graph", 1, 1),
        ("s03_layout", "03_critique/1", 1, 1),
        ("s05_assets", "05_assets", 1, 1),
    ):
        text = reply(bed_x) if key == "01_analysis" else "{}"
        kept.keep_answer(stage, key, text, EntryMeta(time="t", prompt_bytes=1000, tries=tries, round=number))
    return kept


def write_run(folder: Path, result_x: float | None, direct_x: float, name: str = "double bed") -> None:
    folder.mkdir(parents=True)
    (folder / "memory.json").write_text(dump_memory(memory(direct_x)))
    if result_x is not None:
        room = {"size": [4, 3, 2.6], "floor": FLOOR}
        (folder / "scene.json").write_text(json.dumps({"room": room, "objects": things(result_x, name)}))


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    """Runs: one better than its direct answer, one worse, one that failed, one without a truth."""
    truths = tmp_path / "truths"
    (truths / "flat").mkdir(parents=True)
    truth = {"room": {"size": [4, 3, 2.6], "polygon": FLOOR}, "objects": things(-1.0)}
    (truths / "flat" / "truth.json").write_text(json.dumps(truth))
    (truths / "one.truth.json").write_text(json.dumps(truth))
    runs = tmp_path / "runs"
    write_run(runs / "flat" / "persp", -1.0, -0.8)
    write_run(runs / "flat" / "plan", -0.6, -1.0)
    write_run(runs / "one", None, -1.0)
    write_run(runs / "unknown", -1.0, -1.0)
    return runs, truths


def test_rows_compare_result_and_direct_answer_of_the_same_run(folders: tuple[Path, Path]) -> None:
    rows, notes = table.make_rows(*folders)
    better, worse, failed = rows
    assert [row.name for row in rows] == ["flat persp", "flat plan", "one"]
    assert better.direct is not None and better.result["footprint_iou"] == 1 > (better.direct["footprint_iou"] or 0)
    assert worse.direct is not None and worse.direct["footprint_iou"] == 1 > (worse.result["footprint_iou"] or 0)
    assert failed.result["object_recall"] == 0 and failed.result["self_overlap"] == 1 and failed.problem
    assert any("unknown" in note for note in notes) and any(note.startswith("one") for note in notes)
    mean = table.mean_row(rows)
    assert mean.result["object_recall"] == pytest.approx(2 / 3)


def test_stars_mark_exactly_what_is_worse(folders: tuple[Path, Path], tmp_path: Path) -> None:
    runs, truths = folders
    assert (
        table.main([str(runs), str(truths), "--json", str(tmp_path / "t.json"), "--markdown", str(tmp_path / "t.md")])
        == 0
    )
    lines = (tmp_path / "t.md").read_text().splitlines()
    heads = [cell.strip() for cell in lines[0].split("|")]
    cells = {line.split("|")[1].strip(): [c.strip() for c in line.split("|")] for line in lines[2:6]}
    at = heads.index("footprint IoU")
    assert cells["flat persp"][at].startswith("100.0 / ") and "*" in cells["flat plan"][at]
    assert not any("*" in cell for cell in cells["flat persp"])
    assert all("*" in cells["one"][heads.index(name)] for name in ("recall", "self-overlap (less is better)"))
    data = json.loads((tmp_path / "t.json").read_text())
    assert data["runs"][1]["details"]["footprints"]["bed"] < 1
    assert data["mean"]["direct"]["object_recall"] == 1


def test_costs_are_those_of_the_first_four_stages() -> None:
    costs = costs_of(memory(0.0))
    assert (costs.calls, costs.prompt_bytes) == (6, 5000)
    assert costs.rounds == 5, "a repair is waited for, two questions side by side are one round"
    assert costs.rounds_before_critique == 4


def test_the_overlay_shows_picture_and_plan(folders: tuple[Path, Path]) -> None:
    runs, truths = folders
    outcome = read_run(runs / "flat" / "plan")
    assert outcome.result is not None
    comparison = compare(load_truth(truths / "flat" / "truth.json"), outcome.result)
    plan = draw_overlay(comparison, None, "flat plan")
    both = draw_overlay(comparison, Image.new("RGB", (400, 300), "#ff00ff"), "flat plan")
    assert both.width > plan.width and (255, 0, 255) in {c for _, c in both.getcolors(1 << 20) or []}
    assert (255, 0, 255) not in {c for _, c in plan.getcolors(1 << 20) or []}


def test_nothing_to_score_is_an_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert table.main([str(tmp_path), str(tmp_path)]) == 1
    assert "no runs" in capsys.readouterr().err
