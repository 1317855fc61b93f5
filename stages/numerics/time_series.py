"""Fields stored frame by frame: read in blocks, linear in time between two frames.

A frame alone would cost its whole chunk of storage, so frames are read by blocks, and a history is
never held whole.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Any, Protocol

import numpy as np

from stages.numerics.bsplines import Array

BLOCK = 64
"""Frames read at once where the array does not say how it is chunked."""

SLACK = 1e-9
"""Difference that rounding may make between two equal times, relative to the longest time."""


class StoredFrames(Protocol):
    """An array, in memory or stored, whose first axis is time; it may have ``chunks``."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Frames first."""
        ...

    def __getitem__(self, part: slice, /) -> Any:
        """Successive frames."""
        ...


class TimesNotCoveredError(ValueError):
    """A field is wanted at times for which it is not known; nothing is extrapolated.

    Attributes
    ----------
    wanted, given
        First and last time asked for and known, ms.
    remedy
        What to try.

    Examples
    --------
    >>> print(TimesNotCoveredError((0.0, 20.0), (0.0, 10.0)))
    the field is needed from 0 to 20 ms, but it is known from 0 to 10 ms only
    """

    def __init__(
        self,
        wanted: tuple[float, float],
        given: tuple[float, float],
        *,
        name: str = "the field",
        known: str = "it is known",
        remedy: str = "ask for times that it covers",
    ) -> None:
        self.wanted = wanted
        self.given = given
        self.remedy = remedy
        super().__init__(
            f"{name} is needed {_span(wanted)}, but {known} from {given[0]:g} to {given[1]:g} ms only"
        )


def blocks(frames: StoredFrames) -> Iterator[tuple[slice, Array]]:
    """Successive blocks of frames, read one at a time, in double precision."""
    length = _block_length(frames)
    for start in range(0, frames.shape[0], length):
        block = slice(start, min(start + length, frames.shape[0]))
        yield block, np.asarray(frames[block], dtype=float)


class FrameReader:
    """Single frames by number, in double precision, read by whole blocks.

    Two blocks are kept: numbers that grow, or pairs of neighbours that do, read each block once.
    """

    def __init__(self, frames: StoredFrames) -> None:
        length = self._length = _block_length(frames)

        @lru_cache(maxsize=2)
        def block(number: int) -> Array:
            part = slice(number * length, (number + 1) * length)
            return np.asarray(frames[part], dtype=float)

        self._block = block

    def __call__(self, index: int) -> Array:
        """Frame ``index``, counted from 0."""
        number, offset = divmod(index, self._length)
        return np.asarray(self._block(number)[offset])


class TimeSeries:
    """A field at any time that its frames cover, linear between the two frames around it.

    Parameters
    ----------
    frames
        Array or stored array, shape ``(time, ...)``.
    times
        Increasing times of the frames, ms.
    name, known, remedy
        How an error calls the field, who knows it until when, and what to try.

    Examples
    --------
    >>> series = TimeSeries(np.array([[0.0], [10.0], [40.0]]), np.array([0.0, 1.0, 2.0]))
    >>> series.at(0.25).tolist(), series.at(2.0).tolist()
    ([2.5], [40.0])
    """

    def __init__(self, frames: StoredFrames, times: Array, **words: str) -> None:
        self._frame = FrameReader(frames)
        self._times = np.asarray(times, dtype=float)
        self._slack = SLACK * float(np.abs(self._times).max())
        self._words = words

    def check_covers(self, wanted: Array | float) -> None:
        """Refuse times before the first or after the last frame by more than round-off.

        Raises
        ------
        TimesNotCoveredError
            With the range wanted and the range given.
        """
        low, high = float(np.min(wanted)), float(np.max(wanted))
        first, last = float(self._times[0]), float(self._times[-1])
        if not first - self._slack <= low <= high <= last + self._slack:
            raise TimesNotCoveredError((low, high), (first, last), **self._words)

    def at(self, time: float) -> Array:
        """Field at a time, ms; at a frame's own time, that frame exactly.

        Raises
        ------
        TimesNotCoveredError
            If the frames do not cover it.
        """
        self.check_covers(time)
        times = self._times
        after = min(int(np.searchsorted(times, time - self._slack)), times.size - 1)
        if abs(times[after] - time) <= self._slack:
            return self._frame(after)
        weight = (time - times[after - 1]) / (times[after] - times[after - 1])
        return (1.0 - weight) * self._frame(after - 1) + weight * self._frame(after)


def _block_length(frames: StoredFrames) -> int:
    chunks: tuple[int, ...] | None = getattr(frames, "chunks", None)
    return chunks[0] if chunks else BLOCK


def _span(times: tuple[float, float]) -> str:
    first, last = times
    return f"at {first:g} ms" if first == last else f"from {first:g} to {last:g} ms"
