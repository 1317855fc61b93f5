"""One computation per key without file locks: leases that their owner keeps alive, and that expire.

The lease of a key is the object ``leases/<key>/<generation>`` of the highest generation. Whoever
creates the next generation, which succeeds for one, has the lease; nobody else writes that object.
Its owner writes it again at an interval, so that the server's times tell whether he is alive.

An owner may lose his lease without knowing, for instance while his machine sleeps. So a lease saves
double work and no more: that artefacts are whole does not depend on it.
"""

from __future__ import annotations

import contextlib
import json
import os
import platform
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass

from pipeline.errors import StoreError
from pipeline.events import Holder
from pipeline.store.remote.clock import ServerClock
from pipeline.store.remote.heart import Heart
from pipeline.store.remote.objects import Objects

SECONDS = 60.0
"""Age at which a lease expires. Compiled kernels may keep the owner's other threads waiting for seconds."""

BEATS = 6
"""Signs of life in this time."""

POLL = 0.1, 2.0
"""Seconds between looks at another's lease, first and at most."""


@dataclass(frozen=True)
class Lease:
    """What its object says.

    Attributes
    ----------
    host, pid, stage
        Its owner.
    place
        The cache folder of the owner, in which he holds a file lock as well.
    seconds
        Age at which it expires.
    free
        Whether the owner has let it go.
    """

    host: str
    pid: int
    stage: str
    place: str
    seconds: float
    free: bool = False


@dataclass
class Held:
    """A lease that one has.

    Attributes
    ----------
    path, before
        Its object, and that of the generation before.
    settled
        Set when the artefact is published: then nobody needs a lease of this key again.
    """

    path: str
    before: str
    settled: bool = False


class Leases:
    """Leases of a store.

    Parameters
    ----------
    objects, clock, heart
        Of the store.
    place
        Id of the cache folder on this machine.
    seconds
        Age at which leases expire.
    """

    def __init__(
        self, objects: Objects, clock: ServerClock, heart: Heart, place: str, seconds: float
    ) -> None:
        self._objects, self._clock, self._heart = objects, clock, heart
        self._place, self._seconds = place, seconds

    @contextlib.contextmanager
    def hold(
        self, key: str, stage: str, on_wait: Callable[[Holder], None], *, alone_here: bool
    ) -> Iterator[Held]:
        """Have the lease of a key, waiting for its present owner.

        Parameters
        ----------
        alone_here
            Whether the file lock of the key in the cache folder is held: then a lease that was
            taken from this folder belongs to a process that is gone.
        """
        pause, told = POLL[0], False
        while (held := self.take(key, stage, alone_here=alone_here)) is None:
            if not told and (owner := self.owner(key)) is not None:
                on_wait(owner)
                told = True
            time.sleep(pause)
            pause = min(1.5 * pause, POLL[1])
        with self.keeping(held, stage):
            yield held

    @contextlib.contextmanager
    def keeping(self, held: Held, stage: str) -> Iterator[None]:
        """Keep a lease alive in the block, then let it go."""
        try:
            with self._heart.beating(lambda: self._write(held.path, stage)):
                yield
        finally:
            with contextlib.suppress(StoreError):  # it expires
                if held.settled:
                    self._objects.remove([held.before])
                    self._objects.remove([held.path])
                else:
                    self._write(held.path, stage, free=True)

    def take(self, key: str, stage: str, *, alone_here: bool) -> Held | None:
        """The lease of a key, ``None`` if another has it."""
        generations = self._generations(key)
        latest = max(generations, default=0)
        if latest and not self._is_free(key, latest, generations[latest], alone_here):
            return None
        path = _path(key, latest + 1)
        if not self._objects.create(path, self._text(stage)):
            return None
        # The one before stays: a listing that is under way may miss the new one, not both.
        self._objects.remove([_path(key, old) for old in generations if old < latest])
        return Held(path, _path(key, latest))

    def owner(self, key: str) -> Holder | None:
        """Who has the lease of a key now, alive or not."""
        latest = max(self._generations(key), default=0)
        lease = self._read(_path(key, latest)) if latest else None
        if lease is None or lease.free:
            return None
        return Holder(lease.host, lease.pid, lease.stage)

    def busy(self, key: str) -> bool:
        """Whether somebody alive has the lease of a key."""
        generations = self._generations(key)
        latest = max(generations, default=0)
        return bool(latest) and not self._is_free(key, latest, generations[latest], False)

    def _generations(self, key: str) -> dict[int, float]:
        """When the owner of each generation gave his last sign of life, by the server's clock."""
        found = self._objects.listing(f"leases/{key}")
        names = {path.rpartition("/")[2]: entry.modified for path, entry in found.items()}
        return {int(name): modified for name, modified in names.items() if name.isdecimal()}

    def _is_free(self, key: str, generation: int, beat: float, alone_here: bool) -> bool:
        lease = self._read(_path(key, generation))
        if lease is None:
            # Gone, since the artefact was published or a later generation taken; or unreadable.
            return self._clock.now() - beat > self._seconds
        if lease.free or (alone_here and lease.place == self._place):
            return True
        return self._clock.now() - beat > lease.seconds

    def _read(self, path: str) -> Lease | None:
        try:
            return Lease(**json.loads(self._objects.read(path) or b""))
        except (ValueError, TypeError):
            return None

    def _text(self, stage: str, *, free: bool = False) -> bytes:
        lease = Lease(platform.node(), os.getpid(), stage, self._place, self._seconds, free)
        return json.dumps(asdict(lease)).encode()

    def _write(self, path: str, stage: str, *, free: bool = False) -> None:
        self._objects.write({path: self._text(stage, free=free)})


def _path(key: str, generation: int) -> str:
    return f"leases/{key}/{generation:08d}"
