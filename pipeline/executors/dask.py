"""Jobs in the worker processes of a dask.distributed scheduler.

The scheduler sees bytes only: a job is a pickled reference to a function with small arguments, its end the
same. So only the workers must have this program installed.
"""

from __future__ import annotations

import itertools
import pickle
import queue
import signal
import time
import uuid
from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any

from distributed import Client, KilledWorker

from pipeline.errors import InputError
from pipeline.executors.agreement import Agreement
from pipeline.executors.connection import BROKEN, Connection, Future, Warn
from pipeline.executors.protocol import Completion, Hear, LostExecutor, LostJob
from pipeline.executors.working import Ended, Ticket
from pipeline.running.interrupts import Stopped

RECONNECT = 60.0
"""Seconds in which a scheduler that went away may come back."""

RETRY = 1.0
"""Seconds between two attempts to reach it."""

REFRESH = 2.0
"""Seconds between two looks at which workers there are."""

BUNDLES_A_SECOND = 50
"""Bundles of messages that all workers together may send."""

BUNDLE_INTERVAL = 0.5
"""Seconds between two bundles of one job at least."""


@dataclass
class _Job:
    tag: Hashable
    payload: bytes
    future: Future | None = None
    attempts: int = 0


class DaskExecutor:
    """Runs jobs on whatever workers a scheduler has.

    Parameters
    ----------
    connect
        Opens a client, or raises OSError within seconds; called again if the connection is lost.
    agreement
        What workers must have in common with this process; ``None`` if they cannot but have it.
    warn
        Receives lines about what a user should know.
    on_close
        Called at the end.

    Raises
    ------
    InputError
        If a worker does not agree.
    """

    in_process = False

    def __init__(
        self,
        connect: Callable[[], Client],
        agreement: Agreement | None = None,
        *,
        warn: Warn = lambda line: None,
        on_close: Callable[[], None] = lambda: None,
    ) -> None:
        self._connect, self._agreement = connect, agreement
        self._brief = agreement and agreement.brief
        self._warn, self._on_close = warn, on_close
        self._name = f"myofilm-{uuid.uuid4().hex}"
        self._numbers = itertools.count()
        self._jobs: dict[int, _Job] = {}
        self._news: queue.SimpleQueue[tuple[int, Future] | bytes] = queue.SimpleQueue()
        self._ended: deque[Completion] = deque()
        self._stopped = False
        self._counted, self._threads = float("-inf"), 0
        self._connection = self._opened(connect())

    @property
    def slots(self) -> int:
        """Two for each thread and two more: one always waits where another one ends."""
        return 2 * self._thread_count() + 2

    def submit(self, tag: Hashable, function: Callable[..., Any], *arguments: Any) -> None:
        """Send a job.

        Raises
        ------
        InputError
            If function or arguments cannot be pickled.
        """
        try:
            payload = pickle.dumps((function, arguments))
        except (pickle.PicklingError, TypeError, AttributeError) as error:
            raise InputError(
                f"a job cannot be sent to other processes ({error}): define stages, models and what "
                "finishes a case at the top of an importable module"
            ) from error
        number = next(self._numbers)
        self._jobs[number] = _Job(tag, payload)
        self._send(number)

    def next(self, hear: Hear, timeout: float | None = None) -> Completion | None:
        """Wait for a job to end.

        Raises
        ------
        LostExecutor
            If the scheduler went away and did not come back.
        InputError
            If a worker that came later cannot be used.
        """
        deadline = float("inf") if timeout is None else time.monotonic() + timeout
        while self._jobs and not self._ended:
            left = min(REFRESH, max(0.0, deadline - time.monotonic()))
            try:
                self._digest(self._news.get(timeout=left), hear)
            except queue.Empty:
                if self._stopped and not self._thread_count():
                    self._give_up()
                elif self._connection.is_closed:
                    self._recover()
                elif time.monotonic() >= deadline:
                    return None
        return self._ended.popleft() if self._ended else None

    def stop(self) -> None:
        """Ask the jobs on all workers to stop."""
        self._stopped = True
        try:
            self._connection.stop()
        except BROKEN:
            self._give_up()

    def close(self) -> None:
        """Leave the scheduler; jobs that run there are not waited for."""
        self._connection.close()
        self._on_close()

    def _opened(self, client: Client) -> Connection:
        return Connection(client, self._name, self._agreement, self._warn, self._news.put)

    def _send(self, number: int) -> None:
        job = self._jobs[number]
        job.attempts += 1
        interval = max(BUNDLE_INTERVAL, self._threads / BUNDLES_A_SECOND)
        ticket = Ticket(self._name, number, interval, self._brief)
        try:
            future = job.future = self._connection.submit(ticket, job.payload, job.attempts)
        except BROKEN:
            self._recover()
            return
        future.add_done_callback(lambda future: self._news.put((number, future)))

    def _digest(self, first: tuple[int, Future] | bytes, hear: Hear) -> None:
        """Take one piece of news and all that is there besides."""
        done: dict[int, Future] = {}
        news: tuple[int, Future] | bytes | None = first
        while news is not None:
            if isinstance(news, bytes):
                number, messages = pickle.loads(news)
                self._tell(number, messages, hear)
            elif news[0] in self._jobs and self._jobs[news[0]].future is news[1]:
                done[news[0]] = news[1]
            news = None if self._news.empty() else self._news.get()
        lost = False
        results = self._connection.results(list(done.values()))
        for number, result in zip(done, results, strict=True):
            lost |= self._collect(number, result, hear)
        if lost:
            self._recover()

    def _collect(self, number: int, result: bytes | Exception, hear: Hear) -> bool:
        """Note how a job ended, or send it again; ``True`` if the scheduler is to be found again."""
        if isinstance(result, BROKEN):
            return True
        job = self._jobs[number]
        if isinstance(result, Exception):
            error = result
            if isinstance(result, KilledWorker):
                died = f"{result.allowed_failures + 1} processes"
                error = LostJob(
                    f"{died} that ran it died, the last one {result.last_worker.address}"
                )
            elif isinstance(result, ImportError):
                error = InputError(f"a worker cannot run this program: {result}")
            completion = Completion(job.tag, error=error)
        else:
            ended: Ended = pickle.loads(result)
            if ended.unfit:
                self._connection.examine()  # tells more
                raise InputError(ended.unfit)
            self._tell(number, ended.messages, hear)
            completion = Completion(job.tag, ended.value, ended.error)
        del self._jobs[number]
        self._ended.append(completion)
        return False

    def _tell(self, number: int, messages: tuple[Any, ...], hear: Hear) -> None:
        if (job := self._jobs.get(number)) is not None:
            for message in messages:
                hear(job.tag, message)

    def _thread_count(self) -> int:
        """Threads of all workers, as it was seconds ago."""
        if time.monotonic() - self._counted > REFRESH:
            try:
                self._threads = self._connection.threads()
            except BROKEN:
                self._threads = max(1, self._threads)  # news of the loss will come
            self._counted = time.monotonic()
        return self._threads

    def _give_up(self) -> None:
        """Hand out all jobs as stopped."""
        jobs, self._jobs = self._jobs, {}
        self._ended.extend(
            Completion(job.tag, error=Stopped(signal.SIGINT)) for job in jobs.values()
        )

    def _recover(self) -> None:
        """Find the scheduler again, and send it what is not done."""
        self._connection.close()
        if self._stopped:
            self._give_up()
            return
        self._warn("the connection to the scheduler is lost; trying to find it again")
        self._connection = self._reopened(time.monotonic() + RECONNECT)
        for number in self._jobs:
            self._send(number)

    def _reopened(self, deadline: float) -> Connection:
        while True:
            try:
                return self._opened(self._connect())
            except BROKEN as error:
                if time.monotonic() > deadline:
                    raise LostExecutor(
                        f"the scheduler went away and did not come back within {RECONNECT:g} s. "
                        "Finished stages are kept; the same command goes on from there"
                    ) from error
                time.sleep(RETRY)
