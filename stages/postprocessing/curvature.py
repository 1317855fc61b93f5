"""Curvature of the bent film from the length of its projection, as experimenters measure it."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import brentq

from stages.numerics.bsplines import Array, SplineSpace

SAMPLES_PER_ELEMENT = 4
"""Samples that bracket the widest point; a spline of low degree bends at most once between two."""


def widest_point(space: SplineSpace, coefficients: Array) -> float:
    """Largest value of a spline over its domain.

    The largest sample brackets it; within the bracket the zero of the derivative is solved for, so
    that the result varies smoothly when the spline does.

    Parameters
    ----------
    space
        Spline space of the line.
    coefficients
        Shape ``(n,)``.

    Examples
    --------
    >>> line = SplineSpace.uniform(degree=2, elements=3)
    >>> parabola = line.interpolate(line.greville() * (1.3 - line.greville()))
    >>> abs(widest_point(line, parabola) - 0.65**2) < 1e-15
    True
    """
    spline = BSpline(space.knots, coefficients, space.degree)
    slope = spline.derivative()
    grid = _samples(space)
    values = spline(grid)
    best = int(np.argmax(values))
    left, right = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
    if slope(left) > 0 > slope(right):
        turn = brentq(lambda at: float(slope(at)), left, right, xtol=1e-15)
        return max(float(values[best]), float(spline(turn)))
    return float(values[best])


def curvature_from_projection(projected: float, length: float) -> float:
    """Curvature 1/R of a circular arc of known length from the length of its projection (eq. 101).

    x = R sin(L/R) while the arc turns by less than 90 degrees, that is while x > 2 L/pi; beyond, the
    projection ends at the widest point of the circle and x = R.

    Parameters
    ----------
    projected
        Length x of the projection on the plane of the undeformed film, mm.
    length
        Length L of the arc, mm.

    Returns
    -------
    float
        1/R in 1/mm; 0 for a film that is flat or stretched (x >= L).

    Raises
    ------
    ValueError
        If the projection has no length: no arc looks like that.

    Notes
    -----
    Eq. 101 prints the threshold as L/pi. There R sin(L/R) would give two curvatures for one x; the
    two branches meet at 2 L/pi.

    Examples
    --------
    >>> from math import sin
    >>> round(curvature_from_projection(4.0 * sin(3.5 / 4.0), 3.5), 12)
    0.25
    >>> curvature_from_projection(1.25, 3.5)
    0.8
    """
    if not projected > 0:
        raise ValueError(
            f"the projected length is {projected:g} mm: the film folds back behind its clamped edge"
        )
    if projected >= length:
        return 0.0
    if projected <= 2 * length / np.pi:
        return 1.0 / projected
    ratio = projected / length
    angle = brentq(lambda u: np.sinc(u / np.pi) - ratio, 0.0, np.pi / 2, xtol=1e-15)
    return float(angle) / length


def arc_length(space: SplineSpace, control_points: Array) -> float:
    """Length of a spline curve with control points ``(n, 3)``: Gauss rule of 8 points per span."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    half = np.diff(space.breaks) / 2
    points = (space.breaks[:-1] + half)[:, None] + half[:, None] * nodes
    speed = np.linalg.norm(space.evaluate(points.ravel(), 1) @ control_points, axis=1)
    return float(np.sum(speed.reshape(points.shape) * weights * half[:, None]))


def _samples(space: SplineSpace) -> Array:
    fractions = np.arange(SAMPLES_PER_ELEMENT) / SAMPLES_PER_ELEMENT
    inner = space.breaks[:-1, None] + np.diff(space.breaks)[:, None] * fractions
    return np.append(inner.ravel(), space.breaks[-1])
