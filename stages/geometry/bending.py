"""Arcs and rings, and films bent to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch
from stages.numerics.shapes import unit_arc


@dataclass(frozen=True)
class Curve:
    """Plane spline curve of a film's cross-section.

    Attributes
    ----------
    space
        Its splines.
    points
        Control points (along, up), shape ``(n, 2)``, mm.
    weights
        Shape ``(n,)``; none: polynomial.
    """

    space: SplineSpace
    points: Array
    weights: Array | None = None

    def refined(self, degree: int, elements: int) -> Curve:
        """The same curve on a finer mesh."""
        finer = self.space.refine(degree, elements)
        embed = self.space.embed(finer)
        if self.weights is None:
            return Curve(finer, embed @ self.points)
        weights = embed @ self.weights
        return Curve(
            finer, embed @ (self.weights[:, None] * self.points) / weights[:, None], weights
        )


def line(length: float, degree: int, elements: int) -> Curve:
    """Straight line from (0, 0) to (length, 0)."""
    start = SplineSpace.uniform(1, 1)
    return Curve(start, np.array([(0.0, 0.0), (length, 0.0)])).refined(degree, elements)


def arc(radius: float, start: float, stop: float, degree: int, elements: int) -> Curve:
    """Arc through (0, 0), where it runs along the first axis, that bends upwards.

    Below half a turn it is exact: one rational quadratic, refined. A longer one would need segments with
    kinks in the splines between them (:mod:`stages.numerics.shapes`); it is a spline through points of
    the arc instead, of the right length, whose radius is off by the fourth power of the mesh size.

    Parameters
    ----------
    radius
        mm.
    start, stop
        Lengths along the arc from (0, 0), start <= 0 <= stop, mm.

    Examples
    --------
    >>> quarter = arc(2.0, 0.0, np.pi, 2, 4)
    >>> quarter.points[-1].round(12).tolist()
    [2.0, 2.0]
    """
    low, high = start / radius, stop / radius
    if high - low < np.pi:
        circle, weights = unit_arc((float(np.rad2deg(low)), float(np.rad2deg(high))))
        points = radius * np.stack((circle[:, 1], 1.0 - circle[:, 0]), axis=1)
        return Curve(SplineSpace.uniform(2, 1), points, weights).refined(degree, elements)
    space = SplineSpace.uniform(degree, elements)
    angles = low + (high - low) * space.greville()
    points = radius * np.stack((np.sin(angles), 1.0 - np.cos(angles)), axis=1)
    net = space.interpolate(points)
    return Curve(space, net * (stop - start) / _length(space, net))


def ring(circumference: float, degree: int, elements: int) -> Curve:
    """Closed circle that begins and ends at its top, as smooth there as between any other two spans.

    A periodic spline with a regular polygon as its control points; its length is right, its lowest point
    lies at (0, 0), and its radius is off by the fourth power of the mesh size.

    Raises
    ------
    ValueError
        If there are too few spans.
    """
    if elements <= degree:
        raise ValueError(
            f"{elements} elements of degree {degree} are too few around a tube: it takes {degree + 1} at least"
        )
    turned = np.arange(-degree, elements) + 0.5 * (
        degree + 1
    )  # Greville points of a periodic spline
    angles = 2.0 * np.pi * turned / elements - np.pi
    polygon = np.stack((np.sin(angles), -np.cos(angles)), axis=1)
    # periodic splines are open splines, too: interpolation between the two is exact
    space = SplineSpace.uniform(degree, elements)
    knots = np.arange(-degree, elements + degree + 1) / elements
    net = space.interpolate(BSpline(knots, polygon, degree)(space.greville()))
    net[-1] = net[0]
    net *= circumference / _length(space, net)
    lowest = space.evaluate(np.array([0.5])) @ net
    return Curve(space, net - lowest)


def bent(profile: Curve, straight: Curve, about: str, middle: float, inside: str) -> Patch:
    """Film with a curved profile in one direction, straight in the other.

    Parameters
    ----------
    profile
        Cross-section, from (0, 0) along the film.
    straight
        The other direction.
    about
        ``"Y"``: the profile runs along X. ``"X"``: along Y, and (0, 0) is at Y = ``middle``.
    inside
        Face towards which the film bends: ``"top"`` bends up.
    """
    sign = 1.0 if inside == "top" else -1.0
    curved = profile.points * (1.0, sign)
    m, n = len(curved), len(straight.points)
    net = np.empty((m, n, 3))
    net[..., 2] = curved[:, 1, None]
    if about == "Y":
        net[..., 0], net[..., 1] = curved[:, 0, None], straight.points[:, 0]
        spaces = profile.space, straight.space
    else:
        net[..., 0], net[..., 1] = straight.points[:, 0], middle + curved[:, 0, None]
        net, spaces = np.swapaxes(net, 0, 1), (straight.space, profile.space)
    if profile.weights is None:
        return Patch(*spaces, net)
    rational = np.repeat(profile.weights[:, None], n, axis=1)
    return Patch(*spaces, net, rational if about == "Y" else rational.T.copy())


def sphere(radius: float, length: float, width: float, inside: str) -> Patch:
    """Segment of a sphere around the middle line Y = width/2 of its equator, exact.

    At the longitude X/radius and the latitude (Y - width/2)/radius.
    """
    around, weights1 = unit_arc((0.0, float(np.rad2deg(length / radius))))
    half = float(np.rad2deg(0.5 * width / radius))
    upwards, weights2 = unit_arc((-half, half))
    net = np.empty((3, 3, 3))
    net[..., 0] = radius * around[:, 1, None] * upwards[:, 0]
    net[..., 1] = 0.5 * width + radius * upwards[:, 1]
    net[..., 2] = radius * (1.0 - around[:, 0, None] * upwards[:, 0])
    net[..., 2] *= 1.0 if inside == "top" else -1.0
    return Patch(*(SplineSpace.uniform(2, 1),) * 2, net, np.outer(weights1, weights2))


def _length(space: SplineSpace, net: Array) -> float:
    """Length of a polynomial spline curve with control points ``(n, k)``."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    half = 0.5 * np.diff(space.breaks)
    points = (space.breaks[:-1] + half)[:, None] + half[:, None] * nodes
    speed = np.linalg.norm(space.evaluate(points.ravel(), 1) @ net, axis=1)
    return float(np.sum(speed.reshape(points.shape) * weights * half[:, None]))
