"""Closed tubes: splines through a circle that join smoothly where they meet."""

from __future__ import annotations

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch


def interpolate_closed(space: SplineSpace, values: Array) -> Array:
    """Control values of the closed spline through values at the inner Greville points.

    Closed: with one value and one slope at both ends. The ends themselves are not interpolated.

    Parameters
    ----------
    space
        Degree 2 or more.
    values
        At ``greville()[1:-1]``, shape ``(n - 2, ...)``.

    Returns
    -------
    Array
        Shape ``(n, ...)``; the first and the last are equal to the last bit.
    """
    greville = space.greville()
    matrix = space.evaluate(greville)
    slopes = space.evaluate(greville[[0, -1]], 1)
    matrix[0], matrix[-1] = matrix[0] - matrix[-1], slopes[0] - slopes[1]
    right = np.zeros((space.size, *values.shape[1:]))
    right[1:-1] = values
    control = np.linalg.solve(matrix, right)
    control[-1] = control[0]
    return np.asarray(control)


def closed_tube(radius: float, length: float, along: SplineSpace, around: SplineSpace) -> Patch:
    """Tube about the X axis, closed in the second direction, with the normal outwards.

    At the angle phi = 2 pi theta2 from Z towards Y a point is (X, radius sin phi, radius cos phi): the
    parameter measures the arc. No rational spline below degree 5 draws a whole circle without kinks in
    its parameter, so this one goes through points of the circle: it is off by h^(p + 1), and the fields
    of collocation on it keep their order.

    Parameters
    ----------
    radius, length
        mm.
    along, around
        Spaces over [0, 1]; the degree around is 2 or more.

    Examples
    --------
    >>> tube = closed_tube(2.0, 3.0, SplineSpace.uniform(1, 1), SplineSpace.uniform(4, 24))
    >>> (tube.evaluate([0.5], [0.25]).round(6) + 0.0).tolist()
    [[1.5, 2.0, 0.0]]
    """
    phi = 2.0 * np.pi * around.greville()[1:-1]
    circle = radius * interpolate_closed(around, np.stack((np.sin(phi), np.cos(phi)), axis=1))
    x = length * along.greville()
    net = np.empty((along.size, around.size, 3))
    net[..., 0] = x[:, None]
    net[..., 1:] = circle
    return Patch(along, around, net, closed=(False, True))
