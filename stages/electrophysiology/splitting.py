"""Steppers of the Strang splitting: cells, diffusion, cells."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from stages.electrophysiology.events import UNWATCHED, Watch, watch
from stages.electrophysiology.l_stable import LStableDiffusion, amplification
from stages.electrophysiology.modes import Factors, Modes, factors, multiply
from stages.electrophysiology.tissue import Problem, TissueState
from stages.numerics.bsplines import Array
from stages.numerics.compiled import kernel


class GeneralSplitting:
    """Steps on any patch, curved or skewed."""

    def __init__(self, problem: Problem, diffusion: LStableDiffusion) -> None:
        self.problem, self.diffusion = problem, diffusion

    def diffusion_state(self, potential: Array) -> Array:
        """Nothing: the potential at the points is all that a step needs."""
        return np.empty(0)

    def advance(self, state: TissueState, steps: int, beats: Watch = UNWATCHED) -> None:
        """Take ``steps`` steps in place."""
        problem, diffusion = self.problem, self.diffusion
        step, cells, react = problem.step, state.cells(), problem.reaction.react
        means = problem.means(state.steps, steps)
        nothing = np.zeros(state.potential.size)
        for k in range(steps):
            react(cells, nothing, 0.5 * step, 1, *problem.constants)
            new = diffusion(state.potential, nothing, nothing) + means[k] @ diffusion.responses
            state.potential[:] = new
            react(cells, nothing, 0.5 * step, 1, *problem.constants)
            watch(beats, state.potential, state.steps * step, step)
            state.steps += 1


class System(NamedTuple):
    """Matrices of the compiled loop, C-contiguous; see ``Modes`` and :class:`LStableDiffusion`."""

    to1: Array
    to2: Array
    from1: Array
    from2: Array
    damp: Factors
    responses: Array


class SeparableSplitting:
    """Steps on a flat film or any patch with orthogonal, constant metric: blocks of steps in one call."""

    def __init__(
        self, problem: Problem, diffusion: LStableDiffusion, modes: tuple[Modes, Modes]
    ) -> None:
        self.problem = problem
        first, second = modes
        self.shape = (first.to_points.shape[0], second.to_points.shape[0])
        self.block = compile_block(problem.reaction.react)
        self.system = System(
            np.ascontiguousarray(first.to_points),
            np.ascontiguousarray(second.to_points.T),
            np.ascontiguousarray(first.from_points),
            np.ascontiguousarray(second.from_points.T),
            factors(first, second, amplification, diffusion.tau),
            diffusion.responses,
        )

    def diffusion_state(self, potential: Array) -> Array:
        """Nothing: the potential at the points is all that a step needs."""
        return np.empty(0)

    def advance(self, state: TissueState, steps: int, beats: Watch = UNWATCHED) -> None:
        """Take ``steps`` steps in place."""
        problem = self.problem
        self.block(
            state.cells(),
            self.system,
            problem.means(state.steps, steps),
            state.steps,
            problem.step,
            beats,
            *problem.constants,
        )
        state.steps += steps


@functools.cache
def compile_block(react: Callable[..., None]) -> Callable[..., None]:
    """Compiled loop over time steps of :class:`SeparableSplitting`, once per pair of models."""

    @kernel
    def block(
        cells: Any,
        system: Any,
        means: Any,
        first_step: int,
        step: float,
        beats: Any,
        cell: Any,
        tension: Any,
    ) -> None:
        to1, to2, from1, from2, damp, responses = system
        m1, m2 = to1.shape[0], to2.shape[1]
        potential, half_step = cells.potential, 0.5 * step
        grid = potential.reshape((m1, m2))
        nothing = np.zeros(potential.size)
        half = np.empty((from1.shape[0], m2))
        modes = np.empty((from1.shape[0], from2.shape[1]))
        damped = np.empty_like(modes)
        wide = np.empty((m1, to2.shape[0]))
        for k in range(means.shape[0]):
            react(cells, nothing, half_step, 1, cell, tension)
            np.dot(from1, grid, half)
            np.dot(half, from2, modes)
            multiply(damp, modes, damped)
            np.dot(to1, damped, wide)
            np.dot(wide, to2, grid)
            for s in range(means.shape[1]):
                if means[k, s] != 0.0:
                    for i in range(potential.size):
                        potential[i] += means[k, s] * responses[s, i]
            react(cells, nothing, half_step, 1, cell, tension)
            watch(beats, potential, (first_step + k) * step, step)

    return block
