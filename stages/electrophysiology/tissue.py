"""The tissue in time: its state, the numbers of the time loop, and what a stepper does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from stages.electrophysiology.events import UNWATCHED, Watch
from stages.electrophysiology.reaction import Cells, Reaction
from stages.electrophysiology.sources import Source
from stages.numerics.bsplines import Array


class UnstableSolutionError(ArithmeticError):
    """The solution grew beyond all bounds."""

    remedy = (
        "The explicit ionic current limits the time step: raise electrophysiology.n_steps, "
        "or check the strength of the stimuli."
    )

    def __init__(self, steps: int, time: float) -> None:
        self.place = f"step {steps}, t = {time:g} ms"
        super().__init__("the cells' state is no longer finite")


@dataclass
class TissueState:
    """State of all cells at one time level; arrays over collocation points, changed in place.

    ``potential`` in mV, ``states`` of the cell model with shape ``(variable, point)``, ``active_stress``
    in kPa, ``ionic`` and ``ionic_before`` I_ion/C_m at this and the previous level in mV/ms,
    ``diffusion`` the solver's own unknowns, ``steps`` the number of steps done.
    """

    potential: Array
    states: Array
    active_stress: Array
    ionic: Array
    ionic_before: Array
    diffusion: Array
    steps: int

    def cells(self) -> Cells:
        """The cells' arrays as the compiled loops take them."""
        return Cells(self.potential, self.states, self.active_stress, self.ionic)

    def arrays(self) -> dict[str, Any]:
        """Everything that a continuation needs."""
        return {name: np.copy(value) for name, value in vars(self).items()}

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Go on from :meth:`arrays`; other entries of ``saved`` are ignored."""
        for name in vars(self):
            setattr(self, name, np.array(saved[name]))
        self.steps = int(self.steps)

    def check_finite(self, step: float) -> None:
        """Stop as soon as a cell's state is no number any more.

        Raises
        ------
        UnstableSolutionError
            With the time at which it was noticed.
        """
        largest = np.finfo(np.float32).max  # frames are stored in single precision
        everything = (self.potential, self.states, self.active_stress)
        if not all((np.abs(values) <= largest).all() for values in everything):
            raise UnstableSolutionError(self.steps, self.steps * step)


@dataclass(frozen=True)
class Problem:
    """Data of the time loop.

    Time step in ms; C_m in nF/mm^2 and D in nF/ms; stimuli; the compiled loops over cells
    with the constants of the cell model and of the tension law.
    """

    step: float
    capacitance: float
    conductivity: float
    sources: tuple[Source, ...]
    reaction: Reaction
    constants: tuple[NamedTuple, NamedTuple]

    def amplitudes(self, first: int, steps: int) -> Array:
        """Amplitude of each stimulus at levels first .. first + steps, shape ``(steps + 1, stimulus)``."""
        times = np.arange(first, first + steps + 1, dtype=float) * self.step
        columns = [source.amplitude(times) for source in self.sources]
        return np.stack(columns, axis=1) if columns else np.zeros((steps + 1, 0))

    def means(self, first: int, steps: int) -> Array:
        """Mean of each stimulus' factor over each of the steps after ``first``, ``(steps, stimulus)``."""
        times = np.arange(first, first + steps + 1, dtype=float) * self.step
        columns = [source.mean(times[:-1], times[1:]) for source in self.sources]
        return np.stack(columns, axis=1) if columns else np.zeros((steps, 0))

    @property
    def diffusivity(self) -> float:
        """D/C_m, mm^2/ms."""
        return self.conductivity / self.capacitance

    def applied(self, inside: Array) -> Array:
        """I_app/C_m of each stimulus at interior points, mV/ms, shape ``(stimulus, point)``.

        ``inside`` is 1 at interior points and 0 on the boundary, shape ``(point,)``.
        """
        rows = [inside * source.interior / self.capacitance for source in self.sources]
        return np.array(rows).reshape(len(rows), inside.size)


class Stepper(Protocol):
    """One way to take time steps; both ways give the same potentials up to round-off."""

    def diffusion_state(self, potential: Array) -> Array:
        """Solver unknowns that represent a potential given at the points, with no flux."""

    def advance(self, state: TissueState, steps: int, beats: Watch = UNWATCHED) -> None:
        """Take ``steps`` steps in place, and let ``beats`` note what happens in each of them."""
