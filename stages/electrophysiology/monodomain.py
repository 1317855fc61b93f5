"""The monodomain problem in time: Crank-Nicolson, Adams-Bashforth and Runge-Kutta (sec. 3.4).

One step from t_i to t_(i+1):

1. the potential by CN for diffusion and AB2 for the ionic current (AB1 at the first step), eqs. 82-84
   with I_ion entering by -3/2 dt I_i + 1/2 dt I_(i-1);
2. recovery variable and active stress at every collocation point by RK4, v linear over the step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.diffusion import (
    SeparableDiffusion,
    SparseDiffusion,
    separable_diffusion,
    sparse_diffusion,
)
from stages.electrophysiology.reaction import compile_reaction
from stages.electrophysiology.stimuli import Source, sources
from stages.numerics.bsplines import Array
from stages.numerics.collocation import CollocationOperators, collocate
from stages.numerics.compiled import kernel
from stages.numerics.patches import Patch

LONGEST_BLOCK = 5.0
"""ms; within one block a point is taken to be activated at most once (refractory for far longer)."""


@dataclass
class TissueState:
    """State of all cells at one time level; arrays over collocation points, changed in place.

    ``potential`` in mV, ``recovery`` dimensionless, ``active_stress`` in kPa, ``ionic`` and
    ``ionic_before`` I_ion/C_m at this and the previous level in mV/ms, ``diffusion`` the solver's
    own unknowns, ``steps`` the number of steps done.
    """

    potential: Array
    recovery: Array
    active_stress: Array
    ionic: Array
    ionic_before: Array
    diffusion: Array
    steps: int

    def arrays(self) -> dict[str, Any]:
        """Everything that a continuation needs."""
        return {name: np.copy(value) for name, value in vars(self).items()}


class Stepper(Protocol):
    """One way to take time steps; both ways give the same potentials up to round-off."""

    def diffusion_state(self, potential: Array) -> Array:
        """Solver unknowns that represent a potential given at the points, with no flux."""

    def advance(self, state: TissueState, steps: int, crossing: Array) -> None:
        """Take ``steps`` steps in place; crossing times of the activation threshold go to ``crossing``."""


@dataclass(frozen=True)
class Problem:
    """Numbers of the time loop: step (ms), 1/C_m-scaled sources, threshold (mV), compiled cells."""

    step: float
    capacitance: float
    conductivity: float
    threshold: float
    sources: tuple[Source, ...]
    cells: Callable[..., None]
    cell_constants: Any
    tension_constants: Any

    def amplitudes(self, first: int, steps: int) -> Array:
        """Amplitude of each stimulus at levels first .. first + steps, shape ``(steps + 1, stimulus)``."""
        times = np.arange(first, first + steps + 1) * self.step
        columns = [source.amplitude(times) for source in self.sources]
        return np.stack(columns, axis=1) if columns else np.zeros((steps + 1, 0))

    def applied(self) -> Array:
        """I_app/C_m of each stimulus, mV/ms, shape ``(stimulus, point)``."""
        return np.array([source.interior / self.capacitance for source in self.sources])


def build(
    config: ElectrophysiologyConfig, patch: Patch, general: bool = False
) -> tuple[Stepper, TissueState]:
    """Stepper of a patch and the resting state.

    Parameters
    ----------
    config
        Mesh-independent data; the mesh is that of ``patch``.
    general
        Use the solver for any patch even where the fast one would do.
    """
    operators = collocate(patch)
    problem = Problem(
        config.step,
        config.membrane_capacitance,
        config.conductivity,
        config.activation_threshold,
        sources(config.stimuli, operators),
        compile_reaction(config.cell_model, config.tension_law),
        config.cell_model.constants(),
        config.tension_law.constants(),
    )
    diffusivity = config.conductivity / config.membrane_capacitance
    fast = None
    if not general:
        fast = separable_diffusion(
            patch, operators, problem.sources, diffusivity, config.conductivity, config.step
        )
    stepper: Stepper
    if fast is None:
        stepper = SparseStepper(
            problem, sparse_diffusion(operators, diffusivity, config.step), operators
        )
    else:
        stepper = SeparableStepper(problem, fast, operators)
    return stepper, rest(config, stepper, patch.size)


def rest(config: ElectrophysiologyConfig, stepper: Stepper, points: int) -> TissueState:
    """All cells at rest, no active stress (initial conditions of Table 3)."""
    potential = np.full(points, config.initial_potential)
    return TissueState(
        potential,
        np.full(points, config.cell_model.resting_recovery()),
        np.zeros(points),
        np.zeros(points),
        np.zeros(points),
        stepper.diffusion_state(potential),
        0,
    )


class SparseStepper:
    """Steps on any patch: one sparse solve and one pass over the cells each."""

    def __init__(
        self, problem: Problem, diffusion: SparseDiffusion, operators: CollocationOperators
    ) -> None:
        self.problem, self.diffusion = problem, diffusion
        self.inside = operators.interior.astype(float)
        self.boundary = np.array([s.boundary / problem.conductivity for s in problem.sources])
        self.applied = problem.applied()
        self.interpolation = operators.values

    def diffusion_state(self, potential: Array) -> Array:
        """Control values of the potential."""
        from scipy.sparse.linalg import spsolve

        return np.asarray(spsolve(self.interpolation.tocsc(), potential))

    def advance(self, state: TissueState, steps: int, crossing: Array) -> None:
        """Take ``steps`` steps in place."""
        problem, diffusion = self.problem, self.diffusion
        on = problem.amplitudes(state.steps, steps)
        for k in range(steps):
            now, before = adams_bashforth(state.steps)
            source = problem.step * (before * state.ionic_before - now * state.ionic)
            right = diffusion.explicit @ state.diffusion + self.inside * source
            if on.shape[1]:
                right += problem.step * (0.5 * (on[k] + on[k + 1]) @ self.applied)
                right += on[k + 1] @ self.boundary
            state.diffusion[:] = diffusion.solver.solve(right)
            potential = diffusion.values @ state.diffusion
            state.ionic, state.ionic_before = state.ionic_before, state.ionic
            problem.cells(
                state.potential,
                potential,
                state.recovery,
                state.active_stress,
                state.ionic,
                crossing,
                state.steps * problem.step,
                problem.step,
                problem.threshold,
                problem.cell_constants,
                problem.tension_constants,
            )
            state.potential[:] = potential
            state.steps += 1


def adams_bashforth(step: int) -> tuple[float, float]:
    """Weights of I_i and I_(i-1): 3/2 and 1/2, at the first step 1 and 0."""
    return (1.5, 0.5) if step else (1.0, 0.0)


class SeparableStepper:
    """Steps on a separable patch: whole blocks of steps inside one compiled call."""

    def __init__(
        self, problem: Problem, diffusion: SeparableDiffusion, operators: CollocationOperators
    ) -> None:
        self.problem, self.diffusion = problem, diffusion
        inside = operators.interior.astype(float)
        first, second = diffusion.first, diffusion.second
        self.shape = (first.to_points.shape[0], second.to_points.shape[0])
        applied = (problem.applied() * inside).reshape(-1, *self.shape)
        self.applied = np.ascontiguousarray(applied)
        self.block = compile_block(problem.cells)
        self.matrices = tuple(
            np.ascontiguousarray(matrix)
            for matrix in (
                first.to_points,
                second.to_points.T,
                first.from_points,
                second.from_points.T,
            )
        )

    def diffusion_state(self, potential: Array) -> Array:
        """Amplitudes of the modes, shape ``(n1 - 2, n2 - 2)``."""
        grid = potential.reshape(self.shape)
        return self.diffusion.first.from_points @ grid @ self.diffusion.second.from_points.T

    def advance(self, state: TissueState, steps: int, crossing: Array) -> None:
        """Take ``steps`` steps in place."""
        problem, diffusion = self.problem, self.diffusion
        self.block(
            state.potential,
            state.recovery,
            state.active_stress,
            state.ionic,
            state.ionic_before,
            state.diffusion,
            crossing,
            *self.matrices,
            diffusion.keep,
            diffusion.gain,
            diffusion.lifts,
            diffusion.lift_modes,
            self.applied,
            problem.amplitudes(state.steps, steps),
            state.steps,
            problem.step,
            problem.threshold,
            problem.cell_constants,
            problem.tension_constants,
        )
        state.steps += steps


def compile_block(cells: Callable[..., None]) -> Callable[..., None]:
    """Compiled loop over time steps of :class:`SeparableStepper`."""

    @kernel
    def block(
        potential, recovery, stress, ionic, ionic_before, modes, crossing,
        to1, to2, from1, from2, keep, gain, lifts, lift_modes, applied,
        on, first_step, step, threshold, cell, tension,
    ):  # fmt: skip
        m1, m2 = to1.shape[0], to2.shape[1]
        points = m1 * m2
        residual = np.empty((m1, m2))
        flat = residual.reshape(points)
        half = np.empty((from1.shape[0], m2))
        source = np.empty_like(modes)
        wide = np.empty((m1, to2.shape[0]))
        new = np.empty((m1, m2))
        new_flat = new.reshape(points)
        for k in range(on.shape[0] - 1):
            now = 1.5 * step if first_step + k > 0 else step
            before = 0.5 * step if first_step + k > 0 else 0.0
            for i in range(points):
                flat[i] = before * ionic_before[i] - now * ionic[i]
            for s in range(on.shape[1]):
                weight = 0.5 * step * (on[k, s] + on[k + 1, s])
                if weight > 0.0:
                    for a in range(m1):
                        for b in range(m2):
                            residual[a, b] += weight * applied[s, a, b]
            np.dot(from1, residual, half)
            np.dot(half, from2, source)
            for s in range(on.shape[1]):
                if on[k, s] > 0.0:
                    for a in range(modes.shape[0]):
                        for b in range(modes.shape[1]):
                            source[a, b] += on[k, s] * lift_modes[s, a, b]
            for a in range(modes.shape[0]):
                for b in range(modes.shape[1]):
                    modes[a, b] = keep[a, b] * modes[a, b] + gain[a, b] * source[a, b]
            np.dot(to1, modes, wide)
            np.dot(wide, to2, new)
            for s in range(on.shape[1]):
                if on[k + 1, s] > 0.0:
                    for i in range(points):
                        new_flat[i] += on[k + 1, s] * lifts[s, i]
            for i in range(points):
                ionic_before[i] = ionic[i]
            cells(
                potential, new_flat, recovery, stress, ionic, crossing,
                (first_step + k) * step, step, threshold, cell, tension,
            )  # fmt: skip
            for i in range(points):
                potential[i] = new_flat[i]

    return block
