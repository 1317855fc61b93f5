"""Beats of all points, collected while the solution advances, and put into tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from stages.electrophysiology.events import watch_of
from stages.numerics.bsplines import Array

LOG_ROWS = 2**18
"""Finished beats that one block of steps may log; memory is taken only for those that come."""

WATCHED = ("high", "low", "started", "half", "full", "top", "awaited", "levels", "counts")


class BeatRecorder:
    """All beats so far; memory grows with their number only.

    Parameters
    ----------
    potential
        Potential at the start, mV, shape ``(point,)``.
    threshold
        Potential that begins a beat, mV.
    rest
        Potential to which the tissue returns, mV.
    log_rows
        Room for finished beats; a block of steps ends before it can be filled.
    """

    def __init__(
        self, potential: Array, threshold: float, rest: float, log_rows: int = LOG_ROWS
    ) -> None:
        self._room = max(log_rows // potential.size, 1)
        self.watch = watch_of(potential, threshold, rest, self._room * potential.size)
        self._finished: list[Array] = []

    def blocks(self, steps: int) -> Iterator[int]:
        """Numbers of time steps that add up to ``steps``, none long enough to fill the log.

        A beat needs two steps at least: one below the threshold and one above. So a point finishes
        one beat at most in every two steps, and the first of them in the first step.
        """
        longest = 2 * self._room
        while steps:
            block = min(steps, longest)
            yield block
            self._collect()
            steps -= block

    def _collect(self) -> None:
        """Keep the beats that ended in the block that just ran."""
        count = int(self.watch.counts[0])
        if count > len(self.watch.log):
            raise RuntimeError(f"{count} beats ended in a block of steps with room for fewer")
        if count:
            self._finished.append(self.watch.log[:count].copy())
            self.watch.counts[0] = 0

    def arrays(self) -> dict[str, Array]:
        """Everything that a continuation needs."""
        watched = {f"watched_{name}": getattr(self.watch, name).copy() for name in WATCHED}
        return {**watched, "finished_beats": np.concatenate([np.empty((0, 5)), *self._finished])}

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Go on from :meth:`arrays`; other entries of ``saved`` are ignored."""
        for name in WATCHED:
            getattr(self.watch, name)[:] = saved[f"watched_{name}"]
        self._finished = [np.asarray(saved["finished_beats"])]

    def tables(self) -> dict[str, Array]:
        """Maps of shape ``(point, beat)``, filled up with NaN, under their names in the history."""
        w = self.watch
        under_way = np.flatnonzero(np.isfinite(w.started))
        peak = np.where(w.low == np.inf, w.high, w.top)  # the highest so far, where it still rises
        columns = (under_way, *(field[under_way] for field in (w.started, w.half, w.full, peak)))
        beats = np.concatenate([*self._finished, np.column_stack(columns)])
        points = beats[:, 0].astype(np.int64)
        order = np.argsort(points, kind="stable")  # beats of a point come in the order of time
        counts = np.bincount(points, minlength=w.started.size)
        starts = np.cumsum(counts) - counts
        beat = np.arange(points.size) - np.repeat(starts, counts)

        def table(values: Array) -> Array:
            rows = np.full((w.started.size, int(counts.max(initial=0))), np.nan)
            rows[points[order], beat] = values[order]
            return rows

        _, started, half, full, peak = beats.T
        return {
            "activation_times": table(started),
            "repolarisation_times": table(full),
            "apd50": table(half - started),
            "apd90": table(full - started),
            "peak_potential": table(peak),
        }
