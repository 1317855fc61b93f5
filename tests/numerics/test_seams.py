"""Closed patches: the field and its flux go on across the seam, at full order, on any mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from scipy.linalg import eigvals
from scipy.sparse.linalg import spsolve

from stages.numerics.bsplines import SplineSpace
from stages.numerics.collocation import collocate
from stages.numerics.diffusivity import Diffusivity, along_fibres, isotropic
from stages.numerics.patches import Patch
from stages.numerics.seams import check_seams
from stages.numerics.tubes import closed_tube, interpolate_closed
from tests.problems import observed_orders

RADIUS, LENGTH = 1.0, 2.0


def uneven(degree: int, elements: int) -> SplineSpace:
    """Spans that change from 0.7 to 1.3 of their mean, not alike on both sides of the seam."""
    even = np.linspace(0.0, 1.0, elements + 1)
    breaks = even + 0.3 * even * (1.0 - even)
    return SplineSpace(degree, np.concatenate((np.zeros(degree), breaks, np.ones(degree))))


def tube(degree: int, elements: int, even: bool = True) -> Patch:
    make = SplineSpace.uniform if even else uneven
    return closed_tube(
        RADIUS, LENGTH, SplineSpace.uniform(degree, elements), make(degree, 2 * elements)
    )


def heated(patch: Patch, diffusivity: Diffusivity) -> np.ndarray:
    """Solution of v - div(D grad v) = q with no flux through the ends; q has a bump beside the seam."""
    operators = collocate(patch, diffusivity)
    x, y, z = operators.frame.position.T
    source = np.exp(-((x - 0.7) ** 2) + 2.0 * np.cos(np.arctan2(y, z) - 0.4))
    inside = sparse.diags_array(operators.interior.astype(float))
    matrix = inside @ (operators.values - operators.laplacian) + operators.flux
    return np.asarray(spsolve(matrix.tocsc(), operators.interior * source))


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
@pytest.mark.parametrize("even", [True, False], ids=["even", "uneven"])
@pytest.mark.parametrize(
    "diffusivity", [isotropic, along_fibres(0.25, 40.0)], ids=["iso", "fibres"]
)
def test_a_field_runs_through_the_seam(degree: int, even: bool, diffusivity: Diffusivity) -> None:
    """One value on both sides, and slopes along the arc that agree."""
    patch = tube(degree, 6, even)
    control = heated(patch, diffusivity).reshape(patch.first.size, -1)
    # imposed by rows of the system, whose other entries are some hundreds
    np.testing.assert_allclose(control[:, 0], control[:, -1], rtol=0, atol=1e-11)
    slopes = control @ patch.second.evaluate(np.array([0.0, 1.0]), 1).T
    values = patch.first.evaluate(patch.first.greville()) @ slopes
    # along the arc; the axial slopes agree because the values do
    np.testing.assert_allclose(values[1:-1, 0], values[1:-1, 1], rtol=0, atol=1e-10)
    assert np.abs(values).max() > 0.1


@pytest.mark.parametrize(("degree", "order"), [(2, 2), (3, 2), (4, 4)])
def test_fields_on_uneven_tubes_converge_at_full_order(degree: int, order: int) -> None:
    """Against a fine mesh of degree 6; fibres wind around the tube."""
    diffusivity = along_fibres(0.25, 40.0)
    at = np.linspace(0.0, 1.0, 23), np.linspace(0.0, 1.0, 47)

    def sampled(patch: Patch) -> np.ndarray:
        control = heated(patch, diffusivity).reshape(patch.first.size, -1)
        return patch.first.evaluate(at[0]) @ control @ patch.second.evaluate(at[1]).T

    best = sampled(tube(6, 24))
    errors = [np.abs(sampled(tube(degree, n, even=False)) - best).max() for n in (6, 12, 24)]
    assert observed_orders(np.array(errors))[-1] > order - 0.35  # not yet asymptotic


def test_where_the_seam_lies_does_not_matter() -> None:
    """A tube turned by a whole number of spans carries the same field, to its error."""
    patch = tube(4, 12)
    turned = patch.with_net(patch.control_points @ _rotation(0.25 * 2.0 * np.pi).T)
    n2 = patch.second.evaluate(np.linspace(0.0, 0.75, 13))
    shifted = patch.second.evaluate(np.linspace(0.25, 1.0, 13))
    one = heated(patch, isotropic).reshape(patch.first.size, -1) @ shifted.T
    other = heated(turned, isotropic).reshape(patch.first.size, -1) @ n2.T
    # both lie within 1e-4 of the limit on this mesh
    np.testing.assert_allclose(one, other, atol=3e-4 * np.abs(one).max())


def _rotation(angle: float) -> np.ndarray:
    """About X, from Z towards Y."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])


def test_either_direction_may_be_closed() -> None:
    """The same tube with its directions exchanged; fibres at 40 degrees are then at 50, the other way round."""
    patch = tube(3, 6)
    net = patch.control_points.transpose(1, 0, 2)
    exchanged = Patch(patch.second, patch.first, net, closed=(True, False))
    one = heated(patch, along_fibres(0.25, 40.0)).reshape(patch.first.size, -1)
    other = heated(exchanged, along_fibres(0.25, 50.0)).reshape(patch.second.size, -1)
    # the same rows in another order
    np.testing.assert_allclose(other, one.T, rtol=0, atol=1e-10)


@pytest.mark.parametrize("degree", [2, 3, 4, 5, 6])
def test_diffusion_on_a_closed_tube_is_damped(degree: int) -> None:
    """No eigenvalue of the collocated operator grows, and the first is that of cos(phi): -1/R^2."""
    for even in (True, False):
        patch = tube(degree, 6, even)
        operators = collocate(patch)
        inside = sparse.diags_array(operators.interior.astype(float))
        left = (inside @ operators.laplacian + operators.flux).toarray()
        right = (inside @ operators.values).toarray()
        rates = eigvals(left, right)
        rates = rates[np.abs(rates) < 1e6]  # boundary rows have infinite ones
        assert rates.real.max() < 1e-8  # rounding of entries of some thousands
        slowest = np.sort(rates.real)[::-1][1:3]
        # cos(phi) and sin(phi), before cos(pi x/L) at -2.47; degree 3 is off by 4 % here
        np.testing.assert_allclose(slowest, -1.0, rtol=0.05)


def test_edges_of_a_tube_are_its_two_ends() -> None:
    operators = collocate(tube(2, 4))
    rows, columns = operators.shape
    assert set(operators.edges) == {"X=0", "X=L1"}
    # the second copy of the seam takes no data
    assert operators.edges["X=0"].tolist() == list(range(columns - 1))
    assert not operators.interior.reshape(rows, columns)[:, [0, -1]].any()


def test_a_torus_has_no_edges_and_keeps_a_constant() -> None:
    """Closed both ways: v = 1 solves v - Lap v = 1, and nothing but it."""
    ring = SplineSpace.uniform(3, 12)
    angle = 2.0 * np.pi * ring.greville()[1:-1]
    circle = interpolate_closed(ring, np.stack((np.cos(angle), np.sin(angle)), axis=1))
    reach = 3.0 + circle[:, 0]
    net = np.stack(
        np.broadcast_arrays(
            circle[:, :1] * reach, circle[:, 1:] * reach, circle[:, 1] + np.zeros((ring.size, 1))
        ),
        axis=-1,
    )
    operators = collocate(Patch(ring, ring, net, closed=(True, True)))
    assert operators.edges == {}
    inside = sparse.diags_array(operators.interior.astype(float))
    matrix = inside @ (operators.values - operators.laplacian) + operators.flux
    found = spsolve(matrix.tocsc(), operators.interior.astype(float))
    # rounding in entries of some hundreds
    np.testing.assert_allclose(found, 1.0, rtol=0, atol=1e-11)


def test_a_patch_that_does_not_meet_is_not_closed() -> None:
    open_film = replace(Patch.rectangle(3.5, 2.0).refine(2, (4, 4)), closed=(False, True))
    with pytest.raises(ValueError, match=r"direction 2 is said to be closed, but .* 2 mm apart"):
        check_seams(open_film)
