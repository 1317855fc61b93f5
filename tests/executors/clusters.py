"""Real schedulers and workers in processes of their own, on the loopback interface."""

from __future__ import annotations

import contextlib
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from distributed import Client

ROOT = Path(__file__).parents[2]

PATIENCE = 60.0
"""Seconds in which anything that must happen does, on a busy machine."""


class Cluster:
    """A scheduler on a port of its own, and its workers.

    Parameters
    ----------
    folder
        For what they write.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.scheduler: subprocess.Popen[bytes] | None = None
        self.workers: list[subprocess.Popen[bytes]] = []

    @property
    def address(self) -> str:
        """Of the scheduler."""
        return f"tcp://127.0.0.1:{self.port}"

    def start_scheduler(self, **environment: str) -> None:
        """Start it (again), on the same port."""
        arguments = ("--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard")
        self.scheduler = self._start("scheduler", *arguments, **environment)
        eventually(lambda: _listens(self.port))

    def start_worker(self, *, nanny: bool = False, **environment: str) -> subprocess.Popen[bytes]:
        """Start one worker with one thread; without a nanny it is the very process."""
        arguments = (self.address, "--nthreads", "1", "--no-dashboard", "--memory-limit", "0")
        kind = "--nanny" if nanny else "--no-nanny"
        worker = self._start("worker", *arguments, kind, **environment)
        self.workers.append(worker)
        return worker

    def wait_for(self, workers: int) -> None:
        """Wait until so many workers are there."""
        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=PATIENCE)

    def stop(self) -> None:
        """Kill everything."""
        for process in (*self.workers, self.scheduler):
            if process is not None:
                process.kill()
                process.wait()

    def _start(self, *arguments: str, **environment: str) -> subprocess.Popen[bytes]:
        variables = {
            "PYTHONPATH": str(ROOT),
            "DASK_TEMPORARY_DIRECTORY": str(self.folder),
            "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1",
        }
        log = open(self.folder / "log", "ab")  # noqa: SIM115 - the process keeps it
        with log:
            return subprocess.Popen(
                [sys.executable, "-m", "dask", *arguments],
                cwd=self.folder,
                env={**os.environ, **variables, **environment},
                stdout=log,
                stderr=log,
            )


@contextlib.contextmanager
def cluster(folder: Path, *, workers: int = 2) -> Iterator[Cluster]:
    """A scheduler with workers; all are killed in the end."""
    folder.mkdir(exist_ok=True)
    started = Cluster(folder)
    try:
        started.start_scheduler()
        for _ in range(workers):
            started.start_worker()
        yield started
    finally:
        started.stop()


def eventually(condition: Callable[[], Any]) -> Any:
    """What a condition gives once it holds."""
    deadline = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < deadline, "it never happened"
        time.sleep(0.02)
    return found


def _listens(port: int) -> bool:
    try:
        socket.create_connection(("127.0.0.1", port), timeout=1).close()
    except OSError:
        return False
    return True


def at_work(store: Path, key: str = "*") -> list[int]:
    """Processes that hold the lock of a key, or of any."""
    found = []
    for lock in (store / "locks").glob(key):
        with contextlib.suppress(ValueError):
            found.append(json.loads(lock.read_text())["pid"])
    return found
