# SPDX-License-Identifier: GPL-3.0-or-later
"""Joins Python modules that import each other into the text of one module that imports none of them.

Every module-level name gets a leading underscore, unless it is public. The room language has no names that begin with
one, so no room program can change what the joined text means, and two modules may use the same name for themselves.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path

PRAGMA = re.compile(r"\s*#\s*(?:fmt:|noqa|type:).*$")
FIELD = re.compile(r"(?<!\{)\{(?!\{)[^{}]*\}")


@dataclass
class Module:
    """One module on its way into the joined text.

    Attributes:
        path: its file.
        text, tree: its source and syntax tree.
        relative: names that it imports from other joined modules: name here -> (file, name there).
        imports: names that it imports from elsewhere: name here -> (statement with {} for the new name).
        own: names that it defines at module level.
        final: what each of its module-level names is called in the joined text.
    """

    path: Path
    text: str
    tree: ast.Module
    relative: dict[str, tuple[Path, str]] = field(default_factory=dict)
    imports: dict[str, str] = field(default_factory=dict)
    own: list[str] = field(default_factory=list)
    final: dict[str, str] = field(default_factory=dict)


class JoinError(Exception):
    """A module is written in a way that cannot be joined: a mistake of its author, never the artist's."""


def join_modules(roots: list[Path], public: Collection[tuple[str, str]]) -> tuple[str, dict[tuple[str, str], str]]:
    """The text of these modules and all that they import relatively, each after those that it needs.

    Args:
        roots: files of the modules.
        public: (module's file name without .py, name) of the names that keep their name.

    Returns:
        The text, imports first; and the name in the text of every (module, name).
    """
    modules = list(_ordered(roots))
    taken: dict[str, str] = {name: name for _, name in public}
    by_path = {module.path: module for module in modules}
    for module in modules:
        _choose_names(module, by_path, taken, public)
    statements = {_import_line(module, name) for module in modules for name in module.imports}
    plain = sorted(line for line in statements if line.startswith("import "))
    parts = ["\n".join([*plain, *sorted(statements - set(plain))])]
    parts += [_section(module) for module in modules]
    names = {(m.path.stem, name): m.final[name] for m in modules for name in m.own}
    return "\n\n\n".join(parts) + "\n", names


def _ordered(roots: list[Path]) -> Iterator[Module]:
    """The modules and their relative imports, depth first."""
    done: set[Path] = set()
    stack: list[Path] = []

    def visit(path: Path) -> Iterator[Module]:
        path = path.resolve()
        if path in stack:
            raise JoinError(f"{path.name} imports itself in a circle")
        if path in done:
            return
        stack.append(path)
        module = _read(path)
        for needed in dict.fromkeys(source for source, _ in module.relative.values()):
            yield from visit(needed)
        stack.pop()
        done.add(path)
        yield module

    for root in roots:
        yield from visit(root)


def _read(path: Path) -> Module:
    text = path.read_text(encoding="utf-8")
    module = Module(path, text, ast.parse(text))
    for node in module.tree.body:
        if isinstance(node, ast.ImportFrom) and node.level:
            base = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            for alias in node.names:
                if not base.with_suffix(".py").is_file():
                    raise JoinError(f"{path.name}: import names from modules, not whole modules ({alias.name})")
                module.relative[alias.asname or alias.name] = (base.with_suffix(".py").resolve(), alias.name)
        elif isinstance(node, ast.ImportFrom) and node.module != "__future__":
            for alias in node.names:
                module.imports[alias.asname or alias.name] = f"from {node.module} import {alias.name} as {{}}"
        elif isinstance(node, ast.Import):
            for alias in node.names:
                if "." in alias.name and alias.asname is None:
                    raise JoinError(f"{path.name}: write import {alias.name} as ...")
                module.imports[alias.asname or alias.name] = f"import {alias.name} as {{}}"
        else:
            module.own.extend(_bound_by(node))
    module.own = list(dict.fromkeys(module.own))
    return module


def _bound_by(node: ast.stmt) -> list[str]:
    """Names that a module-level statement binds."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        return [node.name]
    if isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign)):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        return [n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]
    if isinstance(node, (ast.Expr, ast.ImportFrom)):
        return []
    raise JoinError(f"line {node.lineno}: only definitions, assignments and imports can be joined")


def _choose_names(
    module: Module, by_path: dict[Path, Module], taken: dict[str, str], public: Collection[tuple[str, str]]
) -> None:
    """Fill `final`. `taken` says who has each name already: a module's own name, or an import statement."""
    stem = module.path.stem
    for name, (path, there) in module.relative.items():
        module.final[name] = by_path[path].final[there]
    for name, owner in [*((n, f"{stem}.{n}") for n in module.own), *module.imports.items()]:
        if (stem, name) in public:
            module.final[name] = name
            continue
        bare = name.lstrip("_")
        for candidate in (f"_{bare}", f"_{stem}_{bare}"):
            if taken.setdefault(candidate, owner) == owner:
                module.final[name] = candidate
                break
        else:
            raise JoinError(f"{stem}.{name}: no free name")


def _import_line(module: Module, name: str) -> str:
    return module.imports[name].format(module.final[name])


def _section(module: Module) -> str:
    """A module's text under a heading, renamed, without its imports and docstring."""
    lines = _renamed(module).splitlines()
    for node in module.tree.body:
        docstring = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        if docstring or isinstance(node, (ast.Import, ast.ImportFrom)):
            for number in range(node.lineno - 1, node.end_lineno or node.lineno):
                lines[number] = ""
    kept = [PRAGMA.sub("", line).rstrip() for line in lines if not line.startswith("# SPDX")]
    body = re.sub(r"\n{4,}", "\n\n\n", "\n".join(kept)).strip("\n")
    title = (ast.get_docstring(module.tree) or "").split("\n\n")[0].replace("\n", " ")
    heading = f"# ---- {module.path.stem} "
    return "\n".join([heading + "-" * (72 - len(heading)), *_comment(title), "", body])


def _comment(sentence: str, width: int = 110) -> list[str]:
    """A sentence as comment lines."""
    lines = ["#"]
    for word in sentence.split():
        if len(lines[-1]) + 1 + len(word) > width:
            lines.append("#")
        lines[-1] += f" {word}"
    return lines


def _renamed(module: Module) -> str:
    """The module's text with its module-level names as they are in the joined text."""
    renamer = _Renamer(module)
    renamer.visit(module.tree)
    lines = [line.encode() for line in module.text.split("\n")]
    for row, start, old, new in sorted(set(renamer.edits), reverse=True):
        line = lines[row - 1]
        if line[start : start + len(old)] != old.encode():
            raise JoinError(f"{module.path.name}:{row}: {old} is not where the parser says")
        lines[row - 1] = line[:start] + new.encode() + line[start + len(old) :]
    return b"\n".join(lines).decode()


class _Renamer(ast.NodeVisitor):
    """Collects (line, byte column, old, new) for every use of a module-level name, with Python's rules of scope."""

    def __init__(self, module: Module) -> None:
        self.final = module.final
        self.lines = module.text.split("\n")
        self.hidden: list[set[str]] = [set()]
        self.edits: list[tuple[int, int, str, str]] = []

    def wanted(self, name: str) -> str | None:
        """The new name, None when the name is local here or stays."""
        if any(name in scope for scope in self.hidden):
            return None
        new = self.final.get(name)
        return new if new != name else None

    def visit_Name(self, node: ast.Name) -> None:
        """A use of a name."""
        new = self.wanted(node.id)
        if new:
            self.edits.append((node.lineno, node.col_offset, node.id, new))

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """An f-string: Python 3.11 does not say where the names inside it are, so they are looked for."""
        names = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
        for row in range(node.lineno, (node.end_lineno or node.lineno) + 1):
            line = self.lines[row - 1]
            for found in FIELD.finditer(line):
                for word in re.finditer(r"(?<![\w.'\"])[A-Za-z_]\w*", found.group()):
                    new = self.wanted(word.group()) if word.group() in names else None
                    if new:
                        column = len(line[: found.start() + word.start()].encode())
                        self.edits.append((row, column, word.group(), new))

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        """A function: its name, then all else."""
        self._definition(node, "def ")
        self._routine(node)

    def _definition(self, node: ast.FunctionDef | ast.ClassDef, keyword: str) -> None:
        new = self.wanted(node.name)
        if new:
            column = self.lines[node.lineno - 1].index(keyword + node.name) + len(keyword)
            self.edits.append((node.lineno, column, node.name, new))

    def _routine(self, node: ast.FunctionDef) -> None:
        """What is evaluated outside a function, then its body with its local names hidden."""
        for outside in [*node.decorator_list, node.returns]:
            if outside:
                self.visit(outside)
        self._function(node.args, node.body)

    def visit_Lambda(self, node: ast.Lambda) -> None:
        """A lambda."""
        self._function(node.args, [node.body])

    def _function(self, arguments: ast.arguments, body: list[ast.stmt] | list[ast.expr]) -> None:
        self.visit(arguments)
        names = {a.arg for a in [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]}
        names |= {a.arg for a in (arguments.vararg, arguments.kwarg) if a}
        self._inside(names.union(*map(_local_names, body)), list(body))

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        """A class: names bound in its body hide module names there, but not inside its methods."""
        self._definition(node, "class ")
        for outside in [*node.decorator_list, *node.bases]:
            self.visit(outside)
        methods = [child for child in node.body if isinstance(child, ast.FunctionDef)]
        names = set[str]().union(*map(_local_names, node.body))
        self._inside(names, [child for child in node.body if child not in methods])
        for method in methods:
            self._routine(method)

    def _comprehension(self, node: ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp) -> None:
        targets = {n.id for g in node.generators for n in ast.walk(g.target) if isinstance(n, ast.Name)}
        self._inside(targets, list(ast.iter_child_nodes(node)))

    visit_ListComp = visit_SetComp = visit_DictComp = visit_GeneratorExp = _comprehension

    def _inside(self, names: set[str], nodes: list[ast.AST]) -> None:
        self.hidden.append(names)
        for node in nodes:
            self.visit(node)
        self.hidden.pop()


def _local_names(node: ast.AST) -> set[str]:
    """Names that a statement binds in the function it stands in."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        return {node.name}
    if isinstance(node, (ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)):
        return set()
    names = {node.id} if isinstance(node, ast.Name) and isinstance(node.ctx, (ast.Store, ast.Del)) else set()
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        names |= {(alias.asname or alias.name).split(".")[0] for alias in node.names}
    if isinstance(node, ast.ExceptHandler) and node.name:
        names.add(node.name)
    return names.union(*map(_local_names, ast.iter_child_nodes(node)))
