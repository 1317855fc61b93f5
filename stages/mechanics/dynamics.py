"""Motion of the shell under a given activation: time stepping with halved steps (sec. 3.2)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from stages.mechanics.shell import Shell
from stages.mechanics.supports import Fixed
from stages.numerics.bsplines import Array
from stages.numerics.newton import Linearisation, NewtonControls, NewtonError
from stages.numerics.sparse import SymmetricBand
from stages.numerics.time_stepping import GeneralizedAlpha, Motion, StepWeights


@dataclass(frozen=True)
class ShellDynamics:
    """Shell with inertia, Rayleigh damping C = c M + d K_0 (eq. 105) and supports."""

    shell: Shell
    fixed: Fixed
    mass: SymmetricBand
    damping: SymmetricBand

    @classmethod
    def build(
        cls, shell: Shell, fixed: Fixed, *, damping: float, stiffness_damping: float = 0.0
    ) -> ShellDynamics:
        """Dynamics with ``damping`` c in 1/ms and ``stiffness_damping`` d in ms."""
        mass = shell.mass()
        matrix = mass.scaled(damping)
        if stiffness_damping:
            matrix = matrix + shell.stiffness_at_rest().scaled(stiffness_damping)
        return cls(shell, fixed, mass, matrix)

    def at_rest(self) -> Motion:
        """Undeformed shell without motion, a = 0."""
        zero = np.zeros(self.shell.size)
        return Motion(zero, zero, zero)

    def under(self, activation: Array) -> LoadedShell:
        """The problem of one step: the shell under the activation of t_alpha."""
        return LoadedShell(self, activation)

    def energies(self, motion: Motion) -> tuple[float, float]:
        """Kinetic and passive strain energy, kPa mm^3."""
        kinetic = 0.5 * float(motion.velocity @ (self.mass @ motion.velocity))
        silent = np.zeros(self.shell.points)
        return kinetic, self.shell.respond(motion.displacement, silent).energy


@dataclass(frozen=True)
class LoadedShell:
    """Balance of forces of the moving shell under one activation (eqs. 62, 64)."""

    dynamics: ShellDynamics
    activation: Array

    def linearise(self, motion: Motion, weights: StepWeights) -> Linearisation:
        """R = M a + C v + F_int(u) and its derivative by the new displacement."""
        body = self.dynamics
        response = body.shell.respond(motion.displacement, self.activation)
        residual = body.mass @ motion.acceleration + body.damping @ motion.velocity + response.force
        residual[body.fixed] = 0.0
        bands = weights.stiffness * body.shell.tangent(response).bands
        bands += weights.mass * body.mass.bands
        bands += weights.damping * body.damping.bands
        tangent = SymmetricBand(bands)
        stiffness = float(np.abs(tangent.diagonal).max())

        def solve(b: Array) -> Array:
            return tangent.supported(body.fixed).factorise().solve(b)

        return Linearisation(residual, solve, stiffness)


@dataclass(frozen=True)
class StepResult:
    """One output step.

    Attributes
    ----------
    motion
        State at its end.
    iterations
        Newton iterations, those of all partial steps together.
    halvings
        Deepest halving that it took.
    """

    motion: Motion
    iterations: int
    halvings: int


class StepError(Exception):
    """A time step could not be solved, not even in small parts.

    Attributes
    ----------
    step, time
        Number of the output step, and the time (ms) from which it could not go on.
    history
        Iterations of the last attempt.
    remedy
        What to try.
    """

    def __init__(self, step: int, time: float, part: float, failure: NewtonError) -> None:
        self.step = step
        self.time = time
        self.history = failure.history
        self.remedy = f"{failure.remedy}; or allow more halvings (mechanics.max_halvings)"
        super().__init__(
            f"time step {step} failed at t = {time:g} ms, even with a partial step of {part:g} ms: "
            f"{failure}"
        )


@dataclass(frozen=True)
class TimeLoop:
    """Steps of equal output interval; one that fails is halved, and its parts recombined."""

    dynamics: ShellDynamics
    scheme: GeneralizedAlpha
    controls: NewtonControls
    step: float
    max_halvings: int

    def run(
        self, activation: Callable[[int], Array], motion: Motion, first: int, last: int
    ) -> Iterator[StepResult]:
        """Steps ``first + 1`` to ``last``, from ``motion`` at step ``first``.

        ``activation(i)`` is the field at time i dt, shape ``(quadrature point,)``, kPa. The result
        depends on nothing else, so that a run may stop after any step and go on later.

        Raises
        ------
        StepError
            If a step fails in spite of halving; the steps before it have been yielded.
        """
        old = np.asarray(activation(first))
        for index in range(first + 1, last + 1):
            new = np.asarray(activation(index))
            result = self._advance(index, motion, old, new, 0, 0)
            yield result
            motion, old = result.motion, new

    def _advance(
        self, index: int, motion: Motion, old: Array, new: Array, depth: int, part: int
    ) -> StepResult:
        """Part number ``part`` of the 2^depth parts of a step, with its activation at both ends."""
        step = self.step / 2**depth
        solved, failures = self._solve(motion, self.scheme.blend(old, new), step)
        wasted = sum(len(failure.history) for failure in failures)
        if solved is not None:
            return StepResult(solved[0], wasted + solved[1], depth)
        if depth == self.max_halvings:
            time = (index - 1) * self.step + part * step
            raise StepError(index, time, step, failures[-1]) from failures[-1]
        middle = 0.5 * (old + new)
        first = self._advance(index, motion, old, middle, depth + 1, 2 * part)
        second = self._advance(index, first.motion, middle, new, depth + 1, 2 * part + 1)
        return StepResult(
            second.motion,
            wasted + first.iterations + second.iterations,
            max(first.halvings, second.halvings),
        )

    def _solve(
        self, motion: Motion, activation: Array, step: float
    ) -> tuple[tuple[Motion, int] | None, list[NewtonError]]:
        """New state and iterations, or none; and the attempts that failed.

        The first guess goes on at the old velocity: it takes 3 to 5 iterations. A film that turns fast
        is stretched by that; a guess that stays where the film was takes 4 to 7, and rarely fails.
        """
        problem = self.dynamics.under(activation)
        failures: list[NewtonError] = []
        for guess in (motion.displacement + step * motion.velocity, motion.displacement):
            try:
                moved, solution = self.scheme.step(problem, motion, step, guess, self.controls)
            except NewtonError as failure:
                failures.append(failure)
            else:
                return (moved, solution.iterations), failures
        return None, failures
