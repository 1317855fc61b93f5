"""Time steps on a separable patch: whole blocks of steps inside one compiled call."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from stages.electrophysiology.events import UNWATCHED, Watch, watch
from stages.electrophysiology.guard import any_bad
from stages.electrophysiology.modes import Factors, multiply
from stages.electrophysiology.separable import SeparableDiffusion
from stages.electrophysiology.tissue import Problem, TissueState
from stages.numerics.bsplines import Array
from stages.numerics.collocation import CollocationOperators
from stages.numerics.compiled import kernel


class System(NamedTuple):
    """Matrices of the compiled loop, C-contiguous; see :class:`SeparableDiffusion` and ``Modes``."""

    to1: Array
    to2: Array
    from1: Array
    from2: Array
    keep: Factors
    gain: Factors
    lifts: Array
    lift_modes: Array
    applied: Array


class SeparableStepper:
    """Steps on a flat film or any patch with orthogonal, constant metric."""

    def __init__(
        self, problem: Problem, diffusion: SeparableDiffusion, operators: CollocationOperators
    ) -> None:
        self.problem, self.diffusion = problem, diffusion
        inside = operators.interior.astype(float)
        first, second = diffusion.first, diffusion.second
        self.shape = (first.to_points.shape[0], second.to_points.shape[0])
        applied = problem.applied(inside).reshape(len(problem.sources), *self.shape)
        self.block = compile_block(problem.reaction.advance)
        self.system = System(
            np.ascontiguousarray(first.to_points),
            np.ascontiguousarray(second.to_points.T),
            np.ascontiguousarray(first.from_points),
            np.ascontiguousarray(second.from_points.T),
            diffusion.keep,
            diffusion.gain,
            diffusion.lifts,
            diffusion.lift_modes,
            applied,
        )

    def diffusion_state(self, potential: Array) -> Array:
        """Amplitudes of the modes, shape ``(n1 - 2, n2 - 2)``."""
        grid = potential.reshape(self.shape)
        return self.diffusion.first.from_points @ grid @ self.diffusion.second.from_points.T

    def advance(self, state: TissueState, steps: int, beats: Watch = UNWATCHED) -> None:
        """Take ``steps`` steps in place."""
        problem = self.problem
        good = self.block(
            state.cells(),
            state.ionic_before,
            state.diffusion,
            self.system,
            problem.amplitudes(state.steps, steps),
            state.steps,
            problem.step,
            beats,
            *problem.constants,
        )
        problem.count(state, good, steps)


@functools.cache
def compile_block(advance_cells: Callable[..., None]) -> Callable[..., int]:
    """Compiled loop over time steps of :class:`SeparableStepper`, once per pair of models.

    It returns how many steps ended well: fewer than asked if the one after them left a bad state.
    """

    @kernel
    def block(
        cells: Any,
        ionic_before: Any,
        modes: Any,
        system: Any,
        on: Any,
        first_step: int,
        step: float,
        beats: Any,
        cell: Any,
        tension: Any,
    ) -> int:
        to1, to2, from1, from2, keep, gain, lifts, lift_modes, applied = system
        ionic = cells.ionic
        m1, m2 = to1.shape[0], to2.shape[1]
        points = m1 * m2
        residual = np.empty((m1, m2))
        flat = residual.reshape(points)
        half = np.empty((from1.shape[0], m2))
        source = np.empty_like(modes)
        kept = np.empty_like(modes)
        wide = np.empty((m1, to2.shape[0]))
        new = np.empty((m1, m2))
        new_flat = new.reshape(points)
        asked = on.shape[0] - 1
        for k in range(asked):
            now = 1.5 * step if first_step + k > 0 else step
            before = 0.5 * step if first_step + k > 0 else 0.0
            for i in range(points):
                flat[i] = before * ionic_before[i] - now * ionic[i]
            for s in range(on.shape[1]):
                weight = 0.5 * step * (on[k, s] + on[k + 1, s])
                if weight != 0.0:
                    for a in range(m1):
                        for b in range(m2):
                            residual[a, b] += weight * applied[s, a, b]
            np.dot(from1, residual, half)
            np.dot(half, from2, source)
            for s in range(on.shape[1]):
                if on[k, s] != 0.0:
                    for a in range(modes.shape[0]):
                        for b in range(modes.shape[1]):
                            source[a, b] += on[k, s] * lift_modes[s, a, b]
            multiply(keep, modes, kept)
            multiply(gain, source, modes)
            for a in range(modes.shape[0]):
                for b in range(modes.shape[1]):
                    modes[a, b] += kept[a, b]
            np.dot(to1, modes, wide)
            np.dot(wide, to2, new)
            for s in range(on.shape[1]):
                if on[k + 1, s] != 0.0:
                    for i in range(points):
                        new_flat[i] += on[k + 1, s] * lifts[s, i]
            for i in range(points):
                ionic_before[i] = ionic[i]
            advance_cells(cells, new_flat, step, cell, tension)
            if any_bad(cells):
                return k
            watch(beats, new_flat, (first_step + k) * step, step)
        return asked

    return block
