# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the results of a run: room.py with its textures, room.blend, scene.json, memory.json, pictures, report.html.

All of them are made beside their places first and moved there together, so that a full disk or a crash leaves neither
half a file nor results of two rooms.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..pipeline.artifacts.analysis import Calibration
from ..pipeline.artifacts.layout import LayoutProgram
from ..pipeline.backend import ImageKeeper
from ..pipeline.errors import OutputError, RoomError
from ..pipeline.layout.hand import apply_hand_edits
from ..pipeline.layout.overlay import draw_outlines
from ..pipeline.memory import Memory, dump_memory
from ..pipeline.objects.text import relaid
from ..pipeline.program.assemble import assemble_file
from ..pipeline.program.evaluate import evaluate
from ..pipeline.program.limits import FINISHED_ROOM_LIMITS
from ..pipeline.program.lines import parse_layout
from ..pipeline.program.pictures import picture_names
from ..pipeline.program.prelude.image_files import IMAGE_FOLDER, image_file
from ..pipeline.report import make_report
from ..pipeline.run import Run
from .report_pictures import further_pictures

LONG_SIDE = 1120
Write = Callable[[Path], Any]


def write_outputs(run: Run, folder: Path, renders: Mapping[str, Path] | None = None) -> list[Path]:
    """Write everything that the run has so far; main thread only.

    Args:
        renders: pictures of the finished room that the report shows, by the camera's id.

    Raises:
        OutputError: a file cannot be written; what was in the folder before is still there.
        RoomError: there is no layout yet.
    """
    program, calibration = run.memory.latest(LayoutProgram), run.memory.latest(Calibration)
    if program is None or calibration is None:
        raise RoomError("There is no layout yet.", "Run the stages up to the layout first.")
    backend = run.backend
    if not backend.program_text():
        # A finished run that was resumed from its memory alone has nothing in the scene.
        layout, _ = apply_hand_edits(parse_layout(program.text), run.hand_edits(), program.hand_edits)
        backend.build(relaid(program.text, layout))
    text = backend.program_text() or program.text
    document = backend.scene_document(run.picture.name, calibration.camera)
    top = backend.render(calibration.camera, LONG_SIDE, labels=False)
    view = backend.render_view(LONG_SIDE)
    reference = run.picture.for_model()
    overlay = draw_outlines(reference, calibration.camera, parse_layout(text).proxies)
    pictures = {"reference": reference, "top": top, "view": view, "overlay": overlay}
    pictures |= further_pictures(run, renders or {})
    report = make_report(run.memory, pictures, run.reports, run.client.describes)
    return write_together(
        folder,
        {
            "room.py": _bytes(assemble_file(text).encode()),
            "room.blend": backend.save_copy,
            "scene.json": _bytes((document.model_dump_json(indent=1) + "\n").encode()),
            "memory.json": _bytes(dump_memory(run.memory).encode()),
            "top.png": _bytes(top),
            "view.png": _bytes(view),
            "report.html": _bytes(report.encode()),
            **{name: _bytes(data) for name, data in image_files(run, text).items()},
        },
    )


def write_report(run: Run, folder: Path, renders: Mapping[str, Path]) -> Path:
    """Write report.html of results that lie in a folder anew, with pictures that were rendered since.

    Raises:
        OutputError: it cannot be written; the earlier one is still there.
    """
    pictures = {"reference": run.picture.for_model()} | further_pictures(run, renders)
    pictures |= {path.stem: path.read_bytes() for path in (folder / "top.png", folder / "view.png") if path.is_file()}
    program, calibration = run.memory.latest(LayoutProgram), run.memory.latest(Calibration)
    if program is not None and calibration is not None:
        proxies = parse_layout(run.backend.program_text() or program.text).proxies
        pictures["overlay"] = draw_outlines(pictures["reference"], calibration.camera, proxies)
    report = make_report(run.memory, pictures, run.reports, run.client.describes)
    return write_together(folder, {"report.html": _bytes(report.encode())})[0]


def image_files(run: Run, text: str) -> dict[str, bytes]:
    """The images that a room's program shows, as files beside it: by path from its folder, PNG bytes."""
    if not isinstance(run.backend, ImageKeeper):
        return {}
    images = run.backend.kept_images(picture_names(evaluate(text, FINISHED_ROOM_LIMITS)))
    return {f"{IMAGE_FOLDER}/{image_file(name)}": data for name, data in images.items()}


def write_memory(memory: Memory, folder: Path) -> Path:
    """Write memory.json, whole or not at all.

    Raises:
        OutputError: it cannot be written.
    """
    return write_together(folder, {"memory.json": _bytes(dump_memory(memory).encode())})[0]


def write_together(folder: Path, writers: Mapping[str, Write]) -> list[Path]:
    """Let each writer make its file beside its place, then move all of them there.

    The parts lie in the folder itself, since a .blend keeps paths relative to where it was saved.

    Args:
        writers: by file name, or path from the folder on, what writes the file at the path that it is handed.

    Raises:
        OutputError: the folder is gone, full or read-only, or a folder stands where a file belongs.
    """
    mark = f".part-{secrets.token_hex(4)}-"
    name = ""
    try:
        for name in writers:
            if (folder / name).is_dir():
                raise IsADirectoryError(0, "a folder of that name is in its place")
        for name, write in writers.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            write(_part(folder / name, mark))
        for name in writers:
            os.replace(_part(folder / name, mark), folder / name)
    except OSError as error:
        raise OutputError(
            f"{name} cannot be written: {error.strerror or error}.", "Choose another folder, or make room."
        ) from error
    finally:
        for name in writers:
            _forget(_part(folder / name, mark))
    return [folder / name for name in writers]


def _part(path: Path, mark: str) -> Path:
    return path.with_name(mark + path.name)


def _bytes(data: bytes) -> Write:
    def write(path: Path) -> Any:
        path.write_bytes(data)

    return write


def _forget(part: Path) -> None:
    try:
        part.unlink(missing_ok=True)
    except OSError:
        # The folder is gone or read-only; there is nothing that could be cleaned up.
        return
