"""In-memory twin of a run: for tests, notebooks and the plain use of a stage's function."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pipeline.running.frames import FrameShapes

R = TypeVar("R")


class MemoryHistory(Generic[R]):
    """A history held in arrays; stored types apply, so values equal those of a stored run."""

    def __init__(self, frames: FrameShapes[R]) -> None:
        self._frames = frames
        self._fields: dict[str, NDArray[Any]] = {}
        self.frames_done = 0

    def append(self, **fields: ArrayLike) -> None:
        """Add one frame of every streamed field."""
        for name, value in self._frames.checked(fields, self.frames_done).items():
            if name not in self._fields:
                shape = (self._frames.count, *value.shape)
                self._fields[name] = np.zeros(shape, value.dtype)
            self._fields[name][self.frames_done] = value
        self.frames_done += 1

    def finish(self, **fields: Any) -> R:
        """The record, from the streamed frames and the remaining fields."""
        self._frames.check_finished(self.frames_done, fields)
        for name, shape in self._frames.shapes.items():
            self._fields.setdefault(name, np.zeros((0, *shape), self._frames.dtype(name)))
        streamed = {name: values[: self.frames_done] for name, values in self._fields.items()}
        return self._frames.record(**streamed, **fields)


class MemoryRun:
    """A run without a store: it keeps what the stage reports, and can be stopped and resumed.

    Parameters
    ----------
    stop_after
        Raise :class:`Stopped` at the checkpoint that follows this number of frames; a second run of
        the stage on the same object then resumes from there.

    Attributes
    ----------
    warnings, notes, steps, lines
        What the stage reported.
    """

    def __init__(self, *, stop_after: int | None = None) -> None:
        self.warnings: list[str] = []
        self.notes: dict[str, Any] = {}
        self.steps: list[tuple[int, int]] = []
        self.lines: list[str] = []
        self._stop_after = stop_after
        self._state: dict[str, NDArray[Any]] | None = None
        self._histories: dict[type, MemoryHistory[Any]] = {}

    def stream(
        self,
        record: type[R],
        *,
        frames: int,
        shapes: Mapping[str, tuple[int, ...]],
        fewer: bool = False,
    ) -> MemoryHistory[R]:
        """Begin a history, or continue the one that was stopped."""
        if self._state is None or record not in self._histories:
            self._histories[record] = MemoryHistory(FrameShapes(record, frames, shapes, fewer))
        return self._histories[record]

    def resume(self) -> dict[str, NDArray[Any]] | None:
        """Copy of the state saved when the run was stopped."""
        return None if self._state is None else {k: v.copy() for k, v in self._state.items()}

    def checkpoint(self, state: Callable[[], Mapping[str, ArrayLike | np.generic]]) -> None:
        """Save the state and stop, if ``stop_after`` frames are there."""
        done = max((history.frames_done for history in self._histories.values()), default=0)
        if self._stop_after is not None and done >= self._stop_after:
            self._stop_after = None
            self._state = {name: np.array(value) for name, value in state().items()}
            raise Stopped

    def progress(self, done: int, total: int) -> None:
        """Remember a report of progress."""
        self.steps.append((done, total))

    def warn(self, message: str) -> None:
        """Remember a warning."""
        self.warnings.append(message)

    def tell(self, message: str) -> None:
        """Remember a line."""
        self.lines.append(message)

    def note(self, name: str, value: Any) -> None:
        """Remember a note."""
        self.notes[name] = value


class Stopped(Exception):  # noqa: N818 - no error: the test asked for it
    """Raised by :class:`MemoryRun` where it was asked to stop."""
