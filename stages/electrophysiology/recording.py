"""Activation times: upward crossings of a threshold, collected while the solution advances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from stages.numerics.bsplines import Array

LONGEST_BLOCK = 5.0
"""ms; a point is taken to be activated at most once in a block (it stays refractory far longer)."""


def frame_blocks(steps: int, step: float) -> Iterator[int]:
    """Numbers of time steps, each block at most 5 ms, that add up to ``steps`` of length ``step``."""
    longest = max(int(LONGEST_BLOCK / step), 1)
    while steps:
        block = min(steps, longest)
        yield block
        steps -= block


class Crossings:
    """Events (point, time) of all points so far; memory grows with the number of beats only."""

    def __init__(self, points: int) -> None:
        self._now: Array = np.full(points, np.nan)
        self._points: list[Array] = []
        self._times: list[Array] = []

    def fresh(self) -> Array:
        """Array of shape ``(point,)`` for the crossings of the next block, filled with NaN."""
        self._now.fill(np.nan)
        return self._now

    def collect(self) -> None:
        """Keep the crossings of the block that just ran."""
        crossed = np.flatnonzero(~np.isnan(self._now))
        if crossed.size:
            self._points.append(crossed.astype(float))
            self._times.append(self._now[crossed])

    def arrays(self) -> dict[str, Array]:
        """Everything that a continuation needs."""
        return {
            "crossed_points": np.concatenate([*self._points, np.empty(0)]),
            "crossing_times": np.concatenate([*self._times, np.empty(0)]),
        }

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Go on from :meth:`arrays`."""
        self._points = [np.asarray(saved["crossed_points"])]
        self._times = [np.asarray(saved["crossing_times"])]

    def table(self) -> Array:
        """Activation times in ms, shape ``(point, beat)``; rows are filled up with NaN."""
        arrays = self.arrays()
        points = arrays["crossed_points"].astype(np.int64)
        order = np.argsort(points, kind="stable")  # events come in the order of time
        counts = np.bincount(points, minlength=self._now.size)
        starts = np.cumsum(counts) - counts
        beat = np.arange(points.size) - np.repeat(starts, counts)
        table = np.full((self._now.size, int(counts.max(initial=0))), np.nan)
        table[points[order], beat] = arrays["crossing_times"][order]
        return table
