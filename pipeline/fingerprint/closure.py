"""Fingerprint of the code behind a result: the static import closure of modules, hashed as syntax.

Nothing is imported: import statements (also those inside functions) are read from the syntax tree
and resolved to files through the location of their package. Comments, docstrings and layout do not
count; names, numbers and statements do, in every module that can be reached.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass

from pipeline.canonical import digest
from pipeline.errors import InputError
from pipeline.fingerprint.sources import Sources


@dataclass(frozen=True)
class Fingerprint:
    """Digest of a closure and of each module in it; ``bare`` modules hold no code and do not count."""

    digest: str
    modules: dict[str, str]
    bare: tuple[str, ...] = ()


def fingerprint(
    roots: Iterable[str], packages: Collection[str], sources: Sources | None = None
) -> Fingerprint:
    """Fingerprint of the modules named and of all they import inside some packages.

    Parameters
    ----------
    roots
        Dotted names of modules.
    packages
        Names of top-level packages (or modules); imports of anything else are not followed.
    sources
        Source files as they were read before; as they are now if none are given.

    Raises
    ------
    InputError
        If a root has no source file, or a module is not valid Python.
    """
    sources = sources or Sources()
    modules: dict[str, str] = {}
    bare: list[str] = []
    waiting = list(roots)
    for root in waiting:
        if sources.locate(root) is None:
            raise InputError(
                f"module {root!r} has no source file, so results of its code cannot be kept: "
                "define stages and models in an importable file"
            )
    seen: set[str] = set()
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        source = sources.read(name) if name.partition(".")[0] in packages else None
        if source is None:
            continue
        if source.digest is None:
            bare.append(name)
        else:
            modules[name] = source.digest
        waiting.extend(source.imports)
        waiting.extend(_parents(name))
    sources.keep()
    ordered = dict(sorted(modules.items()))
    return Fingerprint(digest(ordered), ordered, tuple(sorted(bare)))


def _parents(name: str) -> Iterator[str]:
    while "." in name:
        name = name.rpartition(".")[0]
        yield name
