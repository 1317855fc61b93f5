"""Patches that run into themselves: where they are closed, and what holds across the seam."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from scipy import sparse

from stages.numerics.patches import Patch

Closed: TypeAlias = tuple[bool, bool]
"""Whether the first and the second direction of a patch are closed."""


def closed_directions(patch: Patch, tolerance: float = 1e-9) -> Closed:
    """Directions in which start and end of a patch are the same curve, point by point.

    With open knots an edge is the curve of its row of control points: rows are compared, relative to
    the size of the patch, and their weights up to a common factor.

    Examples
    --------
    >>> closed_directions(Patch.rectangle(3.5, 2.0))
    (False, False)
    """
    net = patch.control_points
    scale = tolerance * float(np.linalg.norm(np.ptp(net, axis=(0, 1))))
    weights = np.ones(net.shape[:2]) if patch.weights is None else patch.weights

    def meets(direction: int) -> bool:
        points, weight = np.moveaxis(net, direction, 0), np.moveaxis(weights, direction, 0)
        apart = float(np.abs(points[0] - points[-1]).max())
        factor = weight[0] / weight[-1]
        return apart <= scale and float(np.ptp(factor)) <= tolerance * float(factor.max())

    return meets(0), meets(1)


def join_seams(
    flux: sparse.csr_array, values: sparse.csr_array, shape: tuple[int, int], closed: Closed
) -> sparse.csr_array:
    """Boundary rows of a patch whose seams are joined.

    A seam holds every point twice. The row of its first copy becomes the sum of both outward fluxes,
    which vanishes where what leaves on one side enters on the other; the row of the second copy becomes
    the difference of both values. Where an edge meets a seam, the sum of both corners stays, so that the
    edge's flux and the seam's balance are added up as at any corner.

    Parameters
    ----------
    flux
        Co-normal derivatives as if all edges were free, shape ``(point, control)``; edges that end
        on a seam count half in each copy of the corner.
    values
        The field itself, same shape.
    shape
        Points along both directions.
    closed
        Which directions are joined.

    Returns
    -------
    sparse.csr_array
        Same shape; the data of all seam rows are zero, but for those of an edge in its corner.
    """
    joined = flux.tolil()
    grid = np.arange(shape[0] * shape[1]).reshape(shape)
    for direction in np.flatnonzero(closed):
        lines = np.moveaxis(grid, direction, 0)
        start, end = lines[0], lines[-1]
        joined[start] = joined[start] + joined[end]
        joined[end] = (values[start] - values[end]).tolil()
    return sparse.csr_array(joined)
