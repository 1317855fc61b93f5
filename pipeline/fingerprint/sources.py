"""Source files of modules: found without importing anything, read once, parsed at most once ever."""

from __future__ import annotations

import importlib.util
import os
import sys
from functools import cache
from pathlib import Path

from pipeline.errors import InputError
from pipeline.fingerprint.contents import content_id, package_of
from pipeline.fingerprint.source_cache import SourceCache, cache_file
from pipeline.fingerprint.syntax import SourceFile, parsed

Entries = dict[str, bool]
"""Names in a folder, and whether each is a file."""

_KNOWN: dict[str, SourceFile] = {}
"""What this process has parsed or found in the cache, by content id."""


class Sources:
    """Source files as they are when each is first asked for.

    Later edits are not seen: whoever wants to see them takes new ``Sources``. So a plan of thousands of
    cases reads every file once, and all its keys are of one state of the code.
    """

    def __init__(self) -> None:
        self._files: dict[str, str | None] = {}
        self._contents: dict[str, bytes] = {}
        self._sources: dict[str, SourceFile] = {}
        self._parsed: dict[str, SourceFile] = {}
        self._folders: dict[str, Entries] = {}
        self._tops: dict[str, list[str]] = {}

    def locate(self, name: str) -> str | None:
        """Source file of a module, by the location of its top-level package; ``None`` if absent."""
        if name not in self._files:
            self._files[name] = self._locate(name)
        return self._files[name]

    def read(self, name: str) -> SourceFile | None:
        """What the file of a module says, ``None`` if there is no file.

        Raises
        ------
        InputError
            If it is not valid Python.
        """
        if name not in self._sources:
            file = self.locate(name)
            if file is None:
                return None
            self._sources[name] = self._source(file, name)
        return self._sources[name]

    def content(self, name: str) -> str | None:
        """Content id of the file of a module, ``None`` if there is no file."""
        file = self.locate(name)
        return None if file is None else content_id(self._bytes(file), name, file)

    def keep(self) -> None:
        """Keep on disk what had to be parsed."""
        if self._parsed:
            _cache().add(self._parsed)
            self._parsed = {}

    def _source(self, file: str, name: str) -> SourceFile:
        contents = self._bytes(file)
        content = content_id(contents, name, file)
        source = known_source(content)
        if source is None:
            try:
                source = parsed(contents, package_of(name, file))
            except SyntaxError as error:
                raise InputError(
                    f"{file}, line {error.lineno}: not valid Python: {error.msg}"
                ) from error
            except ValueError as error:  # null bytes
                raise InputError(f"{file}: not valid Python: {error}") from error
            self._parsed[content] = _KNOWN[content] = source
        return source

    def _bytes(self, file: str) -> bytes:
        if file not in self._contents:
            with open(file, "rb", buffering=0) as opened:
                self._contents[file] = opened.readall()
        return self._contents[file]

    def _locate(self, name: str) -> str | None:
        top, *rest = name.split(".")
        if top not in self._tops:
            self._tops[top] = _search_path(top)
        for base in self._tops[top]:
            folder, above, inside = base, Entries(), self._list(base)
            for part in rest:
                folder, above = f"{folder}{os.sep}{part}", inside
                inside = self._list(folder) if above.get(part) is False else Entries()
            if inside.get("__init__.py"):  # Python prefers a package, too
                return f"{folder}{os.sep}__init__.py"
            if rest and above.get(f"{rest[-1]}.py"):
                return f"{folder}.py"
        return None if rest else _single_file(top)

    def _list(self, folder: str) -> Entries:
        """Entries of a folder, which is listed once: most names that are asked for are no modules."""
        if folder not in self._folders:
            self._folders[folder] = _entries(folder)
        return self._folders[folder]


def known_source(content: str) -> SourceFile | None:
    """What a file with this content id says, ``None`` if it was never parsed."""
    source = _KNOWN.get(content) or _cache().find(content)
    if source is not None:
        _KNOWN[content] = source
    return source


def locate(name: str) -> Path | None:
    """Source file of a module as things are now; ``None`` if absent."""
    file = Sources().locate(name)
    return None if file is None else Path(file)


@cache
def _cache() -> SourceCache:
    return SourceCache(cache_file())


def _entries(folder: str) -> Entries:
    try:
        with os.scandir(folder) as found:
            return {entry.name: entry.is_file() for entry in found}
    except OSError:
        return {}


def _search_path(top: str) -> list[str]:
    try:
        spec = importlib.util.find_spec(top)
    except (ImportError, ValueError):
        return []
    return list((spec and spec.submodule_search_locations) or ())


def _single_file(top: str) -> str | None:
    """File of a top-level module that is no package, or of the running script."""
    loaded = getattr(sys.modules.get(top), "__file__", None)
    if loaded is None:
        try:
            spec = importlib.util.find_spec(top)
        except (ImportError, ValueError):
            return None
        loaded = spec.origin if spec else None
    return loaded if loaded and loaded.endswith(".py") else None
