"""Words, synonyms and size: what an artist would call the right asset scores best, and what is none stays below."""

from __future__ import annotations

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.assets import AssetRef
from code_as_room.pipeline.retrieval.fit import STRETCH, best_fit, placing
from code_as_room.pipeline.retrieval.match import THRESHOLD, Asset, Wanted, matches

Size = tuple[float, float, float]


def asset(name: str, tags: str = "", description: str = "", catalog: str = "", size: Size | None = None) -> Asset:
    return Asset(AssetRef(library="L", file="f.blend", name=name), tuple(tags.split()), description, catalog, size=size)


def wanted(category: str, size: Size, label: str = "") -> Wanted:
    return Wanted("x_1", category, label, "", size)


SHELF = [
    asset("Table Lamp Brass", "lamp light", size=(0.2, 0.2, 0.4)),
    asset("SM_FloorLamp_02", size=(0.4, 0.4, 1.6)),
    asset("Bed Lamp", "bed lamp bedroom", size=(1.7, 2.0, 0.6)),
    asset("Prop_0231", "nightstand", size=(0.45, 0.4, 0.5)),
    asset("CoffeeMug.001", size=(0.12, 0.09, 0.1)),
    asset("couch grey", size=(2.1, 0.9, 0.8)),
    asset("kl_0815", description="An old painting in a wooden frame", size=(0.8, 0.04, 0.6)),
    asset("Thing 12", catalog="Furniture/Chairs", size=(0.5, 0.5, 0.9)),
    asset("植物", "plant", size=(0.4, 0.4, 1.0)),
    asset("Bookshelf", size=(0.2, 0.15, 0.03)),
]


@pytest.mark.parametrize(
    ("category", "size", "best"),
    [
        ("table lamp", (0.25, 0.25, 0.45), "Table Lamp Brass"),
        ("desk lamp", (0.25, 0.25, 0.45), "Table Lamp Brass"),
        ("floor lamp", (0.4, 0.4, 1.5), "SM_FloorLamp_02"),
        ("bedside table", (0.5, 0.45, 0.55), "Prop_0231"),
        ("cup", (0.1, 0.09, 0.1), "CoffeeMug.001"),
        ("sofa", (2.0, 0.9, 0.8), "couch grey"),
        ("picture", (0.9, 0.03, 0.7), "kl_0815"),
        ("chair", (0.5, 0.5, 0.9), "Thing 12"),
        ("potted plant", (0.4, 0.4, 1.1), "植物"),
    ],
)
def test_the_right_thing_is_found_under_whatever_name(category: str, size: Size, best: str) -> None:
    found = matches(wanted(category, size), SHELF)
    assert found and found[0].asset.ref.name == best and found[0].is_good
    assert found[0].score == pytest.approx(found[0].words * found[0].fit)


@pytest.mark.parametrize(
    ("category", "size"),
    [("bed", (1.7, 2.0, 0.6)), ("mirror", (0.5, 0.02, 1.0)), ("book", (0.2, 0.15, 0.03)), ("", (1.0, 1.0, 1.0))],
)
def test_what_only_sounds_like_it_is_not_taken(category: str, size: Size) -> None:
    found = matches(wanted(category, size), SHELF)
    assert all(match.score < THRESHOLD for match in found), [(m.asset.ref.name, m.score) for m in found]


def test_size_decides_between_two_of_one_name() -> None:
    shelf = [asset("Rug round", size=(2.0, 2.0, 0.02)), asset("Rug runner", size=(0.8, 3.0, 0.02))]
    found = matches(wanted("rug", (0.9, 3.2, 0.01)), shelf)
    assert found[0].asset.ref.name == "Rug runner" and found[0].fit > 0.9 > found[1].fit


def test_the_label_decides_between_two_that_fit_alike() -> None:
    shelf = [asset(f"{colour} chair", size=(0.5, 0.5, 0.9)) for colour in ("black", "oak")]
    assert matches(wanted("chair", (0.5, 0.5, 0.9), "oak chair"), shelf)[0].asset.ref.name == "oak chair"


def corners_in_box(low: Size, high: Size, box: Size, turn: int = 0, placement: str = "floor") -> np.ndarray:
    matrix = placing(low, high, box, turn, placement)
    corners = np.array([[(low, high)[i >> a & 1][a] for a in range(3)] for i in range(8)])
    points: np.ndarray = corners @ matrix[:3, :3].T + matrix[:3, 3]
    return points


@pytest.mark.parametrize("box", [(0.5, 0.5, 0.5), (0.3, 0.9, 0.2), (2.0, 0.1, 0.01)])
@pytest.mark.parametrize("low", [(5.0, -3.0, 2.0), (-900.0, 4.0, 0.0), (0.0, 0.0, -0.004)])
@pytest.mark.parametrize("turn", [0, 1, 2, 3])
def test_an_asset_stays_in_its_box_wherever_its_origin_is_and_touches_it(box: Size, low: Size, turn: int) -> None:
    high = (low[0] + 0.4, low[1] + 0.3, low[2] + 0.7)
    points = corners_in_box(low, high, box, turn)
    lowest, highest = points.min(axis=0), points.max(axis=0)
    half = np.array([box[0] / 2, box[1] / 2])
    assert (lowest[:2] >= -half - 1e-6).all() and (highest[:2] <= half + 1e-6).all()
    assert lowest[2] == pytest.approx(0.0, abs=1e-6) and highest[2] <= box[2] + 1e-6
    assert lowest[:2] == pytest.approx(-highest[:2], abs=1e-6)
    filled = (highest - lowest) / np.array(box)
    assert filled.max() == pytest.approx(1.0, abs=1e-3)


def test_no_axis_is_stretched_beyond_reason() -> None:
    factors = best_fit((1.0, 1.0, 1.0), (1.0, 1.0, 4.0)).factors
    assert max(factors) / min(factors) == pytest.approx(STRETCH)
    assert best_fit((0.4, 0.5, 0.9), (0.42, 0.5, 0.95)).factors == pytest.approx((1.05, 1.0, 0.95 / 0.9))


def test_what_hangs_is_held_where_it_hangs() -> None:
    low, high, box = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.4, 0.4, 2.0)
    assert corners_in_box(low, high, box, 0, "ceiling")[:, 2].max() == pytest.approx(2.0)
    assert corners_in_box((0, 0, 0), (1.0, 0.01, 1.0), (1.0, 0.2, 1.0), 0, "wall")[:, 1].max() == pytest.approx(0.1)


def test_only_what_fits_clearly_better_so_is_turned() -> None:
    assert best_fit((0.9, 2.0, 0.8), (2.0, 0.9, 0.8)).turn == 1
    assert best_fit((0.5, 0.55, 0.9), (0.55, 0.5, 0.9)).turn == 0
