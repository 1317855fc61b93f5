"""When artefacts were used last: noted together, since nobody waits for it."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, field

from pipeline.keys import Ref
from pipeline.store.remote.objects import Objects

TOGETHER = 64
"""Artefacts noted by one call."""

DELAY = 60.0
"""Seconds after which a later use takes those before along."""


@dataclass
class Uses:
    """Notes of a process that are not written yet; those of one that is killed are lost.

    Nothing but the order in which a collection removes depends on them.

    Attributes
    ----------
    objects
        The place.
    """

    objects: Objects
    _waiting: set[Ref] = field(default_factory=set)
    _since: float = 0.0
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def note(self, ref: Ref) -> None:
        """An artefact is used now."""
        with self._lock:
            if not self._waiting:
                self._since = time.monotonic()
            self._waiting.add(ref)
            due = len(self._waiting) >= TOGETHER or time.monotonic() - self._since > DELAY
        if due:
            self.write()

    def drop(self, ref: Ref) -> None:
        """It is removed."""
        with self._lock:
            self._waiting.discard(ref)

    def write(self) -> None:
        """Write all that wait, at once."""
        with self._lock:
            refs, self._waiting = self._waiting, set()
        if refs:
            self.objects.write({f"usage/{ref.stage}/{ref.key}": b"" for ref in refs})
