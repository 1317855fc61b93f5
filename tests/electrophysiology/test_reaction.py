"""The compiled cells agree with a plain twin, with SciPy's integrator, and converge at order four."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from stages.electrophysiology.cell_models import aliev_panfilov
from stages.electrophysiology.reaction import Cells, Clock, compile_reaction
from stages.electrophysiology.tension_laws import goektepe_kuhl
from stages.numerics.bsplines import Array
from tests.paper import CELL, TENSION

CONSTANTS = (CELL.constants(), TENSION.constants())
ADVANCE = compile_reaction(CELL, TENSION)


def random_cells(count: int, seed: int = 0) -> Cells:
    random = np.random.default_rng(seed)
    return Cells(
        potential=random.uniform(-85.0, 25.0, count),
        recovery=random.uniform(0.0, 2.5, count),
        stress=random.uniform(0.0, 12.0, count),
        ionic=np.zeros(count),
        crossing=np.full(count, np.nan),
    )


def twin(cells: Cells, new: Array, step: float) -> tuple[Array, Array]:
    """Runge-Kutta 4 in NumPy, v linear over the step, one cell after the other."""
    cell, tension = CONSTANTS
    w_end, s_end = np.empty_like(new), np.empty_like(new)
    for i, (v0, v1) in enumerate(zip(cells.potential, new, strict=True)):

        def rates(y: Array, fraction: float, v0: float = v0, v1: float = v1) -> Array:
            v = v0 + fraction * (v1 - v0)
            return np.array(
                [
                    aliev_panfilov.recovery_rate(v, y[0], cell),
                    goektepe_kuhl.tension_rate(v, y[0], y[1], tension),
                ]
            )

        y = np.array([cells.recovery[i], cells.stress[i]])
        k1 = rates(y, 0.0)
        k2 = rates(y + 0.5 * step * k1, 0.5)
        k3 = rates(y + 0.5 * step * k2, 0.5)
        k4 = rates(y + step * k3, 1.0)
        w_end[i], s_end[i] = y + step / 6.0 * (k1 + 2 * k2 + 2 * k3 + k4)
    return w_end, s_end


def test_the_compiled_kernel_equals_its_plain_twin() -> None:
    cells = random_cells(257)
    new = cells.potential + np.random.default_rng(1).normal(0, 0.5, 257)
    w, s = twin(cells, new, 0.02)
    ADVANCE(cells, new, 0.0, Clock(0.02, -30.0), *CONSTANTS)
    # the same operations up to fused multiply-add and the fast exponential: a few 1e-16 relative
    np.testing.assert_allclose(cells.recovery, w, rtol=1e-14)
    np.testing.assert_allclose(cells.stress, s, rtol=1e-14, atol=1e-14)
    ionic = [
        aliev_panfilov.ionic_current(v, wi, CONSTANTS[0]) for v, wi in zip(new, w, strict=True)
    ]
    np.testing.assert_allclose(cells.ionic, ionic, rtol=1e-11, atol=1e-13)
    np.testing.assert_array_equal(cells.potential, new)


def advance_over(ramp: tuple[float, float], duration: float, steps: int) -> Cells:
    """One cell under a potential that rises linearly in time."""
    cells = random_cells(1, seed=4)
    cells.potential[:] = ramp[0]
    for k in range(steps):
        new = np.array([ramp[0] + (ramp[1] - ramp[0]) * (k + 1) / steps])
        ADVANCE(cells, new, 0.0, Clock(duration / steps, 99.0), *CONSTANTS)
    return cells


def test_recovery_and_stress_agree_with_an_independent_integrator() -> None:
    ramp, duration = (-40.0, 15.0), 20.0
    cell, tension = CONSTANTS
    start = random_cells(1, seed=4)

    def rates(t: float, y: Array) -> list[float]:
        v = ramp[0] + (ramp[1] - ramp[0]) * t / duration
        return [
            aliev_panfilov.recovery_rate(v, y[0], cell),
            goektepe_kuhl.tension_rate(v, y[0], y[1], tension),
        ]

    exact = solve_ivp(
        rates, (0, duration), [start.recovery[0], start.stress[0]], rtol=1e-12, atol=1e-13
    ).y[:, -1]
    errors = []
    for steps in (100, 200, 400):
        cells = advance_over(ramp, duration, steps)
        errors.append(abs(cells.stress[0] - exact[1]))
        assert abs(cells.recovery[0] - exact[0]) < 1e-8
    # fourth order: each halving divides by about 16
    assert errors[0] / errors[1] > 12
    assert errors[1] / errors[2] > 12


def test_a_crossing_is_interpolated_inside_the_step() -> None:
    cells = random_cells(3)
    cells.potential[:] = [-31.0, -29.0, -31.0]
    new = np.array([-27.0, -20.0, -30.5])
    ADVANCE(cells, new, 7.0, Clock(0.02, -30.0), *CONSTANTS)
    np.testing.assert_allclose(cells.crossing[0], 7.0 + 0.02 * 0.25, rtol=1e-14)
    assert np.isnan(cells.crossing[1:]).all()  # above already; not there yet


def test_rest_is_a_fixed_point() -> None:
    cells = random_cells(5)
    cells.potential[:], cells.recovery[:], cells.stress[:] = -80.0, 0.0, 0.0
    ADVANCE(cells, np.full(5, -80.0), 0.0, Clock(1.0, -30.0), *CONSTANTS)
    for values in (cells.recovery, cells.stress, cells.ionic):
        np.testing.assert_array_equal(values, 0.0)
