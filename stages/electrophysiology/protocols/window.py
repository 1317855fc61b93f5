"""What becomes of a wave that is started across another one: nothing, a passage, or re-entry."""

from __future__ import annotations

import numpy as np

from stages.electrophysiology.monodomain import build
from stages.electrophysiology.protocols.branches import Stimuli, Trunk
from stages.electrophysiology.protocols.config import WindowConfig
from stages.electrophysiology.protocols.gauges import nearest_points
from stages.electrophysiology.tissue import Stepper, TissueState
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.paced_artefacts import NO_WAVE, PASSES, REENTRY

COLUMNS = ("outcome", "activated_share", "reactivated_share", "life_time")
"""What is measured in each case, in this order; activations at the probes follow."""


class CrossField:
    """A film under all its stimuli but the last, with room for the last at any time.

    Parameters
    ----------
    config
        Tissue and protocol.
    patch
        Surface of the film.
    """

    def __init__(self, config: WindowConfig, patch: Patch) -> None:
        self._tissue, self._least = config.tissue, config.protocol.least_share
        self._patch = patch
        self._probes = nearest_points(patch, list(config.protocol.probes.values()))
        *first, self._moved = config.tissue.stimuli
        self._trunk = Trunk(self._tissue, self._build, tuple(first))
        alone = self._trunk.branch(config.protocol.times[-1])
        alone.advance_to(alone.state.steps + self._tissue.n_steps)
        self._without = alone.beats()["activation_times"]

    def at(self, start: float) -> Array:
        """Outcome and measures of the last stimulus at a time (ms).

        Activations are counted from that time on, and those that the film would have had without the
        last stimulus are taken off, point by point. With f1 the share of points that are left with
        one activation or more, and f2 with two or more, the outcome is

        - re-entry where f2 >= ``least_share``: a wave has come back to much of the film,
        - a passage where only f1 >= ``least_share``,
        - nothing otherwise: the stimulus has excited its surroundings at most.

        The life time is that from the stimulus to the last of these activations.
        """
        run = self._trunk.branch(start, self._moved.model_copy(update={"start": start}))
        run.advance_to(run.state.steps + self._tissue.n_steps)
        end, times = run.state.steps * run.step, run.beats()["activation_times"]
        more = _counts(times, start, end) - _counts(self._without, start, end)
        activated, again = float((more >= 1).mean()), float((more >= 2).mean())
        outcome = NO_WAVE
        if again >= self._least:
            outcome = REENTRY
        elif activated >= self._least:
            outcome = PASSES
        added = times[more >= 1]
        last = float(np.nanmax(added)) - start if added.size else 0.0
        return np.array([outcome, activated, again, last, *more[self._probes]])

    def _build(self, stimuli: Stimuli) -> tuple[Stepper, TissueState]:
        return build(self._tissue.model_copy(update={"stimuli": stimuli}), self._patch)


def _counts(times: Array, start: float, end: float) -> Array:
    """Activations of each point between two times, shape ``(point,)``."""
    return np.asarray(((times >= start) & (times <= end)).sum(axis=1))
