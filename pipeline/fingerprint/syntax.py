"""What a source file says, read as syntax: a digest of its code, and the modules that it may import.

Comments, docstrings and layout do not count; names, numbers and statements do.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

from pipeline.canonical import DIGEST_BYTES


@dataclass(frozen=True)
class SourceFile:
    """One parsed module: its digest (``None`` if it holds no code) and the modules it may import."""

    digest: str | None
    imports: tuple[str, ...]


def parsed(contents: bytes, package: str) -> SourceFile:
    """Digest and imports of a source text.

    Raises
    ------
    SyntaxError
        If it is not valid Python.
    """
    parts: list[str] = []
    imports: dict[str, None] = {}
    _walk(ast.parse(contents), package, parts, imports)
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
