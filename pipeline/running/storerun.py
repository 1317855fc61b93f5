"""The run of a stage whose result goes to a store."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pipeline.codecs import part_path
from pipeline.durable import storing, sync_tree
from pipeline.errors import StoreError
from pipeline.events import Event, Listener, StageProgress, StageTold, StageWarned
from pipeline.fingerprint import Fingerprint
from pipeline.fingerprint.freshness import check_loaded
from pipeline.records import parts_of, stored_as
from pipeline.running.checkpoints import Checkpoint, ChunkFiles, UnusableCheckpoint, keep_only
from pipeline.running.frames import FrameShapes
from pipeline.running.interrupts import Interrupts
from pipeline.running.streams import StoredHistory
from pipeline.store import Workspace

R = TypeVar("R")

PROGRESS_INTERVAL = 0.1
"""Seconds between two progress events; more often than the eye can follow is waste."""


class StoreRun:
    """A run that streams into a workspace, saves checkpoints, and emits events.

    Parameters
    ----------
    node, stage, key, code
        What runs.
    record
        Record class of the result.
    work
        Where it is written.
    listen
        Receives the events.
    checkpoint_interval
        Seconds between two checkpoints.
    """

    def __init__(
        self,
        node: str,
        stage: str,
        key: str,
        code: Fingerprint,
        record: type,
        work: Workspace,
        listen: Listener,
        checkpoint_interval: float,
    ) -> None:
        self.node, self.stage, self.key, self.code, self.work = node, stage, key, code, work
        self.interrupts = Interrupts()
        self.histories: dict[str, StoredHistory[Any]] = {}
        self.warnings: list[str] = []
        self.notes: dict[str, Any] = {}
        self.step: tuple[int, int] | None = None
        self._record = record
        self._chunks = ChunkFiles(work.data)
        self._listen = listen
        self._interval = checkpoint_interval
        self._started, self._cpu_started = time.perf_counter(), time.process_time()
        self._saved_at, self._told_at = self._started, float("-inf")
        self._from = self._last_checkpoint()
        work.begin(resume=self._from is not None)
        if self._from is not None:
            self.warnings.extend(w for w in self._from.warnings if w not in self.warnings)
            self.notes.update(self._from.notes)
            with storing(work.data):
                keep_only(work.data, self._from.files)

    @property
    def resumed_frames(self) -> int | None:
        """Frames of the checkpoint that the run goes on from, ``None`` at a fresh start."""
        if self._from is None:
            return None
        return max((s.frames_done for s in self._from.streams.values()), default=0)

    @property
    def seconds(self) -> float:
        """Time spent so far, that of interrupted runs up to their last checkpoint included."""
        before = self._from.seconds if self._from else 0.0
        return before + time.perf_counter() - self._started

    @property
    def cpu_seconds(self) -> float:
        """Processor time spent so far, likewise."""
        before = self._from.cpu_seconds if self._from else 0.0
        return before + time.process_time() - self._cpu_started

    def stream(
        self,
        record: type[R],
        *,
        frames: int,
        shapes: Mapping[str, tuple[int, ...]],
        fewer: bool = False,
    ) -> StoredHistory[R]:
        """Begin a history of the result or of one of its parts, or continue it.

        Raises
        ------
        ValueError
            If the record class is not kept as zarr, or is not that of exactly one part.
        """
        parts = [part for part, cls in parts_of(self._record).items() if cls is record]
        if len(parts) != 1 or parts[0] in self.histories:
            raise ValueError(
                f"{record.__name__} cannot be streamed: a result of stage {self.stage} holds "
                f"{len(parts)} of it, and each is streamed once"
            )
        if stored_as(record) != "zarr":
            raise ValueError(f"{record.__name__} cannot be streamed: it is not kept as zarr")
        saved = self._from.streams.get(parts[0]) if self._from else None
        path = part_path(self.work.data, parts[0], record)
        history = StoredHistory(path, FrameShapes(record, frames, shapes, fewer), saved)
        self.histories[parts[0]] = history
        return history

    def resume(self) -> dict[str, NDArray[Any]] | None:
        """State last saved, or ``None`` at a fresh start."""
        return None if self._from is None else dict(self._from.state)

    def checkpoint(self, state: Callable[[], Mapping[str, ArrayLike | np.generic]]) -> None:
        """Save the state if the interval has passed, or if the user wants to stop.

        Raises
        ------
        Stopped
            After saving, if a signal to stop came since the last call.
        """
        now = time.perf_counter()
        if self.interrupts.requested or now - self._saved_at >= self._interval:
            self._save({name: np.asarray(value) for name, value in state().items()})
            self._saved_at = time.perf_counter()
            self.interrupts.check()  # never where nothing was saved: the next call does that
        self.interrupts.deferrable = True

    def progress(self, done: int, total: int) -> None:
        """Emit an event, at most ten times a second."""
        self.step = (done, total)
        now = time.perf_counter()
        if now - self._told_at >= PROGRESS_INTERVAL or done == total:
            self._told_at = now
            self.emit(StageProgress(self.node, self.stage, done, total, now - self._started))

    def warn(self, message: str) -> None:
        """Emit a warning and keep it for the manifest."""
        if message not in self.warnings:
            self.warnings.append(message)
        self.emit(StageWarned(self.node, self.stage, message))

    def tell(self, message: str) -> None:
        """Emit a line about what goes on."""
        self.emit(StageTold(self.node, self.stage, message))

    def note(self, name: str, value: Any) -> None:
        """Keep a JSON value for the manifest.

        Raises
        ------
        TypeError
            If the value is not one.
        """
        self.notes[name] = json.loads(json.dumps(value, default=_plain))

    def emit(self, event: Event) -> None:
        """Tell the listener."""
        try:
            self._listen(event)
        except OSError:
            if not self.interrupts.requested:
                raise  # otherwise the terminal may be gone, and the work is still to be saved

    def _save(self, state: Mapping[str, NDArray[Any]]) -> None:
        check_loaded(self.stage, self.code)  # the checkpoint is one of this code
        with storing(self.work.data):
            sync_tree(self.work.data)  # the chunks must be on the disk before the state says so
        Checkpoint(
            key=self.key,
            state=state,
            streams={part: history.saved() for part, history in self.histories.items()},
            files=self._chunks.digests(),
            seconds=self.seconds,
            cpu_seconds=self.cpu_seconds,
            warnings=tuple(self.warnings),
            notes=self.notes,
        ).save(self.work.checkpoint)
        try:
            self.work.saved(last=self.interrupts.requested is not None)
        except StoreError as error:
            told = f"the checkpoint is kept on this machine only: {error.cause}"
            self.emit(StageWarned(self.node, self.stage, told))

    def _last_checkpoint(self) -> Checkpoint | None:
        try:
            return Checkpoint.load(self.work.checkpoint, self.key, self.work.data)
        except UnusableCheckpoint as reason:
            self.warn(f"the checkpoint of an interrupted run is discarded: {reason}")
            return None


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"a note cannot hold a {type(value).__name__}")
