"""What is left in a local store beside artefacts: unfinished work, and what was set aside as damaged.

Names of unfinished work are those of its folders: the key, on a file system without locks with the host
and the process that works on it, or what is left of an artefact that was being removed when the
process died. What was set aside is called ``<key>.quarantine.<stage>.<time>`` here.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import platform
import time
from collections.abc import Iterator
from pathlib import Path

from pipeline.durable import remove_tree
from pipeline.fingerprint.contents import state
from pipeline.store.folders import names
from pipeline.store.locks import try_lock
from pipeline.store.registers import UNSURE_DAYS, is_process
from pipeline.store.upkeep import Leftover

REMOVED = "removed"
"""Second part of the name, in ``tmp``, of an artefact that is being removed."""

QUARANTINE = "quarantine"


def read(store: Path) -> list[Leftover]:
    """All that is left, sorted by name."""
    begun = {name for each in ("tmp", "checkpoints") for name in names(store / each)}
    aside = {
        f"{key}.{QUARANTINE}.{stage}.{when}"
        for stage in names(store / QUARANTINE)
        for name in names(store / QUARANTINE / stage)
        if not name.endswith(".json")
        for key, _, when in [name.partition(".")]
    }
    return [_leftover(store, name) for name in sorted(begun | aside)]


def remove(store: Path, leftover: Leftover) -> bool:
    """Remove it, unless it changed since or its process works on it; the caller holds its lock."""
    worker = leftover.name.partition(".")[2]
    paths = _paths(store, leftover.name)
    if _is_at_work(worker, leftover.changed) or _changed(worker, paths) > leftover.changed:
        return False
    for path in paths:
        if path.is_dir():
            remove_tree(path)
        else:
            path.unlink(missing_ok=True)
    return True


def _paths(store: Path, name: str) -> tuple[Path, Path]:
    """The folders, or the folder and the report, of a leftover."""
    key, *rest = name.split(".", 3)
    if rest[:1] == [QUARANTINE]:
        _, stage, when = rest
        folder = store / QUARANTINE / stage / f"{key}.{when}"
        return folder, folder.with_name(f"{folder.name}.json")
    return store / "tmp" / name, store / "checkpoints" / name


def _leftover(store: Path, name: str) -> Leftover:
    key, _, worker = name.partition(".")
    paths = _paths(store, name)
    aside = worker.startswith(f"{QUARANTINE}.")
    changed = _changed(worker, paths)
    objects = store / "objects"
    return Leftover(
        name=name,
        key=key,
        size=sum(size for path in paths for _, size in _states_below(path)),
        changed=changed,
        resumable=not aside and (paths[1] / "state.npz").exists(),
        busy=not aside and (not _is_free(store / "locks" / key) or _is_at_work(worker, changed)),
        published=not aside and any((objects / each / key).is_dir() for each in names(objects)),
        damaged=aside,
    )


def _changed(worker: str, paths: tuple[Path, ...]) -> float:
    """When something changed last, seconds since 1970; long ago for what only waits to be deleted."""
    if worker.startswith(f"{REMOVED}."):
        return 0.0
    states = [mtime_ns for path in paths for mtime_ns, _ in _states_below(path)]
    return max(states, default=0) / 1e9


def _is_free(lock: Path) -> bool:
    """Whether nobody holds a lock alone."""
    try:
        descriptor = os.open(lock, os.O_RDONLY)
    except FileNotFoundError:
        return True
    try:
        return try_lock(descriptor, fcntl.LOCK_SH) is not False
    finally:
        os.close(descriptor)


def _is_at_work(worker: str, changed: float) -> bool:
    """Whether the process that a name ends with, ``host.pid``, is there: it has no lock to tell."""
    host, _, process = worker.rpartition(".")
    if not process.isdigit() or host.partition(".")[0] in (REMOVED, QUARANTINE):
        return False
    if host == platform.node():
        return is_process(int(process))
    return time.time() - changed < UNSURE_DAYS * 86400


def _states_below(path: Path) -> Iterator[tuple[int, int]]:
    """Modification time and size of a file, or of all below a folder; what goes meanwhile is left out."""
    if path.is_file():
        yield state(path)
    for parent, _, files in os.walk(path):
        with contextlib.suppress(FileNotFoundError):
            yield os.stat(parent).st_mtime_ns, 0
        for name in files:
            with contextlib.suppress(FileNotFoundError):
                yield state(os.path.join(parent, name))
