"""Buckling of strips against Euler's loads, and a panel that snaps through."""

from __future__ import annotations

import numpy as np
import pytest

from stages.artefacts import Laminate, Layer
from stages.mechanics.body.body import Body
from stages.mechanics.loads.edge_traction import EdgeTraction
from stages.mechanics.materials.st_venant_kirchhoff import StVenantKirchhoff
from stages.mechanics.shell.shell import build_shell
from stages.mechanics.statics.buckling import buckling_modes, softest_modes
from stages.mechanics.statics.loading import Loading
from stages.mechanics.supports.clamped_normal import ClampedNormal
from stages.numerics.branches import ArcControls
from stages.numerics.buckling import NoModesError
from stages.numerics.continuation import Branch
from stages.numerics.critical import PathEnd, switch_branch, trace
from stages.numerics.newton import newton
from stages.numerics.patches import Patch
from stages.time_laws.constant import Constant
from tests.mechanics import films
from tests.mechanics.load_path import LoadPath

YOUNG, LENGTH, WIDTH, THICKNESS = 1e6, 1.0, 0.2, 0.01
EULER = np.pi**2 * YOUNG * THICKNESS**3 / 12.0 / (4.0 * LENGTH**2)
"""Force per width that buckles a strip clamped at one end."""


def strip(pull: float = -EULER) -> Body:
    """Strip of no lateral contraction, clamped at one end, pulled along its axis at the other."""
    patch = Patch.rectangle(LENGTH, WIDTH).refine(3, (12, 1))
    solid = StVenantKirchhoff(density=1.0, young_modulus=YOUNG, poisson_ratio=0.0)
    laminate = Laminate((Layer("strip", "solid", THICKNESS, 0.0, 0.0),))
    load = EdgeTraction(edge="X=L1", traction=(pull, 0.0, 0.0), time_law=Constant())
    return Body.held(
        build_shell(patch, laminate, {"solid": solid}),
        {"clamp": ClampedNormal(edge="X=0")},
        {"pull": load},
    )


def test_a_strip_buckles_at_eulers_loads() -> None:
    body = strip()
    loaded = body.imposed_at(0.0, np.zeros(body.shell.points))
    modes = buckling_modes(body, loaded, 2)
    # 1 and 9 times; compression before buckling is 2e-5, the mesh's error is (mode h)^4 / 700
    np.testing.assert_allclose(modes.values, [1.0, 9.0], rtol=1e-3)
    lift = modes.shapes[0].reshape(*body.shell.patch.control_points.shape)
    assert np.abs(lift[..., 2]).max() > 1e3 * np.abs(lift[..., 0]).max()


def test_a_pulled_strip_has_negative_factors() -> None:
    body = strip(pull=2.0 * EULER)
    loaded = body.imposed_at(0.0, np.zeros(body.shell.points))
    assert buckling_modes(body, loaded, 1).values[0] == pytest.approx(-0.5, rel=1e-3)


def test_a_film_that_nothing_acts_on_does_not_buckle() -> None:
    body = strip()
    with pytest.raises(NoModesError):
        buckling_modes(body, body.nothing(), 1)


def test_arc_length_finds_eulers_load_and_the_bent_branch() -> None:
    body = strip()
    loaded = body.imposed_at(0.0, np.zeros(body.shell.points))
    loading = Loading(body, body.nothing(), loaded)
    start = np.zeros(body.shell.size)
    controls = films.controls(body.shell)
    branch, first = Branch.begin(loading, start, 0.0, controls, ArcControls(0.3))
    stages = list(trace(branch, first, PathEnd(1.5), 20))
    ((kind, point),) = [(c.kind, c.point) for s in stages for c in s.passed]
    assert kind == "bifurcation"
    assert point.load == pytest.approx(1.0, rel=2e-3)
    assert stages[-1].point.unstable_directions == 1
    softest = softest_modes(body.balance(point.x, loading.imposed(point.load)), 1)
    rest = softest_modes(body.balance(start, body.nothing()), 1)
    assert abs(softest.values[0]) < 0.01 * rest.values[0]
    # bent by a tenth of its length in the norm of all control points
    bent = switch_branch(branch, point, 0.1 * np.sqrt(start.size) / branch.unit)
    assert bent.unstable_directions == 0
    tip = bent.x.reshape(body.shell.patch.control_points.shape)[-1, 0]
    # the elastica: P/P_e = 1 + (pi^2/32) (w/L)^2 + ... for a tip deflection w
    assert bent.load == pytest.approx(1.0 + np.pi**2 / 32.0 * tip[2] ** 2, abs=5e-3)
    assert abs(tip[2]) > 0.05


def test_the_rate_of_a_loading_is_the_difference_of_its_residuals() -> None:
    body = strip()
    loaded = body.imposed_at(0.0, np.full(body.shell.points, 3.0))
    loading = Loading(body, body.nothing(), loaded, first=2.0, last=6.0)
    x = loading.admissible(1e-3 * np.random.default_rng(0).normal(size=body.shell.size), 3.0)
    step = loading.linearise(x, 5.0).residual - loading.linearise(x, 3.0).residual
    rate = loading.rate(x, 3.0)
    # residuals are linear in what acts
    np.testing.assert_allclose(rate, step / 2.0, atol=1e-10 * np.abs(rate).max())


def test_predicted_forces_agree_with_those_of_a_small_correction() -> None:
    """n(u + h du) = n(u) + h D : B du + O(h^2), on a curved film of two layers."""
    shell = films.shell(films.arched())
    body = films.clamped(shell)
    state, activation = films.random_state(shell, seed=4, size=0.01)
    motion = np.random.default_rng(5).normal(size=shell.size)
    balance = body.balance(state, body.under(activation))
    gaps = []
    for h in (1e-4, 1e-5):
        after = balance.after(h * motion, balance.imposed)
        assert after.resultants is not None
        gaps.append(np.abs(after.resultants.moment - after.response.resultants.moment).max())
    # second order: a hundredth for a tenth
    assert gaps[1] == pytest.approx(0.01 * gaps[0], rel=0.1)


def test_newton_with_predicted_forces_ends_where_the_common_one_does() -> None:
    shell = films.shell(films.flat((6, 2)))
    body = films.clamped(shell)
    target = body.under(np.full(shell.points, 1.0))
    *_, last = LoadPath(body, target, 4, films.controls(shell), 5).follow()
    common = newton(
        lambda u: body.linearise(u, target), last.state.displacement, films.controls(shell)
    )
    assert np.abs(common.x - last.state.displacement).max() < 1e-9
