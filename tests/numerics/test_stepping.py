"""Adaptive steps: targets hit exactly, growth, halving, what survives a path that ends."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.numerics.bsplines import Array
from stages.numerics.newton import Linearisation, NewtonControls
from stages.numerics.stepping import Attempt, PathEndError, PathPoint, StepControls, follow
from tests.structures import ShallowTruss

CONTROLS = NewtonControls(
    length=1.0,
    displacement_tolerance=1e-7,
    energy_tolerance=1e-8,
    force_tolerance=1e-9,
    max_iterations=15,
)


@dataclass
class SteepRoot:
    """x^3 + x = s, with an energy that Newton overshoots: not a number beyond |x| = ``wall``."""

    wall: float = np.inf
    seen: list[float] = field(default_factory=list)

    def linearise(self, x: Array, s: float) -> Linearisation:
        self.seen.append(float(x[0]))
        residual = np.where(np.abs(x) < self.wall, x**3 + x - s, np.nan)
        slope = 3.0 * x**2 + 1.0
        return Linearisation(residual, lambda b: b / slope, float(slope[0]))

    def admissible(self, x: Array, s: float) -> Array:
        return x


def start() -> PathPoint:
    return PathPoint(0.0, np.zeros(1))


@given(
    increments=st.lists(st.floats(1e-3, 50.0), min_size=1, max_size=6),
    initial=st.floats(1e-3, 100.0),
)
def test_every_target_is_hit_to_the_bit_and_once(increments: list[float], initial: float) -> None:
    targets = np.cumsum(increments)
    steps = StepControls(initial, smallest=1e-6)
    points = list(follow(SteepRoot(), start(), targets, steps, CONTROLS))
    assert [p.s for p in points if p.target is not None] == list(targets)
    assert [p.target for p in points if p.target is not None] == list(range(len(targets)))
    assert np.all(np.diff([0.0, *(p.s for p in points)]) > 0)
    for p in points:  # Newton leaves the square of a correction of 1e-7
        assert p.x[0] ** 3 + p.x[0] == pytest.approx(p.s, abs=1e-10, rel=1e-10)


def test_a_target_is_hit_even_where_the_step_to_it_is_rounded() -> None:
    last, target = 0.4, 1.7
    assert last + (target - last) != target
    path = follow(SteepRoot(), start(), [last, target, 3.0], StepControls(9.0, 1e-6, 15), CONTROLS)
    assert [p.s for p in path] == [last, target, 3.0]


def test_steps_grow_while_newton_is_easy() -> None:
    points = list(follow(SteepRoot(), start(), [100.0], StepControls(0.1, 1e-6), CONTROLS))
    widths = np.diff([0.0, *(p.s for p in points)])
    assert widths[3] > 4.0 * widths[0]
    assert len(points) < 25  # 1000 steps without growth


def test_a_step_cut_short_by_a_target_does_not_shorten_the_next_ones() -> None:
    targets = [5.0, 5.001, 10.0]
    points = list(follow(SteepRoot(), start(), targets, StepControls(5.0, 1e-6, 15), CONTROLS))
    assert [p.s for p in points] == targets


def test_the_rest_of_the_way_to_a_target_is_divided_evenly() -> None:
    """No sliver of a step is left before a target."""
    steps = StepControls(0.4, smallest=0.4)
    path = follow(SteepRoot(), start(), [1.0], steps, CONTROLS)
    assert next(path).s == pytest.approx(1 / 3)


def test_hard_steps_shrink_but_not_below_the_smallest() -> None:
    steps = StepControls(1.0, smallest=0.3, wanted_iterations=1)
    points = list(follow(SteepRoot(), start(), [10.0], steps, CONTROLS))
    assert 25 < len(points) <= 10.0 / 0.3 + 1


def test_a_first_step_that_is_too_large_is_halved_and_told() -> None:
    told: list[Attempt] = []
    problem = SteepRoot(wall=3.0)
    points = list(follow(problem, start(), [20.0], StepControls(20.0, 1e-6), CONTROLS, told.append))
    assert max(map(abs, problem.seen)) > 3.0  # it did overshoot
    assert points[-1].x[0] ** 3 + points[-1].x[0] == pytest.approx(20.0, rel=1e-12)
    failures = [a for a in told if a.failure is not None]
    assert failures
    assert "failed after 1 iteration" in str(failures[0])
    assert points[0].iterations > len(failures)  # failed attempts are counted
    assert points[-1].smallest_step <= 10.0


def test_a_path_that_ends_keeps_its_points_and_says_where_why_and_what_to_do() -> None:
    """Load control of the shallow truss ends at its first peak when snapping is out of reach."""
    truss = ShallowTruss()
    peak = truss.limit_load
    controls = NewtonControls(0.1, 1e-7, 1e-8, 1e-9, max_iterations=15)
    steps = StepControls(0.1 * peak, smallest=1e-4 * peak, rescue_cuts=0)
    kept: list[PathPoint] = []
    path = follow(_Fenced(truss), start(), [0.5 * peak, 2.0 * peak], steps, controls)
    with pytest.raises(PathEndError, match="no solution beyond") as failure:
        kept.extend(path)  # extends point by point
    assert kept[0].s < 0.5 * peak or kept[0].target == 0
    assert failure.value.reached is kept[-1]
    # the last step of 1e-4 fails
    assert kept[-1].s == pytest.approx(peak, rel=2e-4)
    assert failure.value.history
    assert "arc length" in failure.value.remedy
    assert all(p.unstable_directions == 0 for p in kept)


@dataclass(frozen=True)
class _Fenced:
    """A truss that may not snap: its apex stays above the supports."""

    truss: ShallowTruss

    def linearise(self, x: Array, s: float) -> Linearisation:
        system = self.truss.linearise(x, s)
        if x[0] > self.truss.rise:
            return Linearisation(np.full(1, np.nan), system.solve, system.stiffness)
        return system

    def admissible(self, x: Array, s: float) -> Array:
        return x


def test_the_line_search_is_the_last_resort() -> None:
    """A path that no step length can start: its first correction is 1e8 however small s is."""

    class Cliff:
        def linearise(self, x: Array, s: float) -> Linearisation:
            residual = np.where(np.abs(x) < 10.0, np.cbrt(x) - s - 1.0, np.nan)
            slope = 1e-5 if x[0] == 0 else float(np.cbrt(x[0]) ** -2 / 3.0)
            return Linearisation(residual, lambda b: b / slope, slope)

        def admissible(self, x: Array, s: float) -> Array:
            return x

    steps = StepControls(0.25, smallest=0.25, rescue_cuts=10)
    (point,) = follow(Cliff(), start(), [0.25], steps, CONTROLS)
    assert point.x[0] == pytest.approx(1.25**3, rel=1e-9)
    with pytest.raises(PathEndError):
        list(follow(Cliff(), start(), [0.25], StepControls(0.25, 0.25, rescue_cuts=0), CONTROLS))


def test_a_path_goes_on_from_any_of_its_points() -> None:
    steps = StepControls(0.3, 1e-6)
    points = list(follow(SteepRoot(), start(), [1.0, 4.0], steps, CONTROLS))
    middle = next(i for i, p in enumerate(points) if p.target == 0)
    again = list(follow(SteepRoot(), points[middle], [4.0], steps, CONTROLS))
    assert [p.s for p in again] == [p.s for p in points[middle + 1 :]]
    assert [p.x[0] for p in again] == [p.x[0] for p in points[middle + 1 :]]


def test_targets_that_do_not_rise_are_refused() -> None:
    with pytest.raises(ValueError, match="target 1 at 1 does not lie beyond 2"):
        list(follow(SteepRoot(), start(), [2.0, 1.0], StepControls(1.0, 1e-3), CONTROLS))
