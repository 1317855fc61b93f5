"""The compiled cells agree with a plain twin, with SciPy's integrator, and converge at order four."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from stages.electrophysiology.cell_models import aliev_panfilov
from stages.electrophysiology.reaction import Cells, compile_reaction
from stages.electrophysiology.tension_laws import goektepe_kuhl
from stages.numerics.bsplines import Array
from tests.paper import CELL, TENSION

CONSTANTS = (CELL.constants(), TENSION.constants())
ADVANCE, REACT, EXCITE, CONTRACT = compile_reaction(CELL, TENSION)


def random_cells(count: int, seed: int = 0) -> Cells:
    random = np.random.default_rng(seed)
    return Cells(
        potential=random.uniform(-85.0, 25.0, count),
        states=random.uniform(0.0, 2.5, (1, count)),
        stress=random.uniform(0.0, 12.0, count),
        ionic=np.zeros(count),
    )


def rates(v: float, w: float, sigma: float) -> Array:
    """dv/dt, dw/dt and d(sigma)/dt of one cell, from the models' plain functions."""
    cell, tension = CONSTANTS
    rate, target = goektepe_kuhl.relaxation(v, tension)
    (recovery,) = aliev_panfilov.state_rates(v, (w,), cell)
    return np.array(
        [-aliev_panfilov.ionic_current(v, (w,), cell), recovery, rate * (target - sigma)]
    )


def runge_kutta(y: Array, step: float, slope: Callable[[Array, float], Array]) -> Array:
    """One step; ``slope(y, fraction of the step)``."""
    k1 = slope(y, 0.0)
    k2 = slope(y + 0.5 * step * k1, 0.5)
    k3 = slope(y + 0.5 * step * k2, 0.5)
    k4 = slope(y + step * k3, 1.0)
    return y + step / 6.0 * (k1 + 2 * k2 + 2 * k3 + k4)


def test_advance_equals_its_plain_twin() -> None:
    cells, step = random_cells(257), 0.02
    new = cells.potential + np.random.default_rng(1).normal(0, 0.5, 257)
    ends = []
    for v0, v1, w, s in zip(cells.potential, new, cells.states[0], cells.stress, strict=True):

        def slope(y: Array, fraction: float, v0: float = v0, v1: float = v1) -> Array:
            return rates(v0 + fraction * (v1 - v0), *y)[1:]

        ends.append(runge_kutta(np.array([w, s]), step, slope))
    w_end, s_end = np.transpose(ends)
    ADVANCE(cells, new, step, *CONSTANTS)
    # the same operations up to fused multiply-add and the fast exponential: a few 1e-16 relative
    np.testing.assert_allclose(cells.states[0], w_end, rtol=1e-14)
    np.testing.assert_allclose(cells.stress, s_end, rtol=1e-14, atol=1e-14)
    ionic = [
        aliev_panfilov.ionic_current(v, (w,), CONSTANTS[0]) for v, w in zip(new, w_end, strict=True)
    ]
    np.testing.assert_allclose(cells.ionic, ionic, rtol=1e-11, atol=1e-13)
    np.testing.assert_array_equal(cells.potential, new)


def test_react_equals_its_plain_twin() -> None:
    cells, step, substeps = random_cells(257), 0.3, 3
    applied = np.random.default_rng(2).normal(0, 5.0, 257)
    ends = []
    for y, on in zip(
        np.transpose([cells.potential, cells.states[0], cells.stress]), applied, strict=True
    ):

        def slope(y: Array, fraction: float, on: float = on) -> Array:
            return rates(*y) + np.array([on, 0.0, 0.0])

        for _ in range(substeps):
            y = runge_kutta(y, step / substeps, slope)
        ends.append(y)
    before = np.copy(cells.ionic)
    REACT(cells, applied, step, substeps, *CONSTANTS)
    # round-off as above; the double exponential of the switch enlarges that of v by some tens
    for values, plain in zip(
        (cells.potential, cells.states[0], cells.stress), np.transpose(ends), strict=True
    ):
        np.testing.assert_allclose(values, plain, rtol=1e-12, atol=1e-13)
    np.testing.assert_array_equal(cells.ionic, before)


def test_excite_moves_potential_and_states_as_react_does_and_no_stress() -> None:
    one, other = random_cells(257), random_cells(257)
    REACT(one, np.zeros(257), 0.3, 3, *CONSTANTS)
    EXCITE(other, np.zeros(257), 0.3, 3, *CONSTANTS)
    # the same operations up to fused multiply-add, enlarged by the steep current
    np.testing.assert_allclose(other.potential, one.potential, rtol=1e-13, atol=1e-12)
    np.testing.assert_allclose(other.states, one.states, rtol=1e-13, atol=1e-13)
    np.testing.assert_array_equal(other.stress, random_cells(257).stress)


def test_contract_moves_the_stress_as_advance_does_in_as_many_parts() -> None:
    step, parts = 0.3, 3
    one, other = random_cells(257), random_cells(257)
    old = one.potential.copy()
    change = np.random.default_rng(1).normal(0, 0.5, 257)
    for k in range(parts):
        ADVANCE(one, old + (k + 1) * change / parts, step / parts, *CONSTANTS)
    other.potential[:] = old + change
    CONTRACT(other, old, step, parts, CONSTANTS[1])
    # rounding of the potential, enlarged by the double exponential of the switch
    np.testing.assert_allclose(other.stress, one.stress, rtol=1e-12, atol=1e-13)
    np.testing.assert_array_equal(other.states, random_cells(257).states)


def advance_over(ramp: tuple[float, float], duration: float, steps: int) -> Cells:
    """One cell under a potential that rises linearly in time."""
    cells = random_cells(1, seed=4)
    cells.potential[:] = ramp[0]
    for k in range(steps):
        new = np.array([ramp[0] + (ramp[1] - ramp[0]) * (k + 1) / steps])
        ADVANCE(cells, new, duration / steps, *CONSTANTS)
    return cells


def test_recovery_and_stress_agree_with_an_independent_integrator() -> None:
    ramp, duration = (-40.0, 15.0), 20.0
    start = random_cells(1, seed=4)

    def slope(t: float, y: Array) -> Array:
        return rates(ramp[0] + (ramp[1] - ramp[0]) * t / duration, *y)[1:]

    exact = solve_ivp(
        slope, (0, duration), [start.states[0, 0], start.stress[0]], rtol=1e-12, atol=1e-13
    ).y[:, -1]
    errors = []
    for steps in (100, 200, 400):
        cells = advance_over(ramp, duration, steps)
        errors.append(abs(cells.stress[0] - exact[1]))
        assert abs(cells.states[0, 0] - exact[0]) < 1e-8
    # fourth order: each halving divides by about 16
    assert errors[0] / errors[1] > 12
    assert errors[1] / errors[2] > 12


def test_rest_is_a_fixed_point() -> None:
    cells = random_cells(5)
    cells.potential[:], cells.states[:], cells.stress[:] = -80.0, 0.0, 0.0
    ADVANCE(cells, np.full(5, -80.0), 1.0, *CONSTANTS)
    for values in (cells.states, cells.stress, cells.ionic):
        np.testing.assert_array_equal(values, 0.0)
    REACT(cells, np.zeros(5), 1.0, 2, *CONSTANTS)
    np.testing.assert_array_equal(cells.potential, -80.0)
