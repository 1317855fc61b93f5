"""Which exported files are up to date.

``exports.json`` in the output folder names, for each file, what it was made from: one digest over the
content of the results it shows and the code that makes it. A file is made again only if that digest
or the file itself has changed.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pipeline.canonical import digest
from pipeline.fingerprint import fingerprint
from pipeline.fingerprint.sources import Sources
from workflows.exports.files import write_text

NAME = "exports.json"


def source_id(
    modules: Iterable[str], contents: Mapping[str, Any], sources: Sources | None = None
) -> str:
    """Digest of what an export is made from: its code, and the ids of all that it shows.

    The code is that of ``sources``, read before, or without them that of the files as they are now.
    """
    code = fingerprint(modules, ("workflows", "stages"), sources).digest
    return digest({"code": code, "contents": dict(contents)})


class Ledger:
    """The entries of ``exports.json``; an unreadable file counts as empty.

    Parameters
    ----------
    folder
        Output folder.

    Attributes
    ----------
    sources
        The code that makes files now: all are made by one state of it.
    """

    def __init__(self, folder: Path) -> None:
        self.sources = Sources()
        self._folder = folder
        self._entries = _read(folder / NAME)

    def is_current(self, file: str, source: str) -> bool:
        """Whether a file was made from ``source`` and has not been changed since."""
        entry = self._entries.get(file)
        path = self._folder / file
        if not isinstance(entry, dict) or entry.get("source") != source or not path.is_file():
            return False
        status = path.stat()
        if entry.get("size") != status.st_size:
            return False
        return entry.get("mtime_ns") == status.st_mtime_ns or entry.get("sha256") == _sha256(path)

    def made(self, file: str, source: str) -> None:
        """Note a file that has just been made."""
        path = self._folder / file
        status = path.stat()
        self._entries[file] = {
            "source": source,
            "size": status.st_size,
            "mtime_ns": status.st_mtime_ns,
            "sha256": _sha256(path),
        }
        self._save()

    def remove(self, files: Iterable[str]) -> None:
        """Remove files made by an earlier run, of which this one has none."""
        for file in files:
            if self._entries.pop(file, None) is not None:
                (self._folder / file).unlink(missing_ok=True)
                self._save()

    def holds_files(self) -> bool:
        """Whether files were exported here: only whole runs do that, a single stage has none."""
        return any("sha256" in entry for entry in self._entries.values() if isinstance(entry, dict))

    def value(self, name: str, source: str) -> Any:
        """A value kept with its source, ``None`` if it was made from something else or is damaged."""
        entry = self._entries.get(name)
        if not isinstance(entry, dict) or entry.get("source") != source:
            return None
        value = entry.get("value")
        return value if entry.get("digest") == _digest(source, value) else None

    def keep(self, name: str, source: str, value: Any) -> None:
        """Keep a JSON value."""
        self._entries[name] = {"source": source, "value": value, "digest": _digest(source, value)}
        self._save()

    def _save(self) -> None:
        write_text(self._folder / NAME, json.dumps(self._entries, indent=1))


def _read(path: Path) -> dict[str, Any]:
    try:
        entries = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return entries if isinstance(entries, dict) else {}


def _digest(source: str, value: Any) -> str:
    text = json.dumps([source, value], sort_keys=True)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


def _sha256(path: Path) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
