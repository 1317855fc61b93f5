"""Pulses of a stimulus over time."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad

from stages.electrophysiology.stimuli.base import TOLERANCE, Stimulus
from stages.numerics.bsplines import Array
from stages.time_laws.base import TimeLaw


@dataclass(frozen=True)
class PulseTrain:
    """Factor on a stimulus over time.

    Attributes
    ----------
    starts
        Beginning of each pulse, increasing, ms.
    duration
        Length of a pulse, ms; pulses do not overlap.
    time_law
        Course over the time since the beginning of a pulse; none: 1.
    """

    starts: tuple[float, ...]
    duration: float
    time_law: TimeLaw | None = None

    def amplitude(self, times: Array) -> Array:
        """Factor at each time, as the published scheme reads it.

        A pulse is on for ``start < t <= start + duration``. Times are compared with a tolerance of 1e-9
        ms, so that ``n * step`` is on time in floating point too.
        """
        starts = np.array(self.starts)
        pulse = np.searchsorted(starts + TOLERANCE, times, side="left") - 1
        begun = starts[np.maximum(pulse, 0)]
        on = (pulse >= 0) & (times <= begun + self.duration + TOLERANCE)
        if self.time_law is None:
            return on.astype(float)
        factor = np.zeros(on.shape)
        factor[on] = [self.time_law.at(float(t)) for t in (times - begun)[on]]
        return factor

    def acts(self, t0: Array, t1: Array) -> NDArray[np.bool_]:
        """Whether a pulse is on at some time between each ``t0`` and ``t1``, with the same tolerance."""
        starts = np.array(self.starts)
        last = np.searchsorted(starts, np.asarray(t1) - TOLERANCE, side="left") - 1
        begun = starts[np.maximum(last, 0)]
        return np.asarray((last >= 0) & (begun + self.duration > t0 + TOLERANCE))

    def jumps(self, t0: Array, t1: Array) -> NDArray[np.bool_]:
        """Whether a pulse begins or ends between each ``t0`` and ``t1``, not at them, with the same tolerance."""
        starts = np.array(self.starts)
        switches = np.sort(np.concatenate((starts, starts + self.duration)))
        low = np.searchsorted(switches, np.asarray(t0) + TOLERANCE, side="right")
        return low < np.searchsorted(switches, np.asarray(t1) - TOLERANCE, side="left")

    def mean(self, t0: Array, t1: Array) -> Array:
        """Mean of the factor over each step from ``t0`` to ``t1``: for plain pulses the part of it that is on.

        Exact for plain pulses, and for time laws to the 1e-10 of an adaptive quadrature.
        """
        t0, t1 = np.asarray(t0, dtype=float), np.asarray(t1, dtype=float)
        total = np.zeros(t0.shape)
        first = bisect_right(self.starts, t0.min(initial=np.inf) - self.duration)
        last = bisect_left(self.starts, t1.max(initial=-np.inf))
        for start in self.starts[first:last]:
            begin, end = np.maximum(t0, start), np.minimum(t1, start + self.duration)
            begin = np.where(np.abs(begin - t0) <= TOLERANCE, t0, begin)
            end = np.where(np.abs(end - t1) <= TOLERANCE, t1, end)
            for i in np.flatnonzero(end - begin > TOLERANCE):
                total[i] += self._integral(begin[i], end[i], start)
        return total / (t1 - t0)

    def _integral(self, begin: float, end: float, start: float) -> float:
        if self.time_law is None:
            return end - begin
        low, high = max(begin - start, 0.0), min(end - start, self.duration)
        small = 1e-12 * (high - low)
        return float(
            quad(self.time_law.at, low, high, epsabs=small, epsrel=1e-10, full_output=1)[0]
        )


def train_of(stimulus: Stimulus) -> PulseTrain:
    """All pulses of a stimulus."""
    return PulseTrain(stimulus.starts, stimulus.duration, stimulus.time_law)
