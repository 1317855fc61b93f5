"""What a beat is like, depending on how long the tissue has rested: S1-S2 pacing."""

from __future__ import annotations

import math

import numpy as np

from stages.electrophysiology.monodomain import build
from stages.electrophysiology.protocols.branches import Stimuli, TissueRun, Trunk, sampled
from stages.electrophysiology.protocols.cells_alone import build_cell
from stages.electrophysiology.protocols.config import RestitutionConfig
from stages.electrophysiology.protocols.gauges import Gauge
from stages.electrophysiology.stimuli.base import TOLERANCE
from stages.electrophysiology.tissue import Stepper, TissueState
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch

COLUMNS = (
    "activation_time",
    "diastolic_interval",
    "apd50",
    "apd90",
    "peak_active_stress",
    "conduction_velocity",
)
"""What is measured in each case, in this order; the samples follow."""


class Pacing:
    """The preparation, paced by S1, with room for one S2.

    Parameters
    ----------
    config
        Tissue and protocol.
    patch
        Surface of the strip; none for a cell.
    """

    def __init__(self, config: RestitutionConfig, patch: Patch | None) -> None:
        self.tissue, self.protocol = config.tissue, config.protocol
        self._patch = patch
        self._gauge = Gauge.cell() if patch is None else Gauge.strip(patch, config.protocol.window)
        train = config.protocol.train
        self._last_start = train.starts[-1]
        self._trunk = Trunk(self.tissue, self._build, (train,))
        alone = self._trunk.branch(self._last_start)
        self.s1_samples = self._watched(alone)
        self.longest = self.tissue.duration + config.protocol.intervals[-1]
        alone.advance_to(alone.state.steps + round(config.protocol.intervals[-1] / alone.step))
        beats = alone.beats()
        self._counts = np.isfinite(beats["activation_times"]).sum(axis=1)
        here = slice(0, self._counts[self._gauge.point])
        self.s1_apd90 = beats["apd90"][self._gauge.point, here]
        self._repolarised = _last(beats["repolarisation_times"][self._gauge.point, here])

    def after(self, interval: float) -> Array:
        """Measures and samples of the beat that S2 makes so long after the last S1.

        The S2 of a point makes the first activation that the point would not have had without it. NaN
        where it makes none.
        """
        start = self._last_start + interval
        run = self._trunk.branch(start, self.protocol.pulse.model_copy(update={"start": start}))
        samples = self._watched(run)
        return self._measured(run, start, samples, self._counts, self._repolarised)

    def steady(self, period: float) -> Array:
        """Measures and samples of the last beat of a train S1 of another period."""
        changed = self.protocol.model_copy(update={"period": period})
        start = changed.train.starts[-1]
        run = TissueRun(self.tissue, self._build, (changed.train,))
        run.advance_to(int((start + TOLERANCE) / run.step))
        samples = self._watched(run)
        beats = run.beats()
        late = (beats["activation_times"] < start).sum(axis=1)
        before = beats["repolarisation_times"][self._gauge.point, : late[self._gauge.point]]
        return self._measured(run, start, samples, late, _last(before))

    @property
    def s1_is_over(self) -> bool:
        """Whether the last S1 beat has repolarised in the time of the longest case; no S2 counts before."""
        return math.isfinite(self._repolarised)

    @property
    def sample_times(self) -> Array:
        """Times of the samples since the stimulus, ms."""
        ends = self.tissue.frame_steps
        return np.array(ends) * self.tissue.step

    def _build(self, stimuli: Stimuli) -> tuple[Stepper, TissueState]:
        chosen = self.tissue.model_copy(update={"stimuli": stimuli})
        return build_cell(chosen) if self._patch is None else build(chosen, self._patch)

    def _watched(self, run: TissueRun) -> Array:
        """Potential and active stress at the gauge, shape ``(2, sample)``."""
        point, tissue = self._gauge.point, self.tissue
        return np.array(sampled(run, point, tissue.n_steps, tissue.steps_per_frame)).T

    def _measured(
        self, run: TissueRun, start: float, samples: Array, number: Array, repolarised: float
    ) -> Array:
        """One row: what ``COLUMNS`` say of the beat ``number`` of each point, and the samples.

        A stimulus that lifts a potential still on its way down through the threshold has made no beat: what
        counts begins after 90 % repolarisation of the beat before.
        """
        point, beats = self._gauge.point, run.beats()
        activation, apd50, apd90 = (
            _column(beats[name], number) for name in ("activation_times", "apd50", "apd90")
        )
        began = activation[point]
        if not began >= repolarised:
            return np.concatenate((np.full(len(COLUMNS), np.nan), *samples))
        values = [
            began - start,
            began - repolarised,
            apd50[point],
            apd90[point],
            peak_after(began - start, self.sample_times, samples[1]),
            speed(activation[self._gauge.line], self._gauge.distance),
        ]
        return np.concatenate((values, *samples))


def peak_after(begin: float, times: Array, stress: Array) -> float:
    """Largest active stress from a time on, kPa: that of the parabola through the highest sample."""
    if not np.isfinite(begin):
        return math.nan
    first = int(np.searchsorted(times, begin))
    if first >= times.size:
        return math.nan
    top = first + int(np.argmax(stress[first:]))
    if not first < top < times.size - 1:
        return float(stress[top])
    low, middle, high = stress[top - 1 : top + 2]
    bend = 0.5 * (low + high) - middle
    return float(middle - (0.25 * (high - low)) ** 2 / bend) if bend < 0.0 else float(middle)


def speed(arrivals: Array, distance: Array) -> float:
    """Speed of a wave that runs along a line, by least squares of its times, mm/ms; NaN if none does."""
    if arrivals.size < 2 or not (np.diff(arrivals) > 0).all():
        return math.nan
    return float(1.0 / np.polyfit(distance, arrivals, 1)[0])


def _column(table: Array, number: Array) -> Array:
    """Entry ``number`` of each row, NaN where the row is shorter."""
    filled = np.column_stack((table, np.full(len(table), np.nan)))
    return np.asarray(filled[np.arange(len(table)), np.minimum(number, table.shape[1])])


def _last(values: Array) -> float:
    return float(values[-1]) if values.size else math.nan
