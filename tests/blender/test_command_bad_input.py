"""Whatever is handed to the command, it ends in one sentence that helps, or in a whole room that tells what was repaired."""

from __future__ import annotations

import copy
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline import stages
from code_as_room.pipeline.artifacts.layout import LayoutProgram
from code_as_room.pipeline.program.assemble import room_part
from code_as_room.pipeline.program.lines import parse_layout
from PIL import Image

Make = Callable[[Path], object]
CALL = "import sys; from code_as_room.operators.command import main; sys.exit(main())"


def run_in_process(arguments: list[str], cwd: Path) -> subprocess.CompletedProcess[str]:
    """The command as a program of its own."""
    return subprocess.run(
        [sys.executable, "-c", CALL, *arguments], cwd=cwd, capture_output=True, text=True, timeout=120
    )


# ---- the picture


def cut_png(path: Path) -> None:
    Image.effect_noise((300, 300), 80).save(path)
    path.write_bytes(path.read_bytes()[:9000])


NO_PICTURES: dict[str, tuple[Make, str]] = {
    "text": (lambda p: p.write_text("a room"), "'p.png' is not a picture that can be read"),
    "empty": (lambda p: p.write_bytes(b""), "'p.png' is empty"),
    "svg": (lambda p: p.write_text('<svg xmlns="http://www.w3.org/2000/svg"/>'), "vector drawing"),
    "one pixel": (lambda p: Image.new("RGB", (1, 1)).save(p), "only 1 x 1 pixels"),
    "a line": (lambda p: Image.new("RGB", (4000, 3)).save(p), "only 4000 x 3 pixels"),
    "cut": (cut_png, "damaged or incomplete"),
    "folder": (lambda p: p.mkdir(), "is a folder, not a picture"),
    "missing": (lambda p: None, "There is no file 'p.png'"),
    "device": (lambda p: p.symlink_to("/dev/null"), "is not a file"),
    "circle of links": (lambda p: p.symlink_to(p), "p.png"),
}


@pytest.fixture
def unfurnished(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only the stages that the bad input is about: furnishing takes longer than all of them."""
    layout = stages.all_stages()[:4]
    monkeypatch.setattr(stages, "all_stages", lambda: layout)


@pytest.mark.parametrize(("make", "says"), NO_PICTURES.values(), ids=NO_PICTURES.keys())
def test_what_is_no_picture_is_named_and_nothing_is_made(room, make: Make, says: str) -> None:
    room.picture = room.home / "p.png"
    make(room.picture)
    assert says in room.make().failed()
    assert not room.out.exists()


def large_turned_cmyk(path: Path) -> None:
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.new("CMYK", (4700, 6400), (0, 40, 60, 10)).save(path, "JPEG", exif=exif)


def with_alpha(path: Path) -> None:
    image = Image.new("RGBA", (240, 204), (200, 150, 100, 255))
    image.paste((0, 0, 0, 0), (0, 0, 60, 60))
    image.save(path, "PNG")


def sixteen_bit(path: Path) -> None:
    Image.fromarray(np.linspace(0, 65535, 240 * 204).astype(np.uint16).reshape(204, 240)).save(path, "PNG")


ODD_PICTURES: dict[str, tuple[Make, list[str], str]] = {
    "30 megapixels, CMYK, turned by EXIF": (
        large_turned_cmyk,
        ["CMYK", "turned upright", "scaled from"],
        "4096 x 3008",
    ),
    "alpha": (with_alpha, ["transparent parts were put on white"], "240 x 204"),
    "16 bit": (sixteen_bit, ["16 or 32 bits"], "240 x 204"),
}


@pytest.mark.usefixtures("unfurnished")
@pytest.mark.parametrize(("make", "notes", "size"), ODD_PICTURES.values(), ids=ODD_PICTURES.keys())
def test_an_odd_picture_becomes_a_room_and_the_change_is_said(room, make: Make, notes: list[str], size: str) -> None:
    make(room.picture)
    result = room.make().finished()
    assert all(note in result.out for note in notes)
    assert f"{room.picture.name}, {size}" in result.out
    assert len(result.scene["objects"]) == 7


@pytest.mark.usefixtures("unfurnished")
@pytest.mark.parametrize(
    "name", ['a room\'s "plan" <b>é.png', "line\nbreak.png", os.fsdecode(b"\xff\xfe.png"), "-.png"]
)
def test_any_file_name_goes(room, name: str) -> None:
    room.picture = room.picture.rename(room.home / name)
    result = room.make().finished()
    assert result.scene["image"] == name.encode("utf-8", "replace").decode() == result.memory.picture_name


# ---- the folders and the numbers


def test_a_folder_that_cannot_be_written_is_said_before_anything_is_asked(room) -> None:
    (room.home / "file").write_text("mine")
    for place, says in {
        room.home / "file": "is a file, not a folder",
        room.home / "file" / "below": "Nothing can be written in",
        Path("/proc/code-as-room"): "Nothing can be written in",
        room.home / ("x" * 300): "Nothing can be written in",
    }.items():
        room.out = place
        result = room.call(room.arguments())
        assert result.code == 1 and says in result.err and "--out" in result.err and result.err.count("\n") == 1
        assert "Picture:" not in result.out
    assert (room.home / "file").read_text() == "mine"


def test_a_folder_in_the_place_of_a_result_leaves_the_rest_alone(room) -> None:
    (room.out / "scene.json").mkdir(parents=True)
    (room.out / "room.py").write_text("mine")
    said = room.make().failed(files={"scene.json", "room.py", "memory.json"})
    assert "scene.json cannot be written" in said
    assert (room.out / "room.py").read_text() == "mine"


def test_no_recordings_where_they_were_said_to_be(room) -> None:
    plain = [str(room.picture), "--out", str(room.out), "--replies"]
    assert "no recorded answers in 'nowhere'" in room.call([*plain, str(room.home / "nowhere")]).failed()
    (room.record() / "replies.json").write_text('{"format": "code-as-')
    assert "not readable JSON" in room.call([*plain, str(room.home / "replies")]).failed()
    (room.record() / "replies.json").write_text('{"format": "other/1", "replies": {}}')
    assert "another format" in room.call([*plain, str(room.home / "replies")]).failed()


@pytest.mark.parametrize("given", [("--width", "nan"), ("--width", "-3"), ("--wall-height", "1e9")])
def test_sizes_that_no_room_has_are_refused(room, given: tuple[str, str]) -> None:
    assert "not a possible size" in room.make(*given).failed()


def test_arguments_that_are_none_are_a_matter_of_usage(room) -> None:
    assert room.call([str(room.picture)]).code == 2
    assert room.make("--width", "wide").code == 2


# ---- answers that cannot be used


def polygon(*corners: tuple[float, float]) -> list[dict[str, float]]:
    return [{"x": float(x), "y": float(y)} for x, y in corners]


NO_FLOORS = {
    "none": [],
    "two corners": [(100, 100), (900, 900)],
    "on a line": [(100, 100), (500, 500), (900, 900)],
    "one place": [(500, 500)] * 4,
    "tiny": [(500, 500), (502, 500), (502, 502), (500, 502)],
    "far outside": [(5000, 5000), (6000, 5000), (6000, 6000), (5000, 6000)],
}


@pytest.mark.parametrize("corners", NO_FLOORS.values(), ids=NO_FLOORS.keys())
def test_a_floor_that_is_none_is_said(room, corners: Any) -> None:
    room.analysis["floor_polygon"] = polygon(*corners)
    room.analysis["wall_top_polygon"] = None
    said = room.make().failed(files={"memory.json"})
    assert "floor" in said


def all_but(field: str) -> Make:
    return lambda answer: answer.pop(field)  # type: ignore[attr-defined]


UNUSABLE: dict[str, tuple[Callable[[dict[str, Any]], Any], str]] = {
    "prose": (lambda a: "I am sorry, I cannot help with that.", "no readable JSON"),
    "nothing": (lambda a: "  ", "empty"),
    "cut": (lambda a: json.dumps(a)[:900], "cut off"),
    "a list": (lambda a: [1, 2, 3], "does not fit"),
    "deep": (lambda a: "[" * 5000 + "]" * 5000, "deep"),
    "endless": (lambda a: json.dumps({**a, "room_type": "x" * 5_000_001}), "too long"),
    "no width": (lambda a: {**a, "room_width_m": None}, "room_width_m"),
    "infinite width": (lambda a: json.dumps({**a, "room_width_m": float("inf")}), "room_width_m"),
    "other fields": (lambda a: {"rooms": [a]}, "does not fit"),
}


@pytest.mark.parametrize(("spoil", "says"), UNUSABLE.values(), ids=UNUSABLE.keys())
def test_a_first_answer_that_cannot_be_used_is_said(room, spoil: Any, says: str) -> None:
    room.answers["analysis"] = spoil(room.analysis)
    assert says in room.make().failed()


def test_an_unusable_later_answer_keeps_the_stages_before_it(room) -> None:
    room.answers["graph"] = "no"
    assert "no readable JSON" in room.make().failed(files={"memory.json"})
    kept = {e.type for e in room.make().memory.entries}
    assert {"SceneAnalysis", "Calibration"} <= kept


# ---- answers that are repaired


def test_odd_numbers_of_objects_are_repaired_and_told(room) -> None:
    room.object("bed")["size_m"]["width"] = -1.7
    room.object("stand")["size_m"]["height"] = 0.0
    room.object("chair")["centre_m"]["x_m"] = 1e200
    room.object("closet")["size_m"]["depth"] = 5e4
    room.object("rug")["yaw_deg"] = 1e15
    room.analysis["wall_height_m"] = -1.0
    room.analysis["room_depth_m"] = 1e4
    result = room.make().finished()
    assert "negative size" in result.told("bed") and "size of zero" in result.told("stand")
    assert "not possible" in result.told("chair") and "more than 100 m" in result.told("closet")
    assert "wall height -1 m" in result.told("room") and "room depth 10000 m" in result.told("room")
    numbers = [v for o in result.scene["objects"] for v in (*o["centre"], *o["size"], o["yaw"])]
    assert np.isfinite(numbers).all() and max(map(abs, numbers)) <= 360


@pytest.mark.usefixtures("unfurnished")
@pytest.mark.parametrize("value", ["NaN", "Infinity", "1e308", "-1e400"])
def test_numbers_that_are_none_cost_one_object_at_most(room, value: str) -> None:
    room.object("chair")["centre_m"]["x_m"] = 777777
    room.object("bed")["base_m"] = room.analysis["wall_height_m"] = 777777
    room.answers["analysis"] = json.dumps(room.analysis).replace("777777", value)
    result = room.make().finished()
    assert {o["id"] for o in result.scene["objects"]} == {"bed", "stand", "closet", "lamp", "rug", "art"}
    notes = [note for entry in result.memory.entries for note in entry.meta.notes]
    assert any("left out" in note and "chair" in note for note in notes)


@pytest.mark.usefixtures("unfurnished")
def test_boxes_outside_the_picture_or_inside_out(room) -> None:
    box = room.object("bed")["box"]
    box["x_min"], box["x_max"] = box["x_max"], box["x_min"]
    room.object("chair")["box"] = {"x_min": 1500, "y_min": -900, "x_max": 2000, "y_max": -10}
    result = room.make().finished()
    assert "inside out" in result.told("bed") and "outside the picture" in result.told("chair")
    true = {"bed": (0.2, 0.9), "chair": (-1.6, -1.2)}
    for item in result.scene["objects"]:
        if item["id"] in true:
            np.testing.assert_allclose(item["centre"][:2], true[item["id"]], atol=0.15)


def test_parents_in_a_circle_of_their_own_or_unknown(room) -> None:
    for name, parent in (("lamp", "stand"), ("stand", "lamp"), ("bed", "bed"), ("chair", "ghost")):
        room.object(name)["parent"] = parent
    result = room.make().finished()
    assert "circle" in result.told("lamp") + result.told("stand") and "circle" in result.told("bed")
    assert "'ghost' does not exist" in result.told("chair")
    assert len(result.scene["objects"]) == 7


def test_unknown_objects_in_any_answer_are_told_and_change_nothing(room) -> None:
    missed = {**copy.deepcopy(room.object("chair")), "id": "far", "picture": 99}
    room.answers["second_look"] = {"missed": [missed], "corrections": [{"id": "ghost" * 999, "remove": True}]}
    room.answers["graph"] = {
        "attributes": [{"id": "ghost_2", "color": "red"}],
        "relations": [{"source": "bed", "relation": "on", "target": "ghost_3"}],
    }
    room.answers["critique"] = {"score": 1e9, "edits": [{"op": "remove", "id": "ghost_4"}]}
    room.answers["auxiliary"] = {"placements": [{"id": "ghost_5", "placement": "floor", "base_m": 0}]}
    result = room.make("--iterations", "1").finished()
    assert "was not sent" in result.told("far") and result.told("ghost_2") and result.told("ghost_3")
    assert any(f.about.startswith("ghostghost") and len(f.about) <= 300 for f in result.findings)
    rounds = result.memory.latest(LayoutProgram, ("s03_layout",)).iterations
    assert any(f.about == "ghost_4" for f in rounds[0].refused)
    assert {o["id"] for o in result.scene["objects"]} == {"bed", "stand", "chair", "closet", "lamp", "rug", "art"}


def test_an_empty_room(room) -> None:
    room.analysis["objects"] = []
    result = room.make().finished()
    assert result.scene["objects"] == [] and "No objects" in result.told("objects")


def test_a_thousand_objects(room) -> None:
    lamp = {**room.object("lamp"), "placement": "ceiling", "parent": None, "base_m": 2.0}
    lamp["box"] = {"x_min": -9, "y_min": 0, "x_max": -8, "y_max": 9}
    room.analysis["objects"] = [
        {**lamp, "id": f"o{n}", "centre_m": {"x_m": n % 20 / 5 - 2, "y_m": n // 20 % 15 / 5 - 1.5}} for n in range(1000)
    ]
    result = room.make().finished()
    assert len(result.scene["objects"]) == 300
    assert "1000 objects were answered; the first 300 are used" in result.told("objects")


ODD_IDS = [
    'a"b', "a'b\n", "\u0430bed", "bed\u202e", "", "   ", "../../etc/passwd", "\U0001f4a5", "a" * 5000, "__import__('os')",
    "room", "wall_n", "wall_n_2", "bed", "build", "\x00", "floor", "door_1", "reference", "None", "proxy", "\ud800", "42",
    '"); import os #', "{{found}}", "<script>alert(1)</script>",
]  # fmt: skip


def test_odd_ids_become_plain_ones_that_nothing_else_has(room) -> None:
    like = room.object("chair")
    room.analysis["objects"] = [
        {**copy.deepcopy(like), "id": name, "category": name, "label": name, "zone": name, "parent": parent}
        for name, parent in zip(ODD_IDS, [None, *ODD_IDS], strict=False)
    ]  # fmt: skip
    room.analysis["architecture"][0]["wall"] = '"\n'
    result = room.make().finished()
    text = (room.out / "room.py").read_text(encoding="utf-8")
    layout = parse_layout(room_part(text))
    lines = [*layout.walls, *layout.doors, *layout.proxies, *layout.cameras]
    assert len({line.id for line in lines}) == len(lines) and len(layout.proxies) == len(ODD_IDS)
    assert all(set(line.id) <= set("abcdefghijklmnopqrstuvwxyz0123456789_") for line in layout.proxies)
    assert "<script>alert" not in (room.out / "report.html").read_text(encoding="utf-8")
    assert result.scene["objects"]


def test_a_parent_is_found_however_its_id_was_written(room) -> None:
    room.object("stand")["id"] = "Night-Stand 1"
    room.object("lamp")["parent"] = "Night-Stand 1"
    result = room.make().finished()
    lamp = next(o for o in result.scene["objects"] if o["id"] == "lamp")
    assert lamp["parent"] == "night_stand_1" and not result.told("lamp")


def test_huge_texts_do_not_get_into_the_room(room) -> None:
    room.object("bed")["category"] = "x" * 100_000
    room.object("chair")["label"] = "y\x00\n" * 50_000
    room.object("rug")["parent"] = "z" * 100_000
    room.analysis["room_type"] = "\n\"'" * 9999
    room.analysis["zones"] = [{"id": "e\n", "label": "w" * 10_000}] * 50
    result = room.make().finished()
    assert max(len(line) for line in (room.out / "room.py").read_text(encoding="utf-8").splitlines()) < 1000
    assert (room.out / "scene.json").stat().st_size < 50_000
    assert max(len(f.message) for f in result.findings) <= 300


FLOORS = {
    "crossing itself": [(100, 100), (900, 900), (900, 100), (100, 900)],
    "a spike": [(100, 100), (900, 100), (900, 900), (500, 900), (500, 150), (499, 900), (100, 900)],
    "far larger than the picture": [(-5000, -5000), (6000, -5000), (6000, 6000), (-5000, 6000)],
    "clockwise": [(100, 100), (900, 100), (900, 900), (100, 900)],
}


@pytest.mark.usefixtures("unfurnished")
@pytest.mark.parametrize("corners", FLOORS.values(), ids=FLOORS.keys())
def test_an_odd_floor_becomes_a_room_of_a_possible_size(room, corners: Any) -> None:
    room.analysis["floor_polygon"] = polygon(*corners)
    room.analysis["wall_top_polygon"] = None
    result = room.make().finished()
    assert all(1 < side < 20 for side in result.scene["room"]["size"])
    assert ("crossed itself" in result.told("floor")) == (corners is FLOORS["crossing itself"])


@pytest.mark.usefixtures("unfurnished")
def test_wall_tops_that_cannot_be_are_told(room) -> None:
    floor = room.analysis["floor_polygon"]
    room.analysis["wall_top_polygon"] = [{k: 500 + (v - 500) * 0.9 for k, v in p.items()} for p in floor]
    assert "smaller than the floor" in room.make().finished().told("wall tops")
    room.analysis["wall_top_polygon"] = polygon((100, 100), (900, 900), (900, 100), (100, 900))
    assert room.make().finished().told("wall tops")


@pytest.mark.parametrize("side", [0.01, 1e4])
def test_a_room_of_a_centimetre_or_ten_kilometres(room, side: float) -> None:
    room.analysis["room_width_m"] = room.analysis["room_depth_m"] = side
    result = room.make().finished()
    assert f"{side:g} m is not possible" in result.told("room")
    assert all(1 < length < 20 for length in result.scene["room"]["size"])


@pytest.mark.usefixtures("unfurnished")
def test_doors_and_partitions_from_anywhere(room) -> None:
    door = room.analysis["architecture"][0]
    point = {"x_m": 0.5, "y_m": 0.5}
    room.analysis["architecture"] += [
        {**door, "id": "none", "start": point, "end": point},
        {**door, "id": "long", "kind": "partition", "start": {"x_m": -90, "y_m": 0}, "end": {"x_m": 90, "y_m": 0}},
        {**door, "id": "tall", "kind": "window", "height_m": 50, "sill_m": 4},
        {**door, "id": "tall", "kind": "opening", "height_m": -2},
        *({**door, "id": f"d{n}"} for n in range(200)),
    ]
    result = room.make().finished()
    assert "no length" in result.told("none")
    assert all(np.isfinite(o["start"] + o["end"]).all() for o in result.scene["architecture"])


# ---- as a program of its own


def test_on_a_terminal_it_is_one_sentence_and_exit_code_one(room) -> None:
    room.answers["analysis"] = "Sorry."
    done = run_in_process(room.arguments(), room.home)
    assert done.returncode == 1 and done.stderr.startswith("code-as-room: The answer holds no readable JSON.")
    assert done.stderr.count("\n") == 1 and "Traceback" not in done.stderr + done.stdout
    done = run_in_process(["nowhere.png", "--out", "out2"], room.home)
    assert done.returncode == 1 and "There is no file 'nowhere.png'" in done.stderr and done.stdout == ""
    assert not (room.home / "out2").exists()
