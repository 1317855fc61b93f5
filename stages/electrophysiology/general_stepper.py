"""Time steps on any patch: one sparse solve and one pass over the cells each."""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import spsolve

from stages.electrophysiology.diffusion import SparseDiffusion
from stages.electrophysiology.events import UNWATCHED, Watch, watch
from stages.electrophysiology.guard import any_bad
from stages.electrophysiology.tissue import Problem, TissueState
from stages.numerics.bsplines import Array
from stages.numerics.collocation import CollocationOperators


class GeneralStepper:
    """Steps on any patch, curved or skewed."""

    def __init__(
        self, problem: Problem, diffusion: SparseDiffusion, operators: CollocationOperators
    ) -> None:
        self.problem, self.diffusion = problem, diffusion
        self.inside = operators.interior.astype(float)
        self.boundary = np.array([s.boundary / problem.conductivity for s in problem.sources])
        self.applied = problem.applied(self.inside)
        self.interpolation = operators.values

    def diffusion_state(self, potential: Array) -> Array:
        """Control values of the potential."""
        return np.asarray(spsolve(self.interpolation.tocsc(), potential), dtype=float)

    def advance(self, state: TissueState, steps: int, beats: Watch = UNWATCHED) -> None:
        """Take ``steps`` steps in place."""
        problem, diffusion = self.problem, self.diffusion
        step, cells = problem.step, state.cells()
        on = problem.amplitudes(state.steps, steps)
        for k in range(steps):
            now, before = adams_bashforth(state.steps)
            source = step * (before * state.ionic_before - now * state.ionic)
            right = diffusion.explicit @ state.diffusion + self.inside * source
            if on.shape[1]:
                right += step * (0.5 * (on[k] + on[k + 1]) @ self.applied)
                right += on[k + 1] @ self.boundary
            state.diffusion[:] = diffusion.solver.solve(right)
            potential = diffusion.values @ state.diffusion
            state.ionic_before[:] = state.ionic
            start = state.steps * step
            problem.reaction.advance(cells, potential, step, *problem.constants)
            problem.count(state, 0 if any_bad(cells) else 1, 1)
            watch(beats, potential, start, step)


def adams_bashforth(step: int) -> tuple[float, float]:
    """Weights of I_i and I_(i-1): 3/2 and 1/2, at the first step 1 and 0."""
    return (1.5, 0.5) if step else (1.0, 0.0)
