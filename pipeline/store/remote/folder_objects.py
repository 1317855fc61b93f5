"""Objects in a folder that machines share, for file systems on which file locks do not work."""

from __future__ import annotations

import contextlib
import os
import shutil
import uuid
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from pipeline.durable import storing, sync, write_atomically
from pipeline.store.remote.objects import Entry

UNFINISHED = ".new"
"""How names of files end that are being written."""


@dataclass(frozen=True)
class FolderObjects:
    """Objects as files: each is there as a whole or not at all.

    Attributes
    ----------
    path
        The folder; made when something is written.
    """

    path: Path

    @property
    def location(self) -> str:
        """URL."""
        return self.path.as_uri()

    def be_patient(self) -> None:
        """The system waits for file servers by itself."""

    def check_place(self) -> None:
        """Any folder will do, it may be made."""

    def read(self, path: str) -> bytes | None:
        """Contents of a file."""
        with storing(self.path / path):
            try:
                return (self.path / path).read_bytes()
            except (FileNotFoundError, NotADirectoryError):
                return None

    def read_many(self, paths: Iterable[str]) -> dict[str, bytes]:
        """Contents of several files."""
        return {path: contents for path in paths if (contents := self.read(path)) is not None}

    def write(self, contents: Mapping[str, bytes]) -> None:
        """Write files, each by renaming."""
        for path, one in contents.items():
            with storing(self.path / path):
                write_atomically(self.path / path, one)

    def create(self, path: str, contents: bytes) -> bool:
        """Write beside the name, then link to it: a link fails if the name is there, on NFS, too."""
        target = self.path / path
        with storing(target):
            target.parent.mkdir(parents=True, exist_ok=True)
            written = target.with_name(f"{target.name}.{uuid.uuid4().hex}{UNFINISHED}")
            try:
                write_atomically(written, contents)
                os.link(written, target)
            except FileExistsError:
                return False
            finally:
                written.unlink(missing_ok=True)
            sync(target.parent)
        return True

    def listing(self, folder: str) -> dict[str, Entry]:
        """All files below a folder."""
        found = {}
        with storing(self.path / folder):
            for parent, _, names in os.walk(self.path / folder):
                for name in names:
                    path = Path(parent, name)
                    if not name.endswith(UNFINISHED):
                        with contextlib.suppress(FileNotFoundError):
                            found[path.relative_to(self.path).as_posix()] = _entry(path)
        return found

    def upload(self, files: Mapping[str, Path]) -> None:
        """Copy files, and force them to the disk."""
        for path, source in files.items():
            target = self.path / path
            with storing(target):
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, target)
                sync(target)
        for parent in {(self.path / path).parent for path in files}:
            with storing(parent):
                sync(parent)

    def download(self, files: Mapping[str, Path]) -> None:
        """Copy files."""
        for path, target in files.items():
            with storing(self.path / path):
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(self.path / path, target)

    def remove(self, paths: Iterable[str]) -> None:
        """Remove files."""
        for path in paths:
            with storing(self.path / path):
                (self.path / path).unlink(missing_ok=True)


def _entry(path: Path) -> Entry:
    status = path.stat()
    return Entry(status.st_size, status.st_mtime_ns / 1e9, f"{status.st_ino} {status.st_mtime_ns}")
