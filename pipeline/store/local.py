"""The store in a folder: each artefact in a folder of its own that is there completely or not at all.

Layout of a local store::

    store.json                                  version of this layout
    objects/<stage>/<key>/manifest.json, data/  artefacts, never modified
    tmp/<key>/                                  work of the one process that holds the lock
    locks/<key>
    checkpoints/<key>/state.npz
"""

from __future__ import annotations

import contextlib
import heapq
import json
import os
import platform
import time
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path

from pipeline.durable import opening, storing, write_atomically
from pipeline.errors import InputError, StoreError
from pipeline.events import Holder
from pipeline.keys import SCHEMA, Ref
from pipeline.loaded import state
from pipeline.locks import locked
from pipeline.manifest import Manifest
from pipeline.store.workspace import LocalWorkspace
from pipeline.verification import damaged, full_problems, size_problem

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
        by a newer version.
    StoreError
        If the description of the store is damaged.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path).expanduser().absolute()
        self._written = False
        with opening(self.path):
            above = (self.path, *self.path.parents)
            blocking = [p for p in above if p.exists() and not p.is_dir()]
        if blocking:
            raise InputError(f"the store must be a folder, but {blocking[0]} is a file")
        self._check_version()

    def find(self, ref: Ref) -> Manifest | None:
        """Manifest of an artefact, ``None`` if there is none; sizes of its files are checked."""
        with storing(self.path):
            present = self._folder(ref).is_dir()
        if not present:
            return None
        if problems := self.verify(ref):
            raise damaged(ref, self._folder(ref), problems)
        return self.manifest(ref)

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

    def refs(self, stage: str | None = None) -> Iterator[Ref]:
        """Artefacts of one stage or of all, sorted."""
        objects = self.path / "objects"
        for name in [stage] if stage is not None else _entries(objects):
            yield from (Ref(name, key) for key in _entries(objects / name))

    def newest(self, stage: str, count: int) -> list[Ref]:
        """The artefacts of a stage that were published last, at most ``count`` of them."""
        folder = self.path / "objects" / stage
        with storing(folder):
            found = [(state(folder / key), key) for key in _entries(folder)]
        return [Ref(stage, key) for _, key in heapq.nlargest(count, found)]

    def verify(self, ref: Ref, *, full: bool = False) -> tuple[str, ...]:
        """Problems of an artefact in words; ``full`` recomputes every checksum and the key."""
        try:
            manifest = self.manifest(ref)
        except StoreError as error:
            return (error.cause,)
        problems = [p for p in (size_problem(self.data(ref), f) for f in manifest.files) if p]
        if manifest.ref != ref:
            problems.append(f"its manifest belongs to {manifest.ref}")
        if full and not problems:
            problems.extend(full_problems(self.data(ref), manifest))
        return tuple(problems)

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

    def _folder(self, ref: Ref) -> Path:
        return self.path / "objects" / ref.stage / ref.key

    def _prepare(self) -> None:
        for name in ("objects", "tmp", "locks", "checkpoints"):
            (self.path / name).mkdir(parents=True, exist_ok=True)
        if not (self.path / "store.json").exists():
            write_atomically(self.path / "store.json", json.dumps({"version": SCHEMA}).encode())

    def _check_version(self) -> None:
        about = self.path / "store.json"
        try:
            with opening(about):
                version = json.loads(about.read_bytes())["version"] if about.exists() else SCHEMA
        except (ValueError, KeyError, TypeError) as error:
            raise StoreError("unreadable description of the store", path=about) from error
        if version > SCHEMA:
            raise InputError(
                f"the store {self.path} has layout version {version}; this program knows versions "
                f"up to {SCHEMA}: update it, or choose another store with --store"
            )


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
