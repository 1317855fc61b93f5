"""The store in a folder: each artefact in a folder of its own that is there completely or not at all.

Layout of a local store::

    store.json                                  version of this layout
    objects/<stage>/<key>/manifest.json, data/  artefacts, never modified
    tmp/<key>/                                  work of the one process that holds the lock
    locks/<key>
    checkpoints/<key>/state.npz
    quarantine/<stage>/<key>.<time>/, .json     damaged artefacts, and what was found
    runs/<name>.../                             which runs there are, and what they use
    usage/<stage>/<key>                         its time is that of the last use
    tags/<stage>/<key>/<tag>
    index.jsonl                                 for lists; a cache
"""

from __future__ import annotations

import contextlib
import errno
import heapq
import json
import os
import platform
import time
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from pathlib import Path

from pipeline.durable import opening, storing, write_atomically
from pipeline.errors import InputError, StoreError
from pipeline.events import Holder
from pipeline.fingerprint.contents import state
from pipeline.keys import SCHEMA, Ref
from pipeline.manifest import Manifest
from pipeline.store.description import check_description
from pipeline.store.labels import RunLabel
from pipeline.store.local_upkeep import LocalUpkeep
from pipeline.store.locks import locked, sharing
from pipeline.store.quarantine import move_aside
from pipeline.store.registers import Registers
from pipeline.store.workspace import LocalWorkspace
from pipeline.verification import DamagedError, folder_problems

READ_ONLY = {errno.EROFS, errno.EACCES, errno.EPERM}
"""Why a store may not be written to; its results can still be used."""

RECENT_NS = 100_000_000
"""A file as young as this may change again without a change of its modification time."""


class LocalStore:
    """A store in a folder; it is created when the first artefact is written.

    Parameters
    ----------
    path
        The folder.

    Raises
    ------
    InputError
        If the path is (or lies below) a file, the folder may not be read, or the store was written
        by a newer version, or does not say by which.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path).expanduser().absolute()
        self._written = False
        self._registers = Registers(self.path / "runs")
        with opening(self.path):
            above = (self.path, *self.path.parents)
            blocking = [p for p in above if p.exists() and not p.is_dir()]
        if blocking:
            raise InputError(f"the store must be a folder, but {blocking[0]} is a file")
        about = self.path / "store.json"
        with opening(about):
            if about.exists():
                check_description(about.read_bytes(), self.path)

    @property
    def location(self) -> str:
        """The folder, for messages."""
        return str(self.path)

    @property
    def upkeep(self) -> LocalUpkeep:
        """Lists, tags, removing."""
        return LocalUpkeep(self.path, self._registers)

    def __reduce__(self) -> tuple[Callable[[Path], LocalStore], tuple[Path]]:
        """In another process: the one store of this path that all jobs there use."""
        return _of_process, (self.path,)

    def begin(self, label: RunLabel) -> None:
        """Make a run known, before it asks for artefacts under its label."""
        with self._unless_read_only():
            self._prepare()
            self._written |= self._registers.begin(label)

    def finish(self, label: RunLabel, *, keep_earlier: bool = False) -> None:
        """Note that a run ended well; unless told otherwise, earlier ones of its name are dropped."""
        with self._unless_read_only():
            self._registers.finish(label, keep_earlier=keep_earlier)

    def find(self, ref: Ref, label: RunLabel | None = None) -> Manifest | None:
        """Manifest of an artefact, ``None`` if there is none; sizes of its files are checked."""
        if label is None:
            return self._find(ref)
        lock = self.path / "locks" / ref.key
        with self._unless_read_only():
            with sharing(lock) as shared:
                self._registers.add(label, ref)
                found = self._find(ref)
                if found is not None:
                    self._touch(ref)
            if found is None or shared:
                return found
            # It is being removed, or was published just now: see what is there when that is done.
            with locked(lock, ref.stage, lambda holder: None):
                return self._find(ref)
        return self._find(ref)

    def _find(self, ref: Ref) -> Manifest | None:
        if not self._holds(ref):
            return None
        try:
            if problems := self.verify(ref):
                raise DamagedError(ref, self._folder(ref), problems)
            return self.manifest(ref)
        except StoreError:
            if self._holds(ref):
                raise
            return None  # it was removed just now

    def _touch(self, ref: Ref) -> None:
        path = self.path / "usage" / ref.stage / ref.key
        try:
            os.utime(path)
        except FileNotFoundError:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()

    @contextlib.contextmanager
    def _unless_read_only(self) -> Iterator[None]:
        """Do the block as far as the store may be written; hits are served in any case."""
        try:
            yield
        except OSError as error:
            if error.errno in READ_ONLY:
                return
            with storing(self.path) if self._written else opening(self.path):
                raise

    def manifest(self, ref: Ref) -> Manifest:
        """Manifest of an artefact that must be there; its files are not looked at.

        Raises
        ------
        StoreError
            If there is none, or it cannot be read.
        """
        path = self._folder(ref) / "manifest.json"
        try:
            with storing(path):
                return _read_manifest(path)
        except ValueError as error:
            raise StoreError(f"unreadable manifest of {ref} ({error})", path=path) from error

    def data(self, ref: Ref) -> Path:
        """Folder with the data files of an artefact."""
        return self._folder(ref) / "data"

    def where(self, ref: Ref) -> Path:
        """Folder of an artefact."""
        return self._folder(ref)

    def refs(self, stage: str | None = None) -> Iterator[Ref]:
        """Artefacts of one stage or of all, sorted."""
        objects = self.path / "objects"
        for name in [stage] if stage is not None else _entries(objects):
            yield from (Ref(name, key) for key in _entries(objects / name))

    def newest(self, stage: str, count: int) -> list[Ref]:
        """The artefacts of a stage that were published last, at most ``count`` of them."""
        folder = self.path / "objects" / stage
        found = []
        for key in _entries(folder):
            with storing(folder), contextlib.suppress(FileNotFoundError):  # removed just now
                found.append((state(folder / key), key))
        return [Ref(stage, key) for _, key in heapq.nlargest(count, found)]

    def checkpoint(self, ref: Ref) -> Path | None:
        """File with the checkpoint of an interrupted computation, ``None`` if there is none."""
        path = self.path / "checkpoints" / ref.key / "state.npz"
        return path if path.is_file() else None

    def verify(self, ref: Ref, *, full: bool = False) -> tuple[str, ...]:
        """Problems of an artefact in words; ``full`` recomputes every checksum and the key."""
        folder = self._folder(ref)
        with storing(folder):
            return tuple(folder_problems(ref, folder, _read_manifest, full=full))

    @contextlib.contextmanager
    def writing(self, ref: Ref, on_wait: Callable[[Holder], None]) -> Iterator[LocalWorkspace]:
        """Hold the lock of a key, waiting for its present holder, and work on the artefact."""
        with contextlib.ExitStack() as stack:
            # A store that could be written to before is no bad request, whatever happens now.
            with storing(self.path) if self._written else opening(self.path):
                self._prepare()
                lock = locked(self.path / "locks" / ref.key, ref.stage, on_wait)
                exclusive = stack.enter_context(lock)
            self._written = True
            # Without locks each process works apart, and the rename decides who was first.
            name = ref.key if exclusive else f"{ref.key}.{platform.node()}.{os.getpid()}"
            yield LocalWorkspace(
                folder=self.path / "tmp" / name,
                checkpoint=self.path / "checkpoints" / name / "state.npz",
                target=self._folder(ref),
            )

    def quarantine(self, ref: Ref, problems: Iterable[str] = ()) -> Path | None:
        """Move an artefact aside if it is damaged; where it is then, ``None`` if it is not.

        It is verified again, whatever the caller knows: another process may have computed it anew.
        """
        with storing(self.path):
            self._prepare()
            with locked(self.path / "locks" / ref.key, ref.stage, lambda holder: None):
                if not self._holds(ref) or not (found := self.verify(ref, full=True)):
                    return None
                told = dict.fromkeys([*problems, *found])
                return move_aside(self._folder(ref), self.path / "quarantine", ref, told)

    def _holds(self, ref: Ref) -> bool:
        with storing(self.path):
            try:
                os.lstat(self._folder(ref))  # whatever it is: a file would be in the way, too
            except FileNotFoundError:
                return False
            return True

    def _folder(self, ref: Ref) -> Path:
        return self.path / "objects" / ref.stage / ref.key

    def _prepare(self) -> None:
        for name in ("objects", "tmp", "locks", "checkpoints"):
            (self.path / name).mkdir(parents=True, exist_ok=True)
        if not (self.path / "store.json").exists():
            write_atomically(self.path / "store.json", json.dumps({"version": SCHEMA}).encode())


@lru_cache(maxsize=16)
def _of_process(path: Path) -> LocalStore:
    return LocalStore(path)


def _entries(folder: Path) -> list[str]:
    with storing(folder):
        return sorted(os.listdir(folder)) if folder.is_dir() else []


def _read_manifest(path: Path) -> Manifest:
    """Manifest of a file, memoised once the file is old enough to show by its time if it changes."""
    mtime_ns, size = state(path)
    if time.time_ns() - mtime_ns < RECENT_NS:
        return Manifest.from_json(path.read_bytes())
    return _memoised_manifest(path, mtime_ns, size)


@lru_cache(maxsize=256)
def _memoised_manifest(path: Path, mtime_ns: int, size: int) -> Manifest:
    return Manifest.from_json(path.read_bytes())
