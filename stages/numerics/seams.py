"""Patches that run into themselves: what holds across the seam, where start and end are one line."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from stages.numerics.patches import Patch

Closed = tuple[bool, bool]
"""Whether the first and the second direction of a patch are closed."""


def check_seams(patch: Patch, tolerance: float = 1e-9) -> None:
    """Raise ``ValueError`` unless start and end meet, point by point, in every closed direction.

    With open knots an edge is the curve of its row of control points: rows are compared, relative to
    the size of the patch.
    """
    net = patch.control_points
    size = float(np.linalg.norm(np.ptp(net, axis=(0, 1))))
    for direction in np.flatnonzero(patch.closed):
        lines = np.moveaxis(net, direction, 0)
        gap = float(np.linalg.norm(lines[0] - lines[-1], axis=1).max())
        if gap > tolerance * size:
            raise ValueError(
                f"direction {direction + 1} is said to be closed, but its start and its end lie up to "
                f"{gap:g} mm apart"
            )


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
    if not any(closed):
        return flux
    joined = flux.tolil()
    grid = np.arange(shape[0] * shape[1]).reshape(shape)
    for direction in np.flatnonzero(closed):
        lines = np.moveaxis(grid, direction, 0)
        start, end = lines[0], lines[-1]
        joined[start] = joined[start] + joined[end]
        joined[end] = (values[start] - values[end]).tolil()
    return sparse.csr_array(joined)
