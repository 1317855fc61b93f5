"""A connection to a dask.distributed scheduler, and whether its workers can be used."""

from __future__ import annotations

import asyncio
import contextlib
import pickle
from collections.abc import Callable
from concurrent.futures import CancelledError, ThreadPoolExecutor
from typing import TypeAlias

from distributed import Client
from distributed import Future as PlainFuture
from distributed.client import FutureCancelledError
from distributed.core import rpc
from distributed.security import Security

from pipeline.errors import InputError
from pipeline.executors.agreement import Agreement, Findings
from pipeline.executors.working import Ticket, examine, request_stop, unfit, work

Future: TypeAlias = "PlainFuture[bytes]"

Warn: TypeAlias = Callable[[str], None]

BROKEN = (OSError, RuntimeError, TimeoutError, CancelledError, FutureCancelledError)
"""What calls to a scheduler raise that is not there (any longer)."""


def connected(address: str, timeout: float) -> Client:
    """A client of the scheduler at an address.

    Raises
    ------
    OSError
        If nothing answers within ``timeout`` seconds.
    ValueError
        If the address is none.
    """

    async def ask() -> None:
        security = Security().get_connection_args("client")  # TLS, as dask is configured
        async with rpc(address, connection_args=security) as scheduler:
            await asyncio.wait_for(scheduler.identity(), timeout)

    # A client that fails to connect would linger on for seconds. In a notebook this thread has a loop.
    with ThreadPoolExecutor(1) as thread:
        thread.submit(lambda: asyncio.run(ask())).result()
    return Client(address, timeout=timeout, set_as_default=False)


class Connection:
    """A client of a scheduler, under a name that its messages and its jobs go by.

    Parameters
    ----------
    client
        Of distributed.
    name
        Unique.
    agreement
        What workers must have in common with this process; ``None`` if they cannot but have it.
    warn
        Receives lines about what a user should know.
    hear
        Receives what workers send, in another thread.

    Raises
    ------
    InputError
        If a worker does not agree.
    """

    def __init__(
        self,
        client: Client,
        name: str,
        agreement: Agreement | None,
        warn: Warn,
        hear: Callable[[bytes], None],
    ) -> None:
        self._client, self._name, self._agreement, self._warn = client, name, agreement, warn
        try:
            client.subscribe_topic(name, lambda event: hear(event[1]))
            self.examine()
            if not self.threads():
                warn("the scheduler has no workers yet; waiting for some to come")
        except BaseException:
            self.close()
            raise

    @property
    def is_closed(self) -> bool:
        """Whether the client has given up."""
        return self._client.status in ("closing", "closed")

    def threads(self) -> int:
        """Threads of all workers."""
        return sum(self._client.ncores().values())

    def submit(self, ticket: Ticket, job: bytes, attempt: int) -> Future:
        """Send a job."""
        call = pickle.dumps((work, (ticket, job)))
        key = f"{self._name}-{ticket.number}-{attempt}"
        return self._client.submit(_unpickled_call(), call, key=key, pure=False)

    def results(self, futures: list[Future]) -> list[bytes | Exception]:
        """What became of futures that are done."""
        try:
            if all(future.status == "finished" for future in futures):
                return self._client.gather(futures)
            if len(futures) == 1:
                error = futures[0].exception()
                return [error if isinstance(error, Exception) else FutureCancelledError("", None)]
        except Exception as error:
            if len(futures) == 1:
                return [error]
        return [result for future in futures for result in self.results([future])]

    def stop(self) -> None:
        """Ask the jobs on all workers to stop."""
        self._client.run(request_stop, self._name, on_error="ignore")

    def close(self) -> None:
        """Leave the scheduler; it forgets the jobs that have not begun."""
        with contextlib.suppress(*BROKEN):
            self._client.close(timeout=2)

    def examine(self) -> None:
        """Ask all workers whether they agree.

        Raises
        ------
        InputError
            If one does not.
        """
        if self._agreement is None:
            return
        found = self._client.run(examine, self._name, self._agreement, on_error="return")
        warnings: dict[str, list[str]] = {}
        for address, findings in found.items():
            if isinstance(findings, OSError):
                continue  # it went away; another one is examined when a job gets there
            if not isinstance(findings, Findings):
                raise InputError(
                    f"the worker {address} cannot run this program ({findings}); install the same "
                    "version there"
                )
            if findings.refusals:
                raise InputError(unfit(address, findings.refusals))
            for line in findings.warnings:
                warnings.setdefault(line, []).append(address)
        threads = self._client.ncores()
        if several := [address for address, count in threads.items() if count > 1]:
            warnings["it has several threads, which hinder each other (use --nthreads 1)"] = several
        for line, those in warnings.items():
            others = f" and {len(those) - 1} others" if len(those) > 1 else ""
            self._warn(f"worker {those[0]}{others}: {line}")


def _unpickled_call() -> Callable[[bytes], bytes]:
    """A function that is itself sent by value: a scheduler unpickles it, and need not know this program."""

    def call(job: bytes) -> bytes:
        import pickle

        function, arguments = pickle.loads(job)
        return function(*arguments)

    return call
