# SPDX-License-Identifier: GPL-3.0-or-later
"""CIEDE2000 against published pairs (Sharma, Wu, Dalal 2005)."""

import pytest
from code_as_room.pipeline.materials.difference import difference, difference_of_labs

PAIRS = [
    ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
    ((50.0, 0.0, 0.0), (50.0, -1.0, 2.0), 2.3669),
    ((50.0, 2.49, -0.001), (50.0, -2.49, 0.0011), 7.2195),
    ((50.0, 2.5, 0.0), (73.0, 25.0, -18.0), 27.1492),
    ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
    ((22.7233, 20.0904, -46.694), (23.0331, 14.973, -42.5619), 2.0373),
    ((2.0776, 0.0795, -1.135), (0.9033, -0.0636, -0.5514), 0.9082),
]


@pytest.mark.parametrize(("one", "other", "expected"), PAIRS)
def test_published_pairs(one: tuple[float, ...], other: tuple[float, ...], expected: float) -> None:
    assert difference_of_labs(one, other) == pytest.approx(expected, abs=1e-4)  # type: ignore[arg-type]
    assert difference_of_labs(other, one) == pytest.approx(expected, abs=1e-4)  # type: ignore[arg-type]


def test_ends_of_the_scale() -> None:
    assert difference("8A5A3C", "8A5A3C") == 0 and difference("000000", "FFFFFF") == pytest.approx(100, abs=0.01)
