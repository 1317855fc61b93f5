"""The mid-axis of the film over time: how long its projection is, how far it has turned."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.time_series import StoredFrames, blocks
from stages.postprocessing.curvature import arc_length, curvature_from_projection, widest_point

SAMPLES_PER_ELEMENT = 4
"""Tangents compared with one another; between two neighbours a film turns by far less than 180 degrees."""


@dataclass(frozen=True)
class AxisSeries:
    """A line theta2 = const of the film at every time.

    Attributes
    ----------
    projected_length
        Its largest X, mm, shape ``(time,)``; NaN unless the film is flat at rest.
    curvature
        From that and its own length (eq. 101), 1/mm, shape ``(time,)``; likewise.
    turning
        Largest angle between two of its tangents, seen along Y, degrees, shape ``(time,)``.
    """

    projected_length: Array
    curvature: Array
    turning: Array


def follow_axis(film: Patch, displacement: StoredFrames, theta2: float) -> AxisSeries:
    """Series of a line of the deformed film.

    Projection and curvature are those of experiments with films that are flat at rest; of another one they
    are NaN, since its projection says nothing about how far it has bent.

    Parameters
    ----------
    film
        Undeformed mid-surface, held at X = 0.
    displacement
        Of the control points, shape ``(time, control point, xyz)``, mm.
    theta2
        Parameter of the line.
    """
    samples = SAMPLES_PER_ELEMENT * film.first.elements + 1
    at = np.linspace(film.first.knots[0], film.first.knots[-1], samples)
    slopes = film.functions(np.column_stack((at, np.full(samples, theta2))), (1, 0))
    used = np.flatnonzero(np.any(slopes != 0.0, axis=0))
    slopes, net = slopes[:, used], film.control_points.reshape(-1, 3)
    frames = displacement.shape[0]
    projected, curvature, turning = (np.full(frames, np.nan) for _ in range(3))
    flat = is_flat(film)
    if flat:
        across = film.second.evaluate(np.array([theta2]))[0]
        line = np.einsum("j,ijx->ix", across, film.control_points)
        length = arc_length(film.first, line)
    for found, block in blocks(displacement):
        tangents = np.einsum("sp,tpx->tsx", slopes, net[used] + block[:, used])
        angles = np.unwrap(np.arctan2(tangents[:, :, 2], tangents[:, :, 0]), axis=1)
        turning[found] = np.degrees(np.ptp(angles, axis=1))
        if flat:
            moved = block.reshape(len(block), film.first.size, film.second.size, 3)[..., 0]
            widest = line[:, 0] + np.einsum("tij,j->ti", moved, across)
            projected[found] = [widest_point(film.first, x) for x in widest]
    if flat:
        curvature = np.array([curvature_from_projection(x, length) for x in projected])
    return AxisSeries(projected, curvature, turning)


def is_flat(film: Patch) -> bool:
    """Whether a film lies in a plane Z = const, and so has a projection to be measured.

    Examples
    --------
    >>> is_flat(Patch.rectangle(3.5, 2.0))
    True
    """
    net = film.control_points.reshape(-1, 3)
    size = np.ptp(net, axis=0)
    return film.weights is None and bool(size[2] <= 1e-9 * size.max())
