"""Reading a remote store: markers, listings, data."""

from __future__ import annotations

import contextlib
import heapq
import threading
from collections import OrderedDict
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from pathlib import Path

from pipeline.durable import remove_tree, storing
from pipeline.errors import StoreError
from pipeline.keys import Ref
from pipeline.store.remote.markers import Marker, data_folder, marker_path, ref_of
from pipeline.store.remote.objects import Entry, Objects
from pipeline.store.remote.read_cache import ReadCache
from pipeline.verification import DamagedError, full_problems

KNOWN_AT_MOST = 20_000
"""Markers that a process remembers."""

AHEAD = 1024
"""Markers that are read at once after a listing, over several connections."""


class Reader:
    """Markers of a store, remembered by this process.

    Parameters
    ----------
    objects
        The place.
    cache
        Copies on this machine.
    """

    def __init__(self, objects: Objects, cache: ReadCache) -> None:
        self._objects, self._cache = objects, cache
        self._known: OrderedDict[Ref, Marker] = OrderedDict()
        self._listed: list[Ref] = []
        self._lock = threading.Lock()

    def where(self, ref: Ref) -> str:
        """URL of the marker of an artefact."""
        return f"{self._objects.location}/{marker_path(ref)}"

    def is_there(self, ref: Ref) -> bool:
        """Whether there is a marker, readable or not."""
        return self._objects.read(marker_path(ref)) is not None

    def marker(self, ref: Ref) -> Marker | None:
        """Marker as it is now, ``None`` if there is none.

        Raises
        ------
        StoreError
            If it cannot be read.
        """
        contents = self._objects.read(marker_path(ref))
        if contents is None:
            with self._lock:
                self._known.pop(ref, None)
            return None
        return self._remember(ref, contents)

    def look(self, ref: Ref) -> tuple[Marker | None, list[str]]:
        """Marker as it is now, and what is wrong with the artefact.

        A copy on this machine tells which data will count, most likely: these are then listed while the
        marker is read.

        Raises
        ------
        StoreError
            If the marker cannot be read.
        """
        likely = self._cache.attempt(ref)
        listing = (
            self._second.submit(self._objects.listing, data_folder(ref, likely)) if likely else None
        )
        marker = self.marker(ref)
        if marker is None:
            return None, []
        there = listing.result() if listing and marker.attempt == likely else None
        return marker, self.problems(ref, marker, there)

    def forget(self) -> None:
        """Read markers anew from now on: what is remembered may have been removed and computed again."""
        with self._lock:
            self._known.clear()

    def known(self, ref: Ref) -> Marker:
        """Marker that was read before, or is read now; the next ones of a listing are read with it.

        Raises
        ------
        StoreError
            If there is none, or it cannot be read.
        """
        with self._lock:
            if ref in self._known:
                return self._known[ref]
            wanted = self._next_listed(ref)
        contents = self._objects.read_many(marker_path(one) for one in wanted)
        for one in wanted[1:]:
            if found := contents.get(marker_path(one)):
                try:
                    self._remember(one, found)
                except StoreError:
                    continue  # told when it is asked for
        if marker_path(ref) not in contents:
            raise StoreError("there is no such artefact", path=self.where(ref))
        return self._remember(ref, contents[marker_path(ref)])

    def listed(self, stage: str | None = None) -> dict[Ref, Entry]:
        """Markers of one stage or of all."""
        found = self._objects.listing("objects" if stage is None else f"objects/{stage}")
        refs = {ref: entry for path, entry in found.items() if (ref := ref_of(path))}
        with self._lock:
            self._listed = sorted(refs, key=lambda ref: (ref.stage, ref.key))
        return refs

    def newest(self, stage: str, count: int) -> list[Ref]:
        """The artefacts of a stage that were published last, latest first.

        The server's time decides; where it has ticks of a second, the publishers' clocks within them.
        """
        found = self.listed(stage)
        times = heapq.nlargest(count, (entry.modified for entry in found.values()))
        if not times:
            return []
        tied = [ref for ref, entry in found.items() if entry.modified >= times[-1]]
        with self._lock:
            self._listed = tied

        def published(ref: Ref) -> tuple[float, float]:
            try:
                return found[ref].modified, self.known(ref).published
            except StoreError:
                return found[ref].modified, 0.0

        return heapq.nlargest(count, tied, key=published)

    def problems(
        self, ref: Ref, marker: Marker, there: dict[str, Entry] | None = None
    ) -> list[str]:
        """What is wrong with an artefact, as far as its marker and a listing of its data tell."""
        if there is None:
            there = self._objects.listing(data_folder(ref, marker.attempt))
        found = list(_size_problems(ref, marker, there))
        if marker.manifest.ref != ref:
            found.append(f"its manifest belongs to {marker.manifest.ref}")
        return found

    def verify(self, ref: Ref, *, full: bool) -> tuple[str, ...]:
        """The same; ``full`` downloads the data, whatever copies there are, and compares checksums."""
        try:
            marker = self.marker(ref)
        except DamagedError as error:  # any other one is trouble on the way there, not damage
            return error.problems
        if marker is None:
            return ("there is no such artefact",)
        problems = self.problems(ref, marker)
        if full and not problems:
            folder = data_folder(ref, marker.attempt)
            with self.scratch() as scratch, storing(scratch):
                there = self._objects.listing(folder)
                self._objects.download({p: scratch / p[len(folder) + 1 :] for p in there})
                problems = list(full_problems(scratch, marker.manifest))
        return tuple(problems)

    def fetch(self, ref: Ref, marker: Marker, folder: Path) -> None:
        """Download the data of an artefact."""
        source = data_folder(ref, marker.attempt)
        files = marker.manifest.files
        self._objects.download({f"{source}/{file.path}": folder / file.path for file in files})

    @contextlib.contextmanager
    def scratch(self) -> Iterator[Path]:
        """A folder on this machine that is removed after the block."""
        folder = self._cache.scratch()
        try:
            yield folder
        finally:
            remove_tree(folder)

    @cached_property
    def _second(self) -> ThreadPoolExecutor:
        return ThreadPoolExecutor(2, "listing")

    def _remember(self, ref: Ref, contents: bytes) -> Marker:
        try:
            marker = Marker.from_bytes(contents)
        except ValueError as error:
            raise DamagedError(ref, self.where(ref), [f"unreadable manifest ({error})"]) from error
        with self._lock:
            self._known[ref] = marker
            while len(self._known) > KNOWN_AT_MOST:
                self._known.popitem(last=False)
        return marker

    def _next_listed(self, ref: Ref) -> list[Ref]:
        """The artefact and those after it in the last listing, as far as they are not known."""
        try:
            start = self._listed.index(ref)
        except ValueError:
            return [ref]
        others = (one for one in self._listed[start + 1 :] if one not in self._known)
        return [ref, *(one for one, _ in zip(others, range(AHEAD - 1), strict=False))]


def _size_problems(ref: Ref, marker: Marker, there: dict[str, Entry]) -> Iterator[str]:
    for file in marker.manifest.files:
        entry = there.get(f"{data_folder(ref, marker.attempt)}/{file.path}")
        if entry is None:
            yield f"{file.path} is missing"
        elif entry.size != file.size:
            yield f"{file.path} has {entry.size} bytes instead of {file.size}"
