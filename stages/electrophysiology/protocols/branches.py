"""Runs that branch off a common one: everything up to a stimulus is computed once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.recording import BeatRecorder
from stages.electrophysiology.stimuli.base import TOLERANCE, Stimulus
from stages.electrophysiology.tissue import Stepper, TissueState
from stages.numerics.bsplines import Array

Stimuli: TypeAlias = tuple[Stimulus, ...]
Build: TypeAlias = Callable[[Stimuli], tuple[Stepper, TissueState]]
"""Stepper of the tissue under some stimuli, and its state at rest."""


class TissueRun:
    """Tissue that is stepped and watched.

    Parameters
    ----------
    config
        Time step, threshold and resting potential; its stimuli are not looked at.
    build
        Makes the tissue.
    stimuli
        What is applied.
    """

    def __init__(self, config: ElectrophysiologyConfig, build: Build, stimuli: Stimuli) -> None:
        self.step = config.step
        self.stepper, self.state = build(stimuli)
        self._beats = BeatRecorder(
            self.state.potential, config.activation_threshold, config.initial_potential
        )

    def advance_to(self, step: int) -> None:
        """Go on until so many steps are done.

        Raises
        ------
        UnstableSolutionError
            If the solution grows beyond all bounds.
        """
        for steps in self._beats.blocks(step - self.state.steps):
            self.stepper.advance(self.state, steps, self._beats.watch)

    def beats(self) -> dict[str, Array]:
        """Maps of shape ``(point, beat)`` under their names in an ``ActivationHistory``."""
        return self._beats.tables()

    def arrays(self) -> dict[str, Any]:
        """Everything that a continuation needs."""
        return {**self.state.arrays(), **self._beats.arrays()}

    def restore(self, saved: dict[str, Any]) -> None:
        """Go on from :meth:`arrays` of a run of the same tissue, under whatever stimuli."""
        self.state.restore(saved)
        self._beats.restore(saved)


class Trunk:
    """A run whose states are kept where others have branched off."""

    def __init__(self, config: ElectrophysiologyConfig, build: Build, stimuli: Stimuli) -> None:
        self._config, self._build, self._stimuli = config, build, stimuli
        self._run = TissueRun(config, build, stimuli)
        self._known = {0: self._run.arrays()}

    def branch(self, start: float, *further: Stimulus) -> TissueRun:
        """The run at the time level at or before ``start`` (ms), under further stimuli from then on.

        It goes on bit for bit as if it had begun at rest.
        """
        made = TissueRun(self._config, self._build, (*self._stimuli, *further))
        made.restore(self._state_at(int((start + TOLERANCE) / self._config.step)))
        return made

    def _state_at(self, step: int) -> dict[str, Any]:
        if step not in self._known:
            before = max(known for known in self._known if known < step)
            if not before <= self._run.state.steps <= step:
                self._run.restore(self._known[before])
            self._run.advance_to(step)
            self._known[step] = self._run.arrays()
        return self._known[step]


def sampled(run: TissueRun, point: int, steps: int, every: int) -> Sequence[tuple[float, float]]:
    """Potential (mV) and active stress (kPa) at a point, now and after every so many steps.

    The last interval is shorter where ``every`` does not divide ``steps``.
    """
    first, state = run.state.steps, run.state
    samples = [(float(state.potential[point]), float(state.active_stress[point]))]
    for done in (*range(every, steps, every), steps):
        run.advance_to(first + done)
        samples.append((float(state.potential[point]), float(state.active_stress[point])))
    return samples
