"""The local error of a step, and steps of changing length."""

from __future__ import annotations

import numpy as np
import pytest

from stages.numerics.integration import Integrator
from stages.numerics.step_error import local_error
from stages.numerics.time_stepping import GeneralizedAlpha, Motion
from tests.numerics.moving_bodies import CONTROLS, RADII, System, travel, two_masses
from tests.problems import observed_orders

TWO = two_masses()
U, V = np.array([1.0, -0.3]), np.array([0.2, 0.5])


def start(system: System, consistent: bool = True) -> Motion:
    a = system.acceleration(U, V, 0.0) if consistent else np.zeros(2)
    return Motion(U, V, a)


def estimate_and_truth(
    radius: float, dt: float, steps: int, consistent: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Estimate of the last of some equal steps, and the error of that step against the exact flow."""
    integrator = Integrator(GeneralizedAlpha.damping_to(radius), CONTROLS, shifts=True)
    *_, before, last = travel(TWO, integrator, start(TWO, consistent), np.full(steps, dt))
    estimate = local_error(integrator.scheme, before.motion, last.motion, last.balance)
    exact = TWO.flow(before.motion.displacement, before.motion.velocity, dt)
    return estimate, last.motion.displacement - exact


@pytest.mark.parametrize("radius", RADII)
def test_the_estimate_tends_to_the_true_local_error_and_is_of_third_order(radius: float) -> None:
    """For every spectral radius, in both unknowns, with Rayleigh damping."""
    ratios, sizes = [], []
    for dt in (0.02, 0.01, 0.005):
        estimate, truth = estimate_and_truth(radius, dt, round(0.6 / dt))
        ratios.append(np.abs(estimate / truth - 1.0).max())
        sizes.append(np.abs(estimate).max())
    # the next term is of order dt, and so is the gap
    assert ratios[-1] < 0.05
    assert ratios[0] / ratios[-1] > 3.0
    np.testing.assert_allclose(observed_orders(np.array(sizes)), 3.0, atol=0.1)


@pytest.mark.parametrize("radius", RADII)
def test_the_estimate_has_the_constant_of_the_docstring(radius: float) -> None:
    dt = 0.002
    scheme = GeneralizedAlpha.damping_to(radius)
    integrator = Integrator(scheme, CONTROLS, shifts=True)
    *_, before, last = travel(TWO, integrator, start(TWO), np.full(300, dt))
    estimate = local_error(scheme, before.motion, last.motion, last.balance)
    constant = 1 / 12 + (scheme.alpha_f - scheme.alpha_m) ** 2 / 4
    third = last.balance.slope
    # both sides agree up to the O(dt) by which the slope changes within a step
    np.testing.assert_allclose(estimate, constant * dt**3 * third, rtol=0.02)


@pytest.mark.parametrize("radius", RADII)
def test_the_estimate_sees_an_acceleration_that_has_not_settled(radius: float) -> None:
    """From a = 0 the second step is wrong by the wrong a, and the estimate says by how much.

    Zienkiewicz and Xie's (beta - 1/6) dt^2 (a_2 - a_1) would not: at rho_inf = 1, where a_1 is wrong
    and u is not, it is off by a factor 1/dt.
    """
    estimate, truth = estimate_and_truth(radius, 0.002, 2, consistent=False)
    # the velocity at t_1 is off by O(dt) too, which the damping carries into the slope of A
    np.testing.assert_allclose(estimate, truth, rtol=0.15)


def sawtooth(steps: int) -> np.ndarray:
    """Lengths that grow by 1.5 five times, fall back, and so on; their sum is 3."""
    teeth = 1.5 ** (np.arange(steps) % 6)
    return 3.0 * teeth / teeth.sum()


def global_errors(radius: float, shifts: bool) -> np.ndarray:
    integrator = Integrator(GeneralizedAlpha.damping_to(radius), CONTROLS, shifts=shifts)
    errors = []
    for steps in (204, 408, 816):
        *_, last = travel(TWO, integrator, start(TWO), sawtooth(steps))
        errors.append(np.abs(last.motion.displacement - TWO.flow(U, V, 3.0)).max())
    return np.array(errors)


@pytest.mark.parametrize("radius", RADII)
def test_steps_of_changing_length_keep_second_order(radius: float) -> None:
    # third-order terms spoil the last digit of the observed order
    np.testing.assert_allclose(observed_orders(global_errors(radius, True)), 2.0, atol=0.03)


def test_without_moving_the_acceleration_they_lose_it() -> None:
    """The reason for the shift; at rho_inf = 1 alone there is nothing to move."""
    assert observed_orders(global_errors(0.0, False))[-1] < 1.6
    np.testing.assert_array_equal(global_errors(1.0, False), global_errors(1.0, True))


def test_equal_lengths_are_the_plain_method_to_the_last_bit() -> None:
    scheme = GeneralizedAlpha.damping_to(0.5)
    plain = start(TWO)
    *_, last = travel(TWO, Integrator(scheme, CONTROLS, shifts=True), plain, np.full(20, 0.05))
    for i in range(20):
        problem = TWO.over(scheme, i * 0.05, 0.05)
        plain, _ = scheme.step(problem, plain, 0.05, plain.displacement, CONTROLS)
    np.testing.assert_array_equal(last.motion.displacement, plain.displacement)
    np.testing.assert_array_equal(last.motion.acceleration, plain.acceleration)
