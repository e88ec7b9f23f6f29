# SPDX-License-Identifier: GPL-3.0-or-later
"""The same room in other metres: everything times a factor, and moved when its origin is elsewhere.

A change of scale is uniform: thickness of walls, height of doors and sizes of lamps follow like all else, as the model
judged them by the same yardstick. The camera comes nearer or goes farther, its lens stays, and so the picture fits as
it did before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..artifacts.analysis import ArchitectureItem, Calibration, DetectedObject, SceneAnalysis
from ..artifacts.camera import CameraModel
from ..artifacts.common import Metres2, Metres3
from ..artifacts.corrections import Rescaled
from ..artifacts.layout import (
    CameraLine,
    DoorLine,
    LayoutEdit,
    LightLine,
    Line,
    OpeningLine,
    ProxyLine,
    RoomLine,
    ViewLine,
    WallLine,
    WindowLine,
    WorldLine,
)
from ..program.rewrite import rewrite_lines


@dataclass(frozen=True)
class Similarity:
    """Times `factor`, then moved by `shift` (metres, on the floor)."""

    factor: float = 1.0
    shift: Metres2 = (0.0, 0.0)

    @classmethod
    def of(cls, entry: Rescaled) -> Similarity:
        """What an entry of memory says."""
        return cls(entry.factor, entry.shift)

    @property
    def moves(self) -> bool:
        """Whether anything changes by it."""
        return self.factor != 1.0 or self.shift != (0.0, 0.0)

    def on_floor(self, point: Metres2) -> Metres2:
        """A point of the floor in the new metres."""
        return point[0] * self.factor + self.shift[0], point[1] * self.factor + self.shift[1]

    def in_room(self, point: Metres3) -> Metres3:
        """A point of the room in the new metres."""
        return (*self.on_floor((point[0], point[1])), point[2] * self.factor)

    def sizes(self, size: Metres3) -> Metres3:
        """Three lengths in the new metres."""
        return size[0] * self.factor, size[1] * self.factor, size[2] * self.factor

    def camera_matrix(self, matrix: Sequence[float]) -> tuple[float, ...]:
        """A camera-to-world matrix, 16 numbers row by row: the camera moves, it does not turn."""
        result = list(matrix)
        result[3], result[7], result[11] = self.in_room((matrix[3], matrix[7], matrix[11]))
        return tuple(result)


def rescaled_analysis(analysis: SceneAnalysis, change: Similarity) -> SceneAnalysis:
    """The analysis in the new metres; what it says of the picture stays."""
    return analysis.model_copy(
        update={
            "room_size": change.sizes(analysis.room_size),
            "floor": [change.on_floor(p) for p in analysis.floor],
            "architecture": [_architecture(a, change) for a in analysis.architecture],
            "objects": [rescaled_object(o, change) for o in analysis.objects],
            "left_out": [rescaled_object(o, change) for o in analysis.left_out],
        }
    )


def rescaled_calibration(calibration: Calibration, change: Similarity) -> Calibration:
    """The calibration in the new metres; every point of the picture is where it was."""
    return calibration.model_copy(
        update={
            "camera": rescaled_camera(calibration.camera, change),
            "floor": [change.on_floor(p) for p in calibration.floor],
            "height": calibration.height * change.factor,
        }
    )


def rescaled_camera(camera: CameraModel, change: Similarity) -> CameraModel:
    """The camera that sees the new room as the old one saw the old room."""
    matrix, height = change.camera_matrix(camera.matrix), camera.ortho_height * change.factor
    return camera.model_copy(update={"matrix": matrix, "ortho_height": height})


def rescaled_object(item: DetectedObject, change: Similarity) -> DetectedObject:
    """One detected object in the new metres."""
    return item.model_copy(update={"centre": change.in_room(item.centre), "size": change.sizes(item.size)})


def _architecture(item: ArchitectureItem, change: Similarity) -> ArchitectureItem:
    lengths = {name: getattr(item, name) * change.factor for name in ("height", "sill", "thickness")}
    return item.model_copy(update={"start": change.on_floor(item.start), "end": change.on_floor(item.end), **lengths})


def rescaled_line(line: Line, change: Similarity) -> Line:
    """One layout line in the new metres. Lamps keep their brightness where they shine: their watts grow by the square."""
    factor = change.factor
    if isinstance(line, RoomLine):
        return line.model_copy(
            update={"size": change.sizes(line.size), "floor": [change.on_floor(p) for p in line.floor]}
        )
    if isinstance(line, ProxyLine):
        return line.model_copy(update={"centre": change.in_room(line.centre), "size": change.sizes(line.size)})
    if isinstance(line, CameraLine):
        matrix = change.camera_matrix(line.matrix)
        return line.model_copy(
            update={"matrix": matrix, "ortho_height": line.ortho_height * factor, "near": line.near * factor}
        )
    if isinstance(line, LightLine):
        target = None if line.target is None else change.in_room(line.target)
        # A sun has no place: its strength and its angle do not depend on the room's size.
        watts, size = (line.energy, line.size) if line.kind == "sun" else (line.energy * factor**2, line.size * factor)
        return line.model_copy(
            update={
                "at": change.in_room(line.at),
                "target": target,
                "energy": watts,
                "size": size,
                "size_y": line.size_y * factor,
            },
        )
    if isinstance(line, WorldLine):
        return line
    if isinstance(line, ViewLine):
        return line.model_copy(update={"ceiling": line.ceiling * factor, "cut": line.cut * factor})
    assert isinstance(line, WallLine | DoorLine | WindowLine | OpeningLine)
    lengths = {name: getattr(line, name) * factor for name in ("height", "sill", "thickness") if hasattr(line, name)}
    return line.model_copy(update={"start": change.on_floor(line.start), "end": change.on_floor(line.end), **lengths})


def rescaled_edit(edit: LayoutEdit, change: Similarity) -> LayoutEdit:
    """One typed edit in the new metres."""
    centre = None if edit.centre is None else change.in_room(edit.centre)
    size = None if edit.size is None else change.sizes(edit.size)
    line = None if edit.line is None else rescaled_text(edit.line, change)
    return edit.model_copy(update={"centre": centre, "size": size, "line": line})


def rescaled_text(text: str, change: Similarity) -> str:
    """A room text (or single layout lines) in the new metres; comments, functions and all else stay as they are.

    Raises:
        ProgramError: the text cannot be parsed, or a line would say something that no room can have.
    """
    return rewrite_lines(text, lambda line: rescaled_line(line, change)) if change.moves else text
