# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of books are made by one program, and yet no two are the same."""

from __future__ import annotations

import numpy as np
from code_as_room.pipeline.artifacts.layout import ProxyLine
from code_as_room.pipeline.objects.rows import another, rows
from code_as_room.pipeline.objects.written import take_program

ROW = """
def books_1(size, seed=1):
    w, d, h = size
    n = 8
    def book(k):
        t = h * rand((seed, k), 0.7, 1.0) if k else h
        return part("spine", box((w / n, d, t), at=((k + 0.5) * w / n - w / 2, 0, t / 2)), material="paper")
    return [book(k) for k in range(n)]
"""


def row(number: int, size: tuple[float, float, float] = (0.8, 0.2, 0.25), category: str = "books") -> ProxyLine:
    return ProxyLine(id=f"books_{number}", category=category, centre=(number, 0, size[2] / 2), size=size)


def heights(shapes: object) -> np.ndarray:
    return np.array([s.vertices[:, 2].max() for s in shapes])  # type: ignore[attr-defined]


def test_rows_of_one_kind_have_one_program_and_a_stack_has_its_own() -> None:
    things = [row(1), row(2, (0.85, 0.2, 0.22)), row(3, (0.2, 0.2, 0.25)), row(4), row(5, category="chair")]
    assert rows(things) == {"books_2": "books_1", "books_4": "books_1"}


def test_every_row_fills_its_own_box_with_books_of_its_own() -> None:
    first = take_program(ROW, row(1), "books_1")
    second = another(first, row(2, (0.85, 0.2, 0.22)), "books_2", 2)
    third = another(first, row(3), "books_3", 3)
    assert second is not None and third is not None
    points = np.concatenate([s.vertices for s in second.shapes])
    np.testing.assert_allclose(np.ptp(points, axis=0), (0.85, 0.2, 0.22), atol=1e-6)
    assert not np.allclose(heights(first.shapes), heights(third.shapes))
    assert first.code in second.code, "the program stands once in a room's text"


def test_a_row_whose_program_was_stretched_to_fit_still_takes_its_seed() -> None:
    first = take_program(ROW.replace("w, d, h = size", "w, d, h = size[0], size[1], size[2] * 0.9"), row(1), "books_1")
    assert "fill(" in first.code
    second = another(first, row(2), "books_2", 2)
    assert second is not None and not np.allclose(heights(first.shapes), heights(second.shapes))


def test_a_program_that_takes_no_seed_makes_the_row_again() -> None:
    first = take_program(ROW.replace(", seed=1", "").replace("(seed, k)", "k"), row(1), "books_1")
    second = another(first, row(2), "books_2", 2)
    assert second is not None
    np.testing.assert_allclose(heights(first.shapes), heights(second.shapes), atol=1e-6)
