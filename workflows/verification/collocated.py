"""What studies of collocation share: right-hand sides on edges, errors in the mean, observed orders."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stages.numerics.bsplines import Array
    from stages.numerics.collocation import CollocationOperators
    from stages.numerics.patches import Patch

ROUND_OFF = 5e-11
"""Errors below this are not used for orders: second derivatives on fine meshes lose as many digits."""


def relative_error(patch: Patch, control: Array, exact: Callable[[Array], Array]) -> float:
    """Relative L2 error (eq. C.2) of a spline, integrated with p + 3 points per span and direction.

    Parameters
    ----------
    patch
        Surface and mesh.
    control
        Control values of the field, shape ``(control,)``.
    exact
        The field at positions of shape ``(point, 3)``.
    """
    import numpy as np

    from stages.numerics.quadrature import quadrature_grid
    from stages.numerics.surface_geometry import frame_on_grid

    grid = quadrature_grid(patch, max(space.degree for space in patch.spaces) + 3)
    frame = frame_on_grid(patch, grid.theta1, grid.theta2)
    weights = np.outer(grid.weights1, grid.weights2).ravel() * frame.area
    n1, n2 = patch.first.evaluate(grid.theta1), patch.second.evaluate(grid.theta2)
    found = (n1 @ control.reshape(patch.first.size, -1) @ n2.T).ravel()
    wanted = exact(frame.position)
    return float(np.sqrt(weights @ (found - wanted) ** 2 / (weights @ wanted**2)))


def edge_data(operators: CollocationOperators, flux: Array) -> Array:
    """Right-hand side of the boundary rows from a flux D grad v at the points, shape ``(point, 3)``.

    The outward normal of an edge is that of the surface's own coordinates; corners take the sum.
    """
    import numpy as np

    from stages.numerics.collocation import SIDES

    data = np.zeros(operators.interior.size)
    for name, points in operators.edges.items():
        direction, sign = SIDES[name]
        normal = sign * operators.frame.dual[points, direction]
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        data[points] += np.einsum("px,px->p", normal, flux[points])
    return data


def theory(degree: int) -> int:
    """Order of collocation at Greville points.

    Examples
    --------
    >>> theory(2), theory(3), theory(4)
    (2, 2, 4)
    """
    return degree if degree % 2 == 0 else degree - 1


def observed_order(n: Array, errors: Array, round_off: float = ROUND_OFF) -> float:
    """Order between the two finest meshes, or steps, whose errors lie above round-off."""
    import numpy as np

    usable = errors > round_off
    n, error = n[usable][-2:], errors[usable][-2:]
    return float(np.log(error[0] / error[1]) / np.log(n[1] / n[0]))
