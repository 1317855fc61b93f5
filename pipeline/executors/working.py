"""A job in the process where it runs: what it tells on the way, and how it is asked to stop."""

from __future__ import annotations

import pickle
import signal
import threading
import traceback
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from pipeline.errors import MyofilmError
from pipeline.executors.agreement import Agreement, Findings
from pipeline.running.interrupts import Stopped, stopped_by

Send = Callable[[bytes], None]


@dataclass(frozen=True)
class Ticket:
    """What comes with a job.

    Attributes
    ----------
    client
        Name of the executor that sent it.
    number
        Number of the job there.
    interval
        Seconds between two bundles of messages: many workers must not flood one scheduler.
    agreement
        By which this process is examined before it works for the first time, in brief.
    """

    client: str
    number: int
    interval: float
    agreement: Agreement | None


@dataclass(frozen=True)
class Ended:
    """How a job ended, or that it has not begun since the process is ``unfit`` for it."""

    value: Any = None
    error: Exception | KeyboardInterrupt | None = None
    messages: tuple[Any, ...] = ()
    unfit: str = ""


_stops: dict[str, threading.Event] = {}
_examined: set[str] = set()
_lock = threading.Lock()


def work(ticket: Ticket, job: bytes) -> bytes:
    """Run a pickled ``(function, arguments)``; gives a pickled :class:`Ended`, whatever happens."""
    from distributed import get_worker

    worker = get_worker()
    if refusals := _refusals(ticket):
        return pickle.dumps(Ended(unfit=unfit(worker.address, refusals)))
    event = _stop_of(ticket.client)
    if event.is_set():
        return pickle.dumps(Ended(error=Stopped(signal.SIGINT)))
    relay = Relay(ticket, lambda bundle: worker.log_event(ticket.client, bundle))
    try:
        function, arguments = pickle.loads(job)
        with stopped_by(event):
            value = function(*arguments, tell=relay)
        return pickle.dumps(Ended(value, messages=relay.rest()))
    except Stopped as stopped:
        return pickle.dumps(Ended(error=stopped, messages=relay.rest()))
    except Exception as error:
        return pickle.dumps(Ended(error=_sendable(error), messages=relay.rest()))


def examine(client: str, agreement: Agreement) -> Findings:
    """Find out whether this process can work for an executor."""
    findings = agreement.findings()
    if not findings.refusals:
        _examined.add(client)
    return findings


def _refusals(ticket: Ticket) -> tuple[str, ...]:
    """Why this process, which may have come after the others were examined, cannot work."""
    if ticket.agreement is None or ticket.client in _examined:
        return ()
    return examine(ticket.client, ticket.agreement).refusals


def unfit(address: str, refusals: Iterable[str]) -> str:
    """Why a worker cannot be used, in words."""
    return f"the worker {address} cannot be used: {'; '.join(refusals)}"


def request_stop(client: str) -> None:
    """Ask the jobs of an executor to stop at their next checkpoint, and those to come not to begin."""
    _stop_of(client).set()


def _stop_of(client: str) -> threading.Event:
    with _lock:
        return _stops.setdefault(client, threading.Event())


class Relay:
    """Sends messages in bundles; those of a job that is over before a bundle is due come with its end.

    Parameters
    ----------
    ticket
        Of the job.
    send
        Sends bytes to the executor.
    """

    def __init__(self, ticket: Ticket, send: Send) -> None:
        self._ticket, self._send = ticket, send
        self._messages: list[Any] = []
        self._timer: threading.Timer | None = None
        self._lock = threading.Lock()

    def __call__(self, message: Any) -> None:
        """Keep a message for the next bundle."""
        with self._lock:
            self._messages.append(message)
            if self._timer is None:
                self._timer = threading.Timer(self._ticket.interval, self._flush)
                self._timer.daemon = True
                self._timer.start()

    def rest(self) -> tuple[Any, ...]:
        """Messages that were not sent yet."""
        with self._lock:
            if self._timer is not None:
                self._timer.cancel()
            rest, self._messages = tuple(self._messages), []
        return rest

    def _flush(self) -> None:
        with self._lock:
            bundle, self._messages, self._timer = tuple(self._messages), [], None
            if bundle:
                self._send(pickle.dumps((self._ticket.number, bundle)))


def _sendable(error: Exception) -> Exception:
    """The error with its traceback as a note, or what can be said of it if it cannot be sent."""
    error.add_note("".join(traceback.format_exception(error)))
    try:
        back = pickle.loads(pickle.dumps(error))
    except Exception:
        back = None
    if type(back) is type(error) and str(back) == str(error):
        return error
    told = MyofilmError(f"unexpected {type(error).__name__}: {error}")
    told.add_note("".join(error.__notes__))
    return told
