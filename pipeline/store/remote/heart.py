"""Signs of life, written from a thread as long as the process lives."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator

from pipeline.errors import StoreError


class Heart:
    """Calls what it is given, at an interval; a call that fails is made again next time.

    Parameters
    ----------
    interval
        Seconds.
    """

    def __init__(self, interval: float) -> None:
        self.interval = interval
        self._beats: dict[object, Callable[[], None]] = {}
        self._lock = threading.Lock()
        self._stop: threading.Event | None = None

    def add(self, name: object, beat: Callable[[], None]) -> None:
        """Begin to call ``beat``."""
        with self._lock:
            self._beats[name] = beat
            if self._stop is None:
                self._stop = threading.Event()
                threading.Thread(target=self._run, args=(self._stop,), daemon=True).start()

    def drop(self, name: object) -> None:
        """Call it no longer."""
        with self._lock:
            self._beats.pop(name, None)
            if not self._beats and self._stop is not None:
                self._stop.set()
                self._stop = None

    @contextlib.contextmanager
    def beating(self, beat: Callable[[], None]) -> Iterator[None]:
        """Call ``beat`` at the interval while the block runs."""
        name = object()
        self.add(name, beat)
        try:
            yield
        finally:
            self.drop(name)

    def _run(self, stop: threading.Event) -> None:
        while not stop.wait(self.interval):
            with self._lock:
                beats = list(self._beats.items())
            for name, beat in beats:
                if name in self._beats:
                    with contextlib.suppress(StoreError):
                        beat()
