"""Cells without neighbours: dv/dt = (I_app - I_ion)/C_m, by Runge-Kutta 4 with states and stress (eq. 10)."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.events import UNWATCHED, Watch, watch
from stages.electrophysiology.guard import any_bad
from stages.electrophysiology.monodomain import rest
from stages.electrophysiology.pulse_train import PulseTrain, train_of
from stages.electrophysiology.reaction import compile_reaction
from stages.electrophysiology.stimuli.uniform_current import UniformCurrent
from stages.electrophysiology.tissue import TissueState, count_steps
from stages.numerics.bsplines import Array
from stages.numerics.compiled import kernel


def build_cell(config: ElectrophysiologyConfig) -> tuple[CellStepper, TissueState]:
    """Stepper of one cell under the stimuli of ``config``, and its resting state.

    Raises
    ------
    ValueError
        If a stimulus is none that a cell can take.
    """
    stepper = CellStepper(config)
    return stepper, rest(config, stepper, 1)


class CellStepper:
    """Steps of one cell: of fourth order where pulses begin and end with a step.

    A pulse acts with its mean over each step, so that its charge is right in any case.
    """

    def __init__(self, config: ElectrophysiologyConfig) -> None:
        self._step = config.step
        self._sources: list[tuple[float, PulseTrain]] = []
        for stimulus in config.stimuli:
            if not isinstance(stimulus, UniformCurrent):
                raise ValueError(f"a cell takes a uniform-current, not {stimulus.kind}")
            strength = stimulus.current / config.membrane_capacitance
            self._sources.append((strength, train_of(stimulus)))
        reaction = compile_reaction(config.cell_model, config.tension_law)
        self._block = _compile(reaction.react)
        self._constants = (config.cell_model.constants(), config.tension_law.constants())

    def diffusion_state(self, potential: Array) -> Array:
        """Nothing: no current flows to neighbours."""
        return np.empty(0)

    def advance(self, state: TissueState, steps: int, beats: Watch = UNWATCHED) -> None:
        """Take ``steps`` steps in place, and let ``beats`` note what happens in each of them."""
        times = self._step * np.arange(state.steps, state.steps + steps + 1, dtype=float)
        applied = np.zeros((steps, state.potential.size))
        for strength, pulses in self._sources:
            applied += strength * pulses.mean(times[:-1], times[1:])[:, None]
        good = self._block(state.cells(), beats, applied, state.steps, self._step, *self._constants)
        count_steps(state, good, steps, self._step, None)


@functools.cache
def _compile(react: Callable[..., None]) -> Callable[..., int]:
    @kernel
    def block(
        cells: Any, beats: Any, applied: Any, first: int, step: float, cell: Any, tension: Any
    ) -> int:
        for k in range(applied.shape[0]):
            react(cells, applied[k], step, 1, cell, tension)
            if any_bad(cells):
                return k
            watch(beats, cells.potential, (first + k) * step, step)
        return len(applied)

    return block
