# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures for how long Blender's window stands still while the add-on works: gaps of a 10 ms timer, by phase.

    python -m tests.desktop.stalls --blender /path/to/blender [--objects 40] [--delay 3] [--profile]

A room with many objects is made from prepared answers that a service on this computer streams slowly. The figures are
printed, never asserted: they depend on the machine. Needs a screen (a virtual one does).
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
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(Path(__file__).parent))
from many_objects import Service, draw, replies  # noqa: E402

PARTS = ("__init__.py", "blender_manifest.toml", "operators", "panels", "pipeline", "prompts")
TIME_OUT = 600


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


def measure(options: argparse.Namespace) -> dict[str, Any]:
    """Start Blender and wait for its figures."""
    service = Service(replies(options.objects), options.delay)
    with tempfile.TemporaryDirectory(prefix="code-as-room-stalls-") as folder:
        profile = Path(folder)
        install(profile)
        picture, results = profile / "hall.png", profile / "results.json"
        draw(picture, options.objects)
        environment = {
            **os.environ,
            "BLENDER_USER_RESOURCES": folder,
            "STALLS_PICTURE": str(picture),
            "STALLS_RESULTS": str(results),
            "STALLS_URL": service.url,
            "STALLS_SHOTS": str(options.shots or ""),
            "STALLS_PROFILE": "1" if options.profile else "",
        }
        # The program may be a wrapper with arguments of its own.
        program = [options.blender] if Path(options.blender).is_file() else shlex.split(options.blender)
        inside = str(Path(__file__).with_name("stalls_inside.py"))
        command = [*program, "--window-geometry", "0", "0", "1600", "1000", "--python", inside]
        subprocess.run(command, env=environment, timeout=TIME_OUT, check=False, stdout=None if options.verbose else -3)
        if not results.is_file():
            raise SystemExit("Blender left no figures; try --verbose.")
        found: dict[str, Any] = json.loads(results.read_text(encoding="utf-8"))
        return found


def tell(found: dict[str, Any]) -> None:
    """Print the table."""
    print(f"{'phase':<46}{'gaps':>6}{'longest, ms':>13}{'99 %, ms':>10}{'ours, ms':>10}{'ours, CPU ms':>14}")
    for row in found["table"]:
        times = f"{row['longest']:>13.0f}{row['p99']:>10.0f}{row['ours']:>10.0f}{row['cpu']:>14.0f}"
        print(f"{row['phase']:<46}{row['count']:>6}{times}")
    print(f"\n{'the add-on on the main thread':<46}{'times':>6}{'longest, ms':>13}{'CPU, ms':>10}")
    for row in found["work"]:
        print(f"{row['work']:<46}{row['count']:>6}{row['wall']:>13.0f}{row['cpu']:>10.0f}")
    print()
    for name, value in found["numbers"].items():
        print(f"{name}: {value}")
    if found.get("error"):
        print(found["error"], file=sys.stderr)


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--blender", default=os.environ.get("BLENDER", "blender"))
    parser.add_argument("--objects", type=int, default=40)
    parser.add_argument("--delay", type=float, default=3.0, help="seconds before an answer begins")
    parser.add_argument("--profile", action="store_true", help="profile the main thread's work too")
    parser.add_argument("--shots", type=Path, help="folder for screenshots")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    found = measure(options)
    tell(found)
    return 1 if found.get("error") else 0


if __name__ == "__main__":
    raise SystemExit(main())
