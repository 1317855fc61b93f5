"""Steppers of the Strang splitting: cells, diffusion, cells."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stages.electrophysiology.edge_values import EdgeValues, close_edges, end_rows
from stages.electrophysiology.events import UNWATCHED, Watch, restart, watch
from stages.electrophysiology.guard import any_bad
from stages.electrophysiology.l_stable import LStableDiffusion, amplification
from stages.electrophysiology.modes import Factors, Modes, factors, multiply
from stages.electrophysiology.tissue import Problem, TissueState
from stages.numerics.bsplines import Array
from stages.numerics.compiled import inlined, kernel

REACH = 1.0
"""Decay times that one step of RK4 may take: it is stable up to 2.785, and accurate well below."""


class Parts(NamedTuple):
    """Steps of RK4 into which half a step of the cells is divided, and a whole step of their stress."""

    excitation: int
    contraction: int


def parts(problem: Problem) -> Parts:
    """As many as keep each within :data:`REACH`."""
    decay, step = problem.decay, problem.step
    excitation = 0.5 * step * max(decay.potential, decay.states)
    return Parts(*(max(math.ceil(x / REACH), 1) for x in (excitation, step * decay.stress)))


class GeneralSplitting:
    """Steps on any patch, curved or skewed."""

    def __init__(
        self, problem: Problem, diffusion: LStableDiffusion, edges: EdgeValues | None = None
    ) -> None:
        self.problem, self.diffusion, self.edges = problem, diffusion, edges
        self.parts, self.stimulated = parts(problem), problem.stimulated()

    def diffusion_state(self, potential: Array) -> Array:
        """Nothing: the potential at the points is all that a step needs."""
        return np.empty(0)

    def advance(self, state: TissueState, steps: int, beats: Watch = UNWATCHED) -> None:
        """Take ``steps`` steps in place."""
        problem, diffusion = self.problem, self.diffusion
        step, cells, reaction = problem.step, state.cells(), problem.reaction
        cell, tension = problem.constants
        means, ends = problem.means(state.steps, steps), problem.amplitudes(state.steps, steps)[1:]
        driven = problem.driven(state.steps, steps)
        kinked = problem.kinked(state.steps, steps)
        nothing = np.zeros(state.potential.size)
        for k in range(steps):
            start = state.steps * step
            if self.edges and driven[k]:
                self.edges.close(state.potential)
                state.potential += means[k] @ self.edges.lifts
            for points in self.stimulated[kinked[k]]:
                restart(beats, np.flatnonzero(points), state.potential)
            before = state.potential.copy()
            reaction.excite(cells, nothing, 0.5 * step, self.parts.excitation, cell, tension)
            new = diffusion(state.potential, nothing, nothing)
            for mean, response in zip(means[k], diffusion.responses, strict=True):
                if mean:
                    new += mean * response
            state.potential[:] = new
            reaction.excite(cells, nothing, 0.5 * step, self.parts.excitation, cell, tension)
            if self.edges and driven[k]:
                self.edges.close(state.potential)
                state.potential += means[k] @ self.edges.lifts
            reaction.contract(cells, before, step, self.parts.contraction, tension)
            if self.edges and driven[k]:
                state.potential += (ends[k] - means[k]) @ self.edges.lifts
            problem.count(state, 0 if any_bad(cells) else 1, 1)
            watch(beats, state.potential, start, step)


class System(NamedTuple):
    """Matrices of the compiled loop, C-contiguous.

    See ``Modes``, :class:`LStableDiffusion` and :mod:`~stages.electrophysiology.edge_values`.
    """

    to1: Array
    to2: Array
    from1: Array
    from2: Array
    damp: Factors
    responses: Array
    ends1: Array
    ends2: Array
    lifts: Array
    stimulated: NDArray[np.bool_]


class SeparableSplitting:
    """Steps on a flat film or any patch with orthogonal, constant metric: blocks of steps in one call."""

    def __init__(
        self,
        problem: Problem,
        diffusion: LStableDiffusion,
        modes: tuple[Modes, Modes],
        edges: EdgeValues | None,
    ) -> None:
        self.problem, self.parts = problem, parts(problem)
        first, second = modes
        self.shape = (first.to_points.shape[0], second.to_points.shape[0])
        self.block = compile_block(problem.reaction.excite, problem.reaction.contract)
        self.system = System(
            np.ascontiguousarray(first.to_points),
            np.ascontiguousarray(second.to_points.T),
            np.ascontiguousarray(first.from_points),
            np.ascontiguousarray(second.from_points.T),
            factors(first, second, amplification, diffusion.tau),
            diffusion.responses,
            end_rows(first),
            end_rows(second),
            edges.lifts if edges else np.zeros_like(diffusion.responses),
            problem.stimulated(),
        )

    def diffusion_state(self, potential: Array) -> Array:
        """Nothing: the potential at the points is all that a step needs."""
        return np.empty(0)

    def advance(self, state: TissueState, steps: int, beats: Watch = UNWATCHED) -> None:
        """Take ``steps`` steps in place."""
        problem = self.problem
        good = self.block(
            state.cells(),
            self.system,
            problem.means(state.steps, steps),
            problem.amplitudes(state.steps, steps),
            problem.driven(state.steps, steps),
            problem.kinked(state.steps, steps),
            state.steps,
            problem.step,
            self.parts,
            beats,
            *problem.constants,
        )
        problem.count(state, good, steps)


@inlined
def add(potential: Any, factors: Any, patterns: Any) -> None:
    """Add patterns of shape ``(stimulus, point)`` to the potential, each times its factor."""
    for s in range(factors.size):
        if factors[s] != 0.0:
            for i in range(potential.size):
                potential[i] += factors[s] * patterns[s, i]


@functools.cache
def compile_block(excite: Callable[..., None], contract: Callable[..., None]) -> Callable[..., int]:
    """Compiled loop over time steps of :class:`SeparableSplitting`, once per pair of models.

    It returns how many steps ended well: fewer than asked if the one after them left a bad state.
    """

    @kernel
    def block(
        cells: Any,
        system: Any,
        means: Any,
        on: Any,
        driven: Any,
        kinked: Any,
        first_step: int,
        step: float,
        parts: Any,
        beats: Any,
        cell: Any,
        tension: Any,
    ) -> int:
        to1, to2, from1, from2, damp, responses, ends1, ends2, lifts, stimulated = system
        m1, m2 = to1.shape[0], to2.shape[1]
        potential, half_step = cells.potential, 0.5 * step
        grid = potential.reshape((m1, m2))
        before, nothing = np.empty_like(potential), np.zeros(potential.size)
        half = np.empty((from1.shape[0], m2))
        modes = np.empty((from1.shape[0], from2.shape[1]))
        damped = np.empty_like(modes)
        wide = np.empty((m1, to2.shape[0]))
        asked = means.shape[0]
        for k in range(asked):
            if driven[k]:
                close_edges(grid, ends1, ends2)
                add(potential, means[k], lifts)
            for s in range(kinked.shape[1]):
                if kinked[k, s]:
                    restart(beats, np.flatnonzero(stimulated[s]), potential)
            before[:] = potential
            excite(cells, nothing, half_step, parts.excitation, cell, tension)
            np.dot(from1, grid, half)
            np.dot(half, from2, modes)
            multiply(damp, modes, damped)
            np.dot(to1, damped, wide)
            np.dot(wide, to2, grid)
            add(potential, means[k], responses)
            excite(cells, nothing, half_step, parts.excitation, cell, tension)
            if driven[k]:
                close_edges(grid, ends1, ends2)
                add(potential, means[k], lifts)
            contract(cells, before, step, parts.contraction, tension)
            if driven[k]:
                add(potential, on[k + 1] - means[k], lifts)
            if any_bad(cells):
                return k
            watch(beats, potential, (first_step + k) * step, step)
        return asked

    return block
