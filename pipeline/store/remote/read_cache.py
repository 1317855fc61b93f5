"""Copies of artefacts on this machine: verified when they come, bounded in size, never removed in use."""

from __future__ import annotations

import contextlib
import fcntl
import os
import uuid
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from threading import RLock

from pipeline.durable import remove_tree, storing
from pipeline.keys import Ref
from pipeline.manifest import sha256
from pipeline.store.locks import try_lock
from pipeline.store.remote.markers import Marker
from pipeline.verification import DamagedError, size_problem, wrong_checksum

HELD = 128
"""Artefacts that a process keeps from being removed: the last ones that it asked for."""


@dataclass
class ReadCache:
    """Copies in a folder.

    ``artefacts/<name>/`` holds the data, ``artefacts/<name>.lock`` their size. Processes that read a
    copy hold this file's lock together; whoever removes the copy must hold it alone.

    Attributes
    ----------
    folder
        The folder.
    limit
        Bytes above which copies that nobody reads are removed, those unused for longest first.
    """

    folder: Path
    limit: float
    _held: OrderedDict[str, int] = field(default_factory=OrderedDict)
    _mutex: RLock = field(default_factory=RLock)
    _first: dict[str, str] | None = None

    def get(self, ref: Ref, marker: Marker, fetch: Callable[[Path], None]) -> Path:
        """Folder with the data of an artefact.

        What is there already is compared with the manifest, by checksum when this process asks for
        it first and by size afterwards; a damaged copy is fetched again.

        Parameters
        ----------
        fetch
            Writes the data into a folder.

        Raises
        ------
        DamagedError
            If what is fetched is not what was published.
        """
        name = _name(ref, marker)
        with self._mutex, storing(self.folder):
            known = name in self._held
            self._hold(name)
            target = self.folder / "artefacts" / name
            if target.is_dir() and not _problems(target, marker, full=not known):
                os.utime(self._lock_file(name))
                return target
            self._remove(name)
            new = self._new_folder()
            try:
                fetch(new)
                if problems := _problems(new, marker, full=True):
                    raise DamagedError(ref, str(ref), problems)
                self._place(new, name, marker)
            finally:
                remove_tree(new)
            return target

    def adopt(self, ref: Ref, marker: Marker, data: Path) -> None:
        """Take over data that were published from this machine."""
        name = _name(ref, marker)
        with self._mutex, storing(self.folder):
            self._hold(name)
            self._remove(name)
            self._place(data, name, marker)

    def attempt(self, ref: Ref) -> str | None:
        """Whose data of an artefact there was a copy of when this process asked first, if any."""
        if self._first is None:
            names = []
            with contextlib.suppress(OSError):
                names = os.listdir(self.folder / "artefacts")
            split = (name.rsplit("-", 1) for name in names if name.count("-") >= 2)
            self._first = {name: attempt for name, attempt in split if attempt.isalnum()}
        return self._first.get(f"{ref.stage}-{ref.key}")

    def drop(self, ref: Ref, marker: Marker) -> None:
        """Remove the copy of an artefact that is no longer what it was."""
        with self._mutex, storing(self.folder):
            self._remove(_name(ref, marker))

    def scratch(self) -> Path:
        """A new, empty folder; its user removes it."""
        with storing(self.folder):
            return self._new_folder()

    def _new_folder(self) -> Path:
        folder = self.folder / "new" / uuid.uuid4().hex
        folder.mkdir(parents=True)
        return folder

    def _place(self, data: Path, name: str, marker: Marker) -> None:
        with contextlib.suppress(OSError):  # another process has the same copy
            os.rename(data, self.folder / "artefacts" / name)
        self._lock_file(name).write_text(str(marker.manifest.size))
        self._shrink()

    def _shrink(self) -> None:
        """Remove what was not used for longest until the rest is small enough."""
        sizes = {}
        for path in (self.folder / "artefacts").glob("*.lock"):
            with contextlib.suppress(OSError, ValueError):
                sizes[path] = path.stat().st_mtime_ns, int(path.read_text())
        total = sum(size for _, size in sizes.values())
        for path in sorted(sizes, key=lambda path: sizes[path][0]):
            if total <= self.limit:
                return
            if path.stem not in self._held and self._remove_unused(path):
                total -= sizes[path][1]

    def _remove_unused(self, lock: Path) -> bool:
        try:
            descriptor = os.open(lock, os.O_RDWR)
        except FileNotFoundError:
            return True
        try:
            # Where there are no locks nobody can tell whether it is in use: it stays.
            if try_lock(descriptor, fcntl.LOCK_EX) is not True:
                return False
            self._remove(lock.stem)
            lock.unlink(missing_ok=True)
            return True
        finally:
            os.close(descriptor)

    def _remove(self, name: str) -> None:
        """Out of sight at once, then away."""
        aside = self.folder / "new" / uuid.uuid4().hex
        aside.parent.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileNotFoundError):
            os.rename(self.folder / "artefacts" / name, aside)
        remove_tree(aside)

    def _hold(self, name: str) -> None:
        """Keep others from removing a copy."""
        if name in self._held:
            self._held.move_to_end(name)
            return
        path = self._lock_file(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        while True:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
            if try_lock(descriptor, fcntl.LOCK_SH) is not False and _is_at(descriptor, path):
                break
            os.close(descriptor)  # somebody removes the copy at this moment
        self._held[name] = descriptor
        while len(self._held) > HELD:
            os.close(self._held.popitem(last=False)[1])

    def _lock_file(self, name: str) -> Path:
        return self.folder / "artefacts" / f"{name}.lock"


def _name(ref: Ref, marker: Marker) -> str:
    return f"{ref.stage}-{ref.key}-{marker.attempt}"


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(path))
    except FileNotFoundError:
        return False


def _problems(data: Path, marker: Marker, *, full: bool) -> list[str]:
    files = marker.manifest.files
    problems = [problem for file in files if (problem := size_problem(data, file))]
    if full and not problems:
        problems = [wrong_checksum(f.path) for f in files if sha256(data / f.path) != f.sha256]
    return problems
