"""Fusing must be better than either measurement alone, and never be ruined by one wild measurement."""

from __future__ import annotations

import numpy as np
from code_as_room.pipeline.artifacts.analysis import DetectedObject, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.artifacts.trust import Trust
from code_as_room.pipeline.geometry.footprint import lift_box
from code_as_room.pipeline.geometry.polygon import footprint_iou, rectangle_corners
from code_as_room.pipeline.layout.fuse import fuse, straighten


def test_exact_measurements_stay_exact(analysis: SceneAnalysis, camera: CameraModel) -> None:
    for item in analysis.objects:
        base = item.centre[2] - item.size[2] / 2
        fused, findings = fuse(item, camera, 4.6, base)
        np.testing.assert_allclose(fused.centre, item.centre, atol=1e-4)
        np.testing.assert_allclose(fused.size, item.size, rtol=1e-3, atol=1e-4)
        assert not findings and fused.iou is not None and fused.iou > 0.995


KNOWN = Trust(box_sigma=6.0, centre_sigma=0.06 / 4.6, size_sigma=0.08, height_sigma=0.2)


def noisy(item: DetectedObject, rng: np.random.Generator) -> DetectedObject:
    assert item.box is not None
    box = ImageBox(**{k: v + rng.normal(0, 6) for k, v in item.box.model_dump().items()})
    size = tuple(s * np.exp(rng.normal(0, n)) for s, n in zip(item.size, (0.08, 0.08, 0.2), strict=True))
    centre = (item.centre[0] + rng.normal(0, 0.06), item.centre[1] + rng.normal(0, 0.06), size[2] / 2)
    return item.model_copy(update={"box": box, "size": size, "centre": centre})


def test_fused_is_better_than_metres_and_than_boxes(analysis: SceneAnalysis, camera: CameraModel) -> None:
    rng = np.random.default_rng(7)
    scores = []
    for _ in range(12):
        for true in [o for o in analysis.objects if o.salience == "major"]:
            seen = noisy(true, rng)
            assert seen.box is not None
            outline = rectangle_corners(true.centre, true.size, true.yaw)
            fused, _ = fuse(seen, camera, 4.6, 0.0, KNOWN)
            lifted = lift_box(camera, seen.box, 0.0, seen.size[2], seen.yaw, seen.size)
            scores.append(
                [
                    footprint_iou(outline, rectangle_corners(centre, size, true.yaw))
                    for centre, size in (
                        (fused.centre, fused.size),
                        (seen.centre, seen.size),
                        (lifted.centre, lifted.size),
                    )
                ]
            )
    fused_mean, metres_mean, boxes_mean = np.mean(scores, axis=0)
    assert fused_mean > metres_mean + 0.03
    assert fused_mean > boxes_mean + 0.03


def test_a_wild_box_does_not_carry_an_object_away(analysis: SceneAnalysis, camera: CameraModel) -> None:
    bed = analysis.objects[0]
    assert bed.box is not None
    shifted = ImageBox(**{k: v + (250 if k.startswith("x") else 0) for k, v in bed.box.model_dump().items()})
    fused, findings = fuse(bed.model_copy(update={"box": shifted}), camera, 4.6, 0.0)
    assert np.hypot(fused.centre[0] - bed.centre[0], fused.centre[1] - bed.centre[1]) < 0.5
    assert any("contradict" in f.message for f in findings)


def test_exchanged_width_and_depth_are_noticed(analysis: SceneAnalysis, camera: CameraModel) -> None:
    closet = analysis.objects[3]
    swapped = closet.model_copy(update={"size": (closet.size[1], closet.size[0], closet.size[2])})
    fused, findings = fuse(swapped, camera, 4.6, 0.0)
    np.testing.assert_allclose(fused.size[:2], closet.size[:2], rtol=0.08)
    assert any("exchanged" in f.message for f in findings)


def test_nearly_straight_things_are_straightened_and_turned_ones_are_left() -> None:
    assert straighten(91.5) == 90 and straighten(358) == 0 and straighten(-2) == 0
    assert straighten(40) == 40 and straighten(355) == 355
