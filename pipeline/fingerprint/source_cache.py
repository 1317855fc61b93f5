"""What source files say, kept on disk between processes, so that each is parsed once.

An entry is found by the *contents* of a file, never by its name, times or size: a file that is edited,
copied, checked out or dated back can only be found with what it now holds, and two checkouts share
their entries. Reading and hashing a file takes a hundredth of the time of parsing it.

The entries are lines of one text file in the user's cache folder, each with a checksum of its own. A
process only appends, so that several may write at once; a line that is torn or damaged is as
good as absent. The file's name holds the Python version and a digest of the code that makes the
entries. Where nothing can be written, nothing is kept.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import sys
from collections.abc import Mapping
from pathlib import Path

from pipeline.fingerprint import syntax
from pipeline.fingerprint.syntax import SourceFile

LARGEST = 1_000_000
"""Bytes from which the file is begun anew: some two thousand entries, ten states of this project."""


def cache_file() -> Path | None:
    """File with the entries for this Python and this code, ``None`` if there is no place for it."""
    import platformdirs

    try:
        code = Path(syntax.__file__).read_bytes() + Path(__file__).read_bytes()
        folder = Path(platformdirs.user_cache_dir("myofilm-sources"))
    except (RuntimeError, OSError):  # no source files, or no home folder
        return None
    made_by = hashlib.blake2b(sys.version.encode() + b"\0" + code, digest_size=16)
    return folder / f"{made_by.hexdigest()}.txt"


class SourceCache:
    """The entries of a cache file, read when the first one is asked for.

    Parameters
    ----------
    file
        Where they are; ``None`` for nowhere.
    """

    def __init__(self, file: Path | None) -> None:
        self._file = file

    def find(self, content: str) -> SourceFile | None:
        """What the file with this content id says, ``None`` if that is not known."""
        line = self._lines.get(content.encode())
        return None if line is None else _read(line)

    def add(self, entries: Mapping[str, SourceFile]) -> None:
        """Append entries by content id; what goes wrong is passed over."""
        if self._file is None or not entries:
            return
        # A batch begins with a newline: the one before may have been torn.
        text = b"\n" + b"".join(_line(content, source) for content, source in entries.items())
        with contextlib.suppress(OSError):
            self._file.parent.mkdir(parents=True, exist_ok=True)
            with contextlib.suppress(FileNotFoundError):
                if os.path.getsize(self._file) > LARGEST:
                    self._file.unlink()
            descriptor = os.open(self._file, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
            try:
                os.write(descriptor, text)
            finally:
                os.close(descriptor)

    @functools.cached_property
    def _lines(self) -> dict[bytes, bytes]:
        try:
            contents = self._file.read_bytes() if self._file is not None else b""
        except OSError:
            return {}
        return {line.partition(b" ")[0]: line for line in contents.splitlines()}


def _line(content: str, source: SourceFile) -> bytes:
    """Content id, checksum, digest (``-`` if there is none), imports."""
    words = " ".join((source.digest or "-", *source.imports)).encode()
    return b"%s %s %s\n" % (content.encode(), _checksum(content.encode(), words), words)


def _read(line: bytes) -> SourceFile | None:
    content, _, rest = line.partition(b" ")
    checksum, _, words = rest.partition(b" ")
    if checksum != _checksum(content, words):
        return None
    digest, *imports = words.decode().split(" ")
    return SourceFile(None if digest == "-" else digest, tuple(imports))


def _checksum(content: bytes, words: bytes) -> bytes:
    return hashlib.blake2b(content + b" " + words, digest_size=8).hexdigest().encode()
