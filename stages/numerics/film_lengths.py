"""Lengths X and Y along an undeformed film, and the parameters that belong to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
"""Gauss rule between two knots; exact to rounding for the speed along any smooth film."""

SLACK = 1e-9
"""Part of the film's size by which a point may miss its end, by rounding."""


@dataclass(frozen=True)
class FilmLengths:
    """Material coordinates X(theta1) and Y(theta2) of a film.

    X is the length along the middle line theta2 = 1/2, from the edge theta1 = 0, and Y that along
    theta1 = 1/2. On a flat rectangle these are the Cartesian coordinates, and on a cylinder or any other
    developable film whose parameter lines are straight in the flat state they are lengths along every
    line; on a sphere they belong to the two middle lines.

    Attributes
    ----------
    patch
        The undeformed film, or a surface parallel to it, on which X and Y go on to mean the film's
        (``patch.extent``).
    """

    patch: Patch

    @property
    def size(self) -> tuple[float, float]:
        """Length and width of the film, mm."""
        if self.patch.extent is not None:
            return self.patch.extent
        return self._total(0), self._total(1)

    def grid(self) -> tuple[Array, Array]:
        """X of the rows of Greville points and Y of the columns, shapes ``(m1,)`` and ``(m2,)``, mm."""
        first, second = self.patch.spaces
        return self.along(0, first.greville()), self.along(1, second.greville())

    def along(self, direction: int, theta: Array) -> Array:
        """X (direction 0) or Y (direction 1) of parameters of that direction, shape ``(n,)``, mm."""
        breaks = self.patch.spaces[direction].breaks
        before = self._at_breaks(direction)
        theta = np.asarray(theta, dtype=float)
        span = np.clip(np.searchsorted(breaks, theta, side="right") - 1, 0, breaks.size - 2)
        found = before[span] + self._lengths(direction, breaks[span], theta)
        return np.asarray(found * self._scale(direction))

    def parameters_along(self, direction: int, lengths: Array) -> Array:
        """Parameters of given lengths X or Y, shape ``(n,)``: Newton's method from the nearest span.

        Raises
        ------
        ValueError
            If a length lies off the film.
        """
        space, name = self.patch.spaces[direction], "XY"[direction]
        lengths = np.asarray(lengths, dtype=float)
        off = self._off(direction, lengths)
        if off.any():
            raise ValueError(
                f"{name} = {lengths[off][0]:.10g} mm does not lie on the film, on which {name} runs from 0 "
                f"to {self.size[direction]:.10g} mm"
            )
        low, high = space.knots[0], space.knots[-1]
        at_breaks = self._scale(direction) * self._at_breaks(direction)
        theta = np.interp(lengths, at_breaks, space.breaks)
        for _ in range(50):
            gap = lengths - self.along(direction, theta)
            moved = theta + gap / (self._scale(direction) * self._speed(direction, theta))
            moved = np.clip(moved, low, high)
            change = float(np.abs(moved - theta).max(initial=0.0))
            theta = moved
            if change <= 4e-16 * (high - low):
                break
        return np.asarray(theta)

    def parameters(self, points: Array) -> Array:
        """Parameters of points (X, Y), shape ``(n, 2)`` both.

        Raises
        ------
        ValueError
            If a point lies off the film.
        """
        points = np.atleast_2d(np.asarray(points, dtype=float))
        off = self._off(0, points[:, 0]) | self._off(1, points[:, 1])
        if off.any():
            raise ValueError(
                f"the point {points[off][0].tolist()} mm does not lie on the film, on which X runs from 0 to "
                f"{self.size[0]:.10g} and Y from 0 to {self.size[1]:.10g} mm"
            )
        columns = [self.parameters_along(d, points[:, d]) for d in (0, 1)]
        return np.stack(columns, axis=1)

    def _off(self, direction: int, lengths: Array) -> NDArray[np.bool_]:
        total = self.size[direction]
        inside = (lengths >= -SLACK * total) & (lengths <= (1 + SLACK) * total)
        return np.asarray(~inside)  # NaN lies nowhere

    def _total(self, direction: int) -> float:
        return float(self._at_breaks(direction)[-1])

    def _scale(self, direction: int) -> float:
        """From lengths of the patch itself to those of the film."""
        if self.patch.extent is None:
            return 1.0
        return self.patch.extent[direction] / self._total(direction)

    def _at_breaks(self, direction: int) -> Array:
        """Lengths of the patch's own middle line up to each knot."""
        breaks = self.patch.spaces[direction].breaks
        spans = self._lengths(direction, breaks[:-1], breaks[1:])
        return np.concatenate(([0.0], np.cumsum(spans)))

    def _lengths(self, direction: int, start: Array, stop: Array) -> Array:
        """Lengths of the middle line between parameters of one span each."""
        half = 0.5 * (stop - start)
        theta = (start + half)[:, None] + half[:, None] * NODES
        low, high = self.patch.spaces[direction].knots[[0, -1]]
        speed = self._speed(direction, np.clip(theta.ravel(), low, high)).reshape(theta.shape)
        return np.asarray((speed @ WEIGHTS) * half)

    def _speed(self, direction: int, theta: Array) -> Array:
        """|r_,d| on the middle line."""
        other = self.patch.spaces[1 - direction]
        at = [np.array([0.5 * (other.knots[0] + other.knots[-1])])] * 2
        at[direction] = theta
        orders = (1, 0) if direction == 0 else (0, 1)
        return np.asarray(np.linalg.norm(self.patch.evaluate(at[0], at[1], orders), axis=1))


def length_between(patch: Patch, theta2: float, gates: Array) -> float:
    """Length of the line theta2 = const between two values of theta1, on the patch itself, mm.

    Examples
    --------
    >>> round(length_between(Patch.rectangle(3.5, 2.0), 0.3, np.array([0.2, 0.6])), 14)
    1.4
    """
    low, high = (float(gate) for gate in gates)
    inner = patch.first.breaks
    ends = np.concatenate(([low], inner[(inner > low) & (inner < high)], [high]))
    half = 0.5 * np.diff(ends)
    theta1 = (ends[:-1] + half)[:, None] + half[:, None] * NODES
    tangents = patch.evaluate(theta1.ravel(), np.array([theta2]), (1, 0))
    speed = np.linalg.norm(tangents, axis=1).reshape(theta1.shape)
    return float(np.sum((speed @ WEIGHTS) * half))
