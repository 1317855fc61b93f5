"""Ctrl-C that waits for a moment at which the work can be saved."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType


class Interrupts:
    """Whether the user asked to stop, and whether that can wait for a checkpoint.

    Parameters
    ----------
    on_request
        Called when an interrupt is deferred, inside the signal handler.

    Attributes
    ----------
    deferrable
        Set by the run once the stage has shown that it makes checkpoints.
    requested
        Set by the first Ctrl-C that was deferred; the next one stops at once.
    """

    def __init__(self, on_request: Callable[[], None] = lambda: None) -> None:
        self._on_request = on_request
        self.deferrable = False
        self.requested = False

    def handle(self, number: int, frame: FrameType | None) -> None:
        """Signal handler.

        Raises
        ------
        KeyboardInterrupt
            Unless the interrupt can wait and is the first one.
        """
        if not self.deferrable or self.requested:
            raise KeyboardInterrupt
        self.requested = True
        with contextlib.suppress(RuntimeError):  # it came while a stream was being written to
            self._on_request()


@contextlib.contextmanager
def deferred_interrupts(on_request: Callable[[], None] = lambda: None) -> Iterator[Interrupts]:
    """Defer Ctrl-C in the block; outside the main thread, where none arrives, do nothing."""
    interrupts = Interrupts(on_request)
    if threading.current_thread() is not threading.main_thread():
        yield interrupts
        return
    before = signal.signal(signal.SIGINT, interrupts.handle)
    try:
        yield interrupts
    finally:
        signal.signal(signal.SIGINT, before)
