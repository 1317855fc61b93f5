"""Load paths by arc length: peaks, snap-back, bifurcations, against closed forms."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from stages.numerics.branches import ArcControls, BranchPoint, LoadedProblem
from stages.numerics.continuation import Branch
from stages.numerics.critical import PathEnd, Stage, switch_branch, trace
from stages.numerics.newton import NewtonControls, NewtonError, SingularTangentError
from tests.structures import HingedColumn, ShallowTruss, SprungTruss

CONTROLS = NewtonControls(
    length=0.2,
    displacement_tolerance=1e-9,
    energy_tolerance=1e-8,
    force_tolerance=1e-9,
    max_iterations=15,
)


def traced(
    problem: LoadedProblem, x: list[float], step: float, end: PathEnd, **changes: float
) -> tuple[Branch, list[Stage]]:
    branch, start = Branch.begin(problem, np.array(x), 0.0, CONTROLS, ArcControls(step, **changes))
    stages: list[Stage] = []
    for stage in trace(branch, start, end, max_points=400):
        stages.append(stage)
        # the longest path here takes 400 iterations; one that turns back at every step never ends
        assert sum(s.point.iterations for s in stages) < 2000, "the path gets nowhere"
    return branch, stages


def passed(stages: list[Stage]) -> list[tuple[str, BranchPoint]]:
    return [(c.kind, c.point) for s in stages for c in s.passed]


# no shrinking: a path that gets nowhere takes long to say so
@settings(deadline=None, phases=[Phase.generate], report_multiple_bugs=False)
@given(rise=st.floats(0.02, 1.0), part=st.floats(0.01, 3.0))
def test_the_shallow_truss_snaps_through_both_of_its_limit_loads(rise: float, part: float) -> None:
    """Any rise, any first step, even beyond the peak: the path is followed all the way."""
    truss = ShallowTruss(rise)
    peak = truss.limit_load
    branch, stages = traced(truss, [0.0], part * peak, PathEnd(2.0 * peak))
    points = [s.point for s in stages]
    for p in points:
        # |R| < 1e-9 of stiffness times length is reached, and one more correction made
        assert p.load == pytest.approx(float(truss.load(p.x[0])), abs=1e-9 * peak)
    assert np.all(np.diff([p.x[0] for p in points]) > 0.0)  # never doubles back
    (kind1, first), (kind2, second) = passed(stages)
    assert kind1 == kind2 == "limit point"
    # the load is flat at its limit: an error in place counts squared
    assert first.load == pytest.approx(peak, rel=1e-6)
    assert second.load == pytest.approx(-peak, rel=1e-6)
    assert [first.x[0], second.x[0]] == pytest.approx(truss.limit_displacements, rel=1e-2)
    assert stages[-1].ended
    assert points[-1].load == 2.0 * peak
    assert branch.arcs.initial_load == part * peak


def test_a_load_that_is_crossed_before_the_peak_ends_the_path_there() -> None:
    truss = ShallowTruss()
    _, stages = traced(truss, [0.0], 0.1 * truss.limit_load, PathEnd(0.5 * truss.limit_load))
    assert stages[-1].point.load == 0.5 * truss.limit_load
    assert not passed(stages)


def test_a_path_may_end_at_a_value_of_one_unknown() -> None:
    truss = ShallowTruss()
    _, stages = traced(truss, [0.0], 0.1 * truss.limit_load, PathEnd.at_unknown(0.2, 0, size=1))
    assert stages[-1].ended
    assert stages[-1].point.x[0] == 0.2
    assert abs(stages[-1].point.load) < 1e-9 * truss.limit_load  # flat bars carry nothing


@pytest.mark.parametrize("spring", [0.02, 0.01, 0.003])
def test_a_soft_spring_makes_the_loaded_end_turn_back(spring: float) -> None:
    """Snap-back: the end's displacement falls while the apex goes on; load control sees neither."""
    problem = SprungTruss(spring=spring)
    peak = problem.truss.limit_load
    _, stages = traced(problem, [0.0, 0.0], 0.2 * peak, PathEnd(1.5 * peak))
    apex, end = np.array([s.point.x for s in stages]).T
    np.testing.assert_allclose(end, problem.end(apex), atol=1e-8)
    assert np.all(np.diff(apex) > 0.0)
    assert np.diff(end).min() < 0.0
    assert [kind for kind, _ in passed(stages)] == ["limit point"] * 2
    assert passed(stages)[0][1].load == pytest.approx(peak, rel=1e-6)


def test_a_straight_column_bifurcates_and_its_bent_branches_are_found() -> None:
    column = HingedColumn()
    branch, stages = traced(column, [0.0, 0.0], 0.3, PathEnd(2.0))
    ((kind, point),) = passed(stages)
    assert kind == "bifurcation"
    # bisection to 1e-4 of a step
    assert point.load == pytest.approx(1.0, abs=1e-3)
    assert [s.point.unstable_directions for s in stages][:: len(stages) - 1] == [0, 1]
    for side in (1.0, -1.0):
        bent = switch_branch(branch, point, side * 2.0)
        following = [s.point for s in trace(branch, bent, PathEnd(2.0), 100)]
        for p in (bent, *following):
            assert p.load == pytest.approx(float(column.load(p.x[0])), rel=1e-8)
            assert p.unstable_directions == 0
            assert np.sign(p.x[0]) == np.sign(bent.x[0])
        assert following[-1].load == 2.0
    assert switch_branch(branch, point, 2.0).x[0] == pytest.approx(
        -switch_branch(branch, point, -2.0).x[0]
    )


def test_a_tilted_column_bends_without_bifurcation() -> None:
    column = HingedColumn(tilt=0.01)
    _, stages = traced(column, [0.01, 0.0], 0.1, PathEnd(2.0))
    assert not passed(stages)
    for s in stages:
        assert s.point.load == pytest.approx(float(column.load(s.point.x[0])), rel=1e-7)


def test_steps_shrink_where_the_path_turns_sharply() -> None:
    problem = SprungTruss(spring=0.003)
    peak = problem.truss.limit_load
    branch, stages = traced(problem, [0.0, 0.0], 0.2 * peak, PathEnd(1.5 * peak))
    points = [s.point for s in stages[:-1]]
    turns = [branch.dot(a.tangent, b.tangent) for a, b in pairwise(points)]
    assert min(turns) >= np.cos(np.radians(branch.arcs.max_turn))


def test_without_counted_pivots_limit_points_are_still_found() -> None:
    class Blind(ShallowTruss):
        def linearise(self, x, load):  # type: ignore[no-untyped-def]
            from dataclasses import replace

            return replace(super().linearise(x, load), negative_pivots=None)

    truss = Blind()
    _, stages = traced(truss, [0.0], 0.1 * truss.limit_load, PathEnd(2.0 * truss.limit_load))
    assert [kind for kind, _ in passed(stages)] == ["limit point"] * 2


def test_a_path_that_starts_at_a_critical_point_is_refused() -> None:
    with pytest.raises(SingularTangentError, match="where the path starts"):
        Branch.begin(HingedColumn(), np.array([0.0, 0.1]), 1.0, CONTROLS, ArcControls(0.1))


def test_a_path_into_nowhere_ends_with_an_error_after_its_points() -> None:
    truss = ShallowTruss()

    class Broken(ShallowTruss):
        def linearise(self, x, load):  # type: ignore[no-untyped-def]
            system = super().linearise(x, load)
            if x[0] > 0.25:
                system.residual[:] = np.nan
            return system

    branch, start = Branch.begin(
        Broken(), np.zeros(1), 0.0, CONTROLS, ArcControls(0.1 * truss.limit_load)
    )
    found: list[Stage] = []
    with pytest.raises(NewtonError):
        found.extend(trace(branch, start, PathEnd(1.0), 400))
    assert 0.24 < found[-1].point.x[0] <= 0.25
