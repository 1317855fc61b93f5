"""The part of the film that each collocation point stands for: its interval of an edge, its cell inside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.collocation import edge_points
from stages.numerics.film_lengths import FilmLengths
from stages.numerics.patches import Patch

Interval = tuple[float, float]


@dataclass(frozen=True)
class PointCells:
    """Tensor grid of collocation points, by their lengths along the film.

    Intervals of an edge end half way between its points. Cells inside do likewise, but those next to an
    edge or a seam reach up to it: points there take no current, and none may be lost.

    Attributes
    ----------
    x, y
        Lengths X and Y of the rows and columns of points, shapes ``(m1,)`` and ``(m2,)``, mm.
    closed
        Whether X and Y run around a closed film.
    """

    x: Array
    y: Array
    closed: tuple[bool, bool] = (False, False)

    @classmethod
    def of(cls, patch: Patch) -> PointCells:
        """Cells of the Greville points of a patch."""
        return cls(*FilmLengths(patch).grid(), patch.closed)

    def nowhere(self) -> Array:
        """Zero at every point, shape ``(point,)``."""
        return np.zeros(self.x.size * self.y.size)

    def share_of_edge(self, edge: str, extent: Interval | None) -> Array:
        """Part of each boundary point's interval inside an extent of an edge; none: 1 on all of it.

        Raises
        ------
        ValueError
            If the extent lies beside the edge, or the film is closed where the edge would be.
        """
        share = self.nowhere()
        edges = edge_points(self.x.size, self.y.size, self.closed)
        if edge not in edges:
            raise ValueError(
                f"there is no edge {edge}: the film is closed in that direction; its edges are "
                f"{', '.join(edges) or 'none'}"
            )
        at, seam = (self.y, self.closed[1]) if edge[0] == "X" else (self.x, self.closed[0])
        part = np.ones(at.size) if extent is None else _share(_bounds(at), extent)
        if not part.any():
            raise ValueError(
                f"the extent {extent} mm lies beside the edge {edge}: move it onto the film"
            )
        if seam:  # both ends are one point, with an interval on both sides
            part[0] = 0.5 * (part[0] + part[-1])
            part = part[:-1]
        share[edges[edge]] = part
        return share

    def share_of_rectangle(self, x: Interval, y: Interval) -> Array:
        """Part of each inner point's cell inside a rectangle.

        Raises
        ------
        ValueError
            If the rectangle lies beside the film.
        """
        parts = np.outer(_share(_inner_bounds(self.x), x), _share(_inner_bounds(self.y), y))
        return self._inside(parts, f"the stimulated rectangle X {x}, Y {y} mm")

    def share_of_disc(self, centre: tuple[float, float], radius: float) -> Array:
        """Part of each inner point's cell inside a disc.

        Raises
        ------
        ValueError
            If the disc lies beside the film.
        """
        x, y = _inner_bounds(self.x), _inner_bounds(self.y)
        corners = radius**2 * disc_below(
            ((x - centre[0]) / radius)[:, None], ((y - centre[1]) / radius)[None, :]
        )
        inside = np.diff(np.diff(corners, axis=0), axis=1)
        parts = np.clip(inside / np.outer(np.diff(x), np.diff(y)), 0.0, 1.0)
        return self._inside(parts, f"the stimulated disc of radius {radius:g} mm about {centre} mm")

    def _inside(self, parts: Array, what: str) -> Array:
        if not parts.any():
            raise ValueError(f"{what} lies beside the film: move it onto the film")
        share = np.zeros((self.x.size, self.y.size))
        share[1:-1, 1:-1] = parts
        return share.ravel()


def disc_below(x: Array, y: Array) -> Array:
    """Area of the part u <= x, v <= y of the unit disc.

    The chord at u reaches from -s to min(y, s), s = sqrt(1 - u^2), and s has the primitive
    H(u) = (u s + asin u)/2.

    Examples
    --------
    >>> [round(float(disc_below(np.array(x), np.array(y))), 12) for x, y in ((0, 0), (1, 0), (0, 2))]
    [0.785398163397, 1.570796326795, 1.570796326795]
    """
    x, y = np.clip(x, -1.0, 1.0), np.clip(y, -1.0, 1.0)
    half = np.sqrt(1.0 - y**2)  # where min(y, s) changes over
    middle = np.clip(x, -half, half)

    def primitive(u: Array) -> Array:
        return np.asarray(0.5 * (u * np.sqrt(1.0 - u**2) + np.arcsin(u)))

    cut = y * (middle + half) + primitive(middle) - primitive(-half)
    whole = primitive(np.minimum(x, -half)) - primitive(np.full_like(x, -1.0))
    whole = whole + primitive(np.maximum(x, half)) - primitive(half)
    return np.asarray(cut + np.where(y >= 0.0, 2.0 * whole, 0.0))


def _bounds(at: Array) -> Array:
    return np.concatenate((at[:1], 0.5 * (at[:-1] + at[1:]), at[-1:]))


def _inner_bounds(at: Array) -> Array:
    return np.concatenate((at[:1], 0.5 * (at[1:-2] + at[2:-1]), at[-1:]))


def _share(bounds: Array, extent: Interval) -> Array:
    """Part of each interval between two bounds that lies inside ``extent``."""
    low, high = bounds[:-1], bounds[1:]
    inside = np.minimum(high, extent[1]) - np.maximum(low, extent[0])
    return np.asarray(np.maximum(inside, 0.0) / (high - low))
