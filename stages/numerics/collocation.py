"""Isogeometric collocation operators of a patch at its Greville points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.surface_geometry import SurfaceFrame, frame_on_grid

EDGES = ("X=0", "X=L1", "Y=0", "Y=L2")
"""Start and end of the first parametric direction, start and end of the second."""


@dataclass(frozen=True)
class CollocationOperators:
    """Sparse operators from control values to collocation points, shape ``(point, control)``.

    Attributes
    ----------
    values
        N(xi_j): the field itself (eq. 85).
    laplacian
        Laplace-Beltrami operator in curvilinear coordinates (eqs. 9, 75), 1/mm^2.
    flux
        Outward normal derivative n . grad on the boundary, 1/mm (eq. 77 over D); zero rows inside.
        A corner belongs to two edges; its row is the sum of both edge rows.
    interior
        True where a point lies inside, shape ``(point,)``.
    edges
        Points of each edge by its name, both corners included.
    frame
        Surface frame at the points.
    """

    values: sparse.csr_array
    laplacian: sparse.csr_array
    flux: sparse.csr_array
    interior: NDArray[np.bool_]
    edges: dict[str, NDArray[np.int64]]
    frame: SurfaceFrame


def edge_points(rows: int, columns: int) -> dict[str, NDArray[np.int64]]:
    """Numbers of the grid points on each edge of a ``rows`` x ``columns`` grid, by edge name."""
    grid = np.arange(rows * columns).reshape(rows, columns)
    return dict(zip(EDGES, (grid[0], grid[-1], grid[:, 0], grid[:, -1]), strict=True))


def collocate(patch: Patch) -> CollocationOperators:
    """Operators of a patch at the tensor grid of its Greville points (eqs. 69-77).

    The geometry enters by the frame alone and is exact for rational patches too. The fields are
    polynomial splines N_i M_j over the same parameters in either case: they need no weights, and every
    map from collocation points elsewhere is a tensor product.

    Raises
    ------
    ValueError
        If the patch is not C1 somewhere: second derivatives would jump at knots.
    """
    for direction, space in zip((1, 2), patch.spaces, strict=True):
        if space.continuity < 1 or space.degree < 2:
            raise ValueError(
                f"collocation needs C1 splines of degree 2 or more; direction {direction} has "
                f"degree {space.degree} and continuity C{space.continuity}"
            )
    first, second = patch.first.greville(), patch.second.greville()
    frame = frame_on_grid(patch, first, second)
    n1 = [sparse.csr_array(patch.first.evaluate(first, k)) for k in range(3)]
    n2 = [sparse.csr_array(patch.second.evaluate(second, k)) for k in range(3)]

    def derivative(k1: int, k2: int) -> sparse.csr_array:
        return sparse.csr_array(sparse.kron(n1[k1], n2[k2], format="csr"))

    def weighted(weight: Array, operator: sparse.csr_array) -> sparse.csr_array:
        return sparse.csr_array(sparse.diags_array(weight) @ operator)

    gradient = (derivative(1, 0), derivative(0, 1))
    metric = frame.metric_con
    drift = np.einsum("pab,pcab->pc", metric, frame.christoffel)
    laplacian = (
        weighted(metric[:, 0, 0], derivative(2, 0))
        + weighted(2.0 * metric[:, 0, 1], derivative(1, 1))
        + weighted(metric[:, 1, 1], derivative(0, 2))
        - weighted(drift[:, 0], gradient[0])
        - weighted(drift[:, 1], gradient[1])
    )
    edges = edge_points(patch.first.size, patch.second.size)
    flux = sparse.csr_array((patch.size, patch.size))
    for name, (direction, sign) in zip(EDGES, ((0, -1), (0, 1), (1, -1), (1, 1)), strict=True):
        on_edge = np.zeros(patch.size)
        on_edge[edges[name]] = sign
        for other in (0, 1):  # n = sign h^d / |h^d| is normal to the edge, tangent to the surface
            weight = on_edge * metric[:, direction, other]
            weight /= np.sqrt(metric[:, direction, direction])
            flux = flux + weighted(weight, gradient[other])
    interior = np.ones(patch.size, dtype=bool)
    for points in edges.values():
        interior[points] = False
    return CollocationOperators(
        derivative(0, 0),
        sparse.csr_array(laplacian),
        sparse.csr_array(flux),
        interior,
        edges,
        frame,
    )
