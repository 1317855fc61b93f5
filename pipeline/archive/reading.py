"""Reading an archive, with every name, checksum and key compared before anything is used."""

from __future__ import annotations

import contextlib
import hashlib
import lzma
import tarfile
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from pipeline.archive.form import (
    HEADER,
    LARGEST_TEXT,
    ArchiveError,
    Header,
    folder_of,
    problem_of,
)
from pipeline.keys import Ref
from pipeline.manifest import FileEntry, Manifest

Sink = Callable[[FileEntry, bytes], None]
"""Takes a data file whose checksum is right."""


@dataclass(frozen=True)
class Contents:
    """What a sound archive holds."""

    header: Header
    manifests: dict[Ref, Manifest]

    @property
    def size(self) -> int:
        """Bytes of all data files."""
        return sum(manifest.size for manifest in self.manifests.values())


def check(path: Path) -> Contents:
    """Read a whole archive, and compare everything that can be compared.

    Raises
    ------
    ArchiveError
        If it is not sound, with the first thing that is wrong.
    """
    with _opened(path) as tar:
        reader = Reader(tar, path)
        manifests: dict[Ref, Manifest] = {}
        for ref in reader.header.refs:
            manifests[ref] = manifest = reader.manifest(ref, manifests)
            for _ in reader.files(manifest):
                pass
        reader.end()
    return Contents(reader.header, manifests)


@contextlib.contextmanager
def reading(path: Path) -> Iterator[Reader]:
    """Reader of an archive, member after member."""
    with _opened(path) as tar:
        yield Reader(tar, path)


class Reader:
    """The members of an archive, in the only order in which they may stand."""

    def __init__(self, tar: tarfile.TarFile, path: Path) -> None:
        self._tar, self._path = tar, path
        self.header = Header.from_json(self._text(HEADER), path)

    def manifest(self, ref: Ref, earlier: dict[Ref, Manifest]) -> Manifest:
        """Manifest of the next artefact."""
        try:
            found = Manifest.from_json(self._text(f"{folder_of(ref)}/manifest.json"))
        except ValueError as error:
            raise ArchiveError(self._path, f"the manifest of {ref}: {error}") from error
        if problem := problem_of(found, ref, earlier):
            raise ArchiveError(self._path, problem)
        return found

    def files(self, manifest: Manifest) -> Iterator[tuple[FileEntry, bytes]]:
        """Data files of the artefact whose manifest was read last."""
        for entry in manifest.files:
            contents = self._member(f"{folder_of(manifest.ref)}/data/{entry.path}", entry.size)
            if len(contents) != entry.size:
                cause = f"{entry.path} of {manifest.ref} has {len(contents)} bytes instead of "
                raise ArchiveError(self._path, f"{cause}{entry.size}")
            if hashlib.sha256(contents).hexdigest() != entry.sha256:
                cause = f"the checksum of {entry.path} of {manifest.ref} is wrong"
                raise ArchiveError(self._path, cause)
            yield entry, contents

    def end(self) -> None:
        """Make sure that nothing follows."""
        if (member := self._tar.next()) is not None:
            raise ArchiveError(self._path, f"{member.name!r} does not belong to it")

    def _text(self, name: str) -> bytes:
        return self._member(name, LARGEST_TEXT)

    def _member(self, name: str, largest: int) -> bytes:
        member = self._tar.next()
        if member is None:
            raise ArchiveError(self._path, f"it ends before {name}: it was cut short")
        if member.name != name or not member.isreg():
            kind = "" if member.isreg() else ", which is not a plain file"
            raise ArchiveError(self._path, f"{member.name!r}{kind} stands in place of {name}")
        if member.size > largest:
            cause = f"{name} has {member.size} bytes instead of at most {largest}"
            raise ArchiveError(self._path, cause)
        file = self._tar.extractfile(member)
        assert file is not None
        contents = file.read()
        if len(contents) != member.size:
            raise ArchiveError(self._path, f"it ends inside {name}: it was cut short")
        return contents


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[tarfile.TarFile]:
    """The tar, compressed or not; whatever reading it meets is told of the archive."""
    try:
        with tarfile.open(path, "r:*") as tar:
            yield tar
    except tarfile.ReadError as error:
        raise ArchiveError(path, "it is no tar file, or it was cut short") from error
    except (tarfile.TarError, EOFError, zlib.error, lzma.LZMAError) as error:
        raise ArchiveError(path, f"it is damaged ({error})") from error
    except OSError as error:
        if error.filename is not None and Path(error.filename) == path:
            why = (error.strerror or str(error)).lower()
            raise ArchiveError(path, why, "check the name of the file") from error
        raise
