# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the zips that an artist installs: one a platform, with the wheels that Blender's Python lacks.

    python tools/build_extension.py [--out DIR] [--platform linux-x64 ...] [--lock]

The wheels are fetched with pip from the package index that it is configured with, at the versions and hashes of
`requirements/extension.txt`, and put into the zip as they are. numpy and requests come with Blender. The zips are built
and validated by Blender's own `extension build --split-platforms`, taken from the installed bpy package.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOCK = ROOT / "requirements" / "extension.txt"
BUILD = ROOT / "build" / "extension"
PARTS = ("__init__.py", "blender_manifest.toml", "LICENSE", "README.md", "operators", "panels", "pipeline", "prompts")
PYTHONS = ("3.11", "3.13", "3.14")
"""Blender 4.5 and 5.0; 5.1 and 5.2; builds of Linux distributions that take their own Python."""
TAGS = {
    "linux-x64": ("manylinux2014_x86_64", "manylinux_2_17_x86_64", "manylinux_2_27_x86_64", "manylinux_2_28_x86_64"),
    "windows-x64": ("win_amd64",),
    "macos-arm64": ("macosx_11_0_arm64",),
    "macos-x64": tuple(f"macosx_10_{n}_x86_64" for n in (9, 10, 12, 13, 15)),
}
"""What pip calls the platforms that Blender names so."""


class BuildError(Exception):
    """The zips cannot be built; the text says why and what to do."""


def download(platform: str, requirements: Path, folder: Path) -> list[Path]:
    """Fetch the platform's wheels for every Python into the folder; returns them, sorted by name."""
    folder.mkdir(parents=True, exist_ok=True)
    for version in PYTHONS:
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
        command += ["--only-binary=:all:", "--implementation", "cp", "--python-version", version]
        for tag in (*TAGS[platform], "any"):
            command += ["--platform", tag]
        done = subprocess.run(
            [*command, "--dest", str(folder), "--requirement", str(requirements)],
            check=False,
            capture_output=True,
            text=True,
        )
        if done.returncode:
            said = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
            raise BuildError(
                f"The wheels for {platform}, Python {version}, cannot be fetched: {' '.join(said) or done.stderr.strip()}"
            )
    return sorted(folder.glob("*.whl"))


def stage(wheels: list[Path], platforms: list[str], folder: Path) -> None:
    """Lay out the extension's source: the product's files, the wheels, and a manifest that names them."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for part in PARTS:
        source = ROOT / part
        if source.is_dir():
            shutil.copytree(source, folder / part, ignore=shutil.ignore_patterns("__pycache__", "*.pyc"))
        else:
            shutil.copy(source, folder / part)
    (folder / "wheels").mkdir()
    for wheel in wheels:
        shutil.copy(wheel, folder / "wheels" / wheel.name)
    manifest = (ROOT / "blender_manifest.toml").read_text(encoding="utf-8")
    head, tables = manifest.split("\n[", 1)
    lines = [f"platforms = {_toml(platforms)}", f"wheels = {_toml([f'./wheels/{w.name}' for w in wheels])}"]
    text = "\n".join([head.rstrip(), "", *lines, "", "[" + tables])
    (folder / "blender_manifest.toml").write_text(text, encoding="utf-8")


def _toml(values: list[str]) -> str:
    return "[\n" + "".join(f'    "{value}",\n' for value in values) + "]"


def blender_ext() -> Path:
    """Blender's own packager inside the installed bpy package.

    Raises:
        BuildError: bpy is not installed here.
    """
    found = importlib.util.find_spec("bpy")
    home = Path(found.origin).parent if found is not None and found.origin else Path()
    for path in home.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"):
        return path
    raise BuildError("bpy is not installed for this Python; run `make setup` and use .venv/bin/python.")


def build(source: Path, out: Path, split: bool) -> list[Path]:
    """Build and validate the zips; returns them."""
    out.mkdir(parents=True, exist_ok=True)
    for old in out.glob("code_as_room-*.zip"):
        old.unlink()
    command = [sys.executable, str(blender_ext()), "build", "--source-dir", str(source), "--output-dir", str(out)]
    _call([*command, "--split-platforms"] if split else command)
    zips = sorted(out.glob("code_as_room-*.zip"))
    for path in zips:
        _call([sys.executable, str(blender_ext()), "validate", str(path)])
    return zips


def _call(command: list[str]) -> None:
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode:
        raise BuildError(f"{Path(command[1]).name} {command[2]} refuses: {(done.stdout + done.stderr).strip()}")


def lock() -> None:
    """Write the hashes of every platform's wheels beside the versions that stand in the lock file."""
    pins = re.findall(r"^([A-Za-z0-9_.-]+==[^\s\\]+)", LOCK.read_text(encoding="utf-8"), re.MULTILINE)
    bare = BUILD / "pins.txt"
    bare.parent.mkdir(parents=True, exist_ok=True)
    bare.write_text("\n".join(pins) + "\n", encoding="utf-8")
    hashes: dict[str, set[str]] = {pin: set() for pin in pins}
    for platform in TAGS:
        for wheel in download(platform, bare, BUILD / "lock" / platform):
            name, version = wheel.name.split("-")[:2]
            pin = next(p for p in pins if p.lower().replace("-", "_") == f"{name}=={version}".lower())
            hashes[pin].add(hashlib.sha256(wheel.read_bytes()).hexdigest())
    lines = [line for line in LOCK.read_text(encoding="utf-8").splitlines() if line.startswith("#")]
    for pin in pins:
        lines.append(" \\\n".join([pin, *(f"    --hash=sha256:{digest}" for digest in sorted(hashes[pin]))]))
    LOCK.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description="Build the installable zips of the Blender extension.")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder for the zips (default: dist)")
    parser.add_argument("--platform", action="append", choices=sorted(TAGS), help="only this platform (repeatable)")
    parser.add_argument("--lock", action="store_true", help="write the lock file's hashes anew, then build")
    arguments = parser.parse_args()
    platforms: list[str] = arguments.platform or list(TAGS)
    try:
        if arguments.lock:
            lock()
        wheels: dict[str, Path] = {}
        for platform in platforms:
            print(f"Fetching wheels for {platform}")
            digest = hashlib.sha256(LOCK.read_bytes()).hexdigest()[:12]
            for wheel in download(platform, LOCK, BUILD / "wheels" / digest / platform):
                wheels[wheel.name] = wheel
        stage([wheels[name] for name in sorted(wheels)], platforms, BUILD / "source")
        for path in build(BUILD / "source", arguments.out, split=True):
            print(f"{path}  {path.stat().st_size / 1e6:.1f} MB")
    except BuildError as error:
        print(f"build_extension: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
