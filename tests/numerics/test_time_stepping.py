"""Generalized-alpha: order, numerical damping, energy, on problems with known solutions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from stages.numerics.bsplines import Array
from stages.numerics.newton import Linearisation, NewtonControls
from stages.numerics.time_stepping import GeneralizedAlpha, Motion, StepWeights
from tests.problems import observed_orders

CONTROLS = NewtonControls(
    length=1.0,
    displacement_tolerance=1e-10,
    energy_tolerance=1e-8,
    force_tolerance=1e-9,
    max_iterations=15,
)
RADII = [0.0, 0.5, 0.9, 1.0]
STEPS = (128, 256, 512)


@dataclass(frozen=True)
class Oscillator:
    """u'' + 2 z w u' + w^2 u = f, with f given at t_alpha."""

    frequency: float
    damping: float
    force: float = 0.0

    def linearise(self, motion: Motion, weights: StepWeights) -> Linearisation:
        c, k = 2 * self.damping * self.frequency, self.frequency**2
        residual = motion.acceleration + c * motion.velocity + k * motion.displacement - self.force
        tangent = weights.mass + weights.damping * c + weights.stiffness * k
        return Linearisation(residual, lambda b: b / tangent, tangent)


def single(u: float, v: float, a: float) -> Motion:
    return Motion(np.array([u]), np.array([v]), np.array([a]))


def integrate(
    scheme: GeneralizedAlpha,
    problem: Callable[[float, float], Oscillator],
    start: Motion,
    duration: float,
    steps: int,
) -> list[Motion]:
    """``problem(t_old, t_new)`` is the oscillator with its force at t_alpha."""
    dt = duration / steps
    states = [start]
    for i in range(steps):
        motion, _ = scheme.step(
            problem(i * dt, (i + 1) * dt), states[-1], dt, states[-1].displacement, CONTROLS
        )
        states.append(motion)
    return states


def largest_error(states: list[Motion], exact: Array) -> float:
    """Over all times: a single time may lie where the error changes sign."""
    return float(np.abs(np.array([s.displacement[0] for s in states]) - exact).max())


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("damping", [0.0, 0.2])
def test_second_order_on_a_free_oscillator(radius: float, damping: float) -> None:
    """u(0) = 1, u'(0) = 0: u = e^(-z w t) (cos w_d t + z w/w_d sin w_d t)."""
    w, duration = 2.0, 3.0
    scheme = GeneralizedAlpha.damping_to(radius)
    wd = w * np.sqrt(1 - damping**2)
    problem = Oscillator(w, damping)

    def exact(t: Array) -> Array:
        return np.exp(-damping * w * t) * (np.cos(wd * t) + damping * w / wd * np.sin(wd * t))

    errors = [
        largest_error(
            integrate(scheme, lambda *_: problem, single(1, 0, -(w**2)), duration, steps),
            exact(np.linspace(0.0, duration, steps + 1)),
        )
        for steps in STEPS
    ]
    # third-order terms spoil the last digit of the observed order
    np.testing.assert_allclose(observed_orders(np.array(errors)), 2.0, atol=0.1)


@pytest.mark.parametrize("radius", RADII)
def test_second_order_on_a_forced_oscillator(radius: float) -> None:
    """u = sin(1.3 t) solves u'' + 0.8 u' + 4 u = f; f at t_alpha is interpolated as in eq. 68."""
    s, w, z, duration = 1.3, 2.0, 0.2, 3.0
    scheme = GeneralizedAlpha.damping_to(radius)

    def force(t: float) -> float:
        return float((w**2 - s**2) * np.sin(s * t) + 2 * z * w * s * np.cos(s * t))

    def problem(old: float, new: float) -> Oscillator:
        return Oscillator(w, z, float(scheme.blend(np.array(force(old)), np.array(force(new)))))

    errors = [
        largest_error(
            integrate(scheme, problem, single(0, s, 0), duration, steps),
            np.sin(s * np.linspace(0.0, duration, steps + 1)),
        )
        for steps in STEPS
    ]
    np.testing.assert_allclose(observed_orders(np.array(errors)), 2.0, atol=0.1)


def amplification(scheme: GeneralizedAlpha, frequency: float) -> Array:
    """Matrix of one unit step on (u, u', u'')."""
    columns = []
    for unit in np.eye(3):
        motion, _ = scheme.step(
            Oscillator(frequency, 0.0), single(*unit), 1.0, np.zeros(1), CONTROLS
        )
        columns.append([motion.displacement[0], motion.velocity[0], motion.acceleration[0]])
    return np.array(columns).T


@pytest.mark.parametrize("radius", RADII)
def test_infinitely_fast_modes_are_damped_to_the_spectral_radius(radius: float) -> None:
    matrix = amplification(GeneralizedAlpha.damping_to(radius), frequency=1e5)
    # double and triple eigenvalues: perturbations of 1e-10 show up as their cube root
    assert np.abs(np.linalg.eigvals(matrix)).max() == pytest.approx(radius, abs=2e-3)


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("frequency", [0.01, 0.3, 1.0, 3.0, 30.0])
def test_no_mode_is_amplified_at_any_step_size(radius: float, frequency: float) -> None:
    matrix = amplification(GeneralizedAlpha.damping_to(radius), frequency)
    # the principal pair of r = 1 has modulus 1 up to round-off
    assert np.abs(np.linalg.eigvals(matrix)).max() < 1.0 + 1e-7


def test_without_numerical_damping_a_linear_oscillator_keeps_its_energy() -> None:
    w = 2.0
    problem = Oscillator(w, 0.0)
    scheme = GeneralizedAlpha.damping_to(1.0)
    states = integrate(scheme, lambda *_: problem, single(1, 0, -(w**2)), 20.0, 200)
    energy = [float(0.5 * (s.velocity[0] ** 2 + w**2 * s.displacement[0] ** 2)) for s in states]
    # the trapezoidal rule keeps it exactly: 200 steps of round-off
    np.testing.assert_allclose(energy, energy[0], rtol=1e-11)


def test_the_parameters_are_those_of_the_paper() -> None:
    """rho_inf = 0.5: alpha_m = 1, alpha_f = 2/3, gamma = 5/6, beta = 4/9 (eqs. 65-67)."""
    scheme = GeneralizedAlpha.damping_to(0.5)
    found = scheme.alpha_m, scheme.alpha_f, scheme.gamma, scheme.beta
    assert found == pytest.approx((1.0, 2 / 3, 5 / 6, 4 / 9), rel=1e-15)


def test_newmarks_formulas_hold_between_the_states_of_a_step() -> None:
    scheme = GeneralizedAlpha.damping_to(0.5)
    old, dt = single(0.3, -0.2, 0.7), 0.4
    new = scheme.reach(old, np.array([0.9]), dt)
    u = old.displacement + dt * old.velocity
    u = u + 0.5 * dt**2 * (
        (1 - 2 * scheme.beta) * old.acceleration + 2 * scheme.beta * new.acceleration
    )
    v = old.velocity + dt * (
        (1 - scheme.gamma) * old.acceleration + scheme.gamma * new.acceleration
    )
    np.testing.assert_allclose(u, new.displacement, rtol=1e-14)  # eq. 56
    np.testing.assert_allclose(v, new.velocity, rtol=1e-14)  # eq. 57


@pytest.mark.parametrize("radius", [-0.1, 1.1])
def test_a_spectral_radius_outside_zero_to_one_is_refused(radius: float) -> None:
    with pytest.raises(ValueError, match="between 0 and 1"):
        GeneralizedAlpha.damping_to(radius)
