# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the results of a run: room.py, room.blend, scene.json, memory.json, top.png, view.png, report.html.

Every file is written beside its place first and moved there whole, so that a full disk or a crash leaves no half file.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..pipeline.artifacts.analysis import Calibration
from ..pipeline.artifacts.layout import LayoutProgram
from ..pipeline.errors import OutputError, RoomError
from ..pipeline.layout.overlay import draw_outlines
from ..pipeline.memory import Memory, dump_memory
from ..pipeline.program.assemble import assemble
from ..pipeline.program.lines import parse_layout
from ..pipeline.report import make_report
from ..pipeline.run import Run

LONG_SIDE = 1280


def write_outputs(run: Run, folder: Path) -> list[Path]:
    """Write everything that the run has so far; main thread only.

    Raises:
        OutputError: a file cannot be written; those written before it are whole.
        RoomError: there is no layout yet.
    """
    program, calibration = run.memory.latest(LayoutProgram), run.memory.latest(Calibration)
    if program is None or calibration is None:
        raise RoomError("There is no layout yet.", "Run the stages up to the layout first.")
    backend = run.backend
    text = backend.program_text() or program.text
    document = backend.scene_document(run.picture.name, calibration.camera)
    top = backend.render(calibration.camera, LONG_SIDE, labels=False)
    view = backend.render_view(LONG_SIDE)
    overlay = draw_outlines(run.picture.for_model(), calibration.camera, parse_layout(text).proxies)
    pictures = {"reference": run.picture.for_model(), "top": top, "view": view, "overlay": overlay}
    return [
        write_file(folder / "room.py", assemble(text).encode()),
        write_with(folder / "room.blend", backend.save_copy),
        write_file(folder / "scene.json", (document.model_dump_json(indent=1) + "\n").encode()),
        write_memory(run.memory, folder),
        write_file(folder / "top.png", top),
        write_file(folder / "view.png", view),
        write_file(
            folder / "report.html", make_report(run.memory, pictures, run.reports, run.client.describes).encode()
        ),
    ]


def write_memory(memory: Memory, folder: Path) -> Path:
    """Write memory.json."""
    return write_file(folder / "memory.json", dump_memory(memory).encode())


def write_file(path: Path, data: bytes) -> Path:
    """Write bytes to a file, whole or not at all."""

    def write(part: Path) -> Any:
        part.write_bytes(data)

    return write_with(path, write)


def write_with(path: Path, write: Callable[[Path], Any]) -> Path:
    """Let `write` make a file beside its place, then move it there.

    Raises:
        OutputError: the folder is gone, full or read-only.
    """
    part: Path | None = None
    try:
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".part-") as folder:
            part = Path(folder) / path.name
            write(part)
            os.replace(part, path)
    except OSError as error:
        raise OutputError(
            f"{path.name} cannot be written: {error.strerror or error}.", "Choose another folder, or make room."
        ) from error
    return path
