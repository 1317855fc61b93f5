"""Univariate B-spline spaces: evaluation, Greville points, knot insertion, degree elevation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.linalg import solve_banded

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class SplineSpace:
    """Space of splines of one degree over an open knot vector.

    Parameters
    ----------
    degree
        Polynomial degree p >= 1.
    knots
        Non-decreasing knot vector of shape ``(n + p + 1,)``; the first and the last p + 1 knots
        coincide (open), interior knots are repeated at most p times (continuous).

    Raises
    ------
    ValueError
        If the knot vector is not open, decreases, or breaks continuity.

    Examples
    --------
    >>> space = SplineSpace.uniform(degree=2, elements=4)
    >>> space.size, space.elements
    (6, 4)
    >>> space.greville().tolist()
    [0.0, 0.125, 0.375, 0.625, 0.875, 1.0]
    """

    degree: int
    knots: Array

    def __post_init__(self) -> None:
        p, knots = self.degree, np.asarray(self.knots, dtype=float)
        object.__setattr__(self, "knots", knots)
        if p < 1:
            raise ValueError(f"degree {p} is not allowed: splines here have degree 1 or higher")
        if knots.ndim != 1 or knots.size < 2 * (p + 1):
            raise ValueError(f"a knot vector of degree {p} has at least {2 * (p + 1)} knots")
        if np.any(np.diff(knots) < 0):
            raise ValueError("knots must not decrease")
        if np.any(knots[: p + 1] != knots[0]) or np.any(knots[-p - 1 :] != knots[-1]):
            raise ValueError(f"the knot vector is not open: repeat both end knots {p + 1} times")
        _, counts = np.unique(knots, return_counts=True)
        if np.any(counts[1:-1] > p) or counts[0] > p + 1 or counts[-1] > p + 1:
            raise ValueError(f"a knot is repeated too often for degree {p}: the spline would jump")

    @classmethod
    def uniform(
        cls, degree: int, elements: int, start: float = 0.0, stop: float = 1.0
    ) -> SplineSpace:
        """Space with equal knot spans and maximum continuity C^(p-1)."""
        if elements < 1:
            raise ValueError(f"{elements} elements are not allowed: at least one is needed")
        breaks = np.linspace(start, stop, elements + 1)
        ends = np.full(degree, start), np.full(degree, stop)
        return cls(degree, np.concatenate((ends[0], breaks, ends[1])))

    @property
    def size(self) -> int:
        """Number n of basis functions."""
        return int(self.knots.size) - self.degree - 1

    @property
    def breaks(self) -> Array:
        """Distinct knots, shape ``(elements + 1,)``."""
        return np.unique(self.knots)

    @property
    def elements(self) -> int:
        """Number of non-empty knot spans."""
        return int(self.breaks.size) - 1

    @property
    def continuity(self) -> int:
        """Order of continuity over the interior knots (p - 1 for simple ones)."""
        _, counts = np.unique(self.knots, return_counts=True)
        return self.degree - int(counts[1:-1].max(initial=1))

    def greville(self) -> Array:
        """Greville abscissae (eq. 70), shape ``(n,)``: means of p consecutive knots."""
        p = self.degree
        sums = np.array([self.knots[i + 1 : i + p + 1].sum() for i in range(self.size)])
        points = sums / p
        points[0], points[-1] = self.knots[0], self.knots[-1]
        return points

    def span(self, x: Array) -> NDArray[np.int64]:
        """Index of the last knot of the non-empty span that holds each ``x``; the end belongs to the last."""
        x = np.atleast_1d(np.asarray(x, dtype=float))
        low, high = self.knots[0], self.knots[-1]
        if np.any(x < low) or np.any(x > high):
            bad = x[(x < low) | (x > high)][0]
            raise ValueError(
                f"parameter {bad:g} lies outside the spline's domain [{low:g}, {high:g}]"
            )
        found = np.searchsorted(self.knots, x, side="right") - 1
        return np.clip(found, self.degree, self.size - 1)

    def evaluate(self, x: Array, derivative: int = 0) -> Array:
        """Matrix of the basis functions (or a derivative) at points.

        Parameters
        ----------
        x
            Parameters, shape ``(points,)``, inside the domain.
        derivative
            Order of the derivative.

        Returns
        -------
        Array
            Dense matrix ``(points, n)``; at most p + 1 entries a row are not zero. At an interior
            knot the value from the right is taken.

        Raises
        ------
        ValueError
            If a parameter lies outside the domain.
        """
        x = np.atleast_1d(np.asarray(x, dtype=float))
        self.span(x)
        if derivative > self.degree:
            return np.zeros((x.size, self.size))
        basis = BSpline(self.knots, np.eye(self.size), self.degree)
        return np.asarray(basis(x, nu=derivative), dtype=float)

    def local(self, x: Array, derivatives: int) -> tuple[NDArray[np.int64], Array]:
        """Only the p + 1 functions that do not vanish at each point.

        Returns
        -------
        first
            Index of the first of them, shape ``(points,)``.
        values
            Shape ``(derivatives + 1, points, p + 1)``.
        """
        first = self.span(x) - self.degree
        columns = first[:, None] + np.arange(self.degree + 1)
        values = np.stack(
            [
                np.take_along_axis(self.evaluate(x, order), columns, axis=1)
                for order in range(derivatives + 1)
            ]
        )
        return first, values

    def interpolate(self, values: Array) -> Array:
        """Coefficients of the spline that takes ``values`` (first axis) at the Greville points."""
        matrix = self.evaluate(self.greville())
        p = self.degree
        bands = np.zeros((2 * p + 1, self.size))
        for offset in range(-p, p + 1):
            diagonal = np.diagonal(matrix, offset)
            start = max(offset, 0)
            bands[p - offset, start : start + diagonal.size] = diagonal
        return np.asarray(solve_banded((p, p), bands, values), dtype=float)

    def cardinals(self, x: Array) -> Array:
        """Matrix of the splines that are 1 at one Greville point and 0 at the others, ``(points, n)``.

        It takes values at the Greville points to values of their spline at ``x`` (eqs. 86-87).

        Examples
        --------
        >>> space = SplineSpace.uniform(degree=2, elements=3)
        >>> (space.cardinals(np.array([0.3])) @ space.greville() ** 2).round(12).tolist()
        [0.09]
        """
        return self.evaluate(x) @ self.interpolate(np.eye(self.size))

    def insert(self, new_knots: Array) -> SplineSpace:
        """Space with more knots, same degree; contains this one."""
        return SplineSpace(self.degree, np.sort(np.concatenate((self.knots, new_knots))))

    def elevate(self, by: int) -> SplineSpace:
        """Space of a higher degree with unchanged continuity; contains this one."""
        breaks, counts = np.unique(self.knots, return_counts=True)
        return SplineSpace(self.degree + by, np.repeat(breaks, counts + by))

    def refine(self, degree: int, elements: int) -> SplineSpace:
        """Space of the given degree whose spans split this one's evenly into ``elements`` in all.

        Degree is raised first and knots are inserted after, singly, so that the new knots carry the
        full continuity C^(degree-1).

        Raises
        ------
        ValueError
            If the degree would fall, or the spans cannot be split evenly.
        """
        if degree < self.degree:
            raise ValueError(f"degree {degree} is below the geometry's own degree {self.degree}")
        if elements < 1 or elements % self.elements:
            raise ValueError(
                f"{elements} elements cannot split the geometry's {self.elements} spans evenly"
            )
        each = elements // self.elements
        fractions = np.arange(1, each) / each
        widths = np.diff(self.breaks)
        inner = (self.breaks[:-1, None] + widths[:, None] * fractions).ravel()
        return self.elevate(degree - self.degree).insert(inner)

    def embed(self, finer: SplineSpace) -> Array:
        """Matrix ``(finer.size, size)`` that turns coefficients here into coefficients of ``finer``.

        Exact for knot insertion and degree elevation alike, because both spaces hold the same spline
        and interpolation at the Greville points of the finer one is unique.
        """
        return finer.interpolate(self.evaluate(finer.greville()))
