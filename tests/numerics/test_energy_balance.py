"""Energy balance of the steps: what it adds up to, and what the method itself takes out."""

from __future__ import annotations

import numpy as np
import pytest

from stages.numerics.bsplines import Array
from stages.numerics.integration import Integrator
from stages.numerics.time_stepping import GeneralizedAlpha, Motion
from tests.numerics.moving_bodies import CONTROLS, RADII, System, travel, two_masses
from tests.problems import observed_orders


def imbalances(system: System, radius: float, start: Motion, dt: float, steps: int) -> Array:
    """Imbalance after every step."""
    integrator = Integrator(GeneralizedAlpha.damping_to(radius), CONTROLS, shifts=True)
    held = np.array(system.energy(start))
    found = []
    for state in travel(system, integrator, start, np.full(steps, dt)):
        kinetic, strain = np.array(system.energy(state.motion)) - held
        found.append(state.works.imbalance(kinetic, strain))
    return np.array(found)


def at_rest(size: int) -> Motion:
    return Motion(np.zeros(size), np.zeros(size), np.zeros(size))


def driven() -> System:
    """Two masses with Rayleigh damping and loads."""
    free = two_masses()
    load = lambda t: np.array([np.sin(1.7 * t), 1.0 - np.cos(t)])  # noqa: E731
    return System(free.mass, free.damping, free.stiffness, free.cubic, load)


def test_without_numerical_damping_a_linear_body_is_balanced_to_round_off() -> None:
    """Loads, Rayleigh damping and 500 steps of a fifth of the period."""
    found = imbalances(driven(), 1.0, at_rest(2), 0.6, 500)
    # energies are of order 1, works of order 100 by then: round-off of 500 sums
    assert np.abs(found).max() < 1e-11


@pytest.mark.parametrize("radius", [0.0, 0.5, 0.8])
def test_the_method_takes_out_of_a_free_oscillator_what_its_amplification_says(
    radius: float,
) -> None:
    """Energy ~ |lambda|^(2n) with 1 - |lambda| of order dt^3 and positive."""
    w, cycles = 2.0, 20
    oscillator, lost = System.oscillator(w), []
    for per_cycle in (40, 80, 160):
        dt = 2 * np.pi / w / per_cycle
        start = Motion(np.array([1.0]), np.zeros(1), np.array([-(w**2)]))
        found = imbalances(oscillator, radius, start, dt, cycles * per_cycle)
        amplification = largest(radius, w * dt) ** (2 * cycles * per_cycle) - 1.0
        # E(0) = 2; on the way the energy swings by O(dt^2) of itself
        assert found[-1] / 2.0 == pytest.approx(amplification, rel=0.15)
        assert found[-1] < 0.0
        # within a cycle the loss is hidden by that swing: compare the same phase of every cycle
        assert np.all(np.diff(found[per_cycle - 1 :: per_cycle]) < 0.0)
        lost.append(-np.log1p(found[-1] / 2.0))
    np.testing.assert_allclose(observed_orders(np.array(lost)), 3.0, atol=0.35)


def largest(radius: float, frequency: float) -> float:
    """Modulus of the principal root of a unit step on u'' + w^2 u = 0."""
    scheme, columns = GeneralizedAlpha.damping_to(radius), []
    for unit in np.eye(3):
        start = Motion(*(np.array([x]) for x in unit))
        step = System.oscillator(frequency).over(scheme, 0.0, 1.0)
        motion, _ = scheme.step(step, start, 1.0, np.zeros(1), CONTROLS)
        columns.append([motion.displacement[0], motion.velocity[0], motion.acceleration[0]])
    roots = np.linalg.eigvals(np.array(columns).T)
    return float(np.abs(roots).max())


@pytest.mark.parametrize("radius", RADII)
def test_the_imbalance_of_a_nonlinear_driven_body_is_of_second_order(radius: float) -> None:
    free = two_masses(cubic=4.0)
    load = lambda t: np.array([3.0 * np.sin(1.7 * t) ** 2, 0.0])  # noqa: E731
    system = System(free.mass, free.damping, free.stiffness, free.cubic, load)
    sizes = [
        np.abs(imbalances(system, radius, at_rest(2), 6.0 / n, n)).max() for n in (200, 400, 800)
    ]
    orders = observed_orders(np.array(sizes))
    assert np.all(orders > 1.9)


def test_viscous_damping_never_gives_energy_back_without_numerical_damping() -> None:
    """C v_alpha . du = dt v C v >= 0 step by step, since v_alpha = du/dt at rho_inf = 1."""
    integrator = Integrator(GeneralizedAlpha.damping_to(1.0), CONTROLS, shifts=True)
    states = travel(driven(), integrator, at_rest(2), np.full(300, 0.4))
    dissipated = np.array([state.works.dissipated for state in states])
    assert np.all(np.diff(dissipated) >= 0.0)


@pytest.mark.parametrize("push", [0.0, 2.0])
@pytest.mark.parametrize("radius", RADII)
def test_the_work_of_a_moved_support_is_what_the_body_receives(radius: float, push: float) -> None:
    """The first mass is led along g(t) = (1 - cos t)^2, and what a load on it does, its support gets."""
    free = two_masses()
    led = System(
        free.mass,
        free.damping,
        free.stiffness,
        free.cubic,
        lambda t: np.array([push * np.sin(t), 0.0]),
        moved=lambda t: {0: float((1.0 - np.cos(t)) ** 2)},
    )
    sizes = []
    for n in (200, 400):
        integrator = Integrator(GeneralizedAlpha.damping_to(radius), CONTROLS, shifts=True)
        states = list(travel(led, integrator, at_rest(2), np.full(n, 6.0 / n)))
        last = states[-1]
        # supports hold at t_{i+1} exactly, not at t_alpha
        times = np.cumsum(np.full(n, 6.0 / n))
        held = [state.motion.displacement[0] for state in states]
        np.testing.assert_allclose(held, [led.moved(t)[0] for t in times], atol=1e-13)
        found = [s.works.imbalance(*led.energy(s.motion)) for s in states]
        assert (last.works.loads != 0.0) == (push != 0.0)
        assert last.works.supports > 10 * np.abs(found).max()
        sizes.append(np.abs(found).max())
    if radius == 1.0:
        assert sizes[-1] < 1e-10  # round-off again
    else:
        assert np.log2(sizes[0] / sizes[1]) > 1.9
