"""The collocated Laplace-Beltrami operator converges on flat, skewed and curved patches."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from stages.numerics.bsplines import Array
from stages.numerics.collocation import collocate
from stages.numerics.patches import Patch
from stages.numerics.shapes import cylindrical_panel, spherical_panel
from tests.problems import observed_orders, parabolic_sheet, sheet_arc_length, skewed_square


def poisson_error(patch: Patch) -> float:
    """Relative error of Lap v = q on the skewed square; v = sin(pi x) sin(pi y) (Appendix C)."""
    operators = collocate(patch)
    x, y = operators.frame.position[:, 0], operators.frame.position[:, 1]
    exact = np.sin(np.pi * x) * np.sin(np.pi * y)
    slopes = np.pi * np.stack(
        (np.cos(np.pi * x) * np.sin(np.pi * y), np.sin(np.pi * x) * np.cos(np.pi * y)), axis=1
    )
    matrix = operators.laplacian.tolil()
    right = -2.0 * np.pi**2 * exact
    boundary = ~operators.interior
    matrix[boundary] = operators.flux.tolil()[boundary]
    normals = {"X=0": (-1, 0), "X=L1": (1, 0), "Y=0": (0, -1), "Y=L2": (0, 1)}
    right[boundary] = 0.0
    for name, normal in normals.items():
        points = operators.edges[name]
        right[points] += slopes[points] @ normal
    left = operators.edges["X=0"]
    matrix[left] = operators.values.tolil()[left]
    right[left] = exact[left]
    control = spsolve(matrix.tocsc(), right)
    error = operators.values @ control - exact
    return float(np.linalg.norm(error) / np.linalg.norm(exact))


@pytest.mark.parametrize(("degree", "order"), [(2, 2), (3, 2), (4, 4)])
def test_poisson_converges_at_the_order_of_greville_collocation(degree: int, order: int) -> None:
    """Order p for even and p - 1 for odd degree (Auricchio et al., 2010)."""
    meshes = [skewed_square().refine(degree, (n, n)) for n in (8, 16, 32)]
    errors = np.array([poisson_error(mesh) for mesh in meshes])
    # pre-asymptotic on such meshes: within 0.35 of the order, never far below it
    assert observed_orders(errors)[-1] > order - 0.35
    assert errors[-1] < 1e-3  # 5e-4 for degrees 2 and 3, 5e-7 for degree 4


def uneven_square(degree: int, elements: int, repeated: int) -> Patch:
    """The skewed square on spans that change from 1.35 to 0.65 of their mean, knots repeated."""
    square, even = skewed_square(), np.linspace(0.0, 1.0, elements + 1)
    breaks = even + 0.35 * even * (1.0 - even)
    spaces = tuple(
        space.elevate(degree - space.degree).insert(np.repeat(breaks[1:-1], repeated))
        for space in square.spaces
    )
    first, second = (a.embed(b) for a, b in zip(square.spaces, spaces, strict=True))
    return Patch(*spaces, np.einsum("ai,bj,ijx->abx", first, second, square.control_points))


@pytest.mark.parametrize(
    ("degree", "repeated", "order"), [(2, 1, 2), (4, 1, 4), (3, 2, 2), (5, 2, 4)]
)
def test_poisson_converges_on_uneven_meshes_and_repeated_knots(
    degree: int, repeated: int, order: int
) -> None:
    """Any knots will do that leave the splines C1."""
    errors = np.array([poisson_error(uneven_square(degree, n, repeated)) for n in (8, 16, 32)])
    # pre-asymptotic on such meshes: within 0.35 of the order
    assert observed_orders(errors)[-1] > order - 0.35
    assert errors[-1] < 1e-3


def test_the_laplacian_of_a_curved_sheet_is_that_of_its_arc_length() -> None:
    """On a sheet bent without stretch, Lap cos(k s) = -k^2 cos(k s) with s the arc length."""
    bend, length = 1.2, 2.0
    total = sheet_arc_length(bend, np.array(length))
    errors = []
    for elements in (10, 20, 40):
        patch = parabolic_sheet(bend, length, 1.0).refine(4, (elements, 3))
        operators = collocate(patch)
        field, second = _wave(operators.frame.position[:, 0], bend, float(total))
        control = spsolve(operators.values.tocsc(), field)
        inside = operators.interior
        errors.append(np.abs((operators.laplacian @ control - second)[inside]).max())
    # interpolation of degree 4, differentiated twice: order 3 at least
    assert observed_orders(np.array(errors))[-1] > 2.8


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
def test_heights_on_a_cylinder_and_a_sphere_are_eigenfunctions(shape: str) -> None:
    """Lap z = -k z/R^2, k = 1 on the cylinder and 2 on the sphere; fields are polynomial splines."""
    radius = 2.0
    patch, k = {
        "cylinder": (cylindrical_panel(radius, 3.0, (-40.0, 80.0)), 1.0),
        "sphere": (spherical_panel(radius, (0.0, 90.0), (-30.0, 60.0)), 2.0),
    }[shape]
    errors = []
    for elements in (8, 16, 32):
        operators = collocate(patch.refine(4, (elements, elements)))
        height = operators.frame.position[:, 2]
        control = spsolve(operators.values.tocsc(), height)
        found = operators.laplacian @ control
        errors.append(np.abs((found + k * height / radius**2)[operators.interior]).max())
    # interpolation of degree 4, differentiated twice: order 3 at least
    assert observed_orders(np.array(errors))[-1] > 2.8
    assert errors[-1] < 1e-4


def _wave(x: Array, bend: float, total: float) -> tuple[Array, Array]:
    wave = np.pi / total
    field = np.cos(wave * sheet_arc_length(bend, x))
    return field, -(wave**2) * field


def test_a_corner_row_is_the_sum_of_its_two_edge_rows() -> None:
    patch = Patch.rectangle(3.5, 2.0).refine(2, (6, 4))
    operators = collocate(patch)
    x, y = operators.frame.position[:, 0], operators.frame.position[:, 1]
    linear = spsolve(operators.values.tocsc(), 5.0 * x + 7.0 * y)
    flux = operators.flux @ linear
    rows, columns = patch.first.size, patch.second.size
    grid = flux.reshape(rows, columns)
    # derivatives over spans of 0.5 mm of values up to 30: a few hundred roundings of 1e-15
    np.testing.assert_allclose(grid[0, 1:-1], -5.0, rtol=0, atol=1e-12)
    np.testing.assert_allclose(grid[1:-1, -1], 7.0, rtol=0, atol=1e-12)
    corners = [grid[0, 0], grid[0, -1], grid[-1, 0], grid[-1, -1]]
    np.testing.assert_allclose(corners, [-12.0, 2.0, -2.0, 12.0], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(grid[1:-1, 1:-1], 0.0)


def test_degree_one_is_refused() -> None:
    with pytest.raises(ValueError, match="collocation needs C1 splines"):
        collocate(Patch.rectangle(1.0, 1.0))
