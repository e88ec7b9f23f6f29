"""The dependency rule and the rules of the extension platform, checked on the source itself."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PRODUCT = [
    ROOT / "__init__.py",
    *(p for d in ("operators", "panels", "pipeline") for p in sorted((ROOT / d).rglob("*.py"))),
]
BLENDER = {"bpy", "bmesh", "gpu", "mathutils", "bpy_extras", "gpu_extras", "addon_utils", "blf", "bl_ui"}
RUNTIME = {"requests", "urllib3", "PIL", "numpy", "pydantic", "pydantic_core"}
# A file may import its own layer and lower ones. Files beside the folders count by the first word of their name.
LAYERS = {
    "errors": 0, "artifacts": 0, "program": 1, "geometry": 1, "library": 1, "models": 1, "picture": 1, "memory": 1,
    "backend": 1, "spending": 1, "journal": 1, "analysis": 2, "layout": 2, "objects": 2, "surfaces": 2,
    "retrieval": 2, "textures": 2, "light": 2, "draft": 2, "correction": 2, "materials": 2, "stages": 3,
    "prompting": 4, "ask": 4, "run": 5, "report": 5, "scene": 6,
}  # fmt: skip


def imports(path: Path) -> Iterator[tuple[int, str]]:
    """Each import of a file as (level, dotted name)."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((0, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            if node.module:
                yield node.level, node.module
            else:
                yield from ((node.level, alias.name) for alias in node.names)


@pytest.mark.parametrize("path", PRODUCT, ids=lambda p: str(p.relative_to(ROOT)))
def test_blender_is_imported_only_in_its_rooms(path: Path) -> None:
    parts = path.relative_to(ROOT).parts
    allowed = parts[0] in ("operators", "panels", "__init__.py") or parts[:2] == ("pipeline", "scene")
    used = {name.split(".")[0] for level, name in imports(path) if level == 0} & BLENDER
    assert allowed or not used


@pytest.mark.parametrize("path", PRODUCT, ids=lambda p: str(p.relative_to(ROOT)))
def test_only_the_fixed_packages_and_relative_imports(path: Path) -> None:
    import sys

    foreign = {
        name.split(".")[0]
        for level, name in imports(path)
        if level == 0 and name.split(".")[0] not in BLENDER | RUNTIME | set(sys.stdlib_module_names)
    }
    assert not foreign


def room_of(name: str) -> str:
    """The room that a file or folder of the pipeline belongs to."""
    return name.removesuffix(".py").split("_")[0]


def targets(path: Path) -> Iterator[str]:
    """Names of the pipeline's own rooms that a file imports."""
    package = list(path.relative_to(ROOT).parts[:-1])
    for level, name in imports(path):
        if level:
            full = package[: len(package) - level + 1] + name.split(".")
            if full[:1] == ["pipeline"] and len(full) > 1:
                yield full[1]


@pytest.mark.parametrize(
    "path", [p for p in PRODUCT if p.is_relative_to(ROOT / "pipeline")], ids=lambda p: str(p.relative_to(ROOT))
)
def test_dependencies_point_downwards(path: Path) -> None:
    own = room_of(path.relative_to(ROOT / "pipeline").parts[0])
    if own:
        assert not {t for t in map(room_of, targets(path)) if LAYERS[t] > LAYERS[own]}


def test_nothing_a_model_wrote_is_executed() -> None:
    for path in PRODUCT:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in ("exec", "eval", "compile", "__import__"), f"{path}:{node.lineno}"


def test_no_path_of_a_machine_and_no_absolute_import_of_the_add_on() -> None:
    for path in PRODUCT:
        text = path.read_text(encoding="utf-8")
        assert "sys.path" not in text, path
        assert not [n for level, n in imports(path) if level == 0 and n.split(".")[0] in ("code_as_room", "bl_ext")], (
            path
        )


def test_every_folder_of_the_method_is_installed_as_a_package() -> None:
    import tomllib

    listed = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]["packages"]
    folders = {path.parent.relative_to(ROOT).parts for path in PRODUCT if (path.parent / "__init__.py").exists()}
    assert {".".join(("code_as_room", *parts)) for parts in folders} <= set(listed)
