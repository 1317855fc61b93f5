"""Fingerprint of the code behind a result: the static import closure of modules, hashed as syntax.

Nothing is imported: import statements (also those inside functions) are read from the syntax tree
and resolved to files through the location of their package. Comments, docstrings and layout do not
count; names, numbers and statements do, in every module that can be reached.
"""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import sys
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from pipeline.canonical import DIGEST_BYTES, digest
from pipeline.errors import InputError
from pipeline.loaded import State, state


@dataclass(frozen=True)
class Fingerprint:
    """Digest of a closure and of each module in it; ``bare`` modules hold no code and do not count."""

    digest: str
    modules: dict[str, str]
    bare: tuple[str, ...] = ()


@dataclass(frozen=True)
class SourceFile:
    """One parsed module: its digest (``None`` if it holds no code) and the modules it may import."""

    digest: str | None
    imports: tuple[str, ...]


def fingerprint(roots: Iterable[str], packages: Collection[str]) -> Fingerprint:
    """Fingerprint of the modules named and of all they import inside some packages.

    Parameters
    ----------
    roots
        Dotted names of modules.
    packages
        Names of top-level packages (or modules); imports of anything else are not followed.

    Raises
    ------
    InputError
        If a root has no source file, or a module is not valid Python.
    """
    modules: dict[str, str] = {}
    bare: list[str] = []
    seen: set[str] = set()
    waiting = list(roots)
    for root in waiting:
        if locate(root) is None:
            raise InputError(
                f"module {root!r} has no source file, so results of its code cannot be kept: "
                "define stages and models in an importable file"
            )
    while waiting:
        name = waiting.pop()
        path = locate(name) if name.partition(".")[0] in packages else None
        if name in seen or path is None:
            continue
        seen.add(name)
        source = read_source(path, name)
        if source.digest is None:
            bare.append(name)
        else:
            modules[name] = source.digest
        waiting.extend(source.imports)
        waiting.extend(_parents(name))
    ordered = dict(sorted(modules.items()))
    return Fingerprint(digest(ordered), ordered, tuple(sorted(bare)))


def locate(name: str) -> Path | None:
    """Source file of a module, found by the location of its top-level package; ``None`` if absent."""
    top, *rest = name.split(".")
    for folder in _search_path(top):
        base = folder.joinpath(*rest)
        if rest and base.with_name(base.name + ".py").is_file():
            return base.with_name(base.name + ".py")
        if (base / "__init__.py").is_file():
            return base / "__init__.py"
    return None if rest else _single_file(top)


def read_source(path: Path, name: str) -> SourceFile:
    """Digest and imports of a source file, memoised by its path, modification time and size."""
    while True:
        before = state(path)
        source = _KNOWN.get((path, name, before)) or _parsed(path, name)
        if state(path) == before:  # otherwise it was saved while it was read
            _KNOWN[path, name, before] = source
            return source


def known_source(path: Path, name: str, at: State) -> SourceFile | None:
    """A source file in a present or past state; ``None`` if that past state was never read."""
    if state(path) == at:
        return read_source(path, name)
    return _KNOWN.get((path, name, at))


_KNOWN: dict[tuple[Path, str, State], SourceFile] = {}


def _parsed(path: Path, name: str) -> SourceFile:
    try:
        tree = ast.parse(path.read_bytes())
    except SyntaxError as error:
        raise InputError(f"{path}, line {error.lineno}: not valid Python: {error.msg}") from error
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    parts: list[str] = []
    imports: dict[str, None] = {}
    _walk(tree, package, parts, imports)
    if len(parts) <= 2:  # the module node alone
        return SourceFile(None, tuple(imports))
    text = "\x00".join(parts).encode("utf-8", "surrogatepass")
    return SourceFile(hashlib.blake2b(text, digest_size=DIGEST_BYTES).hexdigest(), tuple(imports))


def _walk(node: ast.AST, package: str, parts: list[str], imports: dict[str, None]) -> None:
    """Append the tokens of a node; empty fields are left out, so Python versions agree."""
    if isinstance(node, ast.Import | ast.ImportFrom):
        imports.update(dict.fromkeys(_imported(node, package)))
    parts.append(type(node).__name__)
    for field in node._fields:
        value = getattr(node, field, None)
        if isinstance(value, ast.AST):
            parts.append(field)
            _walk(value, package, parts, imports)
        elif isinstance(value, list):
            kept = [item for item in value if not _is_text(item)]
            if kept:
                parts.append(f"{field}*{len(kept)}")
            for item in kept:
                if isinstance(item, ast.AST):
                    _walk(item, package, parts, imports)
                else:
                    parts.append(repr(item))
        elif value is not None and field not in ("kind", "type_comment"):
            parts.append(f"{field}={value!r}")
        elif field == "value" and isinstance(node, ast.Constant):
            parts.append("value=None")
    parts.append(")")


def _is_text(item: object) -> bool:
    """Whether a statement is a docstring or another string that stands alone."""
    return (
        isinstance(item, ast.Expr)
        and isinstance(item.value, ast.Constant)
        and isinstance(item.value.value, str)
    )


def _imported(node: ast.Import | ast.ImportFrom, package: str) -> Iterator[str]:
    """Modules that an import statement may load; names that are no modules resolve to no file."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
        return
    base = node.module or ""
    if node.level:
        above = package.split(".")[: len(package.split(".")) - node.level + 1]
        base = ".".join([*above, base] if base else above)
    yield base
    yield from (f"{base}.{alias.name}" for alias in node.names)


def _parents(name: str) -> Iterator[str]:
    while "." in name:
        name = name.rpartition(".")[0]
        yield name


def _search_path(top: str) -> list[Path]:
    try:
        spec = importlib.util.find_spec(top)
    except (ImportError, ValueError):
        return []
    return [Path(folder) for folder in (spec and spec.submodule_search_locations) or ()]


def _single_file(top: str) -> Path | None:
    """File of a top-level module that is no package, or of the running script."""
    loaded = getattr(sys.modules.get(top), "__file__", None)
    if loaded is None:
        try:
            spec = importlib.util.find_spec(top)
        except (ImportError, ValueError):
            return None
        loaded = spec.origin if spec else None
    return Path(loaded) if loaded and Path(loaded).suffix == ".py" else None
