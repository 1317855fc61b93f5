"""Newton's method: order, verdicts, failures with their history."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stages.numerics.bsplines import Array
from stages.numerics.newton import (
    DivergenceError,
    IterationLimitError,
    Linearisation,
    NewtonControls,
    SingularTangentError,
    newton,
)
from stages.numerics.sparse import SingularMatrixError

CONTROLS = NewtonControls(
    length=1.0,
    displacement_tolerance=1e-7,
    energy_tolerance=1e-8,
    force_tolerance=1e-9,
    max_iterations=15,
)
SEARCHING = replace(CONTROLS, max_cuts=6)


def root_of(value: float, power: int = 2) -> object:
    def linearise(x: Array) -> Linearisation:
        slope = power * x ** (power - 1)
        return Linearisation(x**power - value, lambda b: b / slope, float(np.abs(slope).max()))

    return linearise


def test_convergence_is_quadratic() -> None:
    solution = newton(root_of(2.0), np.array([1.5]), CONTROLS)
    # x^2 = 2 to the last bit or so: the correction after a 1e-7 one is far below round-off
    assert solution.x[0] == pytest.approx(np.sqrt(2.0), rel=1e-15)
    steps = [i.displacement for i in solution.history]
    # error' = error^2/(2 x): each correction is about 0.35 of the square of the one before
    assert steps[1] == pytest.approx(0.35 * steps[0] ** 2, rel=0.1)


def test_a_linear_problem_takes_one_iteration_more_than_its_solution() -> None:
    matrix = np.array([[4.0, 1.0], [1.0, 3.0]])
    solve = lambda b: np.linalg.solve(matrix, b)  # noqa: E731
    target = np.array([1.0, 2.0])
    solution = newton(
        lambda x: Linearisation(matrix @ x - target, solve, 4.0), np.zeros(2), CONTROLS
    )
    assert solution.iterations == 2
    np.testing.assert_allclose(solution.x, [1 / 11, 7 / 11], rtol=1e-14)


def test_a_start_at_the_solution_is_kept_to_the_bit() -> None:
    zero = np.zeros(3)
    solution = newton(lambda x: Linearisation(x.copy(), lambda b: b, 1.0), zero, CONTROLS)
    assert not solution.x.any()
    assert solution.iterations == 1


def test_one_small_correction_with_a_large_force_is_no_verdict() -> None:
    """A stiff spring beside a soft one: the first correction is tiny, the energy is not."""
    stiff, soft = 1e6, 1e-6

    def linearise(x: Array) -> Linearisation:
        # the soft spring sees its load only once the stiff one has moved
        load = 1e-7 if x[0] > 0 else 0.0
        residual = np.array([stiff * x[0] - 1e-2, soft * x[1] - load])
        return Linearisation(residual, lambda b: b / np.array([stiff, soft]), stiff)

    solution = newton(linearise, np.zeros(2), CONTROLS)
    assert solution.history[0].displacement < CONTROLS.displacement_tolerance
    assert solution.x[1] == pytest.approx(0.1, rel=1e-12)


def test_a_residual_at_its_round_off_floor_is_accepted() -> None:
    """A residual that keeps a noise of 1e-15 while the soft unknown moves by 1e-4 for ever."""
    noise = iter(1e-15 * (-1.0) ** np.arange(100))

    def linearise(x: Array) -> Linearisation:
        return Linearisation(np.array([next(noise)]), lambda b: b / 1e-11, 1.0)

    assert newton(linearise, np.array([1.0]), CONTROLS).iterations == 1


def logarithm(x: Array) -> Linearisation:
    """R = log x, not a number for x < 0."""
    with np.errstate(invalid="ignore"):
        return Linearisation(np.log(x), lambda b: b * x, 1.0)


def test_a_correction_that_leaves_the_domain_is_cut() -> None:
    solution = newton(logarithm, np.array([3.0]), SEARCHING)  # overshoots to -0.3
    assert [i.cuts for i in solution.history[:3]] == [0, 1, 0]
    assert solution.x[0] == pytest.approx(1.0, rel=1e-14)
    with pytest.raises(DivergenceError, match="not finite"):
        newton(logarithm, np.array([3.0]), CONTROLS)


def test_a_correction_that_explodes_is_cut() -> None:
    """R = e^x - 1 from the flat side: the first iterate would land far up the wall."""

    def wall(x: Array) -> Linearisation:
        slope = np.exp(x)
        return Linearisation(np.exp(x) - 1.0, lambda b: b / slope, float(slope[0]))

    solution = newton(
        wall, np.array([-5.0]), SEARCHING
    )  # whole: to x = 142, R = 5e61, 140 iterations
    assert max(i.cuts for i in solution.history) == 2
    assert abs(solution.x[0]) < 1e-14


def test_a_detour_through_larger_residuals_is_not_cut() -> None:
    """A stiff link that a soft motion strains: |R . du| rises before the quadratic drop."""
    stiff = 1e5

    def link(x: Array) -> Linearisation:
        # a rod from a pin to x, pulled by a unit force that has just turned by 0.1
        strain = 0.5 * (x @ x - 1.0)
        residual = stiff * strain * x - np.array([np.cos(0.1), np.sin(0.1)])
        tangent = stiff * (np.outer(x, x) + strain * np.eye(2))
        return Linearisation(residual, lambda b: np.linalg.solve(tangent, b), stiff)

    start = np.array([1.0 + 1.0 / stiff, 0.0])
    solution = newton(link, start, SEARCHING)
    energies = [i.energy for i in solution.history]
    assert energies[1] > 1e2 * energies[0]
    assert not any(i.cuts for i in solution.history)


def test_a_residual_that_is_finite_nowhere_else_is_a_divergence() -> None:
    def edge(x: Array) -> Linearisation:
        return Linearisation(np.where(x == 1.0, 1.0, np.nan), lambda b: b, 1.0)

    with pytest.raises(DivergenceError, match=r"diverged.*by iteration: 1.00e\+00") as failure:
        newton(edge, np.array([1.0]), CONTROLS)
    assert len(failure.value.history) == 1
    assert "smaller steps" in failure.value.remedy


def test_the_next_tangent_may_use_what_this_one_predicts() -> None:
    """``ahead`` replaces the fresh linearisation: a secant method, say, for x^2 = 2."""

    def at(x: float, slope: float) -> Linearisation:
        def ahead(step: Array, parameter: float | None = None) -> Linearisation:
            new = x + float(step[0])
            return at(new, (new**2 - x**2) / (new - x))

        return Linearisation(np.array([x**2 - 2.0]), lambda b: b / slope, slope, ahead=ahead)

    solution = newton(lambda x: at(float(x[0]), 2.0), np.array([1.0]), CONTROLS)
    assert solution.x[0] == pytest.approx(np.sqrt(2.0), rel=1e-14)


def test_a_singular_tangent_names_the_supports() -> None:
    def singular(b: Array) -> Array:
        raise SingularMatrixError("the matrix is singular: pivot 3 of 9 is zero")

    with pytest.raises(SingularTangentError, match="pivot 3 of 9") as failure:
        newton(lambda x: Linearisation(x - 1.0, singular, 1.0), np.zeros(1), CONTROLS)
    assert "supports" in failure.value.remedy


def test_the_iteration_limit_is_an_error_with_all_residuals() -> None:
    def cycle(x: Array) -> Linearisation:
        return Linearisation(x**3 - 2 * x + 2, lambda b: b / (3 * x**2 - 2), 1.0)

    with pytest.raises(IterationLimitError, match="within 15 iterations") as failure:
        newton(cycle, np.array([0.0]), CONTROLS)  # 0 -> 1 -> 0 -> ...
    assert len(failure.value.history) == 15
