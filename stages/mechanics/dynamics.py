"""Motion of the shell under a given activation: time stepping with halved steps (sec. 3.2)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from stages.mechanics.body import Body
from stages.mechanics.imposed import Imposed
from stages.mechanics.shell import Shell
from stages.numerics.bands import combined
from stages.numerics.bsplines import Array
from stages.numerics.halving import Advance, HalvedSteps
from stages.numerics.newton import Linearisation, NewtonControls
from stages.numerics.sparse import SymmetricBand
from stages.numerics.time_stepping import GeneralizedAlpha, Motion, StepWeights


@dataclass(frozen=True)
class ShellDynamics:
    """Body with inertia and Rayleigh damping C = c M + d K_0 (eq. 105)."""

    body: Body
    mass: SymmetricBand
    damping: SymmetricBand

    @classmethod
    def build(cls, body: Body, *, damping: float, stiffness_damping: float = 0.0) -> ShellDynamics:
        """Dynamics with ``damping`` c in 1/ms and ``stiffness_damping`` d in ms."""
        shell = body.shell
        mass = shell.mass()
        matrix = mass.scaled(damping)
        if stiffness_damping:
            matrix = matrix + shell.stiffness_at_rest().scaled(stiffness_damping)
        return cls(body, mass, matrix)

    @property
    def shell(self) -> Shell:
        """What moves."""
        return self.body.shell

    def at_rest(self) -> Motion:
        """Undeformed shell without motion, a = 0."""
        zero = np.zeros(self.shell.size)
        return Motion(zero, zero, zero)

    def under(self, imposed: Imposed) -> LoadedShell:
        """The problem of one step: the shell under what acts at t_alpha."""
        return LoadedShell(self, imposed)

    def energies(self, motion: Motion) -> tuple[float, float]:
        """Kinetic and passive strain energy, kPa mm^3."""
        silent = np.zeros(self.shell.points)
        return self.kinetic_energy(motion), self.shell.respond(motion.displacement, silent).energy

    def kinetic_energy(self, motion: Motion) -> float:
        """v . M v / 2, kPa mm^3."""
        return 0.5 * float(motion.velocity @ (self.mass @ motion.velocity))


@dataclass(frozen=True)
class LoadedShell:
    """Balance of forces of the moving shell at one instant (eqs. 62, 64).

    Supports that move are where they should be at the end of the step: the guess puts them there.
    """

    dynamics: ShellDynamics
    imposed: Imposed

    def linearise(self, motion: Motion, weights: StepWeights) -> Linearisation:
        """R = M a + C v + F_int(u) and its derivative by the new displacement."""
        dynamics, ties = self.dynamics, self.dynamics.body.ties
        balance = dynamics.body.balance(motion.displacement, self.imposed)
        force = dynamics.mass @ motion.acceleration + dynamics.damping @ motion.velocity
        force += balance.force
        tangent = combined(
            (weights.stiffness, balance.tangent),
            (weights.mass, dynamics.mass),
            (weights.damping, dynamics.damping),
        )
        stiffness = float(np.abs(tangent.diagonal).max())

        def solve(b: Array) -> Array:
            return ties.expand(ties.reduce(tangent).factorise().solve(b))

        return Linearisation(ties.collect(force), solve, stiffness)


@dataclass(frozen=True)
class TimeStep:
    """An output step or a part of one, with what acts at both of its ends.

    Attributes
    ----------
    number
        Number of the output step.
    start, length
        In ms.
    """

    number: int
    start: float
    length: float
    old: Imposed
    new: Imposed

    remedy = "raise mechanics.n_steps, mechanics.max_halvings or mechanics.max_iterations"

    @property
    def place(self) -> str:
        """Output step and time at its start."""
        return f"step {self.number}, t = {self.start:g} ms"

    @property
    def extent(self) -> str:
        """Its length."""
        return f"{self.length:g} ms"

    def halves(self) -> tuple[TimeStep, TimeStep]:
        """Two steps of half the length; what acts is linear in between."""
        half, middle = 0.5 * self.length, self.old.towards(self.new, 0.5)
        return (
            TimeStep(self.number, self.start, half, self.old, middle),
            TimeStep(self.number, self.start + half, half, middle, self.new),
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
        self, imposed: Callable[[int], Imposed], motion: Motion, first: int, last: int
    ) -> Iterator[Advance[Motion]]:
        """Steps ``first + 1`` to ``last``, from ``motion`` at step ``first``.

        ``imposed(i)`` is what acts at time i dt. The result depends on nothing else, so that a run may
        stop after any step and go on later.

        Raises
        ------
        UnsolvedStepError
            If a step fails in spite of halving; the steps before it have been yielded.
        """
        steps = HalvedSteps(self._guesses, self._solve, self.max_halvings)
        old = imposed(first)
        for index in range(first + 1, last + 1):
            new = imposed(index)
            step = TimeStep(index, (index - 1) * self.step, self.step, old, new)
            result = steps.advance(motion, step)
            yield result
            motion, old = result.state, new

    def _guesses(self, motion: Motion, step: TimeStep) -> Iterator[Array]:
        """Displacements to start from.

        To go on at the old velocity takes 3 to 5 iterations. A film that stops or turns within one step
        overshoots and is stretched by that; to stay where it was takes 4 to 7, and rarely fails.
        """
        body = self.dynamics.body
        onward = body.admissible(motion.displacement + step.length * motion.velocity, step.new)
        yield onward
        staying = body.admissible(motion.displacement, step.new)
        if not np.array_equal(onward, staying):
            yield staying

    def _solve(self, motion: Motion, step: TimeStep, guess: Array) -> tuple[Motion, int]:
        problem = self.dynamics.under(step.old.towards(step.new, self.scheme.alpha_f))
        moved, solution = self.scheme.step(problem, motion, step.length, guess, self.controls)
        return moved, solution.iterations
