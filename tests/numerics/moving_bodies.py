"""Small bodies in motion with known solutions: free, forced, damped, nonlinear, with moved supports."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import expm

from stages.numerics.bsplines import Array
from stages.numerics.energy_balance import Forces
from stages.numerics.integration import Integrator, Travel
from stages.numerics.newton import Linearisation, NewtonControls
from stages.numerics.time_stepping import GeneralizedAlpha, Motion, StepWeights

RADII = [0.0, 0.5, 0.8, 1.0]
CONTROLS = NewtonControls(
    length=1.0,
    displacement_tolerance=1e-10,
    energy_tolerance=1e-8,
    force_tolerance=1e-9,
    max_iterations=15,
)


def nothing(u: Array) -> Array:
    return np.zeros_like(u)


@dataclass(frozen=True)
class System:
    """M u'' + C u' + K u + k3 u^3 = f(t), with u = g(t) where ``moved``."""

    mass: Array
    damping: Array
    stiffness: Array
    cubic: Array
    load: Callable[[float], Array]
    moved: Callable[[float], dict[int, float]] = field(default=lambda t: {})

    @classmethod
    def oscillator(
        cls, frequency: float, damping: float = 0.0, cubic: float = 0.0, load: object = None
    ) -> System:
        """u'' + 2 z w u' + w^2 u + k3 u^3 = f."""
        given = load if callable(load) else (lambda t: 0.0)
        c, k = 2 * damping * frequency, frequency**2
        return cls(
            np.eye(1),
            np.array([[c]]),
            np.array([[k]]),
            np.array([cubic]),
            lambda t: np.array([given(t)]),
        )

    def internal(self, u: Array) -> Array:
        return self.stiffness @ u + self.cubic * u**3

    def strain(self, u: Array) -> float:
        return float(0.5 * u @ self.stiffness @ u + 0.25 * self.cubic @ u**4)

    def kinetic(self, v: Array) -> float:
        return float(0.5 * v @ self.mass @ v)

    def energy(self, motion: Motion) -> tuple[float, float]:
        return self.kinetic(motion.velocity), self.strain(motion.displacement)

    def acceleration(self, u: Array, v: Array, t: float) -> Array:
        """What the balance at t asks for."""
        forces = self.load(t) - self.damping @ v - self.internal(u)
        return np.linalg.solve(self.mass, forces)

    def flow(self, u: Array, v: Array, time: float) -> Array:
        """Exact displacement of the free linear system after ``time``."""
        n = u.size
        inverse = np.linalg.inv(self.mass)
        rates = np.block(
            [[np.zeros((n, n)), np.eye(n)], [-inverse @ self.stiffness, -inverse @ self.damping]]
        )
        return np.asarray((expm(time * rates) @ np.concatenate((u, v)))[:n])

    def over(self, scheme: GeneralizedAlpha, start: float, length: float) -> Step:
        """Problem of one step; loads are interpolated to t_alpha as in eq. 68."""
        ends = self.load(start), self.load(start + length)
        return Step(self, scheme.blend(*ends), ends[1], self.moved(start + length))


@dataclass(frozen=True)
class Step:
    """A system under the load of t_alpha, with the values that its supports have at t_{i+1}."""

    system: System
    load: Array
    load_at_end: Array
    moved: dict[int, float]

    def residual(self, motion: Motion) -> Array:
        s = self.system
        inertia = s.mass @ motion.acceleration + s.damping @ motion.velocity
        return np.asarray(inertia + s.internal(motion.displacement) - self.load)

    def linearise(self, motion: Motion, weights: StepWeights) -> Linearisation:
        s = self.system
        slope = s.stiffness + np.diag(3 * s.cubic * motion.displacement**2)
        tangent = weights.mass * s.mass + weights.damping * s.damping + weights.stiffness * slope
        residual, held = self.residual(motion), list(self.moved)
        residual[held] = 0.0
        tangent[held], tangent[:, held] = 0.0, 0.0
        tangent[held, held] = 1.0
        return Linearisation(
            residual, lambda b: np.linalg.solve(tangent, b), float(np.diag(tangent).max())
        )

    def forces(self, displacement: Array) -> Forces:
        internal = self.system.internal(displacement)
        strain = self.system.strain(displacement)
        return Forces(internal, np.zeros_like(internal), self.load_at_end, strain)

    def inertia(self, acceleration: Array) -> Array:
        return np.asarray(self.system.mass @ acceleration)

    def viscous(self, velocity: Array) -> Array:
        return np.asarray(self.system.damping @ velocity)

    def work_of_supports(self, force: Array, increment: Array) -> float:
        held = list(self.moved)
        return float(force[held] @ increment[held])

    def size(self, error: Array) -> float:
        return float(np.abs(np.delete(error, list(self.moved))).max(initial=0.0))

    def admissible(self, guess: Array) -> Array:
        guess = guess.copy()
        guess[list(self.moved)] = list(self.moved.values())
        return guess


def two_masses(mass_part: float = 0.2, stiffness_part: float = 0.05, cubic: float = 0.0) -> System:
    """Two masses on springs with Rayleigh damping, at rest without load."""
    mass, stiffness = np.diag([2.0, 1.0]), np.array([[9.0, -3.0], [-3.0, 4.0]])
    return System(
        mass,
        mass_part * mass + stiffness_part * stiffness,
        stiffness,
        np.array([cubic, 2 * cubic]),
        lambda t: np.zeros(2),
    )


def begin(system: System, start: Motion) -> Travel:
    """State before the first step."""
    here = Step(system, system.load(0.0), system.load(0.0), {})
    return Travel.start(start, here.forces(start.displacement))


def travel(
    system: System,
    integrator: Integrator,
    start: Motion,
    lengths: Array,
) -> Iterator[Travel]:
    """States after steps of the given lengths."""
    state, time = begin(system, start), 0.0
    for length in lengths:
        step = system.over(integrator.scheme, time, length)
        guess = step.admissible(state.motion.displacement)
        state = integrator.step(step, state, length, guess)
        time += length
        yield state
