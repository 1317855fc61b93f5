"""Second order in time for every spectral radius: manufactured motions, moved supports, and starts."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from stages.numerics.integration import Integrator
from stages.numerics.newton import Linearisation
from stages.numerics.time_stepping import GeneralizedAlpha, Motion, StepWeights
from tests.numerics.moving_bodies import CONTROLS, RADII, System, travel, two_masses
from tests.problems import observed_orders

STEPS = (128, 256, 512)
FINAL = 3.0
CLOSE = 0.1
"""Third-order terms spoil the last digit of an observed order."""


def path(t: float, order: int = 0) -> np.ndarray:
    """The chosen motion of two masses, u = (sin 1.3 t, t^2 e^-t), or a derivative of it."""
    s, e = 1.3, math.exp(-t)
    first = (math.sin(s * t), s * math.cos(s * t), -s * s * math.sin(s * t))
    second = (t * t * e, (2 * t - t * t) * e, (2 - 4 * t + t * t) * e)
    return np.array([first[order], second[order]])


def manufactured(mass_part: float, stiffness_part: float, cubic: float) -> System:
    """Two masses whose load makes :func:`path` their motion."""
    free = two_masses(mass_part, stiffness_part, cubic)

    def load(t: float) -> np.ndarray:
        u, v, a = (path(t, order) for order in range(3))
        return np.asarray(free.mass @ a + free.damping @ v + free.internal(u))

    return replace(free, load=load)


def start() -> Motion:
    return Motion(*(path(0.0, order) for order in range(3)))


def errors(system: System, radius: float, begin: Motion) -> np.ndarray:
    """Largest error of displacement over all times, for each number of steps."""
    integrator = Integrator(GeneralizedAlpha.damping_to(radius), CONTROLS, shifts=False)
    found = []
    for steps in STEPS:
        dt = FINAL / steps
        states = travel(system, integrator, begin, np.full(steps, dt))
        found.append(
            max(
                np.abs(state.motion.displacement - path((i + 1) * dt)).max()
                for i, state in enumerate(states)
            )
        )
    return np.array(found)


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("rayleigh", [(0.0, 0.0), (0.5, 0.0), (0.0, 0.3), (0.5, 0.3)])
def test_second_order_with_both_parts_of_rayleigh_damping(
    radius: float, rayleigh: tuple[float, float]
) -> None:
    """Nonlinear springs."""
    found = errors(manufactured(*rayleigh, cubic=2.0), radius, start())
    np.testing.assert_allclose(observed_orders(found), 2.0, atol=CLOSE)


@pytest.mark.parametrize("radius", RADII)
def test_second_order_where_a_support_is_moved(radius: float) -> None:
    """The first mass is led along its path, and so is exact; the second follows."""
    free = manufactured(0.5, 0.3, cubic=2.0)
    led = replace(free, moved=lambda t: {0: float(path(t)[0])})
    found = errors(led, radius, start())
    np.testing.assert_allclose(observed_orders(found), 2.0, atol=CLOSE)


@pytest.mark.parametrize(("radius", "order"), [(0.0, 1.0), (0.5, 1.0), (0.8, 1.0), (1.0, 2.0)])
def test_a_load_that_jumps_at_the_start_costs_an_order_when_a_starts_from_zero(
    radius: float, order: float
) -> None:
    """a(0) = 0 instead of a jump J leaves the velocity off by (alpha_f - 1/2) J dt for good."""
    system = manufactured(0.0, 0.0, cubic=0.0)
    begin = replace(start(), acceleration=np.zeros(2))
    assert np.abs(path(0.0, 2)).max() == 2.0  # the jump
    found = errors(system, radius, begin)
    # next to the first-order term stands the second-order one
    np.testing.assert_allclose(observed_orders(found)[-1], order, atol=0.2)


@pytest.mark.parametrize("radius", RADII)
def test_a_wrong_start_of_a_leaves_the_velocity_off_by_the_known_amount(radius: float) -> None:
    """A free mass under no force: whatever it moves with afterwards comes from a(0)."""
    scheme = GeneralizedAlpha.damping_to(radius)
    free = System.oscillator(0.0)
    begin = Motion(np.zeros(1), np.zeros(1), np.ones(1))
    integrator = Integrator(scheme, CONTROLS, shifts=False)
    *_, before, last = travel(free, integrator, begin, np.full(200, 0.1))
    drift = 0.5 * (before.motion.velocity[0] + last.motion.velocity[0])
    assert drift == pytest.approx((scheme.alpha_f - 0.5) * 0.1, abs=1e-12)


@dataclass(frozen=True)
class Muscle:
    """Spring of stiffness k that also pulls by its law s (u), either at u_alpha or as it was.

    u'' + k u + s u = 0, s > 0: a muscle on the ascending side of its length-tension curve.
    """

    passive: float
    active: float
    lagged: float | None

    def linearise(self, motion: Motion, weights: StepWeights) -> Linearisation:
        u = motion.displacement
        pull = u if self.lagged is None else np.array([self.lagged])
        slope = self.passive + (self.active if self.lagged is None else 0.0)
        tangent = weights.mass + weights.stiffness * slope
        residual = motion.acceleration + self.passive * u + self.active * pull
        return Linearisation(residual, lambda b: b / tangent, tangent)


UNBOUNDED = replace(CONTROLS, length=1e6)
"""Tolerances for a motion that may blow up; the problem is linear, one iteration solves it."""


def muscle_path(dt: float, staggered: bool, radius: float = 0.5) -> np.ndarray:
    """Displacement over a unit of time, from u = 1 in a mode that is too fast for the steps."""
    scheme = GeneralizedAlpha.damping_to(radius)
    motion, found = Motion(np.ones(1), np.zeros(1), np.zeros(1)), []
    for _ in range(round(1.0 / dt)):
        lagged = float(motion.displacement[0]) if staggered else None
        problem = Muscle(1e6, 0.7e6, lagged)
        motion, _ = scheme.step(problem, motion, dt, motion.displacement, UNBOUNDED)
        found.append(motion.displacement[0])
    return np.array(found)


def test_active_stress_that_lags_by_a_step_oscillates_and_shorter_steps_make_it_worse() -> None:
    """Active stiffness 0.7 of the passive one: each step turns u into about -1.5 u.

    Implicit in the step, as here, the same muscle is one more spring.
    """
    coarse, fine = (muscle_path(dt, staggered=True) for dt in (0.1, 0.05))
    assert np.abs(coarse).max() > 50.0
    assert np.abs(fine).max() > 50.0 * np.abs(coarse).max()
    assert np.all(np.sign(fine[:-1]) == -np.sign(fine[1:]))
    for dt in (0.1, 0.05):
        assert np.abs(muscle_path(dt, staggered=False)).max() <= 1.0
