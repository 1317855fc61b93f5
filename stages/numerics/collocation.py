"""Isogeometric collocation operators of a patch at its Greville points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from stages.numerics.bsplines import Array
from stages.numerics.diffusivity import Diffusivity, TensorField, isotropic
from stages.numerics.patches import Patch
from stages.numerics.seams import Closed, check_seams, join_seams
from stages.numerics.surface_geometry import SurfaceFrame, frame_on_grid

EDGES = ("X=0", "X=L1", "Y=0", "Y=L2")
"""Start and end of the first parametric direction, start and end of the second."""

SIDES = {"X=0": (0, -1), "X=L1": (0, 1), "Y=0": (1, -1), "Y=L2": (1, 1)}
"""Direction that an edge bounds, and on which end of it."""


@dataclass(frozen=True)
class CollocationOperators:
    """Sparse operators from control values to collocation points, shape ``(point, control)``.

    Attributes
    ----------
    values
        N(xi_j): the field itself (eq. 85).
    laplacian
        div(D grad) in curvilinear coordinates, 1/mm^2; the Laplace-Beltrami operator where the tissue is
        isotropic (eqs. 9, 75).
    flux
        Outward co-normal derivative n . D grad on the boundary, 1/mm (eq. 77 over the conductivity); zero
        rows inside. A corner belongs to two edges; its row is the sum of both edge rows. Rows of seams:
        :func:`~stages.numerics.seams.join_seams`.
    interior
        True where a point lies inside, shape ``(point,)``; seams count as outside.
    edges
        Points of each edge by its name, both corners included. Where the patch is closed there are no
        edges, and the others stop before the second copy of the seam.
    frame
        Surface frame at the points.
    diffusivity
        D^ab at the points, relative to the conductivity.
    closed
        Whether each direction runs into itself.
    shape
        Points along both directions.
    """

    values: sparse.csr_array
    laplacian: sparse.csr_array
    flux: sparse.csr_array
    interior: NDArray[np.bool_]
    edges: dict[str, NDArray[np.int64]]
    frame: SurfaceFrame
    diffusivity: TensorField
    closed: Closed
    shape: tuple[int, int]


def edge_points(
    rows: int, columns: int, closed: Closed = (False, False)
) -> dict[str, NDArray[np.int64]]:
    """Numbers of the grid points on each edge of a ``rows`` x ``columns`` grid, by edge name.

    Edges of a closed direction are left out, and the second copy of a seam's points with them.
    """
    grid = np.arange(rows * columns).reshape(rows, columns)
    grid = grid[: rows - closed[0], : columns - closed[1]]
    lines = zip(EDGES, (grid[0], grid[-1], grid[:, 0], grid[:, -1]), strict=True)
    return {name: points for name, points in lines if not closed[SIDES[name][0]]}


def collocate(patch: Patch, diffusivity: Diffusivity = isotropic) -> CollocationOperators:
    """Operators of a patch at the tensor grid of its Greville points (eqs. 69-77).

    The geometry enters by the frame alone and is exact for rational patches too. The fields are
    polynomial splines N_i M_j over the same parameters in either case: they need no weights, and every
    map from collocation points elsewhere is a tensor product.

    Parameters
    ----------
    patch
        Surface and mesh: any degree from 2 on, any C1 knots; it may be closed.
    diffusivity
        Tensor field of the tissue.

    Raises
    ------
    ValueError
        If the patch is not C1 somewhere: second derivatives would jump at knots; or if it is said to be
        closed where its edges do not meet.
    """
    for direction, space in zip((1, 2), patch.spaces, strict=True):
        if space.continuity < 1 or space.degree < 2:
            raise ValueError(
                f"collocation needs C1 splines of degree 2 or more; direction {direction} has "
                f"degree {space.degree} and continuity C{space.continuity}"
            )
    check_seams(patch)
    closed = patch.closed
    first, second = patch.first.greville(), patch.second.greville()
    shape = first.size, second.size
    frame = frame_on_grid(patch, first, second)
    n1 = [sparse.csr_array(patch.first.evaluate(first, k)) for k in range(3)]
    n2 = [sparse.csr_array(patch.second.evaluate(second, k)) for k in range(3)]

    def derivative(k1: int, k2: int) -> sparse.csr_array:
        return sparse.csr_array(sparse.kron(n1[k1], n2[k2], format="csr"))

    values, gradient = derivative(0, 0), (derivative(1, 0), derivative(0, 1))
    tensor = diffusivity(frame)
    d = tensor.components
    drift = np.einsum("pab,pcab->pc", d, frame.christoffel) - tensor.divergence
    laplacian = (
        weighted(d[:, 0, 0], derivative(2, 0))
        + weighted(2.0 * d[:, 0, 1], derivative(1, 1))
        + weighted(d[:, 1, 1], derivative(0, 2))
        - weighted(drift[:, 0], gradient[0])
        - weighted(drift[:, 1], gradient[1])
    )
    lines = edge_points(*shape)
    interior = np.ones(patch.size, dtype=bool)
    flux = sparse.csr_array((patch.size, patch.size))
    for name, (direction, sign) in SIDES.items():
        interior[lines[name]] = False
        on_edge = np.zeros(shape)
        on_edge.ravel()[lines[name]] = sign
        if not closed[direction] and closed[1 - direction]:
            np.moveaxis(on_edge, direction, 0)[:, [0, -1]] *= 0.5  # two copies of one corner
        for other in (0, 1):  # n = sign h^d / |h^d| is normal to the edge, tangent to the surface
            weight = on_edge.ravel() * d[:, direction, other]
            weight /= np.sqrt(frame.metric_con[:, direction, direction])
            flux = flux + weighted(weight, gradient[other])
    return CollocationOperators(
        values,
        sparse.csr_array(laplacian),
        join_seams(flux, values, shape, closed),
        interior,
        edge_points(*shape, closed),
        frame,
        tensor,
        closed,
        shape,
    )


def weighted(weight: Array, operator: sparse.csr_array) -> sparse.csr_array:
    """Rows of an operator times one number each."""
    return sparse.csr_array(sparse.diags_array(weight) @ operator)
