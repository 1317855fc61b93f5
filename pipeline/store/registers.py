"""The runs of a local store, and which artefacts each of them uses.

Layout, all below ``runs/``::

    <slug of the name>/<generation>.json               label, written when a run begins
    <slug of the name>/<generation>.<host>.<pid>.refs  what one of its processes asked for, by lines
    <slug of the name>/<generation>.done               it ended well

A process only ever appends to its own file, and holds a lock on the label of a run that it began for
as long as it lives: the kernel frees that even if it is killed.
"""

from __future__ import annotations

import atexit
import contextlib
import errno
import fcntl
import json
import os
import platform
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from pipeline.durable import sync
from pipeline.errors import StoreError
from pipeline.keys import Ref
from pipeline.store.folders import entries
from pipeline.store.labels import RegisteredRun, RunLabel, from_json, to_json
from pipeline.store.locks import try_lock

KNOWN_AT_MOST = 200_000
"""References that a process remembers to have registered; more cost memory, fewer double lines."""

UNSURE_DAYS = 7.0
"""Days for which a run elsewhere counts as alive where there are no locks to tell."""

_held: dict[tuple[Path, str], int] = {}
"""Descriptors with the locks of the runs that this process has begun."""


@dataclass
class Registers:
    """The folder ``runs`` of a store.

    Attributes
    ----------
    path
        The folder; nothing is made before a run begins.
    """

    path: Path
    _known: set[tuple[str, Ref]] = field(default_factory=set)
    _read: dict[Path, tuple[int, list[Ref]]] = field(default_factory=dict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def __reduce__(self) -> tuple[type[Registers], tuple[Path]]:
        """What another process needs: locks and memory stay here."""
        return Registers, (self.path,)

    def begin(self, label: RunLabel) -> bool:
        """Make a run known, alive until this process ends or it is finished; ``False`` if it was."""
        identity = (self._file(label, ".json"), label.generation)
        with self._lock:
            if identity in _held:
                return False
            _held[identity] = self._publish(label)
        if not label.named and label.folder is None:
            atexit.register(self._leave, label)
        return True

    def add(self, label: RunLabel, ref: Ref) -> None:
        """Register an artefact, whether or not it is there already."""
        with self._lock:
            if (label.generation, ref) in self._known:
                return
            path = self._file(label, f".{platform.node()}.{os.getpid()}.refs")
            path.parent.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
            try:
                # What a full disk cut off an earlier line must not spoil this one.
                _write_whole(descriptor, f"\n{ref}\n".encode())
            finally:
                os.close(descriptor)  # at once: on a network file system others see it only then
            if len(self._known) >= KNOWN_AT_MOST:
                self._known.clear()
            self._known.add((label.generation, ref))

    def finish(self, label: RunLabel, *, keep_earlier: bool = False) -> None:
        """Note that a run ended well; unless told otherwise, earlier ones of its name are dropped."""
        done = self._file(label, ".done")
        for entry in self._files_of(label):
            sync(Path(entry.path))
        done.parent.mkdir(parents=True, exist_ok=True)
        done.touch()
        sync(done.parent)
        with self._lock:
            if descriptor := _held.pop((self._file(label, ".json"), label.generation), None):
                os.close(descriptor)
        if keep_earlier:
            return
        with contextlib.suppress(StoreError):  # a damaged label is told to those who need it
            for run in list(self._runs_in(done.parent)):
                if run.label.generation < label.generation and not run.alive:
                    self.forget(run.label)

    def runs(self) -> Iterator[RegisteredRun]:
        """All runs, in no particular order.

        Raises
        ------
        StoreError
            If a label is damaged: nobody knows then what that run keeps.
        """
        for folder in entries(self.path):
            yield from self._runs_in(Path(folder.path))

    def refs(self, label: RunLabel) -> Iterator[Ref]:
        """What a run has registered so far, some of it perhaps twice, or not there."""
        for entry in self._files_of(label):
            if entry.name.endswith(".refs"):
                yield from self._refs_in(entry)

    def forget(self, label: RunLabel) -> None:
        """Remove all that is known of one run; what it used is kept by others, or no longer."""
        folder = self._file(label, "").parent
        # The label last: without it nobody could tell whose the rest is.
        for entry in sorted(self._files_of(label), key=lambda one: one.name.endswith(".json")):
            with contextlib.suppress(FileNotFoundError):
                os.unlink(entry.path)
        with contextlib.suppress(OSError):
            folder.rmdir()  # fails if there are other runs of the same name

    def _leave(self, label: RunLabel) -> None:
        """Forget a run that keeps nothing any longer; a collection does it where this fails."""
        with contextlib.suppress(OSError):
            self.forget(label)

    def _file(self, label: RunLabel, suffix: str) -> Path:
        return self.path / label.slug / f"{label.generation}{suffix}"

    def _files_of(self, label: RunLabel) -> list[os.DirEntry[str]]:
        found = entries(self._file(label, "").parent)
        return [entry for entry in found if entry.name.startswith(label.generation)]

    def _publish(self, label: RunLabel) -> int:
        """Write the label, locked before anybody can see it; gives the descriptor with the lock."""
        path = self._file(label, ".json")
        new = path.with_suffix(f".{os.getpid()}.new")
        while True:
            path.parent.mkdir(parents=True, exist_ok=True)
            with contextlib.ExitStack() as stack, contextlib.suppress(FileNotFoundError):
                # It is not there if another process removed the empty folder just now.
                descriptor = os.open(new, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
                stack.callback(new.unlink, missing_ok=True)
                stack.callback(os.close, descriptor)
                _write_whole(descriptor, json.dumps(to_json(label)).encode())
                os.fsync(descriptor)
                try_lock(descriptor, fcntl.LOCK_EX)
                os.rename(new, path)
                stack.pop_all()
                return descriptor

    def _runs_in(self, folder: Path) -> Iterator[RegisteredRun]:
        for entry in entries(folder):
            if entry.name.endswith(".json"):
                path = Path(entry.path)
                try:
                    label = from_json(json.loads(path.read_bytes()))
                    alive = _alive(path, label)
                except FileNotFoundError:
                    continue  # it was forgotten just now
                except (ValueError, RecursionError) as error:
                    raise StoreError(
                        f"unreadable label of a run ({error})",
                        path=path,
                        remedy="remove this file; what only that run kept may be removed then",
                    ) from error
                finished = _time(path.with_suffix(".done"))
                yield RegisteredRun(label, finished, alive and finished is None)

    def _refs_in(self, entry: os.DirEntry[str]) -> list[Ref]:
        """Lines of one file; only what was added since the last call is read."""
        path = Path(entry.path)
        read, refs = self._read.get(path, (0, []))
        try:
            with open(path, "rb") as file:
                file.seek(read)
                added = file.read()
        except FileNotFoundError:
            return refs
        whole = added[: added.rfind(b"\n") + 1]
        for line in whole.decode(errors="replace").splitlines():
            stage, _, key = line.rpartition("/")
            if stage and key:
                refs.append(Ref(stage, key))
        self._read[path] = (read + len(whole), refs)
        return refs


def _write_whole(descriptor: int, contents: bytes) -> None:
    """Write all of it: a disk that is nearly full takes a part and says nothing."""
    while contents:
        contents = contents[os.write(descriptor, contents) :]


def _alive(path: Path, label: RunLabel) -> bool:
    """Whether the process that began a run still holds the lock of its label."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        free = try_lock(descriptor, fcntl.LOCK_SH)
    finally:
        os.close(descriptor)
    if free is not None:
        return not free
    if label.host != platform.node():
        return time.time() - label.began < UNSURE_DAYS * 86400
    return is_process(label.process)


def is_process(number: int) -> bool:
    """Whether there is a process of this number on this machine."""
    try:
        os.kill(number, 0)
    except OSError as error:
        return error.errno == errno.EPERM
    return True


def _time(path: Path) -> float | None:
    try:
        return path.stat().st_mtime
    except OSError:
        return None
