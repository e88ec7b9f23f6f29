# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the add-on in Blender's real window: load a picture, run all stages, stop, undo, save, reload.

    python tests/desktop/run_panel.py --blender /path/to/blender [--picture FILE] [--shots DIR]

Needs a screen (a virtual one does) and a Blender whose Python has pydantic and Pillow. It works in a profile of its
own that is removed afterwards. Screenshots of the window go to the shots folder; the exit code is 0 when every check
held.
"""

from __future__ import annotations

import argparse
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PARTS = ("__init__.py", "blender_manifest.toml", "operators", "panels", "pipeline", "prompts")
TIME_OUT = 400


def install(profile: Path) -> None:
    """Copy the add-on to where Blender keeps extensions."""
    target = profile / "extensions" / "user_default" / "code_as_room"
    target.mkdir(parents=True)
    for part in PARTS:
        source = ROOT / part
        if source.is_dir():
            shutil.copytree(source, target / part, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target / part)


def default_picture() -> Path:
    """The bundled sample."""
    return ROOT / "samples" / "bedroom" / "picture.png"


def run(blender: str, picture: Path, shots: Path) -> int:
    """Start Blender, wait, and tell what it found; returns the exit code."""
    shots.mkdir(parents=True, exist_ok=True)
    results = shots / "results.json"
    results.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(prefix="code-as-room-desktop-") as folder:
        profile = Path(folder)
        install(profile)
        environment = {**os.environ, "BLENDER_USER_RESOURCES": folder, "CODE_AS_ROOM_SHOTS": str(shots)}
        environment["CODE_AS_ROOM_PICTURE"] = str(picture)
        inside = str(Path(__file__).with_name("inside_blender.py"))
        # The program may be a wrapper with arguments of its own.
        program = [blender] if Path(blender).is_file() else shlex.split(blender)
        command = [
            *program,
            "--window-geometry",
            "0",
            "0",
            "1600",
            "1000",
            "--python-exit-code",
            "3",
            "--python",
            inside,
        ]
        try:
            done = subprocess.run(command, env=environment, timeout=TIME_OUT, check=False)
        except FileNotFoundError:
            print(f"There is no program {blender!r}. Name Blender with --blender.", file=sys.stderr)
            return 2
        except subprocess.TimeoutExpired:
            print(f"Blender did not end within {TIME_OUT} s.", file=sys.stderr)
            return 1
    if not results.is_file():
        print(f"Blender ended with {done.returncode} and left no results.", file=sys.stderr)
        return 1
    return tell(json.loads(results.read_text(encoding="utf-8")))


def tell(results: dict[str, object]) -> int:
    """Print every check; 1 when one failed."""
    checks = results.get("checks", {})
    assert isinstance(checks, dict)
    for name, held in checks.items():
        print(f"{'ok    ' if held else 'FAILED'} {name}")
    print(json.dumps(results.get("numbers", {}), indent=1))
    if results.get("error"):
        print(results["error"], file=sys.stderr)
    return 0 if checks and all(checks.values()) and not results.get("error") else 1


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--blender", default=os.environ.get("BLENDER", "blender"))
    parser.add_argument("--picture", type=Path, default=default_picture())
    parser.add_argument("--shots", type=Path, default=ROOT / "build" / "desktop")
    options = parser.parse_args()
    return run(options.blender, options.picture.resolve(), options.shots.resolve())


if __name__ == "__main__":
    raise SystemExit(main())
