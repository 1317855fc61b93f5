"""Requests to stop that wait for a moment at which the work can be saved.

In the main thread they are signals: Ctrl-C, SIGTERM, SIGHUP. In other threads, where no signal arrives,
whoever started the thread's work sets an event.
"""

from __future__ import annotations

import contextlib
import signal
import threading
import time
from collections.abc import Callable, Iterator
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

REPEATED = 1.0
"""Seconds in which SIGTERM and SIGHUP count once: ``timeout`` and closing terminals send them twice."""


class Stopped(KeyboardInterrupt):
    """A signal asked to stop.

    Attributes
    ----------
    exit_code
        What a process that ends so should return: 128 and the number of the signal.

    Examples
    --------
    >>> Stopped(signal.SIGTERM).exit_code
    143
    """

    def __init__(self, number: int) -> None:
        self.exit_code = 128 + number
        super().__init__(signal.Signals(number).name)

    def __reduce__(self) -> tuple[type[Stopped], tuple[int]]:
        return Stopped, (self.exit_code - 128,)


class Interrupts:
    """Whether the user or the system asked to stop, and whether that can wait for a checkpoint.

    Parameters
    ----------
    on_request
        Called when a signal is deferred, inside the signal handler.
    event
        Set by another thread that asks to stop; nothing is called then.

    Attributes
    ----------
    deferrable
        Set by the run once the stage has shown that it makes checkpoints.
    """

    def __init__(
        self, on_request: Callable[[], None] = lambda: None, event: threading.Event | None = None
    ) -> None:
        self._on_request = on_request
        self._event = event
        self._last = float("-inf")
        self._signal: int | None = None
        self.deferrable = False

    @property
    def requested(self) -> int | None:
        """The first signal that was deferred (the next one stops at once), or that an event stands for."""
        if self._event is not None and self._event.is_set():
            return signal.SIGINT
        return self._signal

    def handle(self, number: int, frame: FrameType | None) -> None:
        """Signal handler.

        Raises
        ------
        Stopped
            Unless the signal can wait and is the first one.
        """
        now = time.monotonic()
        if number != signal.SIGINT and now - self._last < REPEATED:
            return
        self._last = now
        if not self.deferrable or self._signal:
            raise Stopped(number)
        self._signal = number
        # It may come while a stream is being written to, or because the terminal is gone.
        with contextlib.suppress(RuntimeError, OSError):
            self._on_request()

    def check(self) -> None:
        """Stop now if that was asked for.

        Raises
        ------
        Stopped
            If so.
        """
        if self.requested:
            raise Stopped(self.requested)


_of_thread = threading.local()


@contextlib.contextmanager
def stopped_by(event: threading.Event) -> Iterator[None]:
    """Let an event ask the stages to stop that run in the block, in this thread."""
    _of_thread.event = event
    try:
        yield
    finally:
        del _of_thread.event


@contextlib.contextmanager
def deferred_interrupts(on_request: Callable[[], None] = lambda: None) -> Iterator[Interrupts]:
    """Handle signals in the block; outside the main thread, where none arrives, heed the event.

    Those that the process ignores (as under ``nohup``) stay ignored.
    """
    interrupts = Interrupts(on_request, getattr(_of_thread, "event", None))
    if threading.current_thread() is not threading.main_thread():
        yield interrupts
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}
    handled = {n: handler for n, handler in before.items() if handler not in (signal.SIG_IGN, None)}
    try:
        for number in handled:
            signal.signal(number, interrupts.handle)
        yield interrupts
    finally:
        for number, handler in handled.items():
            signal.signal(number, handler)
