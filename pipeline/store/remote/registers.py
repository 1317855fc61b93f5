"""The runs of a remote store, and which artefacts each of them uses.

Layout, all below ``runs/<slug of the name>/<generation>/``::

    label                  written when a run begins
    alive                  written again at an interval, as long as its process lives
    refs/<stage>/<key>     an empty object for each artefact that one of its processes asked for
    done                   it ended well

Objects cannot be appended to, so each artefact has one of its own; no process reads what others wrote.
"""

from __future__ import annotations

import contextlib
import json
import threading
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field

from pipeline.errors import StoreError
from pipeline.keys import Ref
from pipeline.store.labels import RegisteredRun, RunLabel, from_json, to_json
from pipeline.store.remote.clock import ServerClock
from pipeline.store.remote.heart import Heart
from pipeline.store.remote.objects import Entry, Objects

KNOWN_AT_MOST = 200_000
"""References that a process remembers to have registered."""


@dataclass
class RemoteRegisters:
    """Runs of a store.

    Attributes
    ----------
    objects, clock, heart
        Of the store.
    seconds
        Age of the last sign of life above which a run counts as dead.
    """

    objects: Objects
    clock: ServerClock
    heart: Heart
    seconds: float
    _known: set[tuple[str, Ref]] = field(default_factory=set)
    _begun: set[str] = field(default_factory=set)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def begin(self, label: RunLabel) -> None:
        """Make a run known, and alive until this process ends or the run is finished."""
        folder = _folder(label)
        with self._lock:
            if folder in self._begun:
                return
            self.objects.write({f"{folder}/alive": b""})  # first: a run is never seen dead before
            self.objects.write({f"{folder}/label": json.dumps(to_json(label)).encode()})
            self._begun.add(folder)
        self.heart.add(folder, lambda: self.objects.write({f"{folder}/alive": b""}))

    def add(self, label: RunLabel, ref: Ref) -> None:
        """Register an artefact, whether or not it is there already."""
        with self._lock:
            if (label.generation, ref) in self._known:
                return
        self.objects.write({f"{_folder(label)}/refs/{ref.stage}/{ref.key}": b""})
        with self._lock:
            if len(self._known) >= KNOWN_AT_MOST:
                self._known.clear()
            self._known.add((label.generation, ref))

    def finish(self, label: RunLabel, *, keep_earlier: bool = False) -> None:
        """Note that a run ended well; unless told otherwise, earlier ones of its name are dropped."""
        folder = _folder(label)
        self.heart.drop(folder)
        with self._lock:
            self._begun.discard(folder)
        self.objects.write({f"{folder}/done": b""})
        if keep_earlier:
            return
        there = self.objects.listing(f"runs/{label.slug}")
        others = {path: entry for path, entry in there.items() if not _is_in(path, folder)}
        earlier: list[str] = []
        with contextlib.suppress(StoreError):  # a damaged label is told to those who need it
            earlier += [
                _folder(run.label)
                for run in self._runs_of(others)
                if run.label.generation < label.generation and not run.alive
            ]
        self._remove([path for path in others if any(_is_in(path, run) for run in earlier)])

    def runs(self) -> Iterator[RegisteredRun]:
        """All runs, in no particular order.

        Raises
        ------
        StoreError
            If a label is damaged: nobody knows then what that run keeps.
        """
        return self._runs_of(self.objects.listing("runs"))

    def refs(self, label: RunLabel) -> Iterator[Ref]:
        """What a run has registered so far."""
        for path in self.objects.listing(f"{_folder(label)}/refs"):
            yield Ref(*path.split("/")[-2:])

    def forget(self, label: RunLabel) -> None:
        """Remove all that is known of one run."""
        self._remove(self.objects.listing(_folder(label)))

    def _remove(self, paths: Collection[str]) -> None:
        """Remove objects of runs; labels last, without them nobody could tell whose the others are."""
        for labels in (False, True):
            self.objects.remove([path for path in paths if path.endswith("/label") is labels])

    def _runs_of(self, there: Mapping[str, Entry]) -> Iterator[RegisteredRun]:
        """Runs among listed objects."""
        found: dict[str, dict[str, Entry]] = {}
        for path, entry in there.items():
            parts = path.split("/")
            if len(parts) == 4:
                found.setdefault("/".join(parts[:3]), {})[parts[3]] = entry
        labels = self.objects.read_many(f"{run}/label" for run in found if "label" in found[run])
        for path, contents in labels.items():
            entries = found[path.rpartition("/")[0]]
            try:
                label = from_json(json.loads(contents))
            except ValueError as error:
                raise StoreError(
                    f"unreadable label of a run ({error})",
                    path=f"{self.objects.location}/{path}",
                    remedy="remove this object; what only that run kept may be removed then",
                ) from error
            done, sign = entries.get("done"), entries.get("alive")
            alive = (
                done is None
                and sign is not None
                and self.clock.now() - sign.modified <= self.seconds
            )
            yield RegisteredRun(label, None if done is None else done.modified, alive)


def _is_in(path: str, folder: str) -> bool:
    return path.startswith(f"{folder}/")


def _folder(label: RunLabel) -> str:
    return f"runs/{label.slug}/{label.generation}"
