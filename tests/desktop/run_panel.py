# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs the built extension into a clean profile of the real Blender and works in its window as an artist would.

    python tests/desktop/run_panel.py --blender /path/to/blender [--zip FILE | --source] [--shots DIR]

Loads the sample picture, runs all stages with the recorded replies, moves a proxy, resumes, undoes, stops, saves, loads
and resumes again; takes a screenshot at each step. Needs a screen (a virtual one does). The exit code is 0 when every
check held.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PARTS = ("__init__.py", "blender_manifest.toml", "operators", "panels", "pipeline", "prompts")
INSIDE = Path(__file__).with_name("inside") / "main.py"
TIME_OUT = 1800


class DesktopError(Exception):
    """The test cannot be run; the text says why."""


def program_of(blender: str) -> list[str]:
    """The command line's beginning: a program, or a wrapper with arguments of its own."""
    return [blender] if Path(blender).is_file() else shlex.split(blender)


def platform_name() -> str:
    """This machine's platform as the zips name it."""
    system = {"Linux": "linux", "Windows": "windows", "Darwin": "macos"}[platform.system()]
    return f"{system}-{'arm64' if platform.machine() in ('arm64', 'aarch64') else 'x64'}"


def build_zip(folder: Path) -> Path:
    """Build the extension for this platform."""
    command = [sys.executable, str(ROOT / "tools" / "build_extension.py"), "--out", str(folder)]
    subprocess.run([*command, "--platform", platform_name()], check=True)
    return next(iter(folder.glob("code_as_room-*.zip")))


def install_zip(blender: str, path: Path, profile: Path, repository: str = "user_default") -> None:
    """Install a zip with Blender's own command.

    Raises:
        DesktopError: Blender refused.
    """
    # The wrapper of a virtual screen is not needed here, and a profile is named by the environment.
    command = [*program_of(blender), "--background", "--command", "extension", "install-file"]
    done = subprocess.run(
        [*command, "-r", repository, str(path)],
        env={**os.environ, "BLENDER_USER_RESOURCES": str(profile)},
        check=False,
        capture_output=True,
        text=True,
        timeout=TIME_OUT,
    )
    if done.returncode or not (profile / "extensions" / repository / "code_as_room").is_dir():
        raise DesktopError(f"Blender did not install {path.name}: {done.stdout}{done.stderr}")


def install_source(profile: Path) -> None:
    """Copy the source to where Blender keeps extensions; its Python must have pydantic and Pillow then."""
    target = profile / "extensions" / "user_default" / "code_as_room"
    target.mkdir(parents=True)
    for part in PARTS:
        source = ROOT / part
        if source.is_dir():
            shutil.copytree(source, target / part, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target / part)


def start(blender: str, script: Path, profile: Path, environment: dict[str, str]) -> int:
    """Run Blender with its window and a script; returns its exit code.

    Raises:
        DesktopError: there is no such program, or it does not end.
    """
    command = [*program_of(blender), "--enable-event-simulate", "--window-geometry", "0", "0", "1600", "1000"]
    command += ["--python-exit-code", "3", "--python", str(script)]
    given = {**os.environ, "BLENDER_USER_RESOURCES": str(profile), **environment}
    try:
        return subprocess.run(command, env=given, timeout=TIME_OUT, check=False).returncode
    except FileNotFoundError:
        raise DesktopError(f"There is no program {blender!r}. Name Blender with --blender.") from None
    except subprocess.TimeoutExpired:
        raise DesktopError(f"Blender did not end within {TIME_OUT} s.") from None


def run(options: argparse.Namespace) -> int:
    """Install, start Blender, wait, and tell what it found; returns the exit code."""
    shots: Path = options.shots.resolve()
    shots.mkdir(parents=True, exist_ok=True)
    results = shots / "results.json"
    results.unlink(missing_ok=True)
    environment = {
        "CODE_AS_ROOM_SHOTS": str(shots),
        "CODE_AS_ROOM_PICTURE": str(options.picture.resolve()),
        "CODE_AS_ROOM_REPLIES": str(options.replies.resolve()) if options.replies else "",
    }
    with tempfile.TemporaryDirectory(prefix="code-as-room-desktop-") as folder:
        profile = Path(folder) / "profile"
        profile.mkdir()
        if options.source:
            install_source(profile)
        else:
            install_zip(options.blender, options.zip or build_zip(Path(folder) / "zips"), profile)
        code = start(options.blender, INSIDE, profile, environment)
    if not results.is_file():
        raise DesktopError(f"Blender ended with {code} and left no results.")
    return tell(json.loads(results.read_text(encoding="utf-8")))


def tell(results: dict[str, Any]) -> int:
    """Print every check; 1 when one failed."""
    checks: dict[str, bool] = results.get("checks", {})
    for name, held in checks.items():
        print(f"{'ok    ' if held else 'FAILED'} {name}")
    print(json.dumps(results.get("numbers", {}), indent=1))
    if results.get("error"):
        print(results["error"], file=sys.stderr)
    return 0 if checks and all(checks.values()) and not results.get("error") else 1


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--blender", default=os.environ.get("BLENDER", "blender"), help="the program, or a command line"
    )
    parser.add_argument("--zip", type=Path, help="an extension that is built already; by default it is built")
    parser.add_argument("--source", action="store_true", help="copy the source instead of installing a zip")
    parser.add_argument("--picture", type=Path, default=ROOT / "samples" / "bedroom" / "picture.png")
    parser.add_argument("--replies", type=Path, default=ROOT / "samples" / "bedroom" / "replies")
    parser.add_argument("--shots", type=Path, default=ROOT / "build" / "desktop", help="folder for the screenshots")
    try:
        return run(parser.parse_args())
    except (DesktopError, subprocess.SubprocessError) as error:
        print(f"desktop test: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    raise SystemExit(main())
