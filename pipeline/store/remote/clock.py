"""The time on the server, so that clocks of machines are never compared."""

from __future__ import annotations

import threading
import time
import uuid

from pipeline.store.remote.objects import Objects

AGAIN = 600.0
"""Seconds after which the server is asked anew."""


class ServerClock:
    """Time on the server: asked by writing an object, then counted on by the local monotonic clock.

    Servers of S3 give times in whole seconds, so it may lag by one.
    """

    def __init__(self, objects: Objects) -> None:
        self._objects = objects
        self._lock = threading.Lock()
        self._asked: tuple[float, float] | None = None

    def now(self) -> float:
        """Seconds since 1970, by the clock of the server."""
        with self._lock:
            here = time.monotonic()
            if self._asked is None or here - self._asked[0] > AGAIN:
                self._asked = here, self._ask()
            return self._asked[1] + time.monotonic() - self._asked[0]

    def _ask(self) -> float:
        folder = f"clock/{uuid.uuid4().hex}"
        path = f"{folder}/now"
        self._objects.write({path: b""})
        try:
            return self._objects.listing(folder)[path].modified
        finally:
            self._objects.remove([path])
