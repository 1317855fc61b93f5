"""Where beats are measured: collocation points, by their lengths X and Y along the film."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array
from stages.numerics.film_lengths import FilmLengths
from stages.numerics.patches import Patch

Points = NDArray[np.int64]


@dataclass(frozen=True)
class Gauge:
    """One point, and a line of points that times a wave.

    Attributes
    ----------
    point
        Number of the collocation point.
    line
        Points by which a wave is timed, in their order along X; none in a cell.
    distance
        X of these, mm.
    """

    point: int
    line: Points
    distance: Array

    @classmethod
    def cell(cls) -> Gauge:
        """The only point there is."""
        return cls(0, np.empty(0, dtype=np.int64), np.empty(0))

    @classmethod
    def strip(cls, patch: Patch, window: tuple[float, float]) -> Gauge:
        """Points along the middle of a strip; the one is that next to the middle of the window.

        Raises
        ------
        ValueError
            If the window holds fewer than two of them.
        """
        x, y = FilmLengths(patch).grid()
        line = np.arange(x.size, dtype=np.int64) * y.size + y.size // 2
        inside = (x >= window[0]) & (x <= window[1])
        if inside.sum() < 2:
            raise ValueError(
                f"the window {window} mm holds fewer than two collocation points: widen it, or refine "
                "the mesh"
            )
        middle = int(np.argmin(np.abs(x - 0.5 * sum(window))))
        return cls(int(line[middle]), line[inside], x[inside])


def nearest_points(patch: Patch, places: Sequence[tuple[float, float]]) -> Points:
    """Number of the collocation point next to each place (X, Y) in mm."""
    x, y = FilmLengths(patch).grid()
    rows = [int(np.argmin(np.abs(x - place[0]))) for place in places]
    columns = [int(np.argmin(np.abs(y - place[1]))) for place in places]
    return np.array(rows, dtype=np.int64) * y.size + np.array(columns, dtype=np.int64)
