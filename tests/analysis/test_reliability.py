"""What a picture tells of its own errors must make placements better than either measurement, whichever is the poor one."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.analysis.covered import covered_edges
from code_as_room.pipeline.analysis.reliability import learn_trust
from code_as_room.pipeline.artifacts.analysis import ArchitectureItem, Calibration, DetectedObject, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.trust import Trust
from code_as_room.pipeline.geometry.footprint import image_box_of
from code_as_room.pipeline.layout.fuse import fuse
from code_as_room.pipeline.layout.initial import proxy_of

from benchmark.fusion import CASES, Errors, compare, make_room

ROOMS = 4


@pytest.fixture(scope="module")
def table() -> dict[str, dict[str, float]]:
    """Mean footprint IoU by case and by way of placing."""
    result = {}
    for name, errors in CASES.items():
        total: dict[str, list[float]] = {}
        for seed in range(ROOMS):
            for way, values in compare(make_room(seed, errors)).items():
                total.setdefault(way, []).extend(values)
        result[name] = {way: sum(v) / len(v) for way, v in total.items()}
    return result


def test_on_average_learnt_fusion_is_better_than_the_better_source(table: dict[str, dict[str, float]]) -> None:
    best = sum(max(row["metres"], row["boxes"]) for row in table.values()) / len(table)
    learnt = sum(row["learnt"] for row in table.values()) / len(table)
    usual = sum(row["usual"] for row in table.values()) / len(table)
    assert learnt > best + 0.01
    assert learnt > usual + 0.03


@pytest.mark.parametrize("case", [name for name in CASES if name not in ("boxes shifted", "boxes stretched")])
def test_learnt_fusion_is_never_much_worse_than_the_better_source(
    table: dict[str, dict[str, float]], case: str
) -> None:
    row = table[case]
    assert row["learnt"] > max(row["metres"], row["boxes"]) - 0.03


@pytest.mark.parametrize("case", ["boxes shifted", "boxes stretched"])
def test_an_error_of_all_boxes_is_mostly_found(table: dict[str, dict[str, float]], case: str) -> None:
    row = table[case]
    assert row["learnt"] > row["boxes"] + 0.6 * (row["metres"] - row["boxes"])


def test_poor_boxes_and_poor_metres_are_told_apart() -> None:
    def ratio(errors: Errors) -> float:
        total = 1.0
        for seed in range(3):
            room = make_room(seed, errors)
            trust = learn_trust(room.analysis, room.calibration)
            total *= trust.box_sigma / (trust.centre_sigma * 1000.0)
        return total

    assert ratio(Errors(box=15.0)) > 20 * ratio(Errors(centre=0.15, size=0.18, box=3.0))


def test_sizes_that_are_all_too_small_are_put_right() -> None:
    room = make_room(3, Errors(centre=0.03, size=0.04, sizes=0.7, box=4.0))
    trust = learn_trust(room.analysis, room.calibration)
    for part in trust.metres_size:
        assert part == pytest.approx(-0.357, abs=0.1)


def test_exact_measurements_have_no_common_error(analysis: SceneAnalysis, calibration: Calibration) -> None:
    trust = learn_trust(analysis, calibration)
    assert max(map(abs, (*trust.metres_stretch, *trust.metres_size, *trust.box_stretch))) < 3e-3
    assert max(map(abs, (*trust.box_shift, trust.box_inset))) < 0.2
    assert trust.box_sigma < Trust().box_sigma and trust.size_sigma < Trust().size_sigma


def test_two_objects_tell_nothing(analysis: SceneAnalysis, calibration: Calibration) -> None:
    few = analysis.model_copy(update={"objects": analysis.objects[:2]})
    trust = learn_trust(few, calibration)
    assert trust.model_copy(update={"edges": {}, "objects": 0}) == Trust()


def test_metres_that_are_all_the_same_place_leave_the_boxes(analysis: SceneAnalysis, calibration: Calibration) -> None:
    lost = [o.model_copy(update={"centre": (0.0, 0.0, o.centre[2])}) for o in analysis.objects]
    trust = learn_trust(analysis.model_copy(update={"objects": lost}), calibration)
    told = calibration.model_copy(update={"trust": trust})
    bed = proxy_of(lost[0], told, 0.0)[0]
    closet = proxy_of(lost[3], told, 0.0)[0]
    assert abs(bed.centre[1] - 0.9) < 0.3 and abs(closet.centre[0] - 2.0) < 0.3


def test_metres_or_boxes_alone(analysis: SceneAnalysis, calibration: Calibration, camera: CameraModel) -> None:
    bed = analysis.objects[0]
    off = bed.model_copy(update={"centre": (0.35, 0.7, bed.centre[2]), "size": (1.5, 1.9, 0.9)})
    metres = fuse(off, camera, 4.6, 0.0, learn_trust(analysis, calibration, "metres"))[0]
    assert metres.centre[:2] == (0.35, 0.7) and metres.size == off.size
    boxes = fuse(off, camera, 4.6, 0.0, learn_trust(analysis, calibration, "boxes"))[0]
    assert boxes.centre[0] == pytest.approx(0.2, abs=0.02) and boxes.centre[1] == pytest.approx(0.9, abs=0.03)
    assert boxes.size[0] == pytest.approx(1.7, abs=0.06)


def test_an_edge_below_a_table_or_a_partition_is_a_guess(analysis: SceneAnalysis, calibration: Calibration) -> None:
    camera = calibration.camera

    def thing(name: str, centre: tuple[float, float, float], size: tuple[float, float, float]) -> DetectedObject:
        return DetectedObject(
            id=name, category=name, centre=centre, size=size, box=image_box_of(camera, centre, size, 0.0)
        )

    rug = thing("rug", (0.0, 0.0, 0.005), (2.0, 1.4, 0.01))
    table = thing("table", (1.0, 0.0, 0.37), (0.8, 2.0, 0.74))
    cup = thing("cup", (0.0, 0.0, 0.1), (0.1, 0.1, 0.1))
    behind = thing("box", (-1.0, -1.0, 0.2), (0.6, 0.4, 0.4))
    wall = ArchitectureItem(id="p", kind="partition", start=(-0.7, -1.9), end=(-0.7, -0.4), height=2.4, thickness=0.14)
    found = covered_edges(
        analysis.model_copy(update={"objects": [rug, table, cup, behind], "architecture": [wall]}), calibration
    )
    assert found["rug"][2] > 2.5 and found["rug"][0] == found["rug"][1] == 1.0
    assert found["box"][2] > 2.0 and found["box"][0] == 1.0
    assert "table" not in found and "cup" not in found


def test_furniture_is_not_taken_for_too_large_in_one_direction_of_the_picture_alone() -> None:
    room = make_room(3, Errors(centre=0.02, size=0.02, box=4.0))
    squeezed = []
    for item in room.analysis.objects:
        assert item.box is not None
        y_min, y_max = item.box.y_min, item.box.y_max
        inset = 0.07 * (y_max - y_min)
        box = item.box.model_copy(update={"y_min": y_min + inset, "y_max": y_max - inset})
        squeezed.append(item.model_copy(update={"box": box}))
    trust = learn_trust(room.analysis.model_copy(update={"objects": squeezed}), room.calibration)
    assert abs(trust.metres_size[0] - trust.metres_size[1]) < 0.06
