# SPDX-License-Identifier: GPL-3.0-or-later
"""The two commands: `code-as-room PICTURE --out DIR` and `blender --command code_as_room PICTURE --out DIR`."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..pipeline.errors import OutputError, RoomError

if TYPE_CHECKING:
    from ..pipeline.models.base import ModelClient
    from ..pipeline.models.image_base import ImageClient
    from ..pipeline.run import Run

EXIT_PROBLEM = 1
EXIT_USAGE = 2
EXIT_STOPPED = 130
DEBUG = "CODE_AS_ROOM_DEBUG"
PAINTED = ".painted"
"""Folder of the images that were painted, for as long as the run that paid for them has not ended."""


def parser(program: str) -> argparse.ArgumentParser:
    """The command line."""
    result = argparse.ArgumentParser(
        prog=program, description="One picture of a room seen from above becomes an editable Blender room."
    )
    result.add_argument("picture", type=Path, help="PNG, JPEG, WebP or TIFF picture of a room seen from above")
    result.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the results")
    result.add_argument("--width", type=float, metavar="M", help="the room's inner width in metres, when you know it")
    result.add_argument(
        "--wall-height", type=float, metavar="M", help="height of the walls in metres, when you know it"
    )
    result.add_argument("--notes", default="", help="a hint for the model, such as 'the bed is 1.4 m wide'")
    result.add_argument("--iterations", type=int, default=5, metavar="N", help="most rounds of the layout loop (0-5)")
    result.add_argument(
        "--render",
        nargs="?",
        const=768,
        default=0,
        type=int,
        metavar="PIXELS",
        help="render the room's views too (render_reference.png, render_top.png, ...), with Cycles, this long a side (768)",
    )
    result.add_argument(
        "--draft", action="store_true", help="ask the model for the whole room in one answer; the stages read that"
    )
    result.add_argument(
        "--refine", action="store_true", help="with --draft: then ask for what the measured findings call for"
    )
    result.add_argument("--glb", action="store_true", help="write room.glb too: the room as glTF, for other programs")
    result.add_argument("--usd", action="store_true", help="write room.usdz too: the room as USD, for other programs")
    result.add_argument("--resume", action="store_true", help="go on from DIR/memory.json; finished stages are kept")
    group = result.add_argument_group("who answers (default: the built-in analysis, which needs no model)")
    group.add_argument("--base-url", metavar="URL", help="an OpenAI-style service, such as http://localhost:1234/v1")
    group.add_argument("--model", metavar="NAME", help="the model's name at that service")
    group.add_argument("--key-env", metavar="NAME", help="environment variable that holds the key")
    group.add_argument("--replies", type=Path, metavar="DIR", help="play back replies recorded in this folder")
    group.add_argument("--record", type=Path, metavar="DIR", help="record every reply in this folder")
    images = result.add_argument_group("who paints images for surfaces (default: nobody; the picture itself is used)")
    images.add_argument(
        "--image-base-url", metavar="URL", help="a service that paints, such as http://localhost:8080/v1"
    )
    images.add_argument("--image-model", metavar="NAME", help="the image model's name at that service")
    images.add_argument("--image-key-env", metavar="NAME", help="environment variable that holds its key")
    images.add_argument(
        "--image-provider",
        choices=("none", "openai", "gemini", "custom"),
        help="which service's way of asking (custom)",
    )
    return result


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line in plain Python with the `bpy` package; returns the exit code."""
    return cli_main(list(sys.argv[1:] if argv is None else argv), "code-as-room")


def cli_main(argv: list[str], program: str = "blender --command code_as_room") -> int:
    """Run the command line; errors become one sentence on standard error, never a traceback."""
    _print_anything()
    try:
        options = parser(program).parse_args(argv)
    except SystemExit as stop:
        return int(stop.code or 0) and EXIT_USAGE
    try:
        return _perform(options)
    except RoomError as error:
        print(f"{program}: {_one_line(str(error))}", file=sys.stderr)
        return EXIT_PROBLEM
    except KeyboardInterrupt:
        print(f"\n{program}: stopped. What was answered is kept; add --resume to go on.", file=sys.stderr)
        return EXIT_STOPPED
    except Exception as error:
        # A mistake of ours. The artist is told what to do; who looks for it sets the variable.
        if os.environ.get(DEBUG):
            traceback.print_exc()
        words = _one_line(f"{type(error).__name__}: {error}")[:300]
        print(f"{program}: unexpected problem ({words}). Please report it; {DEBUG}=1 shows where.", file=sys.stderr)
        return EXIT_PROBLEM


def _print_anything() -> None:
    """Names may hold characters that the terminal cannot show; that must not end a run."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="backslashreplace")


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _perform(options: argparse.Namespace) -> int:
    from ..pipeline.draft.client import DraftedClient
    from ..pipeline.picture import load_picture
    from ..pipeline.spending import begin_total
    from ..pipeline.stages import all_stages, s00_draft
    from .keeping import MemoryFile

    picture = load_picture(options.picture)
    real = client = _client(options)
    if (options.draft or options.refine) and real.name == "builtin":
        raise RoomError(
            "A draft needs a model that sees.", "Name one with --base-url and --model, or leave --draft out."
        )
    folder = prepare_folder(options.out)
    kept = MemoryFile(folder, options.resume)
    memory = kept.load()
    begin_total(client, memory.cost()[2])
    stages = all_stages()
    if options.draft or options.refine:
        client = DraftedClient(real, memory)
        stages = (s00_draft.STAGE, *stages)
    memory.settings = _settings(options, memory.settings)
    for note in picture.notes:
        print(f"Note: {note}")
    print(f"Picture: {picture.name}, {picture.width} x {picture.height}")
    print(f"Answers: {client.describes}")
    try:
        import bpy
    except ImportError as error:
        raise RoomError(
            f"Blender's Python module cannot be loaded ({error}).", "Run `make demo` once, or use blender --command."
        ) from error
    from ..pipeline.run import Run
    from ..pipeline.run_images import bring_images
    from ..pipeline.scene.backend import BlenderScene
    from ..pipeline.textures.kept import KeptImages
    from . import own_file

    bpy.ops.wm.read_factory_settings(use_empty=True)
    painter, painted = _painter(options, client), KeptImages(folder / PAINTED)
    run = Run(
        picture,
        memory,
        client,
        BlenderScene(bpy.context.scene),
        progress=_print_progress,
        painter=painter,
        painted=painted,
    )
    if painter is not None:
        print(f"Images: {painter.describes}")
    bring_images(memory, run.backend, folder)
    try:
        for stage in stages:
            run.run_all([stage])
            kept.keep(memory)
        if client is not real:
            _judge(run, real, options.refine)
            kept.keep(memory)
        with own_file.scene_settings():
            own_file.keep_start(bpy.context.scene, picture, memory.settings)
            _finish(run, folder)
        _export(bpy.context.scene, folder, options)
        if options.render:
            _render(run, bpy.context.scene, folder, max(64, min(4096, options.render)))
    except BaseException:
        # A client that is still waiting for an answer gives up on this.
        run.cancel.set()
        kept.keep(memory)
        if kept.told():
            print(kept.told())
        raise
    kept.finish()
    shutil.rmtree(folder / PAINTED, ignore_errors=True)  # what was used lies beside room.py now
    return 0


def _finish(run: Run, folder: Path) -> None:
    from ..pipeline.artifacts.layout import LayoutProgram
    from .outputs import write_outputs

    paths = write_outputs(run, folder)
    program = run.memory.latest(LayoutProgram)
    if program is not None:
        states = [entry.state for entry in program.ledger]
        counts = ", ".join(
            f"{states.count(s)} {s}" for s in ("detailed", "placed", "deferred", "dropped") if s in states
        )
        print(f"Objects: {len(states)} detected: {counts or 'none'}. Layout score {program.score.total:.2f}.")
    print(f"Made by: {run.client.describes}")
    print(f"Results in {folder}:")
    for path in paths:
        print(f"  {path.relative_to(folder).as_posix()}")


def _judge(run: Run, real: ModelClient, refined: bool) -> None:
    """Say how good the draft is, and refine it where that is wanted."""
    from ..pipeline.draft.verdict import judge
    from ..pipeline.run_refining import refine

    verdict = judge(run.memory)
    if verdict is not None:
        print(verdict.sentence)
    if refined:
        refine(run, real, lambda words: print(f"  {words}", flush=True))


def _export(scene: object, folder: Path, options: argparse.Namespace) -> None:
    """The room for other programs, beside the other results."""
    from ..pipeline.scene.exports import export_glb, export_usdz

    for wanted, export, name in ((options.glb, export_glb, "room.glb"), (options.usd, export_usdz, "room.usdz")):
        if wanted:
            print(f"  {export(scene, folder / name).name}", flush=True)


def _render(run: Run, scene: object, folder: Path, long_side: int) -> None:
    """A picture of each of the room's cameras beside the other results, and in the report."""
    from ..pipeline.scene.shoot import camera_lines, shoot
    from .outputs import write_report

    renders = {}
    for line in camera_lines(scene):
        print(f"  Rendering {line.id}", flush=True)
        renders[line.id] = folder / f"render_{line.id}.png"
        shoot(scene, line.id, renders[line.id], long_side)
    write_report(run, folder, renders)


def prepare_folder(folder: Path, option: str = "--out") -> Path:
    """The folder of an option, made if it is not there and tried for writing before any work is done.

    Raises:
        OutputError: it is a file, or nothing can be written in it.
    """
    try:
        if folder.is_file():
            raise OutputError(f"{folder} is a file, not a folder.", f"Choose a folder with {option}.")
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".try-", delete=True):
            pass
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise OutputError(
            f"Nothing can be written in {folder}: {reason}.", f"Choose another folder with {option}."
        ) from error
    return folder


def _settings(options: argparse.Namespace, earlier: dict[str, str]) -> dict[str, str]:
    settings = dict(earlier)
    for name, value, low, high in (
        ("known_width_m", options.width, 0.5, 100.0),
        ("wall_height_m", options.wall_height, 1.0, 20.0),
    ):
        if value is None:
            continue
        if not low <= value <= high:
            raise RoomError(f"{value:g} m is not a possible size.", f"Give metres between {low:g} and {high:g}.")
        settings[name] = f"{value:g}"
    if options.notes:
        # An argument may hold bytes that are no text.
        settings["notes"] = options.notes.encode("utf-8", "replace").decode("utf-8")
    settings["iterations"] = str(max(0, min(5, options.iterations)))
    return settings


def _client(options: argparse.Namespace) -> ModelClient:
    from ..pipeline.ask_floor import with_floor
    from ..pipeline.models.recorded import Recorder
    from ..pipeline.models.registry import ClientSettings, make_client, settings_from_environment
    from ..pipeline.spending import metered

    if options.replies is not None:
        settings = ClientSettings(kind="recorded", folder=str(options.replies))
    elif options.base_url:
        key = os.environ.get(options.key_env, "") if options.key_env else os.environ.get("CODE_AS_ROOM_API_KEY", "")
        given = {"PROVIDER": "custom", "BASE_URL": options.base_url, "MODEL": options.model or "", "API_KEY": key}
        settings = settings_from_environment({**os.environ, **{f"CODE_AS_ROOM_{name}": v for name, v in given.items()}})
    else:
        settings = settings_from_environment()
    client = with_floor(metered(make_client(settings), settings), settings)
    if options.record is None:
        return client
    return Recorder(client, prepare_folder(options.record, "--record"))


def _painter(options: argparse.Namespace, client: ModelClient) -> ImageClient | None:
    """The image model that the options, or the environment, name; its images count towards the questions' cap."""
    from ..pipeline.models.image_registry import image_settings_from_environment, make_image_client
    from ..pipeline.spending import Meter, meter_of
    from ..pipeline.spending_images import metered_painter

    given = {
        "PROVIDER": options.image_provider or "",
        "BASE_URL": options.image_base_url or "",
        "MODEL": options.image_model or "",
        "API_KEY": os.environ.get(options.image_key_env, "") if options.image_key_env else "",
    }
    said = {f"CODE_AS_ROOM_IMAGE_{name}": value for name, value in given.items() if value}
    settings = image_settings_from_environment({**os.environ, **said})
    return metered_painter(make_image_client(settings), settings, meter_of(client) or Meter())


def _print_progress(what: str, step: int, steps: int) -> None:
    print(f"  {what}" + (f" ({step}/{steps})" if steps else ""), flush=True)
