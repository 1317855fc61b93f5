"""The runs of a remote store, and which artefacts each of them uses.

Layout, all below ``runs/<slug of the name>/<generation>/``::

    label                  written when a run begins
    alive                  written again at an interval, as long as its process lives
    refs/<stage>/<key>     an empty object for each artefact that one of its processes asked for
    done                   it ended well

Objects cannot be appended to, so each artefact has one of its own; no process reads what others wrote.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field

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
        for run in [] if keep_earlier else list(self._runs_below(f"runs/{label.slug}")):
            if run.label.generation < label.generation and not run.alive:
                self.forget(run.label)

    def runs(self) -> Iterator[RegisteredRun]:
        """All runs, in no particular order."""
        return self._runs_below("runs")

    def refs(self, label: RunLabel) -> Iterator[Ref]:
        """What a run has registered so far."""
        for path in self.objects.listing(f"{_folder(label)}/refs"):
            yield Ref(*path.split("/")[-2:])

    def forget(self, label: RunLabel) -> None:
        """Remove all that is known of one run; the label last, without it nobody could tell whose."""
        folder = _folder(label)
        named = f"{folder}/label"
        self.objects.remove([p for p in self.objects.listing(folder) if p != named])
        self.objects.remove([named])

    def _runs_below(self, folder: str) -> Iterator[RegisteredRun]:
        found: dict[str, dict[str, Entry]] = {}
        for path, entry in self.objects.listing(folder).items():
            parts = path.split("/")
            if len(parts) == 4:
                found.setdefault("/".join(parts[:3]), {})[parts[3]] = entry
        labels = self.objects.read_many(f"{run}/label" for run in found if "label" in found[run])
        for path, contents in labels.items():
            entries = found[path.rpartition("/")[0]]
            try:
                label = from_json(json.loads(contents))
            except ValueError:
                continue
            done, sign = entries.get("done"), entries.get("alive")
            alive = (
                done is None
                and sign is not None
                and self.clock.now() - sign.modified <= self.seconds
            )
            yield RegisteredRun(label, None if done is None else done.modified, alive)


def _folder(label: RunLabel) -> str:
    return f"runs/{label.slug}/{label.generation}"
