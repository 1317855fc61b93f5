"""Smooth surface through a grid of points, and patches that follow it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch, interpolate_grid
from stages.numerics.surface_geometry import frame_on_grid

SAMPLES = 400
"""Chords of the middle lines; lengths between two are interpolated by cubic splines."""

CURVATURE_GRID = 41
"""Samples along each direction of the smallest radius."""


@dataclass(frozen=True)
class FreeSurface:
    """Tensor-product spline of degree 3 (2 through three points) and class C2.

    Attributes
    ----------
    first, second
        Splines over u and v in [0, 1] through unit values at the rows and columns of points.
    net
        The points, shape ``(row, column, 3)``, mm.
    lines
        u and v as splines over the part of the length along the middle lines.
    size
        Lengths of the middle lines, mm.
    """

    first: BSpline
    second: BSpline
    net: Array
    lines: tuple[BSpline, BSpline]
    size: tuple[float, float]

    @classmethod
    def through(cls, points: Sequence[Sequence[Sequence[float]]]) -> FreeSurface:
        """Surface through rows of points, its parameters by the mean of the chords.

        Raises
        ------
        ValueError
            If neighbouring points coincide.
        """
        net = np.array(points, dtype=float)
        first, second = _cardinal(net, 0), _cardinal(net, 1)
        middle = np.array([0.5, 0.5])
        for _ in range(60):  # the middle of each line lies on the other
            lines, sizes, at = [], [], middle.copy()
            for direction in (0, 1):
                by_length, size = _by_length(first, second, net, direction, middle)
                lines.append(by_length)
                sizes.append(size)
                at[direction] = by_length(0.5)
            change, middle = float(np.abs(at - middle).max()), at
            if change < 1e-14:
                break
        return cls(first, second, net, (lines[0], lines[1]), (sizes[0], sizes[1]))

    def at(self, theta1: Array, theta2: Array) -> Array:
        """Points on a tensor grid of parameters by length, shape ``(n1, n2, 3)``, mm."""
        u, v = (line(theta) for line, theta in zip(self.lines, (theta1, theta2), strict=True))
        u, v = np.clip(u, 0.0, 1.0), np.clip(v, 0.0, 1.0)
        return np.asarray(np.einsum("ai,bj,ijx->abx", self.first(u), self.second(v), self.net))

    def patch(self, degree: int, elements: tuple[int, int]) -> Patch:
        """Spline patch through the surface at its Greville points."""
        spaces = SplineSpace.uniform(degree, elements[0]), SplineSpace.uniform(degree, elements[1])
        values = self.at(*(space.greville() for space in spaces))
        return Patch(*spaces, interpolate_grid(spaces, values))

    def smallest_radius(self) -> float:
        """Smallest radius of curvature on a grid of samples, mm; infinite where it is flat.

        Raises
        ------
        ValueError
            If the surface has no normal somewhere.
        """
        patch = self.patch(3, (CURVATURE_GRID, CURVATURE_GRID))
        grid = np.linspace(0.0, 1.0, CURVATURE_GRID)
        frame = frame_on_grid(patch, grid, grid)
        bends = np.linalg.eigvals(frame.curvature @ frame.metric_con)
        largest = float(np.abs(bends).max())
        return 1.0 / largest if largest > 0 else np.inf


def _cardinal(net: Array, direction: int) -> BSpline:
    rows = np.moveaxis(net, direction, 0)
    chords = np.linalg.norm(np.diff(rows, axis=0), axis=2)
    if not (chords > 0).all():
        i, j = np.argwhere(chords == 0)[0]
        name = ("row", "column")[direction]
        raise ValueError(
            f"the points of {name}s {i} and {i + 1} (counted from 0) coincide at "
            f"{rows[i, j].tolist()} mm: give different points"
        )
    at = np.concatenate(([0.0], np.cumsum((chords / chords.sum(axis=0)).mean(axis=1))))
    at /= at[-1]
    return make_interp_spline(at, np.eye(at.size), k=min(3, at.size - 1))


def _by_length(
    first: BSpline, second: BSpline, net: Array, direction: int, middle: Array
) -> tuple[BSpline, float]:
    """The parameter of a middle line over the part of its length, and its length."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    ends = np.linspace(0.0, 1.0, SAMPLES + 1)
    half = 0.5 / SAMPLES
    at = (ends[:-1] + half)[:, None] + half * nodes
    along, across = (first, second) if direction == 0 else (second, first)
    line = np.tensordot(across(middle[1 - direction]), net, axes=(0, 1 - direction))
    speed = np.linalg.norm(along(at.ravel(), 1) @ line, axis=1).reshape(at.shape)
    lengths = np.concatenate(([0.0], np.cumsum(speed @ weights * half)))
    return make_interp_spline(lengths / lengths[-1], ends, k=3), float(lengths[-1])
