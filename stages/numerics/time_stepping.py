"""Generalized-alpha time stepping of M a + C v + F(u, t) = 0 (eqs. 53-67).

The convention is Chung and Hulbert's with weights on the new time level: alpha_m = (2 - r)/(1 + r),
alpha_f = 1/(1 + r). The unknown of a step is the displacement at t_{i+1}, so that supports hold there
exactly; the state goes in and comes out, nothing is kept inside.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from stages.numerics.bsplines import Array
from stages.numerics.newton import Linearisation, NewtonControls, NewtonSolution, newton


@dataclass(frozen=True)
class Motion:
    """Displacement, velocity and acceleration of all degrees of freedom at one time."""

    displacement: Array
    velocity: Array
    acceleration: Array


class StepWeights(NamedTuple):
    """Derivatives of acceleration, velocity and displacement at t_alpha by the new displacement."""

    mass: float
    damping: float
    stiffness: float


class MotionProblem(Protocol):
    """What moves: its residual and tangent at a state."""

    def linearise(self, motion: Motion, weights: StepWeights) -> Linearisation:
        """R = M a + C v + F(u) and K = w_m M + w_c C + w_k dF/du (eqs. 62, 64)."""
        ...


@dataclass(frozen=True)
class GeneralizedAlpha:
    """Parameters of the method (eqs. 65-66).

    Examples
    --------
    >>> scheme = GeneralizedAlpha.damping_to(1.0)  # the trapezoidal rule
    >>> scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma
    (0.5, 0.5, 0.25, 0.5)
    """

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float

    @classmethod
    def damping_to(cls, spectral_radius: float) -> GeneralizedAlpha:
        """Method whose amplification of infinitely fast modes is ``spectral_radius`` in [0, 1]."""
        r = spectral_radius
        if not 0.0 <= r <= 1.0:
            raise ValueError(f"the spectral radius at infinity is {r:g}: it lies between 0 and 1")
        alpha_m, alpha_f = (2.0 - r) / (1.0 + r), 1.0 / (1.0 + r)
        blend = 1.0 - alpha_f + alpha_m
        return cls(alpha_m, alpha_f, 0.25 * blend**2, blend - 0.5)

    def reach(self, old: Motion, displacement: Array, step: float) -> Motion:
        """State at t_{i+1} with that displacement, by Newmark's formulas (eqs. 56-57)."""
        beta, gamma = self.beta, self.gamma
        a = (displacement - old.displacement - step * old.velocity) / (beta * step**2) - (
            0.5 / beta - 1.0
        ) * old.acceleration
        v = old.velocity + step * ((1.0 - gamma) * old.acceleration + gamma * a)
        return Motion(displacement, v, a)

    def blend(self, old: Array, new: Array) -> Array:
        """Value at t_alpha = alpha_f t_{i+1} + (1 - alpha_f) t_i (eqs. 53, 68)."""
        return self.alpha_f * new + (1.0 - self.alpha_f) * old

    def at_alpha(self, old: Motion, new: Motion) -> Motion:
        """State of the balance of a step (eqs. 53-55)."""
        return Motion(
            self.blend(old.displacement, new.displacement),
            self.blend(old.velocity, new.velocity),
            self.alpha_m * new.acceleration + (1.0 - self.alpha_m) * old.acceleration,
        )

    def weights(self, step: float) -> StepWeights:
        """Eq. 64 divided by beta dt^2: the linearisation by displacement instead of acceleration."""
        return StepWeights(
            self.alpha_m / (self.beta * step**2),
            self.alpha_f * self.gamma / (self.beta * step),
            self.alpha_f,
        )

    def step(
        self,
        problem: MotionProblem,
        old: Motion,
        step: float,
        guess: Array,
        controls: NewtonControls,
    ) -> tuple[Motion, NewtonSolution]:
        """State at t_{i+1}, from a guess of its displacement.

        Parameters
        ----------
        problem
            The body, with its loads at t_alpha.
        old
            State at t_i.
        step
            Delta t.
        guess
            First iterate of the new displacement, with prescribed values in place.

        Raises
        ------
        NewtonError
            If the step's equations could not be solved.
        """
        weights = self.weights(step)

        def linearise(displacement: Array) -> Linearisation:
            new = self.reach(old, displacement, step)
            return problem.linearise(self.at_alpha(old, new), weights)

        solution = newton(linearise, guess, controls)
        return self.reach(old, solution.x, step), solution
