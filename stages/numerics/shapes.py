"""Patches of exact shape: bilinear quadrilaterals, panels of cylinders and of spheres.

A circular arc is one rational quadratic segment, exact below 180 degrees. A longer arc would need
segments that join at double knots: such a surface is smooth, but the splines over it have kinks there
(C0), and a shell's displacements must not. Use symmetry, or several films.
"""

from __future__ import annotations

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch

Angles = tuple[float, float]
"""Start and end of an arc, degrees, increasing by less than 180."""


def bilinear_quad(corners: Array) -> Patch:
    """Straight-edged, possibly twisted patch between four corners; theta in the unit square.

    Parameters
    ----------
    corners
        r(0, 0), r(0, 1) and r(1, 0), r(1, 1) in two rows, shape ``(2, 2, 3)``, mm.

    Examples
    --------
    >>> bilinear_quad([[[0, 0, 0], [0, 1, 0]], [[2, 0, 0], [4, 1, 8]]]).evaluate([0.5], [1]).tolist()
    [[2.0, 1.0, 4.0]]
    """
    line = SplineSpace.uniform(1, 1)
    return Patch(line, line, np.asarray(corners, dtype=float))


def cylindrical_panel(radius: float, length: float, angles: Angles) -> Patch:
    """Part of the cylinder Y^2 + Z^2 = radius^2 over 0 <= X <= length, exact.

    Direction 1 runs along the axis, direction 2 along the arc: at the angle phi from Z towards Y the
    point is (X, radius sin phi, radius cos phi). The normal points outwards.

    Raises
    ------
    ValueError
        If a size is not positive, or the arc is empty or reaches 180 degrees.

    Examples
    --------
    >>> roof = cylindrical_panel(25.0, 50.0, (-40.0, 40.0)).refine(2, (4, 4))
    >>> roof.evaluate([0.5], [0.5]).round(12).tolist()
    [[25.0, 0.0, 25.0]]
    """
    _check_positive(radius=radius, length=length)
    arc, weights = unit_arc(angles)
    net = np.empty((2, 3, 3))
    net[..., 0] = np.array([[0.0], [length]])
    net[..., 1], net[..., 2] = radius * arc[:, 1], radius * arc[:, 0]
    spaces = SplineSpace.uniform(1, 1), SplineSpace.uniform(2, 1)
    return Patch(*spaces, net, np.tile(weights, (2, 1)))


def spherical_panel(radius: float, longitudes: Angles, latitudes: Angles) -> Patch:
    """Part of a sphere about the origin between meridians and parallels, exact.

    Direction 1 runs along longitude (from X towards Y), direction 2 along latitude (from the equator
    towards Z). The normal points outwards. At latitude 90 a whole edge shrinks to the pole: there is
    no normal there, and its control points have to be tied to one another.

    Raises
    ------
    ValueError
        If the radius is not positive, or an arc is empty or reaches 180 degrees.

    Examples
    --------
    >>> octant = spherical_panel(10.0, (0.0, 90.0), (0.0, 90.0))
    >>> round(float(np.linalg.norm(octant.evaluate([0.3], [0.8]))), 12)
    10.0
    """
    _check_positive(radius=radius)
    around, weights1 = unit_arc(longitudes)
    upwards, weights2 = unit_arc(latitudes)
    if abs(latitudes[0]) > 90.0 or abs(latitudes[1]) > 90.0:
        raise ValueError(f"latitudes {latitudes} degrees pass a pole: they lie in [-90, 90]")
    net = np.empty((3, 3, 3))
    net[..., :2] = radius * around[:, None] * upwards[:, :1]
    net[..., 2] = radius * upwards[:, 1]
    return Patch(*(SplineSpace.uniform(2, 1),) * 2, net, np.outer(weights1, weights2))


def unit_arc(angles: Angles) -> tuple[Array, Array]:
    """Control points (cos, sin), shape ``(3, 2)``, and weights of an arc of the unit circle.

    The end tangents meet at the distance 1/cos(half the opening), with weight cos(half the opening).
    """
    opening = angles[1] - angles[0]
    if not 0.0 < opening < 180.0:
        raise ValueError(
            f"an arc from {angles[0]:g} to {angles[1]:g} degrees opens by {opening:g}: one smooth "
            f"segment opens by more than 0 and less than 180; use symmetry, or several films"
        )
    middle = np.cos(np.deg2rad(0.5 * opening))
    phi = np.deg2rad([angles[0], 0.5 * (angles[0] + angles[1]), angles[1]])
    reach = np.array([1.0, 1.0 / middle, 1.0])
    points = reach[:, None] * np.stack((np.cos(phi), np.sin(phi)), axis=1)
    return points, np.array([1.0, middle, 1.0])


def _check_positive(**sizes: float) -> None:
    for name, size in sizes.items():
        if not size > 0:
            raise ValueError(f"the {name} {size:g} is not positive: give a size in mm")
