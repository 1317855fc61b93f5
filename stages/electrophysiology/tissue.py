"""The tissue in time: its state, the numbers of the time loop, and what a stepper does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from stages.electrophysiology.events import UNWATCHED, Watch
from stages.electrophysiology.guard import first_bad
from stages.electrophysiology.limits import Decay
from stages.electrophysiology.reaction import Cells, Reaction
from stages.electrophysiology.sources import Source
from stages.numerics.bsplines import Array


class UnstableSolutionError(ArithmeticError):
    """The state of a cell is no finite number any more.

    Parameters
    ----------
    steps, step
        Number of the step in which it happened, and its length in ms.
    position
        X, Y, Z of the first such point, mm; None: a cell without a place.
    saved
        Steps done at the last checkpoint; None: there is none.
    """

    remedy = (
        "Shorten the step (raise electrophysiology.n_steps), take the scheme strang, refine the mesh, or "
        "check the strength of the stimuli."
    )

    def __init__(
        self, steps: int, step: float, position: Array | None, saved: int | None = None
    ) -> None:
        self.steps, self.step, self.position = steps, step, position
        self.place = f"step {steps}, t = {steps * step:g} ms"
        if position is not None:
            x, y, z = (f"{c:.4g}" for c in position)
            self.place += f", X = {x}, Y = {y}, Z = {z} mm"
        last = (
            "there is no checkpoint before"
            if saved is None
            else f"the last checkpoint is of t = {saved * step:g} ms"
        )
        super().__init__(f"the cell's state is no longer finite; {last}")

    def after(self, saved: int | None) -> UnstableSolutionError:
        """The same with what is known of checkpoints."""
        return UnstableSolutionError(self.steps, self.step, self.position, saved)


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


@dataclass(frozen=True)
class Problem:
    """Data of the time loop.

    Time step in ms; C_m in nF/mm^2 and D in nF/ms; stimuli; the compiled loops over cells
    with the constants of the cell model and of the tension law; the fastest decays in a cell in 1/ms;
    the points in mm, shape ``(point, 3)``.
    """

    step: float
    capacitance: float
    conductivity: float
    sources: tuple[Source, ...]
    reaction: Reaction
    constants: tuple[NamedTuple, NamedTuple]
    decay: Decay
    position: Array

    def amplitudes(self, first: int, steps: int) -> Array:
        """Amplitude of each stimulus at levels first .. first + steps, shape ``(steps + 1, stimulus)``."""
        times = np.arange(first, first + steps + 1, dtype=float) * self.step
        columns = [source.pulses.amplitude(times) for source in self.sources]
        return np.stack(columns, axis=1) if columns else np.zeros((steps + 1, 0))

    def means(self, first: int, steps: int) -> Array:
        """Mean of each stimulus' factor over each of the steps after ``first``, ``(steps, stimulus)``."""
        times = np.arange(first, first + steps + 1, dtype=float) * self.step
        columns = [source.pulses.mean(times[:-1], times[1:]) for source in self.sources]
        return np.stack(columns, axis=1) if columns else np.zeros((steps, 0))

    def driven(self, first: int, steps: int) -> NDArray[np.bool_]:
        """Whether a flux through an edge acts in each of the steps after ``first``, or did in the one before."""
        since, until = self._around(first, steps)
        fluxes = (source for source in self.sources if source.boundary.any())
        return sum((s.pulses.acts(since, until) for s in fluxes), np.zeros(steps, dtype=bool))

    def kinked(self, first: int, steps: int) -> NDArray[np.bool_]:
        """Whether each stimulus may jump in each of the steps after ``first``, at its beginning or in the one before.

        Shape ``(steps, stimulus)``.
        """
        since, until = self._around(first, steps)
        columns = [source.pulses.jumps(since, until) for source in self.sources]
        return np.stack(columns, axis=1) if columns else np.zeros((steps, 0), dtype=bool)

    def stimulated(self) -> NDArray[np.bool_]:
        """Whether each stimulus drives each point, shape ``(stimulus, point)``."""
        rows = [(source.boundary != 0.0) | (source.interior != 0.0) for source in self.sources]
        return np.array(rows, dtype=bool).reshape(len(rows), len(self.position))

    def _around(self, first: int, steps: int) -> tuple[Array, Array]:
        """Beginning of the step before each one and end of each one, ms."""
        times = np.arange(first - 1, first + steps + 1, dtype=float) * self.step
        return times[:-2], times[2:]

    def count(self, state: TissueState, good: int, asked: int) -> None:
        """:func:`count_steps` with the step and the points of the problem."""
        count_steps(state, good, asked, self.step, self.position)

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


def count_steps(
    state: TissueState, good: int, asked: int, step: float, position: Array | None
) -> None:
    """Count the steps that a loop has taken, of which so many ended well.

    Raises
    ------
    UnstableSolutionError
        If the loop stopped early, after a step that left a bad state.
    """
    state.steps += min(good + 1, asked)
    if good < asked:
        where = None if position is None else position[first_bad(state.cells())]
        raise UnstableSolutionError(state.steps, step, where)


class Stepper(Protocol):
    """One way to take time steps; both ways give the same potentials up to round-off."""

    def diffusion_state(self, potential: Array) -> Array:
        """Solver unknowns that represent a potential given at the points, with no flux."""

    def advance(self, state: TissueState, steps: int, beats: Watch = UNWATCHED) -> None:
        """Take ``steps`` steps in place, and let ``beats`` note what happens in each of them.

        Raises
        ------
        UnstableSolutionError
            At the end of the step in which a cell's state ceases to be finite.
        """
