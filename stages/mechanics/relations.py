"""Linear relations between the displacements of control points."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from stages.mechanics.edges import Points
from stages.numerics.bsplines import Array

COMPONENTS = ("x", "y", "z")

NEGLIGIBLE = 1e-12
"""Factor of a relation, relative to its largest one, that is round-off of the geometry."""


@dataclass(frozen=True)
class Relation:
    """sum_k factors_k u_k = value between degrees of freedom; value in mm.

    Degrees of freedom are numbered ``3 * control point + component``.
    """

    degrees: tuple[int, ...]
    factors: tuple[float, ...]
    value: float = 0.0


def held(points: Points, components: Iterable[str] = COMPONENTS) -> Iterator[Relation]:
    """Components of control points that are zero."""
    for point in points:
        for component in components:
            yield Relation((3 * int(point) + COMPONENTS.index(component),), (1.0,))


def along(points: Points, directions: Array) -> Iterator[Relation]:
    """The displacement of each control point along its direction (points, 3) is zero.

    Components of round-off size are left out, so that a direction along an axis holds one component.
    """
    for point, direction in zip(points, directions, strict=True):
        kept = np.abs(direction) > NEGLIGIBLE * np.abs(direction).max()
        yield Relation(
            tuple(3 * int(point) + int(x) for x in np.flatnonzero(kept)),
            tuple(float(factor) for factor in direction[kept]),
        )
