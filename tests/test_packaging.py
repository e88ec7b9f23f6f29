# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip that an artist installs, built here for this machine's platform; and the extension platform's rules."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parent.parent
PRODUCT = [ROOT / "__init__.py", *(p for d in ("operators", "panels", "pipeline") for p in (ROOT / d).rglob("*.py"))]
NEEDED = {"annotated_types", "pillow", "pydantic", "pydantic_core", "typing_extensions", "typing_inspection"}
PYTHONS = {"cp311", "cp313", "cp314"}


@pytest.fixture(scope="module")
def zipped(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    """The extension as `make extension` builds it, for Linux alone; Blender's packager has validated it."""
    folder = tmp_path_factory.mktemp("zips")
    command = [
        sys.executable,
        str(ROOT / "tools" / "build_extension.py"),
        "--out",
        str(folder),
        "--platform",
        "linux-x64",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    [path] = folder.glob("*.zip")
    return zipfile.ZipFile(path)


def manifest_of(zipped: zipfile.ZipFile) -> dict[str, Any]:
    return tomllib.loads(zipped.read("blender_manifest.toml").decode())


def test_the_zip_holds_the_product_and_nothing_of_its_development(zipped: zipfile.ZipFile) -> None:
    tops = {name.split("/")[0] for name in zipped.namelist()}
    product = {
        "__init__.py",
        "blender_manifest.toml",
        "LICENSE",
        "README.md",
        "operators",
        "panels",
        "pipeline",
        "prompts",
    }
    assert tops == product | {"wheels"}
    assert not [n for n in zipped.namelist() if n.endswith((".pyc", ".blend", ".orig")) or "__pycache__" in n]


def test_every_product_file_is_in_the_zip(zipped: zipfile.ZipFile) -> None:
    here = {str(p.relative_to(ROOT)) for p in [*PRODUCT, *(ROOT / "prompts").glob("*.md")]}
    assert here <= set(zipped.namelist())


def test_the_wheels_fit_every_supported_blender(zipped: zipfile.ZipFile) -> None:
    wheels = [Path(name).name for name in zipped.namelist() if name.endswith(".whl")]
    assert {w.split("-")[0].lower() for w in wheels} == NEEDED
    for package in ("pydantic_core", "pillow"):
        tags = {w.split("-")[2] for w in wheels if w.startswith(package)}
        assert tags == PYTHONS
        assert all("manylinux" in w and "x86_64" in w for w in wheels if w.startswith(package))
    assert sorted(manifest_of(zipped)["wheels"]) == sorted(f"./wheels/{w}" for w in wheels)


def test_pydantic_and_its_core_belong_together(zipped: zipfile.ZipFile, tmp_path: Path) -> None:
    [name] = [n for n in zipped.namelist() if Path(n).name.startswith("pydantic-")]
    wheel = zipfile.ZipFile(zipped.extract(name, tmp_path))
    [meta] = [n for n in wheel.namelist() if n.endswith(".dist-info/METADATA")]
    wanted = re.search(r"Requires-Dist: pydantic-core==(\S+)", wheel.read(meta).decode())
    assert wanted is not None
    cores = {Path(n).name.split("-")[1] for n in zipped.namelist() if Path(n).name.startswith("pydantic_core-")}
    assert cores == {wanted.group(1)}


def test_the_manifest_keeps_what_it_says_and_names_its_platform(zipped: zipfile.ZipFile) -> None:
    source = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    built = manifest_of(zipped)
    assert {k: v for k, v in source.items() if k != "build"}.items() <= built.items()
    assert built["platforms"] == ["linux-x64"] or built["build"]["generated"]["platforms"] == ["linux-x64"]


def test_the_manifest_follows_the_platforms_rules() -> None:
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert manifest["id"].isidentifier() and "__" not in manifest["id"]
    assert "blender" not in manifest["name"].lower()
    for text in (manifest["tagline"], *manifest["permissions"].values()):
        assert len(text) <= 64 and text[-1].isalnum()
    assert set(manifest["tags"]) <= {"3D View", "Scene", "Pipeline", "Import-Export", "Modeling", "Camera", "Material"}
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert (
        manifest["version"]
        == tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    )


@pytest.mark.parametrize("path", PRODUCT, ids=lambda p: str(p.relative_to(ROOT)))
def test_no_file_breaks_the_platforms_rules(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        dotted = ast.unparse(node) if isinstance(node, ast.Attribute) else ""
        assert dotted not in ("sys.path", "bpy.app.online_access_overriden"), f"line {node.lineno}"
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            assert name not in ("exec", "eval", "compile", "__import__"), f"line {node.lineno}"
            assert name not in ("subprocess.run", "subprocess.Popen", "os.system"), f"line {node.lineno}"
