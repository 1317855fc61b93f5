"""Jobs one after the other, in this process and this thread."""

from __future__ import annotations

import signal
from collections import deque
from collections.abc import Callable, Hashable
from typing import Any

from pipeline.executors.protocol import Completion, Hear
from pipeline.running.interrupts import Stopped


class SerialExecutor:
    """Runs a job when the next completion is asked for. Signals reach the job itself."""

    slots = 1
    in_process = True

    def __init__(self) -> None:
        self._waiting: deque[tuple[Hashable, Callable[..., Any], tuple[Any, ...]]] = deque()
        self._stopped = False

    def submit(self, tag: Hashable, function: Callable[..., Any], *arguments: Any) -> None:
        """Keep a job until its turn comes."""
        self._waiting.append((tag, function, arguments))

    def next(self, hear: Hear, timeout: float | None = None) -> Completion | None:
        """Run the oldest job.

        Raises
        ------
        KeyboardInterrupt
            If a signal stopped it.
        """
        if not self._waiting:
            return None
        tag, function, arguments = self._waiting.popleft()
        if self._stopped:
            return Completion(tag, error=Stopped(signal.SIGINT))
        try:
            value = function(*arguments, tell=lambda message: hear(tag, message))
        except Exception as error:
            return Completion(tag, error=error)
        return Completion(tag, value)

    def stop(self) -> None:
        """No job runs while this is called; those that wait will not begin."""
        self._stopped = True

    def close(self) -> None:
        """Nothing is held."""
