"""A store on object storage."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import platform
import uuid
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from pipeline.durable import opening, storing
from pipeline.errors import InputError, StoreError
from pipeline.events import Holder
from pipeline.keys import SCHEMA, Ref
from pipeline.manifest import Manifest
from pipeline.store.description import check_description
from pipeline.store.labels import RunLabel
from pipeline.store.locks import locked
from pipeline.store.remote import leases
from pipeline.store.remote import mirror as mirrors
from pipeline.store.remote.clock import ServerClock
from pipeline.store.remote.folders import Folders, cache_folder, cache_limit
from pipeline.store.remote.heart import Heart
from pipeline.store.remote.leases import Leases
from pipeline.store.remote.markers import new_attempt
from pipeline.store.remote.mirror import Mirror
from pipeline.store.remote.objects import Objects
from pipeline.store.remote.read_cache import ReadCache
from pipeline.store.remote.reader import Reader
from pipeline.store.remote.registers import RemoteRegisters
from pipeline.store.remote.upkeep import RemoteUpkeep, set_aside
from pipeline.store.remote.uses import Uses
from pipeline.store.remote.workspace import RemoteWorkspace
from pipeline.verification import DamagedError


class RemoteStore:
    """A store below a URL; it is created when the first artefact is written.

    Parameters
    ----------
    objects
        The place.
    cache
        Folder on this machine for work, checkpoints and copies of artefacts; by default in the user's
        cache folder, or below ``MYOFILM_CACHE``.
    lease, mirror
        Seconds after which the lease of a dead process expires, and between copies of a checkpoint.

    Raises
    ------
    InputError
        If the place cannot be reached or refuses, or the store was written by a newer version.
    StoreError
        If the description of the store is damaged.
    """

    def __init__(
        self,
        objects: Objects,
        cache: Path | None = None,
        *,
        lease: float = leases.SECONDS,
        mirror: float = mirrors.SECONDS,
    ) -> None:
        self.objects = objects
        self._given = cache, lease, mirror
        self._described = self._ready = self._written = False
        self._mirror_seconds = mirror
        self.folders = Folders(cache or cache_folder(objects.location))
        self.cache = ReadCache(self.folders.path, cache_limit())
        self.reader = Reader(objects, self.cache)
        self._clock, self._heart = ServerClock(objects), Heart(lease / leases.BEATS)
        self._registers = RemoteRegisters(objects, self._clock, self._heart, lease)
        self._uses = Uses(objects)
        with self._first_use():
            about = objects.read("store.json")
            if about is None:
                objects.check_place()
        if about is not None:
            check_description(about, self.location)
            self._described = True
        objects.be_patient()

    def __reduce__(self) -> tuple[Any, ...]:
        """In another process: the one store of this place that all jobs there use."""
        return _again, (_Place(type(self.objects), self.location, self.objects), *self._given)

    @property
    def location(self) -> str:
        """The URL."""
        return self.objects.location

    @cached_property
    def leases(self) -> Leases:
        """Leases taken from this machine."""
        place = self.folders.identity()
        return Leases(self.objects, self._clock, self._heart, place, self._given[1])

    @property
    def upkeep(self) -> RemoteUpkeep:
        """Lists, tags, removing."""
        return RemoteUpkeep(
            self.objects, self.reader, self._registers, self._uses, self.leases, self.folders
        )

    def begin(self, label: RunLabel) -> None:
        """Make a run known, before it asks for artefacts under its label."""
        with self._unless_read_only():
            self._prepare()
            self._registers.begin(label)

    def finish(self, label: RunLabel, *, keep_earlier: bool = False) -> None:
        """Note that a run ended well; unless told otherwise, earlier ones of its name are dropped."""
        with self._unless_read_only():
            self._uses.write()
            self._registers.finish(label, keep_earlier=keep_earlier)

    def find(self, ref: Ref, label: RunLabel | None = None) -> Manifest | None:
        """Manifest of an artefact, ``None`` if there is none; sizes of its files are checked.

        Registered first, then looked for: whoever removes artefacts takes the marker away first and
        looks for registrations then, so one of the two notices the other.
        """
        if label is not None:
            with self._unless_read_only():
                self._registers.add(label, ref)
        marker, problems = self.reader.look(ref)
        if marker is None and label is not None and self.upkeep.await_removal(ref):
            marker, problems = self.reader.look(ref)
        if marker is None:
            return None
        if problems:
            if self.reader.marker(ref) != marker:
                return self.find(ref)  # it was removed, or computed anew, just now
            raise DamagedError(ref, self.where(ref), problems)
        if label is not None:
            with self._unless_read_only():
                self._uses.note(ref)
        return marker.manifest

    def manifest(self, ref: Ref) -> Manifest:
        """Manifest of an artefact that must be there; its files are not looked at."""
        return self.reader.known(ref).manifest

    def data(self, ref: Ref) -> Path:
        """Folder on this machine with a verified copy of the data files of an artefact."""
        marker = self.reader.known(ref)
        return self.cache.get(ref, marker, lambda folder: self.reader.fetch(ref, marker, folder))

    def where(self, ref: Ref) -> str:
        """URL of the marker of an artefact."""
        return self.reader.where(ref)

    def refs(self, stage: str | None = None) -> Iterator[Ref]:
        """Artefacts of one stage or of all, sorted; a request for some 1,000 of them."""
        yield from sorted(self.reader.listed(stage), key=lambda ref: (ref.stage, ref.key))

    def newest(self, stage: str, count: int) -> list[Ref]:
        """The artefacts of a stage that were published last, at most ``count`` of them."""
        return self.reader.newest(stage, count)

    def checkpoint(self, ref: Ref) -> Path | None:
        """File with the checkpoint of an interrupted computation, here or copied from elsewhere."""
        folder, path = self.folders.work(ref.key)
        if path.is_file():
            return path
        mirror = Mirror(self.objects, ref.key, new_attempt(), folder / "data", path, 0.0)
        return mirror.state()

    def verify(self, ref: Ref, *, full: bool = False) -> tuple[str, ...]:
        """Problems of an artefact in words; ``full`` downloads it and recomputes every checksum."""
        return self.reader.verify(ref, full=full)

    def quarantine(self, ref: Ref, problems: Iterable[str] = ()) -> str | None:
        """Move an artefact aside if it is damaged; where it is then, ``None`` if it is not."""
        self._prepare()
        with (
            self._alone(ref, lambda holder: None) as alone,
            self.leases.hold(ref.key, ref.stage, lambda holder: None, alone_here=alone),
        ):
            if not self.reader.is_there(ref) or not (found := self.verify(ref, full=True)):
                return None
            return set_aside(self.objects, self.reader, ref, dict.fromkeys([*problems, *found]))

    @contextlib.contextmanager
    def writing(self, ref: Ref, on_wait: Callable[[Holder], None]) -> Iterator[RemoteWorkspace]:
        """Hold the lock of a key on this machine and its lease in the store, and work on the artefact."""
        with contextlib.ExitStack() as stack:
            with self._using():
                self._prepare()
                with self._unless_read_only():
                    self._uses.write()
                alone = stack.enter_context(self._alone(ref, on_wait))
                held = stack.enter_context(
                    self.leases.hold(ref.key, ref.stage, on_wait, alone_here=alone)
                )
            self._written = True
            # Without file locks each process of this machine works apart.
            name = ref.key if alone else f"{ref.key}.{platform.node()}.{os.getpid()}"
            folder, checkpoint = self.folders.work(name)
            attempt = new_attempt()
            seconds = self._mirror_seconds
            mirror = Mirror(self.objects, ref.key, attempt, folder / "data", checkpoint, seconds)
            mirror.restore()
            yield RemoteWorkspace(ref, folder, checkpoint, self.objects, self.cache, mirror, held)

    @contextlib.contextmanager
    def _alone(self, ref: Ref, on_wait: Callable[[Holder], None]) -> Iterator[bool]:
        with contextlib.ExitStack() as stack:
            with storing(self.folders.path):
                alone = stack.enter_context(locked(self.folders.lock(ref), ref.stage, on_wait))
            yield alone

    def _prepare(self) -> None:
        """Make ready to write."""
        if self._ready:
            return
        with opening(self.folders.path):
            self.folders.make()
        if not self._described:
            self._describe()
        self._ready = True

    def _describe(self) -> None:
        """Write the description, which also shows whether creating is safe here."""
        with self._first_use():
            about = json.dumps({"version": SCHEMA, "id": uuid.uuid4().hex}).encode()
            if self.objects.create("store.json", about) and self.objects.create(
                "store.json", about
            ):
                raise InputError(
                    f"the store {self.location} cannot be kept there: the server replaces objects that "
                    "it was asked to create only if they are absent (for S3, If-None-Match), so two "
                    "processes could publish the same artefact; update the server, or choose another "
                    "store with --store"
                )

    def _using(self) -> contextlib.AbstractContextManager[None]:
        return contextlib.nullcontext() if self._written else self._first_use()

    @contextlib.contextmanager
    def _first_use(self) -> Iterator[None]:
        """Trouble in the first use is a bad request: no such store can be used now."""
        try:
            yield
        except DamagedError:
            raise
        except StoreError as error:
            raise InputError(str(error)) from error

    @contextlib.contextmanager
    def _unless_read_only(self) -> Iterator[None]:
        """Do the block as far as the store may be written; hits are served in any case."""
        try:
            yield
        except (StoreError, InputError) as error:
            cause: BaseException | None = error
            while cause is not None and not _forbids_writing(cause):
                cause = cause.__cause__
            if cause is None:
                raise


def _forbids_writing(error: BaseException) -> bool:
    return isinstance(error, OSError) and (
        isinstance(error, PermissionError) or error.errno == errno.EROFS
    )


@dataclass(frozen=True)
class _Place:
    """Objects by kind and location: two connections to one place are the same place."""

    kind: type
    location: str
    objects: Objects = field(compare=False)


@lru_cache(maxsize=16)
def _of_process(place: _Place, cache: Path | None, lease: float, mirror: float) -> RemoteStore:
    return RemoteStore(place.objects, cache, lease=lease, mirror=mirror)


def _again(place: _Place, cache: Path | None, lease: float, mirror: float) -> RemoteStore:
    """For a new job: connection and checked copies serve all jobs, manifests may have changed since."""
    store = _of_process(place, cache, lease, mirror)
    store.reader.forget()
    return store
