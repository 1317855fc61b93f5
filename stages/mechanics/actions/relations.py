"""Relations between the displacements of control points, in the forms that supports need.

Degrees of freedom are numbered ``3 * control point + component``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array
from stages.numerics.ties import Relation

Points = NDArray[np.int64]
"""Numbers of control points."""

COMPONENTS = ("x", "y", "z")

NEGLIGIBLE = 1e-12
"""Factor of a relation, relative to its largest one, that is round-off of the geometry."""


def held(points: Points, components: Iterable[str] = COMPONENTS) -> Iterator[Relation]:
    """Components of control points that are zero."""
    yield from moved(points, dict.fromkeys(components, 0.0))


def moved(points: Points, components: Mapping[str, float]) -> Iterator[Relation]:
    """Components of control points that are prescribed, mm."""
    for point in points:
        for component, value in components.items():
            yield Relation((3 * int(point) + COMPONENTS.index(component),), (1.0,), value)


def along(points: Points, directions: Array) -> Iterator[Relation]:
    """The displacement of each control point along its direction (points, 3) is zero."""
    for point, direction in zip(points, directions, strict=True):
        yield weighted([int(point)], [1.0], direction)


def together(points: Points, others: Points, directions: Array) -> Iterator[Relation]:
    """Two control points move alike along a direction (points, 3), pair by pair."""
    for point, other, direction in zip(points, others, directions, strict=True):
        yield weighted([int(point), int(other)], [1.0, -1.0], direction)


def weighted(
    points: Sequence[int], weights: Sequence[float], direction: Array, value: float = 0.0
) -> Relation:
    """sum_i weights_i u_i . direction = value.

    Components of round-off size are left out, so that a direction along an axis holds one component.
    """
    kept = np.flatnonzero(np.abs(direction) > NEGLIGIBLE * np.abs(direction).max())
    terms = [
        (3 * point + int(x), weight * float(direction[x]))
        for point, weight in zip(points, weights, strict=True)
        for x in kept
    ]
    unknowns, factors = zip(*terms, strict=True)
    return Relation(unknowns, factors, value)
