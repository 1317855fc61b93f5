"""One computation per key: file locks that the kernel frees when their process dies."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import json
import os
import platform
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from pipeline.events import Holder

UNSUPPORTED = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL}


MOMENTS, MOMENT = 10, 0.002
"""Readers hold a lock for less than these seconds together: whoever they are, nobody waits for them."""


@contextlib.contextmanager
def locked(path: Path, stage: str, on_wait: Callable[[Holder], None]) -> Iterator[bool]:
    """Hold the lock on a file; the file names host, process and stage of its holder.

    Parameters
    ----------
    path
        Lock file; it is created, and never removed, since another process may hold it open.
    stage
        Stage that is computed under the lock.
    on_wait
        Called once with the present holder before waiting for it.

    Yields
    ------
    bool
        Whether the lock excludes others; ``False`` on a file system without locks, where each
        process must work in a folder of its own.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        exclusive = _acquire(descriptor, on_wait)
        if exclusive:
            _sign(descriptor, Holder(platform.node(), os.getpid(), stage))
        yield exclusive
        if exclusive:
            _sign(descriptor, None)
    finally:
        os.close(descriptor)


@contextlib.contextmanager
def sharing(path: Path) -> Iterator[bool]:
    """Hold a lock together with other readers, so that nobody can hold it alone; do not wait.

    Yields
    ------
    bool
        ``False`` if somebody holds it alone; ``True`` also where the file system has no locks.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    descriptor = os.open(path, os.O_RDONLY | os.O_CREAT, 0o666)
    try:
        yield try_lock(descriptor, fcntl.LOCK_SH) is not False
    finally:
        os.close(descriptor)


def try_lock(descriptor: int, operation: int) -> bool | None:
    """Lock a file at once or not at all; ``None`` on a file system without locks."""
    try:
        fcntl.flock(descriptor, operation | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError as error:
        if error.errno not in UNSUPPORTED:
            raise
        return None
    return True


def _acquire(descriptor: int, on_wait: Callable[[Holder], None]) -> bool:
    for _ in range(MOMENTS):
        exclusive = try_lock(descriptor, fcntl.LOCK_EX)
        if exclusive is not False:
            break
        time.sleep(MOMENT)
    else:
        on_wait(_holder(descriptor))
        fcntl.flock(descriptor, fcntl.LOCK_EX)
    return exclusive is not None


def _sign(descriptor: int, holder: Holder | None) -> None:
    os.ftruncate(descriptor, 0)
    if holder is not None:
        os.pwrite(descriptor, json.dumps(vars(holder)).encode(), 0)


def _holder(descriptor: int) -> Holder:
    """The holder that signed the file; a process that has just taken the lock may not have yet."""
    try:
        return Holder(**json.loads(os.pread(descriptor, 4096, 0)))
    except (ValueError, TypeError):
        return Holder("unknown host", 0, "unknown")
