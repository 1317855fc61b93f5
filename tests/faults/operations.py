"""Every operation of a process on the files of a store, and faults at a chosen one.

Python tells its audit hooks of each file that is opened, renamed, removed and so on, in our code and
in the libraries alike, before it happens. So nothing of the program is replaced by a stand-in: the
hook counts, and at the chosen operation it kills the process, lets the kernel kill it in the middle of
the next write, or lets the operation fail as a full disk would. A hook stays until the process ends.
"""

from __future__ import annotations

import os
import resource
import signal
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

VERBS = {
    "open": "open",
    "os.rename": "rename",
    "os.mkdir": "mkdir",
    "os.remove": "remove",
    "os.rmdir": "remove",
    "os.utime": "touch",
    "os.link": "link",
}
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT


@dataclass(frozen=True)
class Operation:
    """The ``count``-th operation of its kind in a stage: ``what`` is touched, and how.

    Examples
    --------
    >>> print(Operation("mechanics", "checkpoint", "rename", 3))
    mechanics: checkpoint rename 3
    """

    stage: str
    what: str
    verb: str
    count: int

    def __str__(self) -> str:
        return f"{self.stage}: {self.what} {self.verb} {self.count}"


Fault = Callable[["Watch", Operation], None]
"""What happens at an operation; it may not return."""


class Watch:
    """Hook that follows one store.

    Parameters
    ----------
    store
        Its folder.
    at
        Called at every operation, before it happens.
    """

    def __init__(self, store: Path, at: Fault) -> None:
        self._root = f"{store}{os.sep}"
        self._at = at
        self._counts: Counter[tuple[str, str, str]] = Counter()
        self.stage = "start"
        sys.addaudithook(self)

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Called by Python; whatever is raised here is raised by the operation."""
        verb = VERBS.get(event)
        if verb is None or not isinstance(arguments[0], str | os.PathLike):
            return
        if verb == "open" and not arguments[2] & WRITES:
            return
        path = os.fspath(arguments[1] if verb in ("rename", "link") else arguments[0])
        if path.startswith(self._root):
            what = kind_of(path.removeprefix(self._root))
        elif verb == "remove" and os.sep not in path:
            what = "tree"  # of a folder that is removed with all in it, by names inside folders
        else:
            return
        self._counts[self.stage, what, verb] += 1
        self._at(self, Operation(self.stage, what, verb, self._counts[self.stage, what, verb]))


def kind_of(path: str) -> str:
    """What a file of a store is for.

    Examples
    --------
    >>> kind_of("tmp/8a3f/data/record.zarr/potential/c.0.0")
    'chunk'
    >>> kind_of("objects/mesh/8a3f")
    'artefact'
    """
    top, name = path.partition(os.sep)[0], path.rpartition(os.sep)[2]
    if top == "tmp":
        if f".zarr{os.sep}" in path:
            return "metadata" if name.startswith("zarr.") else "chunk"
        if ".h5" in name:
            return "table"
        return "manifest" if name.startswith("manifest") else "folder"
    kinds = {"checkpoints": "checkpoint", "locks": "lock", "objects": "artefact"}
    return kinds.get(top, "register" if top in ("runs", "usage") else top.partition(".")[0])


def kill_before(operation: Operation) -> Fault:
    """End the process without warning, just before an operation."""

    def at(watch: Watch, now: Operation) -> None:
        if now == operation:
            os.kill(os.getpid(), signal.SIGKILL)

    return at


def kill_after(operation: Operation) -> Fault:
    """End the process without warning before the operation that follows."""
    passed = []

    def at(watch: Watch, now: Operation) -> None:
        if passed:
            os.kill(os.getpid(), signal.SIGKILL)
        if now == operation:
            passed.append(now)

    return at


def kill_within(operation: Operation, written: int) -> Fault:
    """Let the kernel end the process in the middle of a file, once some bytes of it are on the disk.

    A limit on the size of files does that: the write is cut at the limit, and the rest of it meets
    SIGXFSZ, whose default action is the end, without any handler.
    """

    def at(watch: Watch, now: Operation) -> None:
        if now == operation:
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGXFSZ])
            libc_default(signal.SIGXFSZ)
            resource.setrlimit(resource.RLIMIT_FSIZE, (written, resource.RLIM_INFINITY))

    return at


def libc_default(number: int) -> None:
    """Give a signal its default action, from whatever thread (Python allows it in one alone)."""
    import ctypes

    libc = ctypes.CDLL(None)
    libc.signal.restype = ctypes.c_void_p
    libc.signal.argtypes = [ctypes.c_int, ctypes.c_void_p]
    libc.signal(number, None)


def fail_from(operation: Operation, code: int) -> Fault:
    """Let an operation, and all later ones that need room on the disk, fail with an error number."""
    failed = []

    def at(watch: Watch, now: Operation) -> None:
        if now == operation or (failed and now.verb in ("open", "mkdir", "rename", "link")):
            failed.append(now)
            raise OSError(code, os.strerror(code))

    return at
