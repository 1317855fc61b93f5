"""Copies of checkpoints on the server, so that a machine that is lost costs a bounded part of the work."""

from __future__ import annotations

import contextlib
import json
import os
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pipeline.durable import remove_tree, storing
from pipeline.store.remote.objects import Objects

SECONDS = 120.0
"""Seconds of work between two copies: what a lost machine costs at most, besides the lease's time."""

SHARE = 20
"""Copies take at most this part of the time: on a slow network there are fewer."""


@dataclass(frozen=True)
class Copy:
    """A copy of a checkpoint.

    Attributes
    ----------
    attempt
        Whose it was.
    state
        Its state, on this machine.
    files
        Chunks that belong to it.
    reached
        How far it got.
    """

    attempt: str
    state: Path
    files: tuple[str, ...]
    reached: tuple[int, float]


@dataclass
class Mirror:
    """Copies of the checkpoints of one attempt.

    Chunks of a history that are written are never changed, so each is copied once. The state goes
    last: chunks that it needs are there before.

    Attributes
    ----------
    objects
        Where the copies go.
    key, attempt
        Whose they are.
    data, checkpoint
        What is copied.
    seconds
        Time between two copies.
    """

    objects: Objects
    key: str
    attempt: str
    data: Path
    checkpoint: Path
    seconds: float
    _copied: dict[str, str] = field(default_factory=dict)
    _next: float = 0.0

    def __post_init__(self) -> None:
        self._next = time.monotonic() + self.seconds

    def copy(self, *, last: bool) -> None:
        """Copy the present checkpoint, if it is time or no other will follow.

        Raises
        ------
        StoreError
            If it could not be copied; the earlier copy stands.
        """
        began = time.monotonic()
        if not last and began < self._next:
            return
        self._next = began + self.seconds
        with storing(self.checkpoint):
            state = self.checkpoint.read_bytes()
            needed = _about(self.checkpoint)["files"]
        new = {path: sha for path, sha in needed.items() if self._copied.get(path) != sha}
        prefix = self._prefix(self.attempt)
        self.objects.upload({f"{prefix}/data/{path}": self.data / path for path in new})
        self._copied.update(new)
        self.objects.write({f"{prefix}/state.npz": state})
        took = time.monotonic() - began
        self._next = max(self._next, time.monotonic() + SHARE * took)

    def state(self) -> Path | None:
        """File with the state of the copy that got furthest, to be looked at; ``None`` if there is none."""
        with self._furthest() as copy:
            if copy is None:
                return None
            kept = self.checkpoint.parents[2] / "looked-at" / f"{self.key}.npz"
            kept.parent.mkdir(parents=True, exist_ok=True)
            os.replace(copy.state, kept)
            return kept

    def restore(self) -> None:
        """Fetch the copy that got furthest, unless the checkpoint on this machine got further."""
        with self._furthest() as copy:
            if copy is None:
                return
            here = _about(self.checkpoint) if self.checkpoint.exists() else None
            if here is not None and _reached(here) >= copy.reached:
                return
            source = f"{self._prefix(copy.attempt)}/data"
            self.objects.download({f"{source}/{p}": self.data / p for p in copy.files})
            self.checkpoint.parent.mkdir(parents=True, exist_ok=True)
            os.replace(copy.state, self.checkpoint)

    def remove(self) -> None:
        """Remove all copies of the key."""
        self.objects.remove(self.objects.listing(f"checkpoints/{self.key}"))

    @contextlib.contextmanager
    def _furthest(self) -> Iterator[Copy | None]:
        """The copy that got furthest; the file with its state is removed after the block."""
        scratch = self.checkpoint.parents[2] / "new" / self.attempt
        best: Copy | None = None
        try:
            for attempt, files in self._copies().items():
                state = scratch / f"{attempt}.npz"
                self.objects.download({f"{self._prefix(attempt)}/state.npz": state})
                about = _about(state)
                copy = Copy(attempt, state, tuple(about["files"]), _reached(about))
                whole = {f"data/{path}" for path in copy.files} <= files
                if whole and (best is None or copy.reached > best.reached):
                    best = copy
            yield best
        finally:
            remove_tree(scratch)

    def _copies(self) -> dict[str, set[str]]:
        """Files of each attempt whose state is there; their checksums are compared on resuming."""
        found: dict[str, set[str]] = {}
        for path in self.objects.listing(f"checkpoints/{self.key}"):
            attempt, _, rest = path.split("/", 2)[2].partition("/")
            found.setdefault(attempt, set()).add(rest)
        return {attempt: files for attempt, files in found.items() if "state.npz" in files}

    def _prefix(self, attempt: str) -> str:
        return f"checkpoints/{self.key}/{attempt}"


def _about(path: Path) -> dict[str, Any]:
    """What a checkpoint says of itself; one that cannot be read got nowhere."""
    import zipfile

    import numpy as np

    try:
        with np.load(path, allow_pickle=False) as kept:
            about: dict[str, Any] = json.loads(kept["about"].tobytes())
        about["files"], about["streams"], about["seconds"]
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile):
        return {"files": {}, "streams": {}, "seconds": -1.0}
    return about


def _reached(about: Mapping[str, Any]) -> tuple[int, float]:
    """How far a checkpoint got: frames, and seconds of work where there are none."""
    return max(about["streams"].values(), default=0), float(about["seconds"])
