# SPDX-License-Identifier: GPL-3.0-or-later
"""All figures of one result: the table's columns in one place, and `score`, which fills them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from . import footprints, functional, layout_iou, outside, overlap, recall, relations, room_size, rotation, support
from .matching import Comparison, compare
from .rooms import Room

Figures = dict[str, float | None]


@dataclass(frozen=True)
class Column:
    """A figure: its name, what it is called in a table, whether more is better, and how it is measured.

    `main` columns are the ones that tables show; the others go to JSON only.
    """

    name: str
    title: str
    measure: Callable[[Comparison], float | None]
    more_is_better: bool = True
    main: bool = True

    @property
    def worst(self) -> float:
        """The figure of a run that failed."""
        return 0.0 if self.more_is_better else 1.0


COLUMNS: tuple[Column, ...] = (
    Column("object_recall", "recall", recall.object_recall),
    Column("f1", "F1", recall.f1),
    Column("functional_accuracy", "functional", functional.functional_accuracy),
    Column("self_overlap", "self-overlap", lambda c: overlap.self_overlap(c.own), False),
    Column("layout_iou", "layout IoU", layout_iou.aligned),
    Column("layout_iou_metres", "layout IoU, metres", layout_iou.in_metres),
    Column("footprint_iou", "footprint IoU", footprints.footprint_iou_of_majors),
    Column("relations", "relations", relations.consistency),
    Column("relations_all", "relations, all", relations.all_asked),
    Column("rotation", "rotation", rotation.rotation_accuracy),
    Column("rotation_all", "rotation, all", rotation.all_asked),
    Column("support", "support", support.support_accuracy),
    Column("support_all", "support, all", support.all_asked),
    Column("outside", "outside", lambda c: outside.out_of_bounds(c.own), False),
    Column("aspect_error", "aspect error", room_size.aspect_error, False),
    Column("size_error", "size error", room_size.size_error, False),
    Column("recall_lenient", "recall, other names too", recall.lenient, main=False),
    Column("recall_category_only", "recall, anywhere", recall.category_only, main=False),
    Column("precision", "precision", recall.precision, main=False),
    Column("functional_soft", "zone members", functional.functional_soft, main=False),
    Column("colliding", "colliding", lambda c: overlap.colliding(c.own), False, main=False),
    Column("footprint_iou_metres", "footprint IoU, metres", footprints.in_metres, main=False),
    Column("floor_iou", "floor IoU", layout_iou.floor, main=False),
    Column("support_label", "support, as said", support.label, main=False),
)
MAIN: tuple[Column, ...] = tuple(column for column in COLUMNS if column.main)
BY_NAME: dict[str, Column] = {column.name: column for column in COLUMNS}


def score(truth: Room, result: Room) -> Figures:
    """Every figure of a result, by column name; None where the truth does not allow one."""
    return score_comparison(compare(truth, result))


def score_comparison(comparison: Comparison) -> Figures:
    """The same of a comparison that is at hand."""
    return {column.name: column.measure(comparison) for column in COLUMNS}


def failed() -> Figures:
    """The figures of a run that brought no room."""
    return {column.name: column.worst for column in COLUMNS}


def is_worse(column: Column, figure: float | None, other: float | None) -> bool:
    """Whether a figure is worse than another by what a table shows (0.1 %)."""
    if figure is None or other is None:
        return False
    one, two = round(100 * figure, 1), round(100 * other, 1)
    return one < two if column.more_is_better else one > two


def mean(rows: list[Mapping[str, float | None]]) -> Figures:
    """Mean of each column over the rows that have it."""
    means: Figures = {}
    for column in COLUMNS:
        values = [v for row in rows if (v := row.get(column.name)) is not None]
        means[column.name] = sum(values) / len(values) if values else None
    return means
